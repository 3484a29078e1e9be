#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "case_rows.h"
#include "commands.h"
#include "impact.h"

namespace carom_bench {
namespace {

std::pair<std::string, double> parse_more(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
  char* end = nullptr;
  const double value = std::strtod(number.c_str(), &end);
  if (number.empty() || *end != '\0') {
    throw std::runtime_error("--set " + text + ": expected a name and a number, as NAME=0.5");
  }
  return {text.substr(0, equals), value};
}

unsigned thread_count(unsigned wanted) {
  return wanted != 0 ? wanted : std::max(1U, std::thread::hardware_concurrency());
}

// Cases differ a lot in effort, so threads take the next few as they come; more at once where there
// are many, since some oracles solve them side by side.
void solve_all(const SolveAll& solve, const std::vector<CaseRow>& cases, unsigned threads,
               std::vector<ExpectedRow>* expected) {
  constexpr std::size_t kLeast = 16, kMost = 1024, kTurns = 8;
  const std::size_t chunk = std::clamp(cases.size() / (kTurns * threads), kLeast, kMost);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t at; (at = next.fetch_add(chunk)) < cases.size();) {
      solve(&cases[at], std::min(chunk, cases.size() - at), &(*expected)[at]);
    }
  };
  std::vector<std::thread> team;
  for (unsigned i = 1; i < threads; ++i) team.emplace_back(work);
  work();
  for (std::thread& member : team) member.join();
}

}  // namespace

void expect(const Expect& options) {
  Asked asked = options.asked;
  for (const std::string& text : options.more) asked.more.insert(parse_more(text));
  const SolveAll solve = solver(asked);
  const std::vector<CaseRow> cases = read_case_rows(options.cases);
  std::vector<ExpectedRow> expected(cases.size());
  solve_all(solve, cases, thread_count(options.threads), &expected);
  write_rows(options.out, expected);
}

}  // namespace carom_bench
