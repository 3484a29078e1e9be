// The fixed-step scheme of pooltool 0.6.0 (FrictionalMathavan) and of the ETH report, on the full
// velocities and in pooltool's order of operations, for any number type and contact model.
#ifndef CAROM_TESTS_ORACLE_FIXED_STEP_H_
#define CAROM_TESTS_ORACLE_FIXED_STEP_H_

#include <cmath>
#include <limits>

#include "exact_solver.h"

namespace carom_oracle {

/// Outcome of the fixed-step scheme and the steps it took. `completed` is false when the limit of
/// steps came first: pooltool itself would loop for ever (v_n below rounding of the velocities).
/// `outcome.sticks` says that the contact slip fell below 1e-16 m/s; error_estimate is NaN.
template <class Real>
struct FixedStepOutcome {
  BasicOutcome<Real> outcome;
  long iterations;
  bool completed;
};

namespace detail {

template <class Real>
struct FixedBall {
  Real vx, vy, vz, wx, wy, wz;
};

template <class Real>
class FixedStepper {
 public:
  FixedStepper(const Params& p, Model model, FixedBall<Real> ball1, FixedBall<Real> ball2)
      : model_(model), b1_(ball1), b2_(ball2), R_(p.R), u_b_(p.u_b), e_b_(p.e_b) {
    m1_ = static_cast<Real>(p.M) * static_cast<Real>(p.M1_over_M2);
    m2_ = p.M;
    u_s1_ = p.u_s1;
    u_s2_ = p.u_s2;
    c1_ = 5 / (2 * m1_ * R_);
    c2_ = 5 / (2 * m2_ * R_);
  }

  /// Steps of dP = (1 + e_b) M |v_n| / (2 n), at most `limit`; true if the end was reached.
  bool run(long n, long limit) {
    Real vn = b2_.vy - b1_.vy;
    // 2 / (1/M1 + 1/M2) is M for equal masses: then exactly pooltool's step.
    const Real mass = m1_ == m2_ ? m1_ : 2 * m1_ * m2_ / (m1_ + m2_);
    const Real dp = Real(0.5) * (1 + e_b_) * mass * absolute(vn) / static_cast<Real>(n);
    Real work = 0, work_end = 0;
    bool restitution = false;
    while (vn < 0 || !restitution || work < work_end) {
      if (iterations_ >= limit) return false;
      step(dp);
      const Real before = vn;
      vn = b2_.vy - b1_.vy;
      work += Real(0.5) * dp * absolute(before + vn);
      ++iterations_;
      if (!restitution && vn > 0) {
        restitution = true;
        work_end = (1 + e_b_ * e_b_) * work;
      }
    }
    return true;
  }

  const FixedBall<Real>& ball1() const { return b1_; }
  const FixedBall<Real>& ball2() const { return b2_; }
  long iterations() const { return iterations_; }
  bool sticks() const { return sticks_; }

 private:
  struct Table {
    Real x, y;
  };

  Table table_impulse(const FixedBall<Real>& b, Real u_s, Real press) const {
    const Real Rwx = R_ * b.wx, Rwy = R_ * b.wy;
    const Real sx = model_.top_slip ? b.vx + Rwy : b.vx - Rwy;
    const Real sy = model_.top_slip ? b.vy - Rwx : b.vy + Rwx;
    const Real s = square_root(sx * sx + sy * sy);
    if (s == 0) return {Real(0), Real(0)};
    return {-u_s * (sx / s) * press, -u_s * (sy / s) * press};
  }

  void step(Real dp) {
    const Real cx = b1_.vx - b2_.vx - R_ * (b1_.wz + b2_.wz);
    Real cz = R_ * (b1_.wx + b2_.wx);
    if (model_.lift) cz += b1_.vz - b2_.vz;
    const Real c = square_root(cx * cx + cz * cz);
    const Real tiny = Real(1e-16);
    Real dp1 = 0, dp2 = 0;
    if (c < tiny) {
      sticks_ = true;
    } else {
      dp1 = -u_b_ * dp * cx / c;
      if (absolute(cz) >= tiny) dp2 = -u_b_ * dp * cz / c;
    }
    apply(dp, dp1, dp2);
  }

