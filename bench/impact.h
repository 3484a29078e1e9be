// What an impact gives to carom_bench: its cases, and what must come out of them.
// bench/impacts/NAME holds it, with its columns in columns.h; carom_bench is built once for each
// impact.
#ifndef CAROM_BENCH_IMPACT_H_
#define CAROM_BENCH_IMPACT_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "case_rows.h"

namespace carom_bench {

struct MadeCase {
  std::string kind;
  CaseRow row;
};

/// Random cases across the envelope of real use and its edges: the mixture of real shots and hard
/// kinds, or all kinds in turn. Same seed, same numbers, whatever the standard library.
std::vector<MadeCase> made_cases(std::uint64_t seed, std::size_t n, bool mixed);

/// What is asked of the oracles.
struct Asked {
  std::string method = "exact";  ///< "exact" or "euler", in long double; "screen": exact in double
  std::string model;
  long steps = 1000;                   ///< of euler
  std::map<std::string, double> more;  ///< what else the impact knows, by name
};

using Solve = std::function<ExpectedRow(const CaseRow&)>;

/// What must come out of `n` cases.
using SolveAll = std::function<void(const CaseRow* cases, std::size_t n, ExpectedRow* expected)>;

inline SolveAll each(const Solve& solve) {
  return [solve](const CaseRow* cases, std::size_t n, ExpectedRow* expected) {
    for (std::size_t i = 0; i < n; ++i) expected[i] = solve(cases[i]);
  };
}

/// The oracle that is asked for. Throws std::runtime_error with one line that names what is wrong.
SolveAll solver(const Asked& asked);

}  // namespace carom_bench

#endif  // CAROM_BENCH_IMPACT_H_
