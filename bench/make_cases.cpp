#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batch.h"
#include "case_rows.h"
#include "commands.h"
#include "impact.h"

namespace carom_bench {
namespace {

using Fixed = std::pair<std::size_t, double>;

std::size_t parameter_column(const std::string& name, const std::string& text) {
  std::string known;
  for (std::size_t i = 0; i < kParameters; ++i) {
    if (name == kParameterNames[i]) return i;
    known.append(i == 0 ? "" : ", ").append(kParameterNames[i]);
  }
  throw std::runtime_error("--fix " + text + ": expected one of " + known + ", as R=0.03");
}

Fixed parse_fixed(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::size_t column = parameter_column(text.substr(0, equals), text);
  const std::string number = equals == std::string::npos ? "" : text.substr(equals + 1);
  char* end = nullptr;
  const double value = std::strtod(number.c_str(), &end);
  if (number.empty() || *end != '\0') {
    throw std::runtime_error("--fix " + text + ": expected a number after the sign, as R=0.03");
  }
  return {column, value};
}

void write_kinds(const std::string& path, const std::vector<MadeCase>& cases) {
  std::string text;
  for (const MadeCase& one : cases) text.append(one.kind).append("\n");
  write_file(path, text.data(), text.size());
}

}  // namespace

void make_cases(const MakeCases& options) {
  std::vector<Fixed> fixed;
  for (const std::string& text : options.fixed) fixed.push_back(parse_fixed(text));
  const std::vector<MadeCase> cases = made_cases(options.seed, options.count, options.mixed);
  std::vector<CaseRow> rows;
  for (const MadeCase& one : cases) {
    rows.push_back(one.row);
    for (const Fixed& each : fixed) set_parameter(&rows.back(), each.first, each.second);
  }
  write_rows(options.out, rows);
  if (!options.kinds.empty()) write_kinds(options.kinds, cases);
}

}  // namespace carom_bench
