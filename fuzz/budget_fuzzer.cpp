// Exact kernels against each other: a loose one must not be grossly off what a tight one says.
#include "fuzz_input.h"

namespace {

using carom::Row;
using carom_fuzz::Case;

// docs/accuracy.md says that hard cases may lie a little over a budget; this looks for the rest.
constexpr double kGross = 30.0;      // budgets
constexpr double kRounding = 1e-12;  // relative, of every number of the input

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

struct Outcome {
  double balls[18];
  int status;
};

Outcome collide(const Row& row, const Case& c) {
  Outcome o{};
  o.status = row.functions.collide(c.p, c.balls, c.balls + 9, o.balls, o.balls + 9);
  return o;
}

// The largest difference of two outcomes, relative to |v1 - v2|.
double apart(const Outcome& a, const Outcome& b, const Case& c) {
  const double relative = std::hypot(c.balls[12] - c.balls[3], c.balls[13] - c.balls[4]);
  double most = 0.0;
  for (int i = 0; i < 18; ++i) {
    const double unit = i % 9 < 6 ? 1.0 : c.p.R;
    most = std::fmax(most, std::fabs(a.balls[i] - b.balls[i]) * unit);
  }
  return most / relative;
}

// Does a change of the input by a budget, or by rounding, change the outcome grossly? Then the
// model itself decides by less than the kernel may be off: pooltool's does where u_b is about 2/5,
// for the table slip of a ball at rest then neither grows nor shrinks.
bool steep(const Row& exact, const Case& c, const Outcome& outcome, double budget) {
  for (int round = 0; round < 8; ++round) {
    const double by = round < 4 ? kRounding : budget;
    Case other = c;
    double* const numbers[] = {&other.p.u_s1, &other.p.u_s2, &other.p.u_b};
    for (int i = 0; i < 3; ++i) *numbers[i] *= 1.0 + ((round >> (i & 1) & 1) != 0 ? by : -by);
    for (int i = 0; i < 18; ++i) {
      other.balls[i] *= 1.0 + (((i * (round + 1) + round / 2) & 1) != 0 ? by : -by);
    }
    if (apart(collide(exact, other), outcome, c) > 0.5 * kGross * budget) return true;
  }
  return false;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  carom_fuzz::Bytes bytes(data, size);
  const Row& row = carom::kRows[bytes.take<std::uint8_t>() % carom::kRowCount];
  const Row& exact = tightest(row);
  if (row.steps > 0 || &row == &exact || !row.runs()) return -1;
  const Case c = carom_fuzz::real_case(bytes);
  const Outcome loose = collide(row, c), tight = collide(exact, c);
  if (loose.status != tight.status) {
    carom_fuzz::found("two kernels disagree about the status", row, c);
  }
  const double off = apart(loose, tight, c);
  if (off > kGross * row.budget && !steep(exact, c, tight, row.budget)) {
    std::fprintf(stderr, "%.3g of |v1 - v2| apart\n", off);
    carom_fuzz::found("grossly over the budget", row, c);
  }
  return 0;
}
