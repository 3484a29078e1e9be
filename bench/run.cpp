#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "batch.h"
#include "case_rows.h"
#include "commands.h"
#include "kernel_library.h"

namespace carom_bench {
namespace {

OutcomeRow outcome_row(const double ball1[9], const double ball2[9], int status) {
  OutcomeRow row{};
  std::copy_n(ball1 + 3, 6, row.begin());
  std::copy_n(ball2 + 3, 6, row.begin() + 6);
  row.back() = status;
  return row;
}

// As the function, which may be either kind, called for one case.
template <class Collide>
OutcomeRow run_one(const Collide& collide, CaseRow row, bool in_place) {
  double out1[9] = {}, out2[9] = {};
  double* ball1 = in_place ? &row[kBall1] : out1;
  double* ball2 = in_place ? &row[kBall2] : out2;
  const int status = collide(row.data(), &row[kBall1], &row[kBall2], ball1, ball2);
  return outcome_row(ball1, ball2, status);
}

template <class Collide>
std::vector<OutcomeRow> run_each(const Collide& collide, const std::vector<CaseRow>& cases,
                                 bool in_place) {
  std::vector<OutcomeRow> outcomes;
  outcomes.reserve(cases.size());
  for (const CaseRow& row : cases) outcomes.push_back(run_one(collide, row, in_place));
  return outcomes;
}

// Bits, since a parameter may be NaN, which is not even equal to itself.
std::array<std::uint64_t, 5> shared_parameters(const CaseRow& row) {
  const double shared[5] = {row[kR], row[kM], row[kUs1], row[kUs2], row[kEb]};
  std::array<std::uint64_t, 5> bits{};
  std::memcpy(bits.data(), shared, sizeof(shared));
  return bits;
}

bool same_u_b(const std::vector<CaseRow>& rows) {
  return std::all_of(rows.begin(), rows.end(),
                     [&](const CaseRow& row) { return row[kUb] == rows.front()[kUb]; });
}

void check_count(std::size_t reported, const Batch& batch) {
  std::size_t good = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) good += batch.outcome(i).back() == 0 ? 1 : 0;
  if (reported == good) return;
  throw std::runtime_error("the batch function returned " + std::to_string(reported) + " for " +
                           std::to_string(good) + " cases with status 0");
}

void run_group(BatchFunction function, const std::vector<CaseRow>& cases,
               const std::vector<std::size_t>& members, bool in_place,
               std::vector<OutcomeRow>* outcomes) {
  std::vector<CaseRow> rows;
  for (std::size_t i : members) rows.push_back(cases[i]);
  Batch batch(rows);
  if (in_place) batch.alias();
  // Groups that share u_b too try the null pointer; single cases try the array.
  const bool each_u_b = rows.size() == 1 || !same_u_b(rows);
  check_count(batch.call(function, 0, rows.size(), each_u_b), batch);
  for (std::size_t i = 0; i < members.size(); ++i) (*outcomes)[members[i]] = batch.outcome(i);
}

std::vector<OutcomeRow> run_batches(BatchFunction function, const std::vector<CaseRow>& cases,
                                    bool in_place) {
  std::map<std::array<std::uint64_t, 5>, std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    groups[shared_parameters(cases[i])].push_back(i);
  }
  std::vector<OutcomeRow> outcomes(cases.size());
  for (const auto& group : groups) {
    run_group(function, cases, group.second, in_place, &outcomes);
  }
  return outcomes;
}

std::vector<OutcomeRow> run_cases(const KernelLibrary& library, const Run& options,
                                  const std::vector<CaseRow>& cases) {
  if (options.batch) return run_batches(library.batch(), cases, options.in_place);
  if (options.steps == 0) return run_each(library.collide(), cases, options.in_place);
  const auto collide = [function = library.steps(), steps = options.steps](
                           const double* params, const double* ball1, const double* ball2,
                           double* out1, double* out2) {
    return function(params, ball1, ball2, out1, out2, steps);
  };
  return run_each(collide, cases, options.in_place);
}

void write_trace(const std::string& path, TraceFunction trace) {
  const std::uint32_t* blocks = nullptr;
  const std::size_t count = trace(&blocks);
  write_file(path, blocks, count * sizeof(*blocks));
}

}  // namespace

void run(const Run& options) {
  if (options.batch && options.steps != 0) {
    throw std::runtime_error("--steps with --batch: batch functions have their own steps");
  }
  if (options.steps < 0) throw std::runtime_error("--steps: expected at least 1");
  const std::vector<CaseRow> cases = read_case_rows(options.cases);
  const KernelLibrary library(options.kernel);
  const TraceFunction trace = options.trace.empty() ? nullptr : library.trace();
  write_rows(options.out, run_cases(library, options, cases));
  if (trace != nullptr) write_trace(options.trace, trace);
}

}  // namespace carom_bench
