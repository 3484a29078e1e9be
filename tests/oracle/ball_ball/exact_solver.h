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
#include <stdexcept>
#include <string>
#include <type_traits>

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

/// Rows r = f x u, f and u = (0, 0, 1) of the collision frame; `r` is not normalised, which only
/// matters for a tilted line of centres, where pooltool does the same.
template <class Real>
struct Frame {
  Real r[3], f[3];
};

/// Unknowns: for ball 1 then ball 2 (v_x, v_y, v_z, R w_x, R w_y, R w_z) in the collision frame,
/// then the normal impulse / M2 and the work / M2 of the phase.
enum { kVx, kVy, kVz, kSx, kSy, kSz, kBall };
enum { kImpulse = 2 * kBall, kWork, kUnknowns };

template <class Real>
class Impact {
 public:
  using State = std::array<Real, kUnknowns>;

  Impact(const Params& p, Model model, const State& start) : model_(model), y_(start) {
    inverse_mass_[0] = 1 / static_cast<Real>(p.M1_over_M2);
    inverse_mass_[1] = 1;
    u_b_ = p.u_b;
    e_b_ = p.e_b;
    mu_ = inverse_mass_[0] + inverse_mass_[1];
    start_normal_ = -normal(y_);
    const Real cz = slip_z(y_);
    pressed_ = cz < 0 ? 1 : 0;
    u_s_ = pressed_ == 1 ? p.u_s2 : p.u_s1;
    press_sign_ = cz < 0 ? 1 : -1;
  }

  static Real normal(const State& y) { return y[kBall + kVy] - y[kVy]; }

  /// Runs the collision to its end; velocities must be scaled to order one.
  void run() {
    while (!done_) {
      if (u_b_ == 0 || slip_is_gone()) {
        finish_without_friction();
      } else if (slip_z(y_) == 0) {
        finish_without_pressing();
      } else if (table_slip_is_gone()) {
        leap();
      } else {
        taylor_step();
      }
    }
  }

  const State& state() const { return y_; }
  bool sticks() const { return sticks_; }
  bool gave_up() const { return gave_up_; }
  int steps() const { return steps_; }

 private:
  // Half the digits wanted, in nepers, minimises work per distance: step = radius / e^2.
  static constexpr int kOrder = sizeof(Real) > 8 && epsilon<Real>() < Real(1e-25) ? 40 : 24;
  static constexpr int kMaxSteps = 4000;
  using Series = std::array<Real, kOrder + 1>;

  Real slip_x(const State& y) const { return y[kVx] - y[kBall + kVx] - y[kSz] - y[kBall + kSz]; }
  Real slip_z(const State& y) const {
    const Real rolling = y[kSx] + y[kBall + kSx];
    return model_.lift ? rolling + y[kVz] - y[kBall + kVz] : rolling;
  }
  Real table_sign() const { return model_.top_slip ? Real(1) : Real(-1); }
  Real table_slip_x(const State& y) const {
    const int b = pressed_ * kBall;
    return y[b + kVx] + table_sign() * y[b + kSy];
  }
  Real table_slip_y(const State& y) const {
    const int b = pressed_ * kBall;
    return y[b + kVy] - table_sign() * y[b + kSx];
  }
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
  bool table_slip_is_gone() const { return u_s_ != 0 && table_slip_size() <= 64 * epsilon<Real>(); }

  /// Change of the velocities for contact impulses (dp, dp1, dp2) and a table impulse (tx, ty) on
  /// the pressed ball, all divided by M2.
  void add_impulse(Real dp, Real dp1, Real dp2, Real tx, Real ty, State* change) const {
    for (int ball = 0; ball < 2; ++ball) {
      const Real side = ball == 0 ? 1 : -1;
      const Real im = inverse_mass_[ball];
      const Real spin = im * 5 / 2;
      const bool pressed = ball == pressed_;
      const Real table_x = pressed ? tx : Real(0), table_y = pressed ? ty : Real(0);
      Real* d = change->data() + ball * kBall;
      d[kVx] += im * (side * dp1 + table_x);
      d[kVy] += im * (table_y - side * dp);
      if (model_.lift && !pressed) d[kVz] += im * absolute(dp2);
      d[kSx] += spin * (dp2 + table_y);
      d[kSy] -= spin * table_x;
      d[kSz] -= spin * dp1;
    }
    (*change)[kImpulse] += dp;
  }

  void work_through(Real dp, const State& before) {
    y_[kWork] += dp * absolute(normal(before) + normal(y_)) / 2;
  }

  void end_compression() {
    restitution_ = true;
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
    sticks_ = u_b_ != 0 || slip_size() == 0;
    const Real dp = rest_of_impulse();
    Real dp1 = 0, dp2 = 0;
    if (u_b_ != 0) remove_slip(&dp1, &dp2);
    add_impulse(dp, dp1, dp2, 0, 0, &y_);
    done_ = true;
  }

