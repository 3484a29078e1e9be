// What must come out of a collision of two balls, by the oracles of tests/oracle/ball_ball.
#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "exact_lanes.h"
#include "exact_solver.h"
#include "fixed_step.h"
#include "impact.h"

namespace carom_bench {
namespace {

constexpr double kSticks = 1, kNoEnd = 2;

carom_oracle::Params oracle_params(const CaseRow& row) {
  return {row[kR], row[kM], row[kUs1], row[kUs2], row[kUb], row[kEb]};
}

template <class Outcome>
ExpectedRow expected_row(const Outcome& outcome, double mark) {
  ExpectedRow row{};
  for (std::size_t i = 0; i < 3; ++i) {
    row[i] = static_cast<double>(outcome.v1[i]);
    row[3 + i] = static_cast<double>(outcome.w1[i]);
    row[6 + i] = static_cast<double>(outcome.v2[i]);
    row[9 + i] = static_cast<double>(outcome.w2[i]);
  }
  row[12] = outcome.status;
  row[13] = mark;
  return row;
}

carom_oracle::Params oracle_params(const CaseRow& row, double mass_ratio) {
  carom_oracle::Params params = oracle_params(row);
  params.M1_over_M2 = mass_ratio;
  return params;
}

ExpectedRow solve_exactly(const CaseRow& row, carom_oracle::Model model, double mass_ratio) {
  const auto outcome = carom_oracle::solve_exact_as<long double>(oracle_params(row, mass_ratio),
                                                                 model, &row[kBall1], &row[kBall2]);
  return expected_row(outcome, outcome.sticks ? kSticks : 0);
}

using RatioOf = std::function<double(const CaseRow&)>;

// In lanes of doubles; in long double what took so many steps that rounding may have added up.
void screen(const CaseRow* cases, std::size_t n, carom_oracle::Model model, const RatioOf& ratio_of,
            ExpectedRow* expected) {
  std::vector<carom_oracle::detail::Collision<double>> collisions;
  collisions.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const carom_oracle::Params params = oracle_params(cases[i], ratio_of(cases[i]));
    collisions.emplace_back(params, model, &cases[i][kBall1], &cases[i][kBall2]);
  }
  carom_oracle::run_in_lanes(&collisions);
  for (std::size_t i = 0; i < n; ++i) {
    const auto outcome = collisions[i].outcome();
    expected[i] = collisions[i].took_many_steps()
                      ? solve_exactly(cases[i], model, ratio_of(cases[i]))
                      : expected_row(outcome, outcome.sticks ? kSticks : 0);
  }
}

// A number that was set, which must be above 0; 0: it was not.
double positive(const Asked& asked, const std::string& name) {
  const auto found = asked.more.find(name);
  if (found == asked.more.end()) return 0;
  if (found->second > 0) return found->second;
  throw std::runtime_error("--set " + name + ": expected a number above 0");
}

// `mass_ratio`: of ball 1 to ball 2; `mass1`: of ball 1 in kg, where M is that of ball 2.
SolveAll exact_solver(const Asked& options, carom_oracle::Model model) {
  const double given = positive(options, "mass_ratio"), mass1 = positive(options, "mass1");
  const double ratio = given > 0 ? given : 1;
  const RatioOf ratio_of = [ratio, mass1](const CaseRow& row) {
    return mass1 > 0 ? mass1 / row[kM] : ratio;
  };
  if (options.method == "screen") {
    return [model, ratio_of](const CaseRow* cases, std::size_t n, ExpectedRow* expected) {
      screen(cases, n, model, ratio_of, expected);
    };
  }
  return each(
      [model, ratio_of](const CaseRow& row) { return solve_exactly(row, model, ratio_of(row)); });
}

ExpectedRow solve_by_steps(const CaseRow& row, carom_oracle::Model model, long steps) {
  const auto result = carom_oracle::solve_fixed_step<long double>(
      oracle_params(row), model, &row[kBall1], &row[kBall2], steps);
  return expected_row(result.outcome, result.completed ? 0 : kNoEnd);
}

void check_names(const Asked& asked) {
  for (const auto& [name, value] : asked.more) {
    if (name != "mass_ratio" && name != "mass1") {
      throw std::runtime_error("--set " + name + ": expected mass_ratio or mass1");
    }
    if (asked.method == "euler" && !(name == "mass_ratio" && value == 1)) {
      throw std::runtime_error("--set " + name + ": the scheme has one mass");
    }
  }
  if (asked.more.size() > 1) throw std::runtime_error("--set: expected mass_ratio or mass1");
}

}  // namespace

SolveAll solver(const Asked& asked) {
  const carom_oracle::Model model = carom_oracle::model_by_name(asked.model);
  check_names(asked);
  if (asked.method == "exact" || asked.method == "screen") return exact_solver(asked, model);
  if (asked.method != "euler") {
    throw std::runtime_error("--method " + asked.method + ": expected exact, screen or euler");
  }
  if (asked.steps < 1) throw std::runtime_error("--steps: expected at least 1");
  const long steps = asked.steps;
  return each([model, steps](const CaseRow& row) { return solve_by_steps(row, model, steps); });
}

}  // namespace carom_bench
