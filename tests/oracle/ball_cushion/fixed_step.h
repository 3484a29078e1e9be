// Steps of the cushion's impulse as pooltool 0.6 takes them (`Mathavan2010`), in any precision and
// for any model: directions by angles, no event is met but the two ends, and these only nearly.
#ifndef CAROM_TESTS_ORACLE_BALL_CUSHION_FIXED_STEP_H_
#define CAROM_TESTS_ORACLE_BALL_CUSHION_FIXED_STEP_H_

#include <algorithm>
#include <cmath>

#include "exact_solver.h"

namespace carom_oracle {
namespace cushion {

/// pooltool's fields: what a phase is cut into, and the shortest step in Ns. Of restitution the
/// step is the phase's work in J by max_steps, as if it were Ns. kClamped: the table only pushes;
/// that and kPrinted: a contact without slip has no friction.
struct FixedSteps {
  long max_steps = 1000;
  double delta_p = 0.001;
  Model model = Model::kPooltool;
};

template <class Real>
struct FixedStepOutcome {
  BasicOutcome<Real> outcome;
  long steps;
  bool completed;  ///< false: more than 10 max_steps in a phase, where pooltool raises
};

namespace detail {

template <class Real>
class FixedStepImpact {
 public:
  /// vx, vy, wx, wy, wz in the cushion's frame.
  using Ball = std::array<Real, 5>;

  FixedStepImpact(const Params& p, FixedSteps options, const Ball& start)
      : R_(p.R),
        M_(p.M),
        u_s_(p.u_s),
        u_w_(p.u_w),
        e_(p.e_c),
        sine_((Real(p.h) - R_) / R_),
        cosine_(std::sqrt(1 - sine_ * sine_)),
        options_(options),
        ball_(start) {}

  void run() {
    const Real floor = options_.delta_p;
    compress(std::max(M_ * ball_[1] / options_.max_steps, floor));
    const Real target = e_ * e_ * work_;
    if (completed_) restore(target, std::max(target / options_.max_steps, floor));
  }

  const Ball& ball() const { return ball_; }
  long steps() const { return steps_; }
  bool completed() const { return completed_; }

 private:
  void compress(Real dp) {
    work_ = 0;
    for (long count = 0; ball_[1] > 0;) {
      const Ball next = after(ball_, dp);
      if (next[1] <= 0) return creep_up_to_rest(dp);
      ball_ = next;
      work_ += dp * std::abs(ball_[1]) * cosine_;
      if (too_many(&count)) return;
    }
  }
  /// Ever shorter steps that do not pass the greatest compression.
  void creep_up_to_rest(Real dp) {
    for (int i = 0; i < 8; ++i) {
      dp /= 2;
      const Ball next = after(ball_, dp);
      if (next[1] <= 0) continue;
      ball_ = next;
      work_ += dp * std::abs(ball_[1]) * cosine_;
    }
  }
  void restore(Real target, Real dp) {
    Real work = 0;
    for (long count = 0; work < target;) {
      if (work + dp * std::abs(ball_[1]) * cosine_ > target) {
        ball_ = after(ball_, (target - work) / (std::abs(ball_[1]) * cosine_));
        return;
      }
      ball_ = after(ball_, dp);
      work += dp * std::abs(ball_[1]) * cosine_;
      if (too_many(&count)) return;
    }
  }
  bool too_many(long* count) {
    ++steps_;
    completed_ = ++*count <= 10 * options_.max_steps;
    return !completed_;
  }

  /// Cosine and sine of the direction of a slip.
  Pair<Real> direction(Real x, Real y) const {
    if (x == 0 && y == 0 && options_.model != Model::kPooltool) return {0, 0};
    const Real angle = positive_angle(y, x);
    return {std::cos(angle), std::sin(angle)};
  }
  static Real positive_angle(Real y, Real x) {
    const Real angle = std::atan2(y, x);
    const Real turn = 2 * static_cast<Real>(3.14159265358979323846264338327950288L);
    return angle < 0 ? angle + turn : angle;
  }

