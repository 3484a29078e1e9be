// Single calls of every kernel: whatever comes in, the promises of carom.h hold.
#include "promises.h"

namespace {

using carom::Row;
using carom_fuzz::Case;
using carom_fuzz::found;
using carom_fuzz::Outcome;

constexpr int kMostSteps = 300;  // more take long, and do nothing else

int collide(const Row& row, const Case& c, const double* in, double* out, int steps) {
  if (steps > 0) return row.collide_steps(c.p, in, in + 9, out, out + 9, steps);
  return row.functions.collide(c.p, in, in + 9, out, out + 9);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  carom_fuzz::Bytes bytes(data, size);
  const Row& row = carom::kRows[bytes.take<std::uint8_t>() % carom::kRowCount];
  if (!row.runs()) return -1;
  const Case c = carom_fuzz::some_case(bytes);
  int steps = 0;
  if (row.steps > 0) steps = 1 + bytes.take<std::uint16_t>() % kMostSteps;
  Outcome o{}, place{};
  o.status = collide(row, c, c.balls, o.balls, steps);
  carom_fuzz::check_promises(row, c, o);
  std::memcpy(place.balls, c.balls, sizeof place.balls);
  place.status = collide(row, c, place.balls, place.balls, steps);
  if (place.status != o.status || !carom_fuzz::same(place.balls, o.balls, 18)) {
    found("other in place", row, c);
  }
  return 0;
}
