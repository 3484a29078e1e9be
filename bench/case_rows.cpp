#include "case_rows.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

namespace carom_bench {
namespace {

constexpr std::size_t kRowBytes = kCaseColumns * sizeof(double);

std::size_t row_count(std::ifstream& file, const std::string& path) {
  file.seekg(0, std::ios::end);
  const auto bytes = static_cast<std::size_t>(file.tellg());
  file.seekg(0);
  if (bytes == 0 || bytes % kRowBytes != 0) {
    throw std::runtime_error(path + ": " + std::to_string(bytes) + " bytes; expected rows of " +
                             std::to_string(kRowBytes) + " (" + std::to_string(kCaseColumns) +
                             " float64 a case)");
  }
  return bytes / kRowBytes;
}

}  // namespace

std::vector<CaseRow> read_case_rows(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot be read; expected a file of cases");
  std::vector<CaseRow> rows(row_count(file, path));
  file.read(reinterpret_cast<char*>(rows.data()),
            static_cast<std::streamsize>(rows.size() * kRowBytes));
  if (!file) throw std::runtime_error(path + ": ended while being read");
  return rows;
}

void write_file(const std::string& path, const void* data, std::size_t bytes) {
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  file.write(static_cast<const char*>(data), static_cast<std::streamsize>(bytes));
  file.close();
  if (!file) throw std::runtime_error(path + ": cannot be written: " + std::strerror(errno));
}

void write_doubles(const std::string& path, const double* values, std::size_t count) {
  write_file(path, values, count * sizeof(double));
}

}  // namespace carom_bench
