// Cases as rows of doubles, in memory and in files: what the generator and carom_bench exchange.
#ifndef CAROM_BENCH_CASE_ROWS_H_
#define CAROM_BENCH_CASE_ROWS_H_

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "columns.h"

namespace carom_bench {

constexpr std::size_t kParameters = kParameterNames.size();
constexpr std::size_t kBodies = kCaseColumns - kParameters;  ///< arrays that a batch is given
constexpr std::size_t kOutcomes = kChanged.size();           ///< and that it gives

using CaseRow = std::array<double, kCaseColumns>;
using Results = std::array<double, kResults>;

/// What a collision changes (m/s, rad/s), then the status as in carom.h.
using OutcomeRow = std::array<double, kOutcomes + 1>;

/// As OutcomeRow, then 1 if the contact sticks, 2 if the scheme did not end, else 0.
using ExpectedRow = std::array<double, kOutcomes + 2>;

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
