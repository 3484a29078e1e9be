// Batches of every kernel: the promises of carom.h hold, and what a collision gives depends on
// nothing but itself: not on its neighbours, its place, n, alignment, or outputs that are the
// inputs.
#include <algorithm>
#include <vector>

#include "promises.h"

namespace {

using carom::Row;
using carom_fuzz::Bytes;
using carom_fuzz::Case;
using carom_fuzz::found;
using carom_fuzz::Outcome;

constexpr int kKinds = 4;        // different collisions of a batch
constexpr unsigned kMost = 60;   // collisions; three vectors of eight lanes go in turn
constexpr double kGuard = 12.5;  // stands behind the last number of every column

// Columns of n numbers and a guard, each `offset` doubles off its alignment.
class Columns {
 public:
  Columns(std::size_t count, std::size_t n, std::size_t offset)
      : n_(n), offset_(offset), columns_(count, std::vector<double>(offset + n + 1, kGuard)) {}

  double* at(std::size_t j) { return columns_[j].data() + offset_; }
  bool guarded() const {
    for (const std::vector<double>& column : columns_) {
      if (column[offset_ + n_] != kGuard) return false;
    }
    return true;
  }

 private:
  std::size_t n_, offset_;
  std::vector<std::vector<double>> columns_;
};

// Whether a collision takes too many steps, and so is refused, may turn on the last bit, which
// lanes round otherwise. That it does not in real use is the budget fuzzer's to hold.
bool undecided(int one, int other) {
  constexpr int kBadInput = 2;
  return std::max(one, other) == kBadInput && std::min(one, other) == carom_fuzz::kOk;
}

void check_batch(const Row& row, const std::vector<Case>& cases, bool own, bool in_place,
                 std::size_t offset) {
  const std::size_t n = cases.size();
  Columns inputs(18, n, offset), outputs(12, n, offset), frictions(1, n, offset);
  const double* in[18];
  double* out[12];
  for (std::size_t j = 0; j < 18; ++j) {
    in[j] = inputs.at(j);
    for (std::size_t i = 0; i < n; ++i) inputs.at(j)[i] = cases[i].balls[j];
  }
  for (std::size_t j = 0; j < 12; ++j) {
    out[j] = in_place ? inputs.at(j < 6 ? j + 3 : j + 6) : outputs.at(j);
  }
  for (std::size_t i = 0; i < n; ++i) frictions.at(0)[i] = cases[i].p.u_b;
  std::vector<unsigned char> statuses(n);
  const double* const u_b = own ? frictions.at(0) : nullptr;
  const std::size_t good = row.functions.batch(cases[0].p, u_b, n, in, out, statuses.data());
  std::size_t expected = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const Case& c = cases[i];
    const Outcome o = carom_fuzz::alone(row, c);
    expected += o.status == carom_fuzz::kOk;
    if (statuses[i] != o.status) found("another status beside others", row, c);
    for (int j = 0; j < 12; ++j) {
      if (!carom_fuzz::same(&out[j][i], &o.balls[j < 6 ? j + 3 : j + 6], 1)) {
        found("another result beside others", row, c);
      }
    }
  }
  if (good != expected) found("the count is not that of OK", row, cases[0]);
  if (!inputs.guarded() || !outputs.guarded()) found("written beyond n", row, cases[0]);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const Row& row = carom::kRows[bytes.take<std::uint8_t>() % carom::kRowCount];
  if (!row.runs()) return -1;
  const unsigned ways = bytes.take<std::uint8_t>();
  const bool own = (ways & 1u) != 0, in_place = (ways & 2u) != 0;
  std::vector<Case> kinds;
  for (int i = 0; i < kKinds; ++i) {
    Case c = carom_fuzz::some_case(bytes);
    const double u_b = c.p.u_b;
    if (i > 0) c.p = kinds[0].p;
    if (own) c.p.u_b = u_b;
    kinds.push_back(c);
    const Outcome o = carom_fuzz::alone(row, c);
    carom_fuzz::check_promises(row, c, o);
    Outcome single{};
    single.status =
        row.functions.collide(c.p, c.balls, c.balls + 9, single.balls, single.balls + 9);
    if (single.status != o.status && !undecided(single.status, o.status)) {
      found("a batch has another status than a call", row, c);
    }
  }
  const unsigned n = 1 + bytes.take<std::uint8_t>() % kMost;
  std::vector<Case> cases;
  for (unsigned i = 0; i < n; ++i) cases.push_back(kinds[bytes.take<std::uint8_t>() % kKinds]);
  check_batch(row, cases, own, in_place, ways >> 2 & 1u);
  return 0;
}
