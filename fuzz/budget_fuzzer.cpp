// Exact kernels against each other: a loose one must not be grossly off what a tight one says.
#include "fuzz_input.h"

namespace {

using carom::Row;
using carom_fuzz::Case;

// docs/accuracy.md says that hard cases may lie a little over a budget; this looks for the rest.
constexpr double kGross = 30.0;  // budgets

const Row& tightest(const Row& of) {
  const Row* best = &of;
  for (std::size_t i = 0; i < carom::kRowCount; ++i) {
    const Row& row = carom::kRows[i];
    const bool alike =
        std::strcmp(row.model, of.model) == 0 && std::strcmp(row.target, of.target) == 0;
    if (alike && row.steps == 0 && row.budget < best->budget) best = &row;
  }
  return *best;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  carom_fuzz::Bytes bytes(data, size);
  const Row& row = carom::kRows[bytes.take<std::uint8_t>() % carom::kRowCount];
  const Row& exact = tightest(row);
  if (row.steps > 0 || &row == &exact || !carom_fuzz::runs_here(row)) return -1;
  const Case c = carom_fuzz::real_case(bytes);
  const double *one = c.balls, *two = c.balls + 9;
  double loose[18], tight[18];
  const int status = row.functions.collide(c.p, one, two, loose, loose + 9);
  if (status != exact.functions.collide(c.p, one, two, tight, tight + 9)) {
    carom_fuzz::found("two kernels disagree about the status", row, c);
  }
  const double relative = std::hypot(two[3] - one[3], two[4] - one[4]);
  for (int i = 0; i < 18; ++i) {
    const double unit = i % 9 < 6 ? 1.0 : c.p.R;
    const double apart = std::fabs(loose[i] - tight[i]) * unit;
    if (apart > kGross * row.budget * relative) {
      std::fprintf(stderr, "%.3g of |v1 - v2| apart\n", apart / relative);
      carom_fuzz::found("grossly over the budget", row, c);
    }
  }
  return 0;
}