  void apply(Real dp, Real dp1, Real dp2) {
    Table t1{Real(0), Real(0)}, t2{Real(0), Real(0)};
    if (dp2 > 0) t2 = table_impulse(b2_, u_s2_, dp2);
    if (dp2 < 0) t1 = table_impulse(b1_, u_s1_, -dp2);
    b1_.vx += (dp1 + t1.x) / m1_;
    b2_.vx += (-dp1 + t2.x) / m2_;
    b1_.vy += (-dp + t1.y) / m1_;
    b2_.vy += (dp + t2.y) / m2_;
    if (model_.lift && dp2 > 0) b1_.vz += dp2 / m1_;
    if (model_.lift && dp2 < 0) b2_.vz -= dp2 / m2_;
    b1_.wx += c1_ * (dp2 + t1.y);
    b1_.wy += c1_ * (-t1.x);
    b1_.wz += c1_ * (-dp1);
    b2_.wx += c2_ * (dp2 + t2.y);
    b2_.wy += c2_ * (-t2.x);
    b2_.wz += c2_ * (-dp1);
  }

  Model model_;
  FixedBall<Real> b1_, b2_;
  Real R_, u_b_, e_b_, m1_, m2_, u_s1_, u_s2_, c1_, c2_;
  long iterations_ = 0;
  bool sticks_ = false;
};

/// pooltool's frame: one division of d by its length, no scaling.
template <class Real>
Frame<Real> fixed_frame(const double ball1[9], const double ball2[9], bool as_pooltool) {
  Real d[3];
  for (int i = 0; i < 3; ++i) d[i] = static_cast<Real>(ball2[i]) - static_cast<Real>(ball1[i]);
  if (!as_pooltool) d[2] = 0;
  const Real length = square_root(dot(d, d));
  Frame<Real> frame{};
  for (int i = 0; i < 3; ++i) frame.f[i] = d[i] / length;
  frame.r[0] = frame.f[1];
  frame.r[1] = -frame.f[0];
  return frame;
}

template <class Real>
FixedBall<Real> fixed_ball(const Frame<Real>& frame, const double ball[9]) {
  Real v[3], w[3];
  for (int i = 0; i < 3; ++i) {
    v[i] = ball[3 + i];
    w[i] = ball[6 + i];
  }
  return {dot(v, frame.r), dot(v, frame.f), v[2], dot(w, frame.r), dot(w, frame.f), w[2]};
}

template <class Real>
void fixed_back(const Frame<Real>& frame, const FixedBall<Real>& b, Real v[3], Real w[3]) {
  for (int i = 0; i < 3; ++i) {
    v[i] = i == 2 ? b.vz : frame.r[i] * b.vx + frame.f[i] * b.vy;
    const Real spin = frame.r[i] * b.wx + frame.f[i] * b.wy;
    w[i] = i == 2 ? spin + b.wz : spin;
  }
}

}  // namespace detail

/// One collision with n fixed steps of normal impulse, at most 10 n of them. Arguments, units and
/// status as solve_exact_as; n > 0. Error of the scheme: first order, up to about 1e-3 of |v1 - v2|
/// at n = 1000. Source: pooltool 0.6.0, and for the other models the paper named in exact_solver.h.
template <class Real>
FixedStepOutcome<Real> solve_fixed_step(const Params& p, Model model, const double ball1[9],
                                        const double ball2[9], long n) {
  const auto as_they_came = [&](int status) {
    return FixedStepOutcome<Real>{detail::unchanged<Real>(ball1, ball2, status), 0, true};
  };
  const bool finite = detail::all_finite(ball1, 9) && detail::all_finite(ball2, 9);
  if (!finite || !detail::valid(p) || n <= 0) return as_they_came(kBadInput);
  const bool as_pooltool = model.top_slip && !model.lift;
  detail::Frame<Real> checked;
  const int status = detail::make_frame(ball1, ball2, as_pooltool, &checked);
  if (status != kOk) return as_they_came(status);

  const auto frame = detail::fixed_frame<Real>(ball1, ball2, as_pooltool);
  const auto start1 = detail::fixed_ball(frame, ball1), start2 = detail::fixed_ball(frame, ball2);
  if (start2.vy - start1.vy >= 0) return as_they_came(kSeparating);
  detail::FixedStepper<Real> stepper(p, model, start1, start2);
  FixedStepOutcome<Real> result{};
  result.completed = stepper.run(n, 10 * n);
  result.iterations = stepper.iterations();
  BasicOutcome<Real>& out = result.outcome;
  detail::fixed_back(frame, stepper.ball1(), out.v1, out.w1);
  detail::fixed_back(frame, stepper.ball2(), out.v2, out.w2);
  out.status = kOk;
  out.sticks = stepper.sticks();
  out.error_estimate = std::numeric_limits<double>::quiet_NaN();
  return result;
}

}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_FIXED_STEP_H_
