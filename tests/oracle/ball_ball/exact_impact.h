// One collision of two balls in the frame of the contact, from its start to its end.
#ifndef CAROM_TESTS_ORACLE_EXACT_IMPACT_H_
#define CAROM_TESTS_ORACLE_EXACT_IMPACT_H_

#include <algorithm>
#include <array>
#include <cmath>

#include "expansion.h"
#include "params.h"

namespace carom_oracle {

namespace detail {

template <class Real>
class Impact {
 public:
  using State = std::array<Real, kUnknowns>;
  // Half the digits wanted, in nepers, minimises work per distance: step = radius / e^2.
  static constexpr int kOrder = sizeof(Real) > 8 && epsilon<Real>() < Real(1e-25) ? 40 : 24;

  Impact(const Params& p, Model model, const State& start) : y_(start) {
    of_.model = model;
    of_.inverse_mass[0] = 1 / static_cast<Real>(p.M1_over_M2);
    of_.inverse_mass[1] = 1;
    of_.u_b = p.u_b;
    e_b_ = p.e_b;
    mu_ = of_.inverse_mass[0] + of_.inverse_mass[1];
    start_normal_ = -normal(y_);
    const Real cz = slip_z(y_);
    of_.pressed = cz < 0 ? 1 : 0;
    of_.u_s = of_.pressed == 1 ? p.u_s2 : p.u_s1;
    of_.press_sign = cz < 0 ? 1 : -1;
    of_.table = of_.u_s == 0 ? 0 : 1;
    of_.pace[0] = 3 * mu_ * of_.u_b;
    of_.pace[1] = of_.u_s == 0 ? Real(0) : of_.inverse_mass[of_.pressed];
    of_.forward = -1;
  }

  static Real normal(const State& y) { return normal_of(y); }

  /// Runs the collision to its end; velocities must be scaled to order one.
  void run() {
    Expansion<Real, kOrder> expansion;
    while (needs_series()) {
      expansion.expand(of_, y_);
      step_along([&](int n, int i) { return expansion.y[n][i]; });
    }
  }

  /// Goes on as far as no series is needed. Is one needed then, or is the collision over?
  bool needs_series() {
    while (!done_) {
      if (of_.u_b == 0 || slip_is_gone()) {
        finish_without_friction();
      } else if (slip_z(y_) == 0) {
        finish_without_pressing();
      } else if (table_slip_is_gone()) {
        leap();
      } else {
        return true;
      }
    }
    return false;
  }

  /// Goes on along the series that begin here; at(n, i): coefficient n of unknown i.
  template <class At>
  void step_along(const At& at) {
    Real t = step_size(at);
    const bool reached = event(at, t) >= 0;
    if (reached) t = event_time(at, t);
    for (int i = 0; i < kUnknowns; ++i) y_[i] = value(at, i, t);
    count_step();
    if (!reached) return;
    if (restitution_) {
      done_ = true;
    } else {
      end_compression();
    }
  }

  const Equations<Real>& equations() const { return of_; }
  const State& state() const { return y_; }
  bool sticks() const { return sticks_; }
  bool gave_up() const { return gave_up_; }
  int steps() const { return steps_; }

 private:
  static constexpr int kMaxSteps = 4000;

  static Real slip_x(const State& y) { return slip_x_of(y); }
  Real slip_z(const State& y) const { return slip_z_of(of_.model, y); }
  Real table_slip_x(const State& y) const { return table_slip_x_of(of_.model, of_.pressed, y); }
  Real table_slip_y(const State& y) const { return table_slip_y_of(of_.model, of_.pressed, y); }
  Real slip_size() const {
    const Real x = slip_x(y_), z = slip_z(y_);
    return square_root(x * x + z * z);
  }
  Real table_slip_size() const {
    const Real x = table_slip_x(y_), y = table_slip_y(y_);
    return square_root(x * x + y * y);
  }

  // Below these sizes the slips, being differences of numbers of order one, are rounding only.
  bool slip_is_gone() const { return slip_size() <= 16 * epsilon<Real>(); }
  bool table_slip_is_gone() const {
    return of_.u_s != 0 && table_slip_size() <= 64 * epsilon<Real>();
  }

  void add_impulse(Real dp, Real dp1, Real dp2, Real tx, Real ty, State* change) const {
    add_level_impulse(of_, dp, dp1, dp2, tx, ty, change);
    if (!of_.model.lift) return;
    const int lifted = 1 - of_.pressed;
    (*change)[lifted * kBall + kVz] += of_.inverse_mass[lifted] * absolute(dp2);
  }

  void work_through(Real dp, const State& before) {
    y_[kWork] += dp * absolute(normal(before) + normal(y_)) / 2;
  }

  void end_compression() {
    restitution_ = true;
    of_.forward = 1;
    target_ = e_b_ * e_b_ * y_[kWork];
    y_[kWork] = 0;
    if (e_b_ == 0) done_ = true;
  }

  /// Impulse until the end of the collision when v_n grows at the constant rate mu_.
  Real rest_of_impulse() const {
    const Real vn = normal(y_);
    if (restitution_) {
      return (square_root(vn * vn + 2 * mu_ * (target_ - y_[kWork])) - vn) / mu_;
    }
    return (e_b_ * square_root(vn * vn + 2 * mu_ * y_[kWork]) - vn) / mu_;
  }

