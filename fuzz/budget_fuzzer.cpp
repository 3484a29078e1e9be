// Exact kernels against each other: a loose one, called or in a batch, must not be grossly off what
// a tight one says.
#include "promises.h"

namespace {

using carom::Row;
using carom_fuzz::apart;
using carom_fuzz::Case;
using carom_fuzz::Outcome;

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

Outcome collide(const Row& row, const Case& c) {
  Outcome o{};
  o.status = row.functions.collide(c.p, c.balls, c.balls + 9, o.balls, o.balls + 9);
  return o;
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
  const Outcome tight = collide(exact, c);
  for (const Outcome& loose : {collide(row, c), carom_fuzz::alone(row, c)}) {
    if (loose.status != tight.status) {
      carom_fuzz::found("two kernels disagree about the status", row, c);
    }
    const double off = apart(loose, tight, c);
    if (off > kGross * row.budget && !steep(exact, c, tight, row.budget)) {
      std::fprintf(stderr, "%.3g of |v1 - v2| apart\n", off);
      carom_fuzz::found("grossly over the budget", row, c);
    }
  }
  return 0;
}