  /// One step of the impulse dp; every friction is that of the state before it. The order of the
  /// operations is pooltool's, for its digits.
  Ball after(const Ball& b, Real dp) const {
    const Real slip_x = b[0] + b[3] * R_ * sine_ - b[4] * R_ * cosine_;
    const Real slip_z = -b[1] * sine_ + b[2] * R_;
    const Pair<Real> c = direction(slip_x, slip_z);
    const Pair<Real> s = direction(b[0] - b[3] * R_, b[1] + b[2] * R_);
    Real press = sine_ + u_w_ * c.y * cosine_;
    if (options_.model == Model::kClamped) press = std::max(press, Real(0));
    const Real pull_x = u_s_ * s.x * press, pull_y = u_s_ * s.y * press;
    const Real mass = 1 / M_, spin = 5 / (2 * M_ * R_);
    return {b[0] - mass * (u_w_ * c.x + pull_x) * dp,
            b[1] - mass * (cosine_ - u_w_ * sine_ * c.y + pull_y) * dp,
            b[2] + -spin * (u_w_ * c.y + pull_y) * dp,
            b[3] + -spin * (u_w_ * c.x * sine_ - pull_x) * dp,
            b[4] + spin * (u_w_ * c.x * cosine_) * dp};
  }

  const Real R_, M_, u_s_, u_w_, e_, sine_, cosine_;
  const FixedSteps options_;
  Ball ball_;
  Real work_ = 0;
  long steps_ = 0;
  bool completed_ = true;
};

/// pooltool turns the ball by an angle, as a product of matrices whose sums are fused. That decides
/// which way a ball that rolls without slip, but for rounding, is pushed first.
template <class Real>
class Turn {
 public:
  explicit Turn(const double normal[2]) {
    const Real pi = static_cast<Real>(3.14159265358979323846264338327950288L);
    Real angle = std::atan2(static_cast<Real>(normal[1]), static_cast<Real>(normal[0]));
    if (angle < 0) angle += 2 * pi;
    turn_ = pi / 2 - angle;
  }
  Pair<Real> in(Pair<Real> a) const { return turned(turn_, a); }
  Pair<Real> out(Pair<Real> a) const { return turned(-turn_, a); }

 private:
  static Pair<Real> turned(Real angle, Pair<Real> a) {
    const Real cosine = std::cos(angle), sine = std::sin(angle);
    return {std::fma(-sine, a.y, cosine * a.x), std::fma(cosine, a.y, sine * a.x)};
  }
  Real turn_;
};

}  // namespace detail

/// One collision in fixed steps. Arguments, units and status as solve_exact_as. Error of the
/// scheme: first order; where M v_y is far below max_steps delta_p it is larger than the speed.
template <class Real>
FixedStepOutcome<Real> solve_fixed_step(const Params& p, FixedSteps options, const double ball[6],
                                        const double normal[2]) {
  detail::Frame<Real> frame;
  Velocities<Real> checked;
  const int status = detail::enter(p, ball, normal, &frame, &checked);
  FixedStepOutcome<Real> result{detail::unchanged<Real>(ball, status), 0, true};
  if (status != kOk) return result;
  const detail::Turn<Real> turn(normal);
  const Pair<Real> v = turn.in({ball[0], ball[1]}), w = turn.in({ball[3], ball[4]});
  detail::FixedStepImpact<Real> impact(p, options, {v.x, v.y, w.x, w.y, Real(ball[5])});
  impact.run();
  const auto& after = impact.ball();
  const Pair<Real> v_out = turn.out({after[0], after[1]}), w_out = turn.out({after[2], after[3]});
  BasicOutcome<Real>& out = result.outcome;
  out.v[0] = v_out.x;
  out.v[1] = v_out.y;
  out.w[0] = w_out.x;
  out.w[1] = w_out.y;
  out.w[2] = after[4];
  result.steps = impact.steps();
  result.completed = impact.completed();
  return result;
}

}  // namespace cushion
}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_BALL_CUSHION_FIXED_STEP_H_
