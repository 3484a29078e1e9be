// Reference outcome of a ball-ball collision on a table, in the limit of a vanishing step.
//
// Independent of the kernels under test: it integrates the full velocities of both balls (not the
// reduced slip system) with Taylor series of high order in a regularised impulse-time, so nothing
// here shares a formula, a method or an error with what the generator derives.
//
// Source of the equations: Mathavan, Jackson, Parkin, Sports Engineering 17 (2014),
// doi 10.1007/s12283-014-0158-y, written for two masses M1 and M2.
#ifndef CAROM_TESTS_ORACLE_EXACT_SOLVER_H_
#define CAROM_TESTS_ORACLE_EXACT_SOLVER_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "exact_impact.h"
#include "params.h"

namespace carom_oracle {

/// Same values as CAROM_OK, CAROM_SEPARATING, CAROM_BAD_INPUT and CAROM_TILTED.
enum Status { kOk = 0, kSeparating = 1, kBadInput = 2, kTilted = 3 };

/// Velocities (m/s) and angular velocities (rad/s) after the collision, world axes. `sticks`: the
/// slip between the balls vanishes before the end (or at the start). `error_estimate`, m/s, counts
/// rounding in |dv| and R |dw| before they are rounded to Real; with top slip a table slip that
/// passes zero closely can exceed it 100 times. Infinite if the integration gave up.
template <class Real>
struct BasicOutcome {
  Real v1[3], w1[3], v2[3], w2[3];
  int status;
  bool sticks;
  double error_estimate;
};
using Outcome = BasicOutcome<double>;

/// Rise |dz| / |d| above which a line of centres counts as tilted.
constexpr double kTiltLimit = 1e-6;

namespace detail {

/// Rows r = f x u, f and u = (0, 0, 1) of the collision frame; `r` is not normalised, which only
/// matters for a tilted line of centres, where pooltool does the same.
template <class Real>
struct Frame {
  Real r[3], f[3];
};

inline bool all_finite(const double* x, int n) {
  return std::all_of(x, x + n, [](double v) { return std::isfinite(v); });
}

inline bool in_range(double x, double low, double high) { return x >= low && x <= high; }

inline bool valid(const Params& p) {
  const double most = std::numeric_limits<double>::max();
  const double least = std::numeric_limits<double>::denorm_min();
  return in_range(p.R, least, most) && in_range(p.M, least, most) &&
         in_range(p.M1_over_M2, least, most) && in_range(p.u_s1, 0, 1) && in_range(p.u_s2, 0, 1) &&
         in_range(p.u_b, 0, 1) && in_range(p.e_b, 0, 1);
}

/// Frame of the line of centres d. A rise of up to kTiltLimit is levelled, except in pooltool's
/// model.
template <class Real>
int make_frame(const double ball1[9], const double ball2[9], bool as_pooltool, Frame<Real>* out) {
  Real d[3], most = 0;
  for (int i = 0; i < 3; ++i) {
    d[i] = static_cast<Real>(ball2[i]) - static_cast<Real>(ball1[i]);
    most = std::max(most, absolute(d[i]));
  }
  if (most == 0) return kBadInput;
  for (Real& x : d) x /= most;
  const Real length = square_root(dot(d, d));
  const bool tilted = absolute(d[2]) > static_cast<Real>(kTiltLimit) * length;
  if (tilted && !as_pooltool) return kTilted;
  const Real level = square_root(d[0] * d[0] + d[1] * d[1]);
  if (level == 0) return kTilted;
  const Real norm = as_pooltool ? length : level;
  for (int i = 0; i < 3; ++i) out->f[i] = d[i] / norm;
  if (!as_pooltool) out->f[2] = 0;
  out->r[0] = out->f[1];
  out->r[1] = -out->f[0];
  out->r[2] = 0;
  return kOk;
}

template <class Real>
void to_frame(const Frame<Real>& frame, const double ball[9], Real R, Real out[kBall]) {
  Real v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    v[i] = ball[3 + i];
    w[i] = R * static_cast<Real>(ball[6 + i]);
  }
  out[kVx] = dot(v, frame.r);
  out[kVy] = dot(v, frame.f);
  out[kVz] = v[2];
  out[kSx] = dot(w, frame.r);
  out[kSy] = dot(w, frame.f);
  out[kSz] = w[2];
}

/// Back to world axes by the transpose, as pooltool does even when the frame is not orthonormal.
template <class Real>
void from_frame(const Frame<Real>& frame, const Real y[kBall], Real R, Real v[3], Real w[3]) {
  for (int i = 0; i < 3; ++i) {
    v[i] = i == 2 ? y[kVz] : frame.r[i] * y[kVx] + frame.f[i] * y[kVy];
    const Real spin = frame.r[i] * y[kSx] + frame.f[i] * y[kSy];
    w[i] = (i == 2 ? spin + y[kSz] : spin) / R;
  }
}

template <class Real>
BasicOutcome<Real> unchanged(const double ball1[9], const double ball2[9], int status) {
  BasicOutcome<Real> out{};
  for (int i = 0; i < 3; ++i) {
    out.v1[i] = ball1[3 + i];
    out.w1[i] = ball1[6 + i];
    out.v2[i] = ball2[3 + i];
    out.w2[i] = ball2[6 + i];
  }
  out.status = status;
  return out;
}

/// Power of two near the largest of the 12 velocities (the problem is homogeneous in them).
template <class Real>
Real velocity_scale(const std::array<Real, kUnknowns>& y) {
  Real most = 0;
  for (int i = 0; i < 2 * kBall; ++i) most = std::max(most, absolute(y[i]));
  int exponent = 0;
  std::frexp(static_cast<long double>(most), &exponent);
  return static_cast<Real>(std::ldexp(1.0L, exponent));
}

/// A collision from world axes to the frame of the contact and back.
template <class Real>
class Collision {
 public:
  using State = typename Impact<Real>::State;