  // What is left of the slip is small but known: take it away rather than leave it as an error.
  void remove_slip(Real* dp1, Real* dp2) const {
    const Real lifted = model_.lift ? inverse_mass_[1 - pressed_] : Real(0);
    *dp1 = -slip_x(y_) / (mu_ * 7 / 2);
    *dp2 = -slip_z(y_) / (mu_ * 5 / 2 + lifted);
  }

  void finish_without_pressing() {
    const Real c = slip_x(y_);
    const Real dp = rest_of_impulse();
    const Real to_stick = absolute(c) / (mu_ * 7 / 2);
    sticks_ = u_b_ * dp >= to_stick;
    const Real size = sticks_ ? to_stick : u_b_ * dp;
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
    const Real d1 = -u_b_ * slip_x(y_) / c, d2 = -u_b_ * slip_z(y_) / c;
    Real ax, ay;
    table_drive(d1, d2, &ax, &ay);
    const Real a = square_root(ax * ax + ay * ay);
    const Real smooth = std::min(c / (u_b_ + 1), absolute(normal(y_)));
    Real dp = square_root(epsilon<Real>()) * smooth / 100;
    dp = std::max(dp, 256 * epsilon<Real>() / a);
    const Real pull = -u_s_ * absolute(d2) * dp / a;
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

  static Real product(const Series& a, const Series& b, int n) {
    Real sum = 0;
    for (int k = 0; k <= n; ++k) sum += a[k] * b[n - k];
    return sum;
  }
  static Real square(const Series& a, int n) {
    Real sum = 0;
    for (int k = 0; 2 * k < n; ++k) sum += a[k] * a[n - k];
    sum += sum;
    return n % 2 == 0 ? sum + a[n / 2] * a[n / 2] : sum;
  }
  /// Coefficient n of the root of a series whose coefficient n is `radicand`.
  static Real root(const Series& r, Real radicand, int n) {
    if (n == 0) return square_root(radicand);
    Real sum = 0;
    for (int k = 1; k < n; ++k) sum += r[k] * r[n - k];
    return (radicand - sum) / (2 * r[0]);
  }
  static Real reciprocal(const Series& d, const Series& inverse, int n) {
    if (n == 0) return 1 / d[0];
    Real sum = 0;
    for (int k = 1; k <= n; ++k) sum += d[k] * inverse[n - k];
    return -sum * inverse[0];
  }

  /// Series in the time t with dP/dt = |c||s| / (k1 |s| + k2 |c|): in it both vanishing slips are
  /// exponentials, and everything is a product of series.
  struct Expansion {
    std::array<State, kOrder + 1> y;
    Series cx, cz, press, c, sx, sy, s, speed, denominator, inverse, over, dp, pull;
  };

  void slips(int n) {
    Expansion& e = expansion_;
    const Real vn = normal(e.y[n]);
    e.cx[n] = slip_x(e.y[n]);
    e.cz[n] = slip_z(e.y[n]);
    e.press[n] = -press_sign_ * e.cz[n];
    e.sx[n] = table_slip_x(e.y[n]);
    e.sy[n] = table_slip_y(e.y[n]);
    e.speed[n] = restitution_ ? vn : -vn;
    e.c[n] = root(e.c, square(e.cx, n) + square(e.cz, n), n);
    if (u_s_ == 0) {
      e.s[n] = n == 0 ? 1 : 0;
    } else {
      e.s[n] = root(e.s, square(e.sx, n) + square(e.sy, n), n);
    }
  }

  void rates(int n, State* rate) {
    Expansion& e = expansion_;
    const Real k1 = 3 * mu_ * u_b_, k2 = u_s_ == 0 ? Real(0) : inverse_mass_[pressed_];
    e.denominator[n] = k1 * e.s[n] + k2 * e.c[n];
    e.inverse[n] = reciprocal(e.denominator, e.inverse, n);
    e.over[n] = product(e.s, e.inverse, n);
    e.dp[n] = product(e.c, e.over, n);
    const Real dp1 = -u_b_ * product(e.cx, e.over, n);
    const Real dp2 = u_b_ * press_sign_ * product(e.press, e.over, n);
    Real tx = 0, ty = 0;
    if (u_s_ != 0) {
      e.pull[n] = product(e.press, e.inverse, n);
      tx = -u_s_ * u_b_ * product(e.pull, e.sx, n);
      ty = -u_s_ * u_b_ * product(e.pull, e.sy, n);
    }
    add_impulse_series(e.dp[n], dp1, dp2, tx, ty, rate);
    (*rate)[kWork] = product(e.speed, e.dp, n);
  }

  // As add_impulse, but a coefficient of dp2 may have either sign: what lifts is the whole series.
  void add_impulse_series(Real dp, Real dp1, Real dp2, Real tx, Real ty, State* rate) const {
    add_impulse(dp, dp1, dp2, tx, ty, rate);
    if (!model_.lift) return;
    const int lifted = 1 - pressed_;
    (*rate)[lifted * kBall + kVz] = inverse_mass_[lifted] * press_sign_ * dp2;
  }

  void expand() {
    Expansion& e = expansion_;
    e.y[0] = y_;
    for (int n = 0; n < kOrder; ++n) {
      slips(n);
      State rate{};
      rates(n, &rate);
      for (int i = 0; i < kUnknowns; ++i) e.y[n + 1][i] = rate[i] / (n + 1);
    }
  }

  double largest(int n) const {
    Real most = 0;
    const State& y = expansion_.y[n];
    for (int i = 0; i <= kImpulse; ++i) most = std::max(most, absolute(y[i]));
    most = std::max(most, absolute(y[kWork]) / start_normal_);
    return static_cast<double>(most);
  }

  Real step_size() const {
    const double tolerance = static_cast<double>(epsilon<Real>()) / 8;
    double h = 3;  // beyond it the terms of exp(t) cancel too many digits
    for (int n = kOrder - 1; n <= kOrder; ++n) {
      const double a = largest(n);
      if (a > 0) h = std::min(h, std::pow(tolerance / a, 1.0 / n));
    }
    return static_cast<Real>(h);
  }

  Real value(int i, Real t) const {
    Real sum = 0;
    for (int n = kOrder; n >= 0; --n) sum = sum * t + expansion_.y[n][i];
    return sum;
  }
  Real slope(int i, Real t) const {
    Real sum = 0;
    for (int n = kOrder; n >= 1; --n) sum = sum * t + n * expansion_.y[n][i];
    return sum;
  }

  Real event(Real t) const {
    if (restitution_) return value(kWork, t) - target_;
    return value(kBall + kVy, t) - value(kVy, t);
  }
  Real event_slope(Real t) const {
    return restitution_ ? slope(kWork, t) : slope(kBall + kVy, t) - slope(kVy, t);
  }

  /// Root of the increasing function event(t) in (0, high]: Newton, kept inside the bracket.
  Real event_time(Real high) const {
    Real low = 0, t = high;
    for (int i = 0; i < 300 && high - low > epsilon<Real>() * high; ++i) {
      const Real f = event(t);
      if (f == 0) break;
      (f > 0 ? high : low) = t;
      const Real next = t - f / event_slope(t);
      const bool inside = next > low && next < high;
      if (inside && absolute(next - t) <= 2 * epsilon<Real>() * t) return next;
      t = inside ? next : (low + high) / 2;
    }
    return t;
  }

  void taylor_step() {
    expand();
    Real t = step_size();
    const bool reached = event(t) >= 0;
    if (reached) t = event_time(t);
    for (int i = 0; i < kUnknowns; ++i) y_[i] = value(i, t);
    count_step();
    if (!reached) return;
    if (restitution_) {
      done_ = true;
    } else {
      end_compression();
    }
  }

  Model model_;
  State y_;
  Real inverse_mass_[2], mu_, u_b_, u_s_, e_b_, start_normal_, press_sign_;
  Real target_ = 0;
  int pressed_, steps_ = 0;
  bool restitution_ = false, done_ = false, sticks_ = false, gave_up_ = false;
  Expansion expansion_;
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
  using Impact = detail::Impact<Real>;
  const auto as_they_came = [&](int status) {
    return detail::unchanged<Real>(ball1, ball2, status);
  };
  const bool as_pooltool = model.top_slip && !model.lift;
  if (!detail::all_finite(ball1, 9) || !detail::all_finite(ball2, 9) || !detail::valid(p)) {
    return as_they_came(kBadInput);
  }
  detail::Frame<Real> frame;
  const int status = detail::make_frame(ball1, ball2, as_pooltool, &frame);
  if (status != kOk) return as_they_came(status);

  typename Impact::State start{};
  const Real R = p.R;
  detail::to_frame(frame, ball1, R, start.data());
  detail::to_frame(frame, ball2, R, start.data() + detail::kBall);
  if (Impact::normal(start) >= 0) return as_they_came(kSeparating);
  const Real scale = detail::velocity_scale<Real>(start);
  for (Real& x : start) x /= scale;

  Impact impact(p, model, start);
  impact.run();
  typename Impact::State end = impact.state();
  for (Real& x : end) x *= scale;
  BasicOutcome<Real> out{};
  detail::from_frame(frame, end.data(), R, out.v1, out.w1);
  detail::from_frame(frame, end.data() + detail::kBall, R, out.v2, out.w2);
  out.status = kOk;
  out.sticks = impact.sticks();
  out.error_estimate = impact.gave_up() ? std::numeric_limits<double>::infinity()
                                        : static_cast<double>(scale * detail::epsilon<Real>()) *
                                              (8 + 2 * impact.steps());
  return out;
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
