// Power series, coefficient by coefficient: each function gives coefficient n of a result from the
// coefficients 0..n of its arguments and 0..n-1 of the result itself.
#ifndef CAROM_TESTS_ORACLE_BALL_CUSHION_POWER_SERIES_H_
#define CAROM_TESTS_ORACLE_BALL_CUSHION_POWER_SERIES_H_

#include <array>

#include "real.h"

namespace carom_oracle {
namespace cushion {

template <class Real, int kOrder>
using PowerSeries = std::array<Real, kOrder + 1>;

template <class Series>
typename Series::value_type product(const Series& a, const Series& b, int n) {
  typename Series::value_type sum = 0;
  for (int k = 0; k <= n; ++k) sum += a[k] * b[n - k];
  return sum;
}

template <class Series>
typename Series::value_type square(const Series& a, int n) {
  typename Series::value_type sum = 0;
  for (int k = 0; 2 * k < n; ++k) sum += a[k] * a[n - k];
  sum += sum;
  return n % 2 == 0 ? sum + a[n / 2] * a[n / 2] : sum;
}

/// Of the root of a series whose coefficient n is `radicand`.
template <class Series>
typename Series::value_type root(const Series& r, typename Series::value_type radicand, int n) {
  if (n == 0) return square_root(radicand);
  typename Series::value_type sum = 0;
  for (int k = 1; k < n; ++k) sum += r[k] * r[n - k];
  return (radicand - sum) / (2 * r[0]);
}

template <class Series>
typename Series::value_type reciprocal(const Series& a, const Series& inverse, int n) {
  if (n == 0) return 1 / a[0];
  typename Series::value_type sum = 0;
  for (int k = 1; k <= n; ++k) sum += a[k] * inverse[n - k];
  return -sum * inverse[0];
}

template <class Series>
typename Series::value_type value_at(const Series& a, typename Series::value_type t) {
  typename Series::value_type sum = 0;
  for (std::size_t n = a.size(); n-- > 0;) sum = sum * t + a[n];
  return sum;
}

/// Where a series that is not negative at 0 first falls below zero in (0, end]; `end` if it does
/// not. Between two of its samples it may dip only as far as its lowest point, which is sought.
template <class Series>
bool first_fall(const Series& a, typename Series::value_type end,
                typename Series::value_type* where) {
  using Real = typename Series::value_type;
  constexpr int kSamples = 24;
  Real before = 0, here = 0, value_before = a[0], value_here = a[0];
  const auto narrow = [&a, where](Real low, Real high) {
    for (int i = 0; i < 200 && high - low > epsilon<Real>() * high; ++i) {
      const Real middle = low + (high - low) / 2;
      (value_at(a, middle) < 0 ? high : low) = middle;
    }
    *where = high;
    return true;
  };
  for (int i = 1; i <= kSamples; ++i) {
    const Real next = end * i / kSamples, value_next = value_at(a, next);
    if (value_next < 0) return narrow(here, next);
    const bool falls = i > 1 ? value_here < value_before : a[1] < 0;
    if (falls && value_here < value_next) {
      Real low = before, high = next;  // thirds around the lowest point
      for (int k = 0; k < 60; ++k) {
        const Real one = low + (high - low) / 3, two = high - (high - low) / 3;
        const Real at_one = value_at(a, one), at_two = value_at(a, two);
        if (at_one < 0) return narrow(low, one);
        if (at_two < 0) return narrow(low, two);
        (at_one < at_two ? high : low) = at_one < at_two ? two : one;
      }
    }
    before = here;
    value_before = value_here;
    here = next;
    value_here = value_next;
  }
  return false;
}

}  // namespace cushion
}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_BALL_CUSHION_POWER_SERIES_H_
