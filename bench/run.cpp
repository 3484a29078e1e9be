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

OutcomeRow outcome_row(const double* results, int status) {
  OutcomeRow row{};
  for (std::size_t k = 0; k < kOutcomes; ++k) row[k] = results[kChanged[k]];
  row.back() = status;
  return row;
}

// `collide`: either kind of function, as called for one case.
template <class Collide>
OutcomeRow run_one(const Collide& collide, CaseRow row, bool in_place) {
  Results own{};
  double* results = in_place ? &row[kParameters] : own.data();
  const int status = collide(row.data(), results);
  return outcome_row(results, status);
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
using Shared = std::array<std::uint64_t, kParameters>;

Shared shared_parameters(const CaseRow& row) {
  Shared bits{};
  std::memcpy(bits.data(), row.data(), sizeof(bits));
  bits[kVaried] = 0;
  return bits;
}

bool same_varied(const std::vector<CaseRow>& rows) {
  return std::all_of(rows.begin(), rows.end(),
                     [&](const CaseRow& row) { return row[kVaried] == rows.front()[kVaried]; });
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
  // Groups that share the varied parameter too try the null pointer; single cases try the array.
  const bool each_varied = rows.size() == 1 || !same_varied(rows);
  check_count(batch.call(function, 0, rows.size(), each_varied), batch);
  for (std::size_t i = 0; i < members.size(); ++i) (*outcomes)[members[i]] = batch.outcome(i);
}

std::vector<OutcomeRow> run_batches(BatchFunction function, const std::vector<CaseRow>& cases,
                                    bool in_place) {
  std::map<Shared, std::vector<std::size_t>> groups;
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
  if (options.steps == 0) {
    const CollideFunction function = library.collide();
    const auto collide = [function](const double* row, double* results) {
      return call(function, row, results);
    };
    return run_each(collide, cases, options.in_place);
  }
  const auto collide = [function = library.steps(), steps = options.steps](const double* row,
                                                                           double* results) {
    return call(function, steps, row, results);
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
