#include <algorithm>
#include <atomic>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "case_rows.h"
#include "commands.h"
#include "exact_solver.h"
#include "fixed_step.h"

namespace carom_bench {
namespace {

using Solve = std::function<ExpectedRow(const CaseRow&)>;
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

template <class Real>
ExpectedRow solve_exactly(const CaseRow& row, carom_oracle::Model model, double mass_ratio) {
  carom_oracle::Params params = oracle_params(row);
  params.M1_over_M2 = mass_ratio;
  const auto outcome =
      carom_oracle::solve_exact_as<Real>(params, model, &row[kBall1], &row[kBall2]);
  return expected_row(outcome, outcome.sticks ? kSticks : 0);
}

Solve exact_solver(const Expect& options, carom_oracle::Model model) {
  const double ratio = options.mass_ratio, mass1 = options.mass1;
  const auto ratio_of = [ratio, mass1](const CaseRow& row) {
    return mass1 > 0 ? mass1 / row[kM] : ratio;
  };
  if (options.method == "screen") {
    return [model, ratio_of](const CaseRow& row) {
      return solve_exactly<double>(row, model, ratio_of(row));
    };
  }
  return [model, ratio_of](const CaseRow& row) {
    return solve_exactly<long double>(row, model, ratio_of(row));
  };
}

ExpectedRow solve_by_steps(const CaseRow& row, carom_oracle::Model model, long steps) {
  const auto result = carom_oracle::solve_fixed_step<long double>(
      oracle_params(row), model, &row[kBall1], &row[kBall2], steps);
  return expected_row(result.outcome, result.completed ? 0 : kNoEnd);
}

Solve solver(const Expect& options) {
  const carom_oracle::Model model = carom_oracle::model_by_name(options.model);
  if (options.method == "exact" || options.method == "screen") return exact_solver(options, model);
  if (options.method != "euler") {
    throw std::runtime_error("--method " + options.method + ": expected exact, screen or euler");
  }
  if (options.mass_ratio != 1) throw std::runtime_error("--mass-ratio: expected 1 with euler");
  if (options.mass1 > 0) throw std::runtime_error("--mass1: expected none with euler");
  if (options.steps < 1) throw std::runtime_error("--steps: expected at least 1");
  const long steps = options.steps;
  return [model, steps](const CaseRow& row) { return solve_by_steps(row, model, steps); };
}

unsigned thread_count(unsigned wanted) {
  return wanted != 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

// Cases differ a lot in effort, so threads take the next few as they come.
void solve_all(const Solve& solve, const std::vector<CaseRow>& cases, unsigned threads,
               std::vector<ExpectedRow>* expected) {
  constexpr std::size_t kChunk = 16;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t at; (at = next.fetch_add(kChunk)) < cases.size();) {
      const std::size_t end = std::min(at + kChunk, cases.size());
      for (std::size_t i = at; i < end; ++i) (*expected)[i] = solve(cases[i]);
    }
  };
  std::vector<std::thread> team;
  for (unsigned i = 1; i < threads; ++i) team.emplace_back(work);
  work();
  for (std::thread& member : team) member.join();
}

}  // namespace

void expect(const Expect& options) {
  const Solve solve = solver(options);
  const std::vector<CaseRow> cases = read_case_rows(options.cases);
  std::vector<ExpectedRow> expected(cases.size());
  solve_all(solve, cases, thread_count(options.threads), &expected);
  write_rows(options.out, expected);
}

}  // namespace carom_bench
