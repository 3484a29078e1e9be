// Which kernel of the table answers a request.
#include <nanobind/stl/string.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "request.h"

namespace carom {

namespace {

constexpr double kDefaultError = 1e-6;

template <class AnyRow>
struct Table {
  const AnyRow* rows;
  std::size_t count;
};

// All values that a column of the table has, for messages.
template <class AnyRow, class Column>
std::string listed(const Table<AnyRow>& table, Column column) {
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < table.count; ++i) {
    const std::string value = column(table.rows[i]);
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

template <class AnyRow>
[[noreturn]] void refuse_goal(const Table<AnyRow>& table, const Request& request) {
  if (request.steps) refuse_value("steps: this module was built without kernels of fixed steps");
  const std::string budgets = listed(table, [&](const AnyRow& row) {
    return row.budget > 0.0 && row.model == request.model ? text_of(row.budget) : "";
  });
  const std::string asked = "max_error " + text_of(*request.max_error);
  if (budgets.empty()) refuse_value(asked + ": " + request.model + " has fixed steps alone");
  refuse_value(asked + ": no kernel is as exact; there are " + budgets);
}

bool is_other(const Row& row) { return row.unequal; }
bool is_other(const CushionRow&) { return false; }

// The loosest, so fastest, kernel that keeps what is asked for; the first target that the CPU runs.
template <class AnyRow>
const AnyRow& found_in(const Table<AnyRow>& table, const Request& request) {
  const AnyRow* best = nullptr;
  bool model_known = false, target_known = !request.target, runs = false;
  for (std::size_t i = 0; i < table.count; ++i) {
    const AnyRow& row = table.rows[i];
    if (is_other(row)) continue;
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
  if (!model_known) {
    const std::string models = listed(table, [](const AnyRow& r) { return r.model; });
    if (models.empty()) {
      refuse_value("model '" + request.model + "': this module was built without such kernels");
    }
    refuse_name("model", request.model, models);
  }
  const std::string targets = listed(table, [](const AnyRow& r) { return r.target; });
  if (!target_known) refuse_name("target", *request.target, targets);
  if (runs) refuse_goal(table, request);
  throw std::runtime_error("this CPU does not run " + request.target.value_or(targets) + " code");
}

}  // namespace

Request checked(Request request) {
  if (request.max_error && request.steps) {
    refuse_value("max_error and steps exclude each other: name one of them");
  }
  if (request.steps && (*request.steps < 1 || *request.steps > kMostSteps)) {
    refuse_value("steps: expected 1 to " + std::to_string(kMostSteps) + "; " +
                 std::to_string(*request.steps) + " came");
  }
  if (!request.steps && !request.max_error) request.max_error = kDefaultError;
  return request;
}

const Row& find_row(const Request& request) {
  return found_in(Table<Row>{kRows, kRowCount}, request);
}

const CushionRow& find_cushion_row(const Request& request) {
  return found_in(Table<CushionRow>{kCushionRows, kCushionRowCount}, request);
}

}  // namespace carom
