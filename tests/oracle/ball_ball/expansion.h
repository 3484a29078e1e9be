// The equations of a collision of two balls as series, in one number type or in lanes of it.
#ifndef CAROM_TESTS_ORACLE_EXPANSION_H_
#define CAROM_TESTS_ORACLE_EXPANSION_H_

#include <array>

#include "params.h"

namespace carom_oracle {

namespace detail {

/// Unknowns: for ball 1 then ball 2 (v_x, v_y, v_z, R w_x, R w_y, R w_z) in the collision frame,
/// then the normal impulse / M2 and the work / M2 of the phase.
enum { kVx, kVy, kVz, kSx, kSy, kSz, kBall };
enum { kImpulse = 2 * kBall, kWork, kUnknowns };

/// A collision's equations: what an expansion needs besides where it starts. N is a number, or a
/// number for each of several collisions (exact_lanes.h), which then press the same ball.
template <class N>
struct Equations {
  Model model;
  int pressed;  // 0 or 1: the ball that is pressed onto the table
  N inverse_mass[2];
  N u_b, u_s;
  N press_sign;  // of dp2
  N table;       // 0 without table friction, else 1
  N pace[2];     // k1 and k2 of Expansion
  N forward;     // 1 in restitution, -1 in compression
};

template <class N>
N normal_of(const std::array<N, kUnknowns>& y) {
  return y[kBall + kVy] - y[kVy];
}
template <class N>
N slip_x_of(const std::array<N, kUnknowns>& y) {
  return y[kVx] - y[kBall + kVx] - y[kSz] - y[kBall + kSz];
}
template <class N>
N slip_z_of(Model model, const std::array<N, kUnknowns>& y) {
  const N rolling = y[kSx] + y[kBall + kSx];
  return model.lift ? rolling + y[kVz] - y[kBall + kVz] : rolling;
}
template <class N>
N table_slip_x_of(Model model, int pressed, const std::array<N, kUnknowns>& y) {
  const int b = pressed * kBall;
  return model.top_slip ? y[b + kVx] + y[b + kSy] : y[b + kVx] - y[b + kSy];
}
template <class N>
N table_slip_y_of(Model model, int pressed, const std::array<N, kUnknowns>& y) {
  const int b = pressed * kBall;
  return model.top_slip ? y[b + kVy] - y[b + kSx] : y[b + kVy] + y[b + kSx];
}

/// Change of the velocities but those that lift, for contact impulses (dp, dp1, dp2) and a table
/// impulse (tx, ty) on the pressed ball, all divided by M2.
template <class N>
void add_level_impulse(const Equations<N>& of, const N& dp, const N& dp1, const N& dp2, const N& tx,
                       const N& ty, std::array<N, kUnknowns>* change) {
  for (int ball = 0; ball < 2; ++ball) {
    const N im = of.inverse_mass[ball];
    const N spin = im * 2.5;
    const bool pressed = ball == of.pressed;
    const N table_x = pressed ? tx : N(), table_y = pressed ? ty : N();
    N* d = change->data() + ball * kBall;
    d[kVx] += im * ((ball == 0 ? dp1 : -dp1) + table_x);
    d[kVy] += im * (table_y - (ball == 0 ? dp : -dp));
    d[kSx] += spin * (dp2 + table_y);
    d[kSy] -= spin * table_x;
    d[kSz] -= spin * dp1;
  }
  (*change)[kImpulse] += dp;
}

template <class N>
N quotient(const N& a, int n) {
  return a / n;
}

/// Series in the time t with dP/dt = |c||s| / (k1 |s| + k2 |c|): in it both vanishing slips are
/// exponentials, and everything is a product of series.
template <class N, int kOrder>
struct Expansion {
  using State = std::array<N, kUnknowns>;
  using Series = std::array<N, kOrder + 1>;

  std::array<State, kOrder + 1> y;  // coefficients of the unknowns
  Series cx, cz, press, c, sx, sy, s, speed, denominator, inverse, over, dp, pull;

  void expand(const Equations<N>& of, const State& start) {
    y[0] = start;
    for (int n = 0; n < kOrder; ++n) {
      slips(of, n);
      State rate{};
      rates(of, n, &rate);
      for (int i = 0; i < kUnknowns; ++i) y[n + 1][i] = quotient(rate[i], n + 1);
    }
  }

 private:
  static N product(const Series& a, const Series& b, int n) {
    N sum{};
    for (int k = 0; k <= n; ++k) sum += a[k] * b[n - k];
    return sum;
  }
  static N square(const Series& a, int n) {
    N sum{};
    for (int k = 0; 2 * k < n; ++k) sum += a[k] * a[n - k];
    sum += sum;
    return n % 2 == 0 ? sum + a[n / 2] * a[n / 2] : sum;
  }
  /// Coefficient n of the root of a series whose coefficient n is `radicand`.
  static N root(const Series& r, const N& radicand, int n) {
    if (n == 0) return square_root(radicand);
    N sum{};
    for (int k = 1; k < n; ++k) sum += r[k] * r[n - k];
    return (radicand - sum) / (r[0] + r[0]);
  }
  static N reciprocal(const Series& d, const Series& inverse, int n) {
    if (n == 0) return 1 / d[0];
    N sum{};
    for (int k = 1; k <= n; ++k) sum += d[k] * inverse[n - k];
    return -sum * inverse[0];
  }

  void slips(const Equations<N>& of, int n) {
    const State& now = y[n];
    const N vn = normal_of(now);
    cx[n] = slip_x_of(now);
    cz[n] = slip_z_of(of.model, now);
    press[n] = -of.press_sign * cz[n];
    sx[n] = table_slip_x_of(of.model, of.pressed, now);
    sy[n] = table_slip_y_of(of.model, of.pressed, now);
    speed[n] = of.forward * vn;
    c[n] = root(c, square(cx, n) + square(cz, n), n);
    const N table_square = of.table * (square(sx, n) + square(sy, n));
    s[n] = root(s, n == 0 ? table_square + (1 - of.table) : table_square, n);
  }

  void rates(const Equations<N>& of, int n, State* rate) {
    denominator[n] = of.pace[0] * s[n] + of.pace[1] * c[n];
    inverse[n] = reciprocal(denominator, inverse, n);
    over[n] = product(s, inverse, n);
    dp[n] = product(c, over, n);
    pull[n] = product(press, inverse, n);
    const N dp1 = -of.u_b * product(cx, over, n);
    const N dp2 = of.u_b * of.press_sign * product(press, over, n);
    const N tx = -of.u_s * of.u_b * product(pull, sx, n);
    const N ty = -of.u_s * of.u_b * product(pull, sy, n);
    add_level_impulse(of, dp[n], dp1, dp2, tx, ty, rate);
    if (of.model.lift) {  // a coefficient of dp2 may have either sign: what lifts is the series
      const int lifted = 1 - of.pressed;
      (*rate)[lifted * kBall + kVz] = of.inverse_mass[lifted] * of.press_sign * dp2;
    }
    (*rate)[kWork] = product(speed, dp, n);
  }
};

}  // namespace detail

}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_EXPANSION_H_
