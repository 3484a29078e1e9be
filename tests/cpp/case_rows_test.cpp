// Cases as rows of doubles in files.
#include "case_rows.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <stdexcept>
#include <string>

#include "cases.h"

namespace carom_bench {
namespace {

TEST(CaseRows, SurviveAFile) {
  const std::string path = testing::TempDir() + "carom_case_rows.bin";
  std::vector<CaseRow> rows;
  for (const Case& one : mixed_cases(1, 20)) rows.push_back(to_row(one));
  write_rows(path, rows);
  EXPECT_EQ(read_case_rows(path), rows);
  std::remove(path.c_str());
}

TEST(CaseRows, RefuseAPartOfARow) {
  const std::string path = testing::TempDir() + "carom_part_row.bin";
  const double values[23] = {};
  write_doubles(path, values, 23);
  EXPECT_THROW(read_case_rows(path), std::runtime_error);
  std::remove(path.c_str());
  EXPECT_THROW(read_case_rows(path), std::runtime_error);
}

TEST(CaseRows, AnUnwritableFileIsAnError) {
  const double value = 1;
  EXPECT_THROW(write_doubles("/no/such/folder/rows.bin", &value, 1), std::runtime_error);
}

}  // namespace
}  // namespace carom_bench
