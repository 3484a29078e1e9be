// The C ABI of every kernel: whatever comes in, the promises of carom.h hold.
#include <initializer_list>

#include "fuzz_input.h"

namespace {

using carom::Row;
using carom_fuzz::Case;
using carom_fuzz::found;

constexpr int kOk = 0, kTilted = 3;
constexpr int kMostSteps = 300;       // more take long, and do nothing else
constexpr double kMostChange = 20.0;  // times |v1 - v2|; 6 are possible, coarse steps overshoot

struct Result {
  double balls[18];
  int status;
};

Result collide(const Row& row, const Case& c, int steps) {
  Result r{};
  const double *one = c.balls, *two = c.balls + 9;
  if (steps > 0) {
    r.status = row.collide_steps(c.p, one, two, r.balls, r.balls + 9, steps);
  } else {
    r.status = row.functions.collide(c.p, one, two, r.balls, r.balls + 9);
  }
  return r;
}

bool same(const double* a, const double* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(double)) == 0;
}

// pooltool's axes are not orthogonal then, and change even what no impulse changes.
bool tilted(const Case& c) {
  const double x = c.balls[9] - c.balls[0], y = c.balls[10] - c.balls[1];
  return std::fabs(c.balls[11] - c.balls[2]) > 1e-9 * std::hypot(x, y);
}

// What a collision may change, and by how much.
void check(const Row& row, const Case& c, const Result& r) {
  if (r.status < kOk || r.status > kTilted) found("no such status", row, c);
  if (!same(r.balls, c.balls, 3) || !same(r.balls + 9, c.balls + 9, 3)) {
    found("a ball was moved", row, c);
  }
  if (r.status != kOk) {
    if (!same(r.balls, c.balls, 18)) found("not as it came, though refused", row, c);
    return;
  }
  for (double value : r.balls) {
    if (!std::isfinite(value)) found("not finite", row, c);
  }
  if (tilted(c)) return;
  const double* const b = c.balls;
  const double relative = std::hypot(std::hypot(b[12] - b[3], b[13] - b[4]), b[14] - b[5]);
  double fastest = 0.0;
  for (int i : {3, 4, 5, 12, 13, 14}) fastest = std::fmax(fastest, std::fabs(b[i]));
  for (int i : {6, 7, 8, 15, 16, 17}) fastest = std::fmax(fastest, c.p.R * std::fabs(b[i]));
  const double most = kMostChange * relative + 1e-9 * fastest;
  for (int i = 0; i < 18; ++i) {
    const double unit = i % 9 < 6 ? 1.0 : c.p.R;
    if (std::fabs(r.balls[i] - b[i]) * unit > most) found("changed by too much", row, c);
  }
}

// In place, and in a batch, the same to the last bit.
void check_ways(const Row& row, const Case& c, const Result& r, int steps) {
  Case place = c;
  double *one = place.balls, *two = place.balls + 9;
  const int status = steps > 0 ? row.collide_steps(c.p, one, two, one, two, steps)
                               : row.functions.collide(c.p, one, two, one, two);
  if (status != r.status || !same(place.balls, r.balls, 18)) found("other in place", row, c);
  if (steps > 0) return;
  constexpr std::size_t kCount = 5;
  double columns[18][kCount], outcomes[12][kCount];
  const double* in[18];
  double* out[12];
  unsigned char statuses[kCount];
  for (int j = 0; j < 18; ++j) {
    in[j] = columns[j];
    for (double& value : columns[j]) value = c.balls[j];
  }
  for (int j = 0; j < 12; ++j) out[j] = outcomes[j];
  const std::size_t good = row.functions.batch(c.p, nullptr, kCount, in, out, statuses);
  if (good != (r.status == kOk ? kCount : 0)) found("batch counts others", row, c);
  for (std::size_t i = 0; i < kCount; ++i) {
    if (statuses[i] != r.status) found("batch has another status", row, c);
    for (int j = 0; j < 12; ++j) {
      const double* const single = r.balls + (j < 6 ? j + 3 : j + 6);
      if (!same(&out[j][i], single, 1)) found("batch gives another result", row, c);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  carom_fuzz::Bytes bytes(data, size);
  const Row& row = carom::kRows[bytes.take<std::uint8_t>() % carom::kRowCount];
  if (!row.runs()) return -1;
  const unsigned kind = bytes.take<std::uint8_t>();
  Case c = (kind & 1u) != 0 ? carom_fuzz::any_case(bytes) : carom_fuzz::real_case(bytes);
  if ((kind & 6u) == 6u) {  // a real one with one number that is not
    c.balls[bytes.take<std::uint8_t>() % 18] = bytes.take<double>();
  }
  int steps = 0;
  if (row.steps > 0) steps = 1 + bytes.take<std::uint16_t>() % kMostSteps;
  const Result r = collide(row, c, steps);
  check(row, c, r);
  check_ways(row, c, r, steps);
  return 0;
}
