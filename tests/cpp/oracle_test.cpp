// The oracles against the reference results.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "cases.h"
#include "exact_solver.h"
#include "fixed_step.h"

namespace {

using carom_bench::Case;
using Columns = std::vector<double>;

// Rows of a CSV file of numbers, without the header.
std::vector<Columns> read_numbers(const std::string& path) {
  std::ifstream file(path);
  std::vector<Columns> rows;
  std::string line, cell;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    rows.emplace_back();
    while (std::getline(cells, cell, ','))
      rows.back().push_back(std::strtod(cell.c_str(), nullptr));
  }
  return rows;
}

carom_oracle::Params params_of(const Case& one) {
  const carom_bench::Params& p = one.params;
  return {p.R, p.M, p.u_s1, p.u_s2, p.u_b, p.e_b};
}

// Largest of |dv| and R |dw|, divided by |v1 - v2| before; `want` starts with the id.
double relative_error(const Case& one, const carom_oracle::Outcome& got, const Columns& want) {
  double most = 0, speed = 0;
  const double* parts[4] = {got.v1, got.w1, got.v2, got.w2};
  for (std::size_t part = 0; part < 4; ++part) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double off = std::fabs(parts[part][i] - want[1 + 3 * part + i]);
      most = std::fmax(most, part % 2 == 1 ? one.params.R * off : off);
    }
  }
  for (int i = 3; i < 6; ++i) speed += std::pow(one.ball1[i] - one.ball2[i], 2);
  return most / std::sqrt(speed);
}

class ExactOracle : public testing::TestWithParam<const char*> {};

// 1e-11 is what positions kilometres away cost in digits.
TEST_P(ExactOracle, GivesTheReference) {
  const std::vector<Case> cases = carom_bench::read_cases(CAROM_REFERENCE "/inputs.csv");
  const std::string path = std::string(CAROM_REFERENCE "/exact_") + GetParam() + ".csv";
  const std::vector<Columns> want = read_numbers(path);
  ASSERT_EQ(want.size(), cases.size());
  const carom_oracle::Model model = carom_oracle::model_by_name(GetParam());
  double worst = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto got =
        carom_oracle::solve_exact(params_of(cases[i]), model, cases[i].ball1, cases[i].ball2);
    EXPECT_EQ(got.status, carom_oracle::kOk);
    EXPECT_EQ(got.sticks, want[i].at(14) != 0) << "case " << i;
    worst = std::max(worst, relative_error(cases[i], got, want[i]));
  }
  std::cout << GetParam() << ": " << worst << " of the relative speed\n";
  EXPECT_LE(worst, 1e-10);
}

INSTANTIATE_TEST_SUITE_P(Models, ExactOracle,
                         testing::Values("pooltool", "bottom_slip", "mathavan2014"));

// In double and in pooltool's order of operations, so to the last digit but for the libraries'.
TEST(FixedStepOracle, GivesPooltoolsResults) {
  const std::vector<Case> cases = carom_bench::read_cases(CAROM_REFERENCE "/inputs.csv");
  const std::vector<Columns> want = read_numbers(CAROM_REFERENCE "/euler_n1000.csv");
  ASSERT_EQ(want.size(), cases.size());
  double worst = 0;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto got = carom_oracle::solve_fixed_step<double>(
        params_of(cases[i]), carom_oracle::kPooltool, cases[i].ball1, cases[i].ball2, 1000);
    EXPECT_TRUE(got.completed);
    worst = std::max(worst, relative_error(cases[i], got.outcome, want[i]));
  }
  std::cout << "fixed steps: " << worst << " of the relative speed\n";
  EXPECT_LE(worst, 1e-12);
}

}  // namespace
