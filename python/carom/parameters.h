// carom.Parameters: what a collision is given besides the balls, in its ranges.
#ifndef CAROM_PYTHON_PARAMETERS_H_
#define CAROM_PYTHON_PARAMETERS_H_

#include <array>
#include <cstdio>
#include <string>

#include "arguments.h"
#include "kernel_table.h"

namespace carom {

inline std::array<double, kRangeCount> values_of(const Parameters& p) {
  return {p.R, p.M, p.u_s1, p.u_s2, p.u_b, p.e_b};
}

/// Has ball 1 another mass?
inline bool is_unequal(const Parameters& p) { return p.M1 != p.M; }

inline bool operator==(const Parameters& a, const Parameters& b) {
  return values_of(a) == values_of(b) && a.M1 == b.M1;
}

/// A limit as it was written: 0 to 1, not 0.0 to 1.0.
inline std::string limit(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

inline void require_in_range(double value, const Range& range) {
  if (value >= range.low && value <= range.high) return;
  refuse_value(std::string(range.name) + " = " + text_of(value) + " is out of range: expected " +
               limit(range.low) + " to " + limit(range.high));
}

/// Raises ValueError where a number is out of its range, with its name and the range.
inline const Parameters& require_in_ranges(const Parameters& p) {
  const auto values = values_of(p);
  for (std::size_t i = 0; i < kRangeCount; ++i) require_in_range(values[i], kRanges[i]);
  const double most = kMassRatio.high;  // the least is its inverse, as kernels ask for it
  if (!(p.M1 * most >= p.M && p.M1 <= most * p.M)) {
    refuse_value("M1 = " + text_of(p.M1) + " is out of range: expected " + limit(kMassRatio.low) +
                 " to " + limit(most) + " times M = " + text_of(p.M));
  }
  return p;
}

/// As keyword arguments; M1 is among them where it was given.
inline nb::dict keywords_of(const Parameters& p) {
  nb::dict named;
  const auto values = values_of(p);
  for (std::size_t i = 0; i < kRangeCount; ++i) named[kRanges[i].name] = values[i];
  if (is_unequal(p)) named["M1"] = p.M1;
  return named;
}

inline std::string shown(const Parameters& p) {
  std::string text;
  for (const auto& [name, value] : keywords_of(p)) {
    text += (text.empty() ? "" : ", ") + nb::cast<std::string>(name) + "=" + text_of(value);
  }
  return "Parameters(" + text + ")";
}

void bind_parameters(nb::module_& m);

}  // namespace carom

#endif  // CAROM_PYTHON_PARAMETERS_H_
