// One collision of a ball with a cushion as calls see it: parameters, a ball's state in world axes,
// a status.
#ifndef CAROM_TESTS_ORACLE_BALL_CUSHION_EXACT_SOLVER_H_
#define CAROM_TESTS_ORACLE_BALL_CUSHION_EXACT_SOLVER_H_

#include <cmath>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "exact_impact.h"

namespace carom_oracle {
namespace cushion {

/// R in m, M in kg, h (of the cushion's nose above the table) in m; u_s at the table, u_w at the
/// cushion, e_c: without unit. Valid: R, M > 0, frictions 0..1, e_c 0..1, R <= h < 2 R, and angles
/// of friction and of the nose that add up to less than 90 degrees.
struct Params {
  double R, M, u_s, u_w, e_c, h;
};

/// kClamped: the table pushes only. kPrinted: the paper's equations, in which it may pull; they
/// have no unique answer for a rolling ball where u_w > tan theta. kPooltool: fixed steps of these
/// in which a contact without slip is pushed along -x; there is nothing exact of it.
enum class Model { kClamped, kPrinted, kPooltool };

/// Throws std::invalid_argument for a name that is no model's.
inline Model model_by_name(const std::string& name) {
  if (name == "clamped") return Model::kClamped;
  if (name == "printed") return Model::kPrinted;
  if (name == "pooltool") return Model::kPooltool;
  throw std::invalid_argument("no model '" + name + "': expected clamped, printed or pooltool");
}

/// Same values as CAROM_OK, CAROM_SEPARATING and CAROM_BAD_INPUT.
enum Status { kOk = 0, kSeparating = 1, kBadInput = 2 };

/// World axes, m/s and rad/s. Impulses / M of compression and of all, m/s.
template <class Real>
struct BasicOutcome {
  Real v[3], w[3];
  int status;
  Events events;
  Real compression_impulse, impulse;
};
using Outcome = BasicOutcome<double>;

namespace detail {

inline bool within(double low, double value, double high) { return low <= value && value <= high; }

inline bool valid(const Params& p) {
  const bool sizes = p.R > 0 && p.M > 0 && std::isfinite(p.R) && std::isfinite(p.M);
  const bool frictions = within(0, p.u_s, 1) && within(0, p.u_w, 1) && within(0, p.e_c, 1);
  if (!sizes || !frictions || !(p.h >= p.R && p.h < 2 * p.R)) return false;
  // The sum of three angles, each below 90 degrees, is below 90 where the cosine of the first two
  // and then of all three is positive: tangents say it without a rounded pi.
  const long double sine = (static_cast<long double>(p.h) - p.R) / p.R;
  const long double nose = sine / std::sqrt(1 - sine * sine);
  const long double left = 1 - nose * p.u_s;
  return left > 0 && left > (nose + p.u_s) * p.u_w;
}

inline bool all_finite(const double* a, int n) {
  for (int i = 0; i < n; ++i) {
    if (!std::isfinite(a[i])) return false;
  }
  return true;
}

template <class Real>
struct Frame {
  Pair<Real> normal;
  Pair<Real> in(Real x, Real y) const {
    return {normal.y * x - normal.x * y, normal.x * x + normal.y * y};
  }
  Pair<Real> out(Pair<Real> a) const {
    return {normal.y * a.x + normal.x * a.y, normal.y * a.y - normal.x * a.x};
  }
};

template <class Real>
Frame<Real> frame_of(const double normal[2]) {
  // Exact, and so that no square leaves the range.
  int exponent = 0;
  std::frexp(std::fmax(std::fabs(normal[0]), std::fabs(normal[1])), &exponent);
  const Pair<Real> n{std::ldexp(normal[0], -exponent), std::ldexp(normal[1], -exponent)};
  return {(1 / size_of(n)) * n};
}

/// In the cushion's frame, spins times R.
template <class Real>
Velocities<Real> into_frame(const Frame<Real>& frame, Real radius, const double ball[6]) {
  const Pair<Real> v = frame.in(ball[0], ball[1]), w = frame.in(ball[3], ball[4]);
  return {v.x, v.y, radius * w.x, radius * w.y, radius * ball[5]};
}

template <class Real>
BasicOutcome<Real> unchanged(const double ball[6], int status) {
  BasicOutcome<Real> out{};
  for (int i = 0; i < 3; ++i) {
    out.v[i] = ball[i];
    out.w[i] = ball[3 + i];
  }
  out.status = status;
  return out;
}

template <class Real>
void out_of_frame(const Frame<Real>& frame, Real radius, const Velocities<Real>& y,
                  BasicOutcome<Real>* out) {
  const Pair<Real> v = frame.out({y[kVx], y[kVy]});
  const Pair<Real> w = frame.out({y[kRx] / radius, y[kRy] / radius});
  out->v[0] = v.x;
  out->v[1] = v.y;
  out->w[0] = w.x;
  out->w[1] = w.y;
  out->w[2] = y[kRz] / radius;
}

/// kOk where there is a collision to solve; then the ball in the cushion's frame is in `start`.
template <class Real>
int enter(const Params& p, const double ball[6], const double normal[2], Frame<Real>* frame,
          Velocities<Real>* start) {
  const bool finite = all_finite(ball, 6) && all_finite(normal, 2);
  if (!finite || !valid(p) || (normal[0] == 0 && normal[1] == 0)) return kBadInput;
  *frame = frame_of<Real>(normal);
  *start = into_frame(*frame, static_cast<Real>(p.R), ball);
  return (*start)[kVy] > 0 ? kOk : kSeparating;
}

}  // namespace detail

/// `ball`: velocity and angular velocity, world axes, m/s and rad/s; `normal`: in the table plane,
/// into the cushion, of any length. v_z stays as it is. Without a collision nothing changes. Throws
/// std::invalid_argument for kPooltool.
template <class Real>
BasicOutcome<Real> solve_exact_as(const Params& p, Model model, const double ball[6],
                                  const double normal[2]) {
  if (model == Model::kPooltool) {
    throw std::invalid_argument("model pooltool: it has fixed steps alone; expected method euler");
  }
  detail::Frame<Real> frame;
  Velocities<Real> start;
  const int status = detail::enter(p, ball, normal, &frame, &start);
  BasicOutcome<Real> out = detail::unchanged<Real>(ball, status);
  if (status != kOk) return out;

  double largest = 0;
  for (const Real& v : start) largest = std::fmax(largest, std::fabs(static_cast<double>(v)));
  int exponent = 0;
  std::frexp(largest, &exponent);
  const Real scale = std::ldexp(1.0L, exponent);  // a power of two: homogeneous to the last digit
  for (Real& v : start) v /= scale;
  const Contacts<Real> contacts(Real(p.h) / Real(p.R));
  ExactImpact<Real> impact(contacts, p.u_w, p.u_s, p.e_c, model == Model::kClamped, start);
  impact.run();

  Velocities<Real> after;
  std::copy_n(impact.state().begin(), after.size(), after.begin());
  for (Real& v : after) v *= scale;
  detail::out_of_frame(frame, static_cast<Real>(p.R), after, &out);
  out.events = impact.events();
  out.compression_impulse = impact.compression_impulse() * scale;
  out.impulse = impact.state()[kImpulse] * scale;
  return out;
}

/// In long double, rounded at the end.
inline Outcome solve_exact(const Params& p, Model model, const double ball[6],
                           const double normal[2]) {
  const auto exact = solve_exact_as<long double>(p, model, ball, normal);
  Outcome out{};
  for (int i = 0; i < 3; ++i) {
    out.v[i] = static_cast<double>(exact.v[i]);
    out.w[i] = static_cast<double>(exact.w[i]);
  }
  out.status = exact.status;
  out.events = exact.events;
  out.compression_impulse = static_cast<double>(exact.compression_impulse);
  out.impulse = static_cast<double>(exact.impulse);
  return out;
}

}  // namespace cushion
}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_BALL_CUSHION_EXACT_SOLVER_H_
