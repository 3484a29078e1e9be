// Which kernel of the table answers a request.
#include <nanobind/stl/string.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "kernel.h"

namespace carom {

namespace {

// All values that a column of the table has, for messages.
template <class Column>
std::string listed(Column column) {
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < kRowCount; ++i) {
    const std::string value = column(kRows[i]);
    if (!value.empty() && std::find(seen.begin(), seen.end(), value) == seen.end()) {
      seen.push_back(value);
    }
  }
  std::string text;
  for (const std::string& value : seen) text += (text.empty() ? "" : ", ") + value;
  return text;
}

[[noreturn]] void refuse_name(const char* what, const std::string& name, const std::string& there) {
  refuse_value(std::string(what) + " '" + name + "': there is none; there are " + there);
}

[[noreturn]] void refuse_goal(const Request& request) {
  if (request.steps) refuse_value("steps: this module was built without kernels of fixed steps");
  const std::string budgets =
      listed([](const Row& row) { return row.budget > 0.0 ? text_of(row.budget) : ""; });
  refuse_value("max_error " + text_of(*request.max_error) + ": no kernel is as exact; there are " +
               budgets);
}

}  // namespace

// The loosest, so fastest, kernel that keeps what is asked for; the first target that the CPU runs.
const Row& find_row(const Request& request) {
  const Row* best = nullptr;
  bool model_known = false, target_known = !request.target, runs = false;
  for (std::size_t i = 0; i < kRowCount; ++i) {
    const Row& row = kRows[i];
    if (row.unequal) continue;
    const bool asked = !request.target || *request.target == row.target;
    target_known = target_known || asked;
    if (row.model != request.model) continue;
    model_known = true;
    if (!asked || !row.runs()) continue;
    runs = true;
    if (request.steps.has_value() != (row.steps > 0)) continue;
    if (!request.steps && !(row.budget <= *request.max_error)) continue;
    if (best == nullptr || row.budget > best->budget) best = &row;
  }
  if (best != nullptr) return *best;
  if (!model_known)
    refuse_name("model", request.model, listed([](const Row& r) { return r.model; }));
  if (!target_known) {
    refuse_name("target", *request.target, listed([](const Row& r) { return r.target; }));
  }
  if (runs) refuse_goal(request);
  const std::string targets = listed([](const Row& r) { return r.target; });
  throw std::runtime_error("this CPU does not run " + request.target.value_or(targets) + " code");
}

}  // namespace carom