  /// The balls must live as long as this.
  Collision(const Params& p, Model model, const double ball1[9], const double ball2[9])
      : ball1_(ball1), ball2_(ball2), R_(p.R) {
    State start{};
    status_ = enter(p, model, &start);
    if (status_ != kOk) return;
    scale_ = velocity_scale<Real>(start);
    for (Real& x : start) x /= scale_;
    impact_.emplace(p, model, start);
  }

  /// What is to be run; null where nothing collides.
  Impact<Real>* impact() { return impact_ ? &*impact_ : nullptr; }

  /// Did it take so many steps that rounding may be of account, or did it give up?
  bool took_many_steps() const { return impact_ && impact_->steps() > kManySteps; }

  BasicOutcome<Real> outcome() const {
    if (!impact_) return unchanged<Real>(ball1_, ball2_, status_);
    State end = impact_->state();
    for (Real& x : end) x *= scale_;
    BasicOutcome<Real> out{};
    from_frame(frame_, end.data(), R_, out.v1, out.w1);
    from_frame(frame_, end.data() + kBall, R_, out.v2, out.w2);
    out.status = kOk;
    out.sticks = impact_->sticks();
    out.error_estimate = impact_->gave_up() ? std::numeric_limits<double>::infinity()
                                            : static_cast<double>(scale_ * epsilon<Real>()) *
                                                  (8 + 2 * impact_->steps());
    return out;
  }

 private:
  int enter(const Params& p, Model model, State* start) {
    if (!all_finite(ball1_, 9) || !all_finite(ball2_, 9) || !valid(p)) return kBadInput;
    const bool as_pooltool = model.top_slip && !model.lift;
    const int status = make_frame(ball1_, ball2_, as_pooltool, &frame_);
    if (status != kOk) return status;
    to_frame(frame_, ball1_, R_, start->data());
    to_frame(frame_, ball2_, R_, start->data() + kBall);
    return Impact<Real>::normal(*start) >= 0 ? kSeparating : kOk;
  }

  static constexpr int kManySteps = 200;

  const double *ball1_, *ball2_;
  Real R_, scale_ = 1;
  Frame<Real> frame_{};
  int status_;
  std::optional<Impact<Real>> impact_;
};

}  // namespace detail

/// The outcome in the number type Real (double, long double or __float128). ball1, ball2: position
/// (m), velocity (m/s), angular velocity (rad/s), 3 each. Status as CAROM_* in carom.h; anything
/// but kOk returns the velocities as they came. A tilted line of centres is kTilted, except with
/// pooltool's model, which gets pooltool's own frame (r = f x u not normalised). v_z changes only
/// with lift. Error about 1e-18 (long double) of the largest of |v| and R|w|, on the range of
/// Params, except where the model itself is ill-conditioned (top slip with u_b u_s near 0.5).
template <class Real>
BasicOutcome<Real> solve_exact_as(const Params& p, Model model, const double ball1[9],
                                  const double ball2[9]) {
  detail::Collision<Real> collision(p, model, ball1, ball2);
  if (auto* impact = collision.impact()) impact->run();
  return collision.outcome();
}

/// As solve_exact_as<long double>, rounded to double.
inline Outcome solve_exact(const Params& p, Model model, const double ball1[9],
                           const double ball2[9]) {
  const BasicOutcome<long double> exact = solve_exact_as<long double>(p, model, ball1, ball2);
  Outcome out{};
  for (int i = 0; i < 3; ++i) {
    out.v1[i] = static_cast<double>(exact.v1[i]);
    out.w1[i] = static_cast<double>(exact.w1[i]);
    out.v2[i] = static_cast<double>(exact.v2[i]);
    out.w2[i] = static_cast<double>(exact.w2[i]);
  }
  out.status = exact.status;
  out.sticks = exact.sticks;
  out.error_estimate = exact.error_estimate;
  return out;
}

}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_EXACT_SOLVER_H_
