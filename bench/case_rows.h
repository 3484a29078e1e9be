// Cases as rows of doubles, in memory and in files: what the generator and carom_bench exchange.
#ifndef CAROM_BENCH_CASE_ROWS_H_
#define CAROM_BENCH_CASE_ROWS_H_

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "cases.h"

namespace carom_bench {

/// Columns of a case: R (m), M (kg), u_s1, u_s2, u_b, e_b, then position (m), velocity (m/s) and
/// angular velocity (rad/s) of ball 1 and of ball 2, three each.
enum CaseColumn : std::size_t {
  kR,
  kM,
  kUs1,
  kUs2,
  kUb,
  kEb,
  kBall1,
  kBall2 = kBall1 + 9,
  kCaseColumns = kBall2 + 9
};

using CaseRow = std::array<double, kCaseColumns>;

/// v1[3], w1[3], v2[3], w2[3] (m/s, rad/s), status as in carom.h.
using OutcomeRow = std::array<double, 13>;

/// As OutcomeRow, then 1 if the contact sticks, 2 if the scheme did not end, else 0.
using ExpectedRow = std::array<double, 14>;

CaseRow to_row(const Case& one);

/// Reads a file of raw float64 rows in the machine's byte order. Throws std::runtime_error with one
/// line that names the file if it cannot be read or is not a whole number (at least 1) of rows.
std::vector<CaseRow> read_case_rows(const std::string& path);

/// Writes a file. Throws std::runtime_error naming it and the reason if it cannot be written.
void write_file(const std::string& path, const void* data, std::size_t bytes);

/// Writes `count` doubles. Throws as write_file.
void write_doubles(const std::string& path, const double* values, std::size_t count);

/// Writes rows of doubles one after the other. Throws as write_file.
template <std::size_t N>
void write_rows(const std::string& path, const std::vector<std::array<double, N>>& rows) {
  static_assert(sizeof(std::array<double, N>) == N * sizeof(double), "rows must be packed");
  write_doubles(path, rows.empty() ? nullptr : rows.front().data(), rows.size() * N);
}

}  // namespace carom_bench

#endif  // CAROM_BENCH_CASE_ROWS_H_
