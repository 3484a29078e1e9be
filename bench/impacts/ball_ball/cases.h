// Collision cases for tests and benchmarks: a strict reader for the CSV format of the reference
// inputs, and seeded generators that give the same numbers with every standard library.
#ifndef CAROM_BENCH_CASES_H_
#define CAROM_BENCH_CASES_H_

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "case_rows.h"

namespace carom_bench {

/// R in m, M in kg, the rest without unit; u_s1 and u_s2 on the table, u_b between the balls.
struct Params {
  double R, M, u_s1, u_s2, u_b, e_b;
};

/// One collision. ball1, ball2: position (m), velocity (m/s), angular velocity (rad/s), 3 each.
struct Case {
  long id;
  std::string kind;
  Params params;
  double ball1[9], ball2[9];
};

/// Reads cases by header name: id, kind, R, M, u_s1, u_s2, u_b, e_b, r1x..w1z, r2x..w2z; other
/// columns are ignored. nan and inf are numbers here. Throws std::runtime_error with one line that
/// names the file, the line (the header is line 1), the column and what would be right.
std::vector<Case> read_cases(const std::string& path);
std::vector<Case> read_cases(std::istream& in, const std::string& name);

/// n cases, ids 0..n-1, all kinds in turn, across the envelope of real use and its edges: balls
/// touch, the line of centres is level, and they approach. Same seed, same numbers, provided
/// cases.cpp is compiled without fused multiply-add (-ffp-contract=off).
std::vector<Case> random_cases(std::uint64_t seed, std::size_t n);

/// As random_cases, in random order and in the proportions of the reference inputs: 30 in 47 of six
/// ordinary kinds of shot, the rest of 17 hard kinds.
std::vector<Case> mixed_cases(std::uint64_t seed, std::size_t n);

CaseRow to_row(const Case& one);

/// Names of all kinds that random_cases deals out.
std::vector<std::string> case_kinds();

}  // namespace carom_bench

#endif  // CAROM_BENCH_CASES_H_
