// What the oracles of two balls are given, and the numbers that they compute with.
#ifndef CAROM_TESTS_ORACLE_PARAMS_H_
#define CAROM_TESTS_ORACLE_PARAMS_H_

#include <cmath>
#include <stdexcept>
#include <string>

namespace carom_oracle {

/// Parameters of one collision. R in m, M in kg (the mass of ball 2), friction coefficients and
/// restitution without unit; u_s1 and u_s2 are ball 1 and ball 2 on the table, u_b is ball on ball.
/// Ball 1 has the mass M * M1_over_M2. Valid: R, M, M1_over_M2 > 0, frictions 0..1, e_b 0..1.
struct Params {
  double R, M, u_s1, u_s2, u_b, e_b;
  double M1_over_M2 = 1;
};

/// The two independent terms of the contact model: table slip taken at the top point of the ball
/// instead of the bottom point, and vertical velocity of the lifted ball.
struct Model {
  bool top_slip;
  bool lift;
};

constexpr Model kPooltool{true, false};
constexpr Model kBottomSlip{false, false};
constexpr Model kMathavan2014{false, true};

/// The preset called `name`; throws std::invalid_argument for any other name.
inline Model model_by_name(const std::string& name) {
  if (name == "pooltool") return kPooltool;
  if (name == "bottom_slip") return kBottomSlip;
  if (name == "mathavan2014") return kMathavan2014;
  throw std::invalid_argument("no model '" + name +
                              "': expected pooltool, bottom_slip or mathavan2014");
}

namespace detail {

// Not std::numeric_limits: it knows nothing of __float128 in strict mode.
template <class Real>
constexpr Real epsilon() {
  Real eps = 1;
  while (Real(1) + eps / 2 != Real(1)) eps /= 2;
  return eps;
}

inline double square_root(double x) { return std::sqrt(x); }
inline long double square_root(long double x) { return std::sqrt(x); }
template <class Real>
Real square_root(Real x) {
  if (!(x > 0)) return Real(0);
  const Real guess = static_cast<Real>(std::sqrt(static_cast<long double>(x)));
  return (guess + x / guess) / 2;
}

template <class Real>
Real absolute(Real x) {
  return x < 0 ? -x : x;
}

template <class Real>
Real dot(const Real a[3], const Real b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace detail

}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_PARAMS_H_
