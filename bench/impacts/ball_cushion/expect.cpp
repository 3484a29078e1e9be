// What must come out of a ball's impact on a cushion, by the oracles of tests/oracle/ball_cushion.
#include <stdexcept>
#include <string>

#include "exact_solver.h"
#include "fixed_step.h"
#include "impact.h"

namespace carom_bench {
namespace {

namespace oracle = carom_oracle::cushion;

constexpr double kSticks = 1, kNoEnd = 2;

oracle::Params oracle_params(const CaseRow& row) {
  return {row[kR], row[kM], row[kUs], row[kUw], row[kEc], row[kH]};
}

template <class Real>
ExpectedRow expected_row(const oracle::BasicOutcome<Real>& outcome, double mark) {
  ExpectedRow row{};
  for (std::size_t i = 0; i < 3; ++i) {
    row[i] = static_cast<double>(outcome.v[i]);
    row[3 + i] = static_cast<double>(outcome.w[i]);
  }
  row[6] = outcome.status;
  row[7] = mark;
  return row;
}

template <class Real>
ExpectedRow solve_exactly(const CaseRow& row, oracle::Model model) {
  const auto outcome =
      oracle::solve_exact_as<Real>(oracle_params(row), model, &row[kBall], &row[kNormal]);
  const oracle::Events& events = outcome.events;
  const bool sticks = events.sticks_cushion + events.sticks_table > 0;
  return expected_row(outcome, events.gave_up ? kNoEnd : sticks ? kSticks : 0);
}

Solve exact_solver(oracle::Model model) {
  return [model](const CaseRow& row) { return solve_exactly<long double>(row, model); };
}
// Terms of a series can leave the range of doubles, where slips are tiny and release a contact.
Solve screen_solver(oracle::Model model) {
  return [model](const CaseRow& row) {
    const ExpectedRow found = solve_exactly<double>(row, model);
    return found.back() == kNoEnd ? solve_exactly<long double>(row, model) : found;
  };
}

template <class Real>
Solve step_solver(oracle::FixedSteps steps) {
  return [steps](const CaseRow& row) {
    const auto result =
        oracle::solve_fixed_step<Real>(oracle_params(row), steps, &row[kBall], &row[kNormal]);
    return expected_row(result.outcome, result.completed ? 0 : kNoEnd);
  };
}

// As pooltool's own defaults are: those of its classes, and from 5000 steps on those of `solve`.
double least_impulse(long steps) { return steps >= 5000 ? 1e-4 : 1e-3; }

// `delta_p`: the shortest step in Ns; `long_double`: 1 for more digits than pooltool's.
Solve step_solver(const Asked& asked, oracle::Model model) {
  if (asked.steps < 1) throw std::runtime_error("--steps: expected at least 1");
  oracle::FixedSteps steps{asked.steps, least_impulse(asked.steps), model};
  bool more_digits = false;
  for (const auto& [name, value] : asked.more) {
    if (name == "delta_p" && value > 0) {
      steps.delta_p = value;
    } else if (name == "long_double" && (value == 0 || value == 1)) {
      more_digits = value == 1;
    } else {
      throw std::runtime_error("--set " + name + ": expected delta_p above 0 or long_double=1");
    }
  }
  return more_digits ? step_solver<long double>(steps) : step_solver<double>(steps);
}

}  // namespace

SolveAll solver(const Asked& asked) {
  const oracle::Model model = oracle::model_by_name(asked.model);
  if (asked.method == "euler") return each(step_solver(asked, model));
  if (asked.method != "exact" && asked.method != "screen") {
    throw std::runtime_error("--method " + asked.method + ": expected exact, screen or euler");
  }
  if (!asked.more.empty()) {
    throw std::runtime_error("--set " + asked.more.begin()->first + ": expected none but of euler");
  }
  if (model == oracle::Model::kPooltool) {
    throw std::runtime_error("--method " + asked.method +
                             ": model pooltool has fixed steps alone; expected euler");
  }
  return each(asked.method == "exact" ? exact_solver(model) : screen_solver(model));
}

}  // namespace carom_bench