  void finish_without_friction() {
    sticks_ = of_.u_b != 0 || slip_size() == 0;
    const Real dp = rest_of_impulse();
    Real dp1 = 0, dp2 = 0;
    if (of_.u_b != 0) remove_slip(&dp1, &dp2);
    add_impulse(dp, dp1, dp2, 0, 0, &y_);
    done_ = true;
  }

  // What is left of the slip is small but known: take it away rather than leave it as an error.
  void remove_slip(Real* dp1, Real* dp2) const {
    const Real lifted = of_.model.lift ? of_.inverse_mass[1 - of_.pressed] : Real(0);
    *dp1 = -slip_x(y_) / (mu_ * 7 / 2);
    *dp2 = -slip_z(y_) / (mu_ * 5 / 2 + lifted);
  }

  void finish_without_pressing() {
    const Real c = slip_x(y_);
    const Real dp = rest_of_impulse();
    const Real to_stick = absolute(c) / (mu_ * 7 / 2);
    sticks_ = of_.u_b * dp >= to_stick;
    const Real size = sticks_ ? to_stick : of_.u_b * dp;
    add_impulse(dp, c > 0 ? -size : size, 0, 0, 0, &y_);
    done_ = true;
  }

  /// Table slip per unit impulse as the contact alone drives it.
  void table_drive(Real d1, Real d2, Real* ax, Real* ay) const {
    State rate{};
    add_impulse(1, d1, d2, 0, 0, &rate);
    *ax = table_slip_x(rate);
    *ay = table_slip_y(rate);
  }

  // Table slip zero (a resting ball, or a slip that passes through zero): it leaves along the
  // direction that the contact drives it in. A step so short that the error of holding every
  // direction fixed, its square, is below rounding.
  void leap() {
    const Real c = slip_size();
    const Real d1 = -of_.u_b * slip_x(y_) / c, d2 = -of_.u_b * slip_z(y_) / c;
    Real ax, ay;
    table_drive(d1, d2, &ax, &ay);
    const Real a = square_root(ax * ax + ay * ay);
    const Real smooth = std::min(c / (of_.u_b + 1), absolute(normal(y_)));
    Real dp = square_root(epsilon<Real>()) * smooth / 100;
    dp = std::max(dp, 256 * epsilon<Real>() / a);
    const Real pull = -of_.u_s * absolute(d2) * dp / a;
    const State before = y_;
    add_impulse(dp, d1 * dp, d2 * dp, pull * ax, pull * ay, &y_);
    work_through(dp, before);
    count_step();
    if (!restitution_ && normal(y_) >= 0) end_compression();
    if (restitution_ && y_[kWork] >= target_) done_ = true;
  }

  void count_step() {
    if (++steps_ < kMaxSteps) return;
    gave_up_ = true;
    done_ = true;
  }

  template <class At>
  double largest(const At& at, int n) const {
    Real most = 0;
    for (int i = 0; i <= kImpulse; ++i) most = std::max(most, absolute(at(n, i)));
    most = std::max(most, absolute(at(n, kWork)) / start_normal_);
    return static_cast<double>(most);
  }

  template <class At>
  Real step_size(const At& at) const {
    const double tolerance = static_cast<double>(epsilon<Real>()) / 8;
    double h = 3;  // beyond it the terms of exp(t) cancel too many digits
    for (int n = kOrder - 1; n <= kOrder; ++n) {
      const double a = largest(at, n);
      if (a > 0) h = std::min(h, std::pow(tolerance / a, 1.0 / n));
    }
    return static_cast<Real>(h);
  }

  template <class At>
  static Real value(const At& at, int i, Real t) {
    Real sum = 0;
    for (int n = kOrder; n >= 0; --n) sum = sum * t + at(n, i);
    return sum;
  }
  template <class At>
  static Real slope(const At& at, int i, Real t) {
    Real sum = 0;
    for (int n = kOrder; n >= 1; --n) sum = sum * t + n * at(n, i);
    return sum;
  }

  template <class At>
  Real event(const At& at, Real t) const {
    if (restitution_) return value(at, kWork, t) - target_;
    return value(at, kBall + kVy, t) - value(at, kVy, t);
  }
  template <class At>
  Real event_slope(const At& at, Real t) const {
    return restitution_ ? slope(at, kWork, t) : slope(at, kBall + kVy, t) - slope(at, kVy, t);
  }

  /// Root of the increasing function event(t) in (0, high]: Newton, kept inside the bracket.
  template <class At>
  Real event_time(const At& at, Real high) const {
    Real low = 0, t = high;
    for (int i = 0; i < 300 && high - low > epsilon<Real>() * high; ++i) {
      const Real f = event(at, t);
      if (f == 0) break;
      (f > 0 ? high : low) = t;
      const Real next = t - f / event_slope(at, t);
      const bool inside = next > low && next < high;
      if (inside && absolute(next - t) <= 2 * epsilon<Real>() * t) return next;
      t = inside ? next : (low + high) / 2;
    }
    return t;
  }

  Equations<Real> of_;
  State y_;
  Real mu_, e_b_, start_normal_;
  Real target_ = 0;
  int steps_ = 0;
  bool restitution_ = false, done_ = false, sticks_ = false, gave_up_ = false;
};

}  // namespace detail

}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_EXACT_IMPACT_H_
