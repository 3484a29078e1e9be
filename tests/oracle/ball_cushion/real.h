// What std:: has for double and long double alone, so that the oracle runs in __float128, too.
#ifndef CAROM_TESTS_ORACLE_BALL_CUSHION_REAL_H_
#define CAROM_TESTS_ORACLE_BALL_CUSHION_REAL_H_

#include <cmath>

namespace carom_oracle {
namespace cushion {

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

/// Two components of a vector: along a contact's first and second direction.
template <class Real>
struct Pair {
  Real x, y;
};

template <class Real>
Real size_of(Pair<Real> a) {
  return square_root(a.x * a.x + a.y * a.y);
}
template <class Real>
Pair<Real> operator+(Pair<Real> a, Pair<Real> b) {
  return {a.x + b.x, a.y + b.y};
}
template <class Real>
Pair<Real> operator*(Real k, Pair<Real> a) {
  return {k * a.x, k * a.y};
}
template <class Real>
Real dot(Pair<Real> a, Pair<Real> b) {
  return a.x * b.x + a.y * b.y;
}
/// Of b, what lies a quarter turn ahead of a.
template <class Real>
Real cross(Pair<Real> a, Pair<Real> b) {
  return a.x * b.y - a.y * b.x;
}

}  // namespace cushion
}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_BALL_CUSHION_REAL_H_
