// The motion during an impact as power series, for any state of the two contacts.
#ifndef CAROM_TESTS_ORACLE_BALL_CUSHION_EXPANSION_H_
#define CAROM_TESTS_ORACLE_BALL_CUSHION_EXPANSION_H_

#include <algorithm>
#include <cmath>

#include "contacts.h"
#include "power_series.h"

namespace carom_oracle {
namespace cushion {

/// What a contact does. kLeaves: it stuck until now and its slip, still zero, begins to grow.
enum class Contact { kNoFriction, kSlips, kSticks, kLeaves };

/// Unknowns beside the velocities: normal impulse / M, and the work / M of the phase.
enum { kImpulse = kVelocities, kWork, kUnknowns };
template <class Real>
using State = std::array<Real, kUnknowns>;

template <class Real>
Velocities<Real> velocities(const State<Real>& y) {
  Velocities<Real> v;
  std::copy_n(y.begin(), static_cast<int>(kVelocities), v.begin());
  return v;
}

/// Friction at the cushion and at the table, for one unit of the cushion's push.
template <class Real>
struct Frictions {
  Pair<Real> cushion, table;
};

/// What the contacts do from here on. `leaving`: direction of the slip of one that leaves.
template <class Real>
struct Mode {
  Contact cushion, table;
  bool restitution = false;
  Pair<Real> leaving{0, 0};
};

template <class Real>
class Expansion {
 public:
  static constexpr int kOrder = sizeof(Real) > 8 && epsilon<Real>() < Real(1e-25) ? 40 : 24;
  using Series = PowerSeries<Real, kOrder>;

  Expansion(const Contacts<Real>& contacts, Real u_w, Real u_s)
      : ball_(contacts),
        u_w_(u_w),
        u_s_(u_s),
        along_(contacts.cushion_slip(contacts.along).x),
        rising_(contacts.cushion_slip(contacts.rising).y),
        crossed_(contacts.table_slip(contacts.along).x),
        pressed_(contacts.table_slip(contacts.rising).y),
        table_(contacts.table_slip(contacts.table_x).x),
        pace_cushion_(3 * u_w + contacts.sine * contacts.cosine),
        pace_table_(contacts.cosine + 3 * u_w) {}

  /// Friction that keeps the cushion's slip at zero while the table slips along e; e = 0: no
  /// friction there.
  Frictions<Real> sticking_cushion(Pair<Real> e) const {
    const Real press = held_press() / (rising_ + u_s_ * pressed_ * ball_.cosine * e.y);
    const Pair<Real> t = (-u_s_ * press) * e;
    return {{-crossed_ * t.x / along_, (ball_.sine - press) / ball_.cosine}, t};
  }
  /// Friction that keeps the table's slip at zero, for d at the cushion.
  Pair<Real> sticking_table(Pair<Real> d) const { return (-1 / table_) * table_drive(d); }
  /// Change of the table's slip but for what friction there does.
  Pair<Real> table_drive(Pair<Real> d) const {
    return {crossed_ * d.x, -ball_.cosine + pressed_ * d.y};
  }
  Velocities<Real> rate(const Frictions<Real>& f) const { return change(1, f); }
  /// Change of the velocities for impulses: the cushion's push and friction.
  Velocities<Real> change(Real push, const Frictions<Real>& f) const {
    Velocities<Real> r;
    for (int i = 0; i < kVelocities; ++i) {
      r[i] = push * ball_.push[i] + f.cushion.x * ball_.along[i] + f.cushion.y * ball_.rising[i] +
             f.table.x * ball_.table_x[i] + f.table.y * ball_.table_y[i];
    }
    return r;
  }

  /// From `start`. The variable is a regularised time in which a vanishing slip is an exponential,
  /// or the impulse where a contact leaves: then the slip's direction is a series of its own, which
  /// need not converge, as a stiff equation's slow solution is asymptotic.
  void expand(const State<Real>& start, const Mode<Real>& mode) {
    cushion_ = mode.cushion;
    table_state_ = mode.table;
    y[0] = start;
    leaves_ = cushion_ == Contact::kLeaves || table_state_ == Contact::kLeaves;
    leaver_ = cushion_ == Contact::kLeaves ? &c_ : &s_;
    sign_ = mode.restitution ? -1 : 1;
    if (leaves_) leave_along(mode.leaving);
    for (int n = 0; n < kOrder; ++n) {
      slips(n);
      if (leaves_) {
        turn(n);
      } else {
        forces(n);
      }
      advance(n);
    }
  }

  State<Real> at(Real t) const {
    State<Real> sum{};
    for (int n = kOrder; n >= 0; --n) {
      for (int i = 0; i < kUnknowns; ++i) sum[i] = sum[i] * t + y[n][i];
    }
    return sum;
  }
  Series of(int unknown) const {
    Series a;
    for (int n = 0; n <= kOrder; ++n) a[n] = y[n][unknown];
    return a;
  }
  /// How hard the table presses; and how far friction at a contact that sticks is from its cone.
  Series press() const { return lacking_last(press_); }
  Series cushion_reserve() const {
    Series left{};
    for (int n = 0; n < kOrder; ++n) left[n] = -square(d_.x, n) - square(d_.y, n);
    left[0] += u_w_ * u_w_;
    return left;
  }
  Series table_reserve() const {
    Series left{};
    for (int n = 0; n < kOrder; ++n) {
      left[n] = u_s_ * u_s_ * square(press_, n) - square(t_.x, n) - square(t_.y, n);
    }
    return left;
  }
  /// Slip of a contact that leaves, and the second derivative that it begins with.
  Series leaving_slip() const { return leaver_->size; }

  /// A step whose terms of the highest orders are below `tolerance`, at most `most`.
  Real step(double speed, double tolerance, double most) const {
    double h = most;
    for (int n = kOrder - 1; n <= kOrder; ++n) {
      double term = static_cast<double>(absolute(y[n][kWork])) / speed;
      for (int i = 0; i <= kImpulse; ++i) {
        term = std::max(term, static_cast<double>(absolute(y[n][i])));
      }
      if (term > 0) h = std::min(h, std::pow(tolerance / term, 1.0 / n));
    }
    return static_cast<Real>(h);
  }

 private:
  struct PairSeries {
    Series x, y;
    Pair<Real> operator[](int n) const { return {x[n], y[n]}; }
    void set(int n, Pair<Real> a) {
      x[n] = a.x;
      y[n] = a.y;
    }
  };
  struct Slip {
    PairSeries vector, unit;
    Series size, inverse;
  };

  Real held_press() const {
    const Real lift = ball_.cushion_slip(ball_.push).y;
    return ball_.sine * rising_ + ball_.cosine * lift;
  }
  static Real only(Real a, int n) { return n == 0 ? a : Real(0); }
  static Series lacking_last(Series a) {
    a[kOrder] = 0;
    return a;
  }
  bool cushion_pulls() const { return cushion_ == Contact::kSlips || cushion_ == Contact::kLeaves; }
  bool table_pulls() const {
    return table_state_ == Contact::kSlips || table_state_ == Contact::kLeaves;
  }

  static void slip(int n, Pair<Real> value, Slip* s) {
    s->vector.set(n, value);
    s->size[n] = root(s->size, square(s->vector.x, n) + square(s->vector.y, n), n);
    s->inverse[n] = reciprocal(s->size, s->inverse, n);
    s->unit.set(n, {product(s->vector.x, s->inverse, n), product(s->vector.y, s->inverse, n)});
  }
  void slips(int n) {
    const Velocities<Real> v = velocities(y[n]);
    if (cushion_ == Contact::kSlips) slip(n, ball_.cushion_slip(v), &c_);
    if (table_state_ == Contact::kSlips) slip(n, ball_.table_slip(v), &s_);
  }

  void forces(int n) {
    Pair<Real> d{0, 0}, t{0, 0};
    if (cushion_pulls()) d = -u_w_ * c_.unit[n];
    if (cushion_ == Contact::kSticks) {
      const Real e_y = table_pulls() ? s_.unit.y[n] : Real(0);
      divisor_[n] = only(rising_, n) + u_s_ * pressed_ * ball_.cosine * e_y;
      inverse_[n] = reciprocal(divisor_, inverse_, n);
      press_[n] = held_press() * inverse_[n];
      d.y = (only(ball_.sine, n) - press_[n]) / ball_.cosine;
    } else {
      press_[n] = only(ball_.sine, n) - ball_.cosine * d.y;
    }
    if (table_pulls()) {
      t = {-u_s_ * product(press_, s_.unit.x, n), -u_s_ * product(press_, s_.unit.y, n)};
    }
    if (cushion_ == Contact::kSticks) d.x = -crossed_ * t.x / along_;
    if (table_state_ == Contact::kSticks) {
      t = {-crossed_ * d.x / table_, (only(ball_.cosine, n) - pressed_ * d.y) / table_};
    }
    d_.set(n, d);
    t_.set(n, t);
  }

  void leave_along(Pair<Real> unit) {
    leaver_->unit.set(0, unit);
    angle_ = Series{};
    leaver_->size = Series{};
  }
  /// Coefficient n of the unit vector, from its angle.
  void unit_from_angle(int n) {
    if (n == 0) return;
    Pair<Real> sum{0, 0};
    for (int j = 1; j <= n; ++j) {
      const Pair<Real> u = leaver_->unit[n - j];
      sum = sum + (j * angle_[j]) * Pair<Real>{-u.y, u.x};
    }
    leaver_->unit.set(n, (Real(1) / n) * sum);
  }
  /// Rate of the leaving slip, coefficient n, along its direction and across it.
  Pair<Real> leaving_rate(int n) {
    unit_from_angle(n);
    forces(n);
    const Velocities<Real> r = change(only(1, n), {d_[n], t_[n]});
    drive_.set(n, leaver_ == &c_ ? ball_.cushion_slip(r) : ball_.table_slip(r));
    if (n == 0) drive_.set(0, {0, 0});  // it is where the slip may just stay zero
    const PairSeries& u = leaver_->unit;
    return {product(u.x, drive_.x, n) + product(u.y, drive_.y, n),
            product(u.x, drive_.y, n) - product(u.y, drive_.x, n)};
  }
  /// The slip is size(q) along the angle(q): size' and size angle' are given by the forces, which
  /// depend on the angle. As the size begins with q², coefficient n of the angle follows from
  /// lower ones.
  void turn(int n) {
    angle_[n] = 0;
    Pair<Real> rate = leaving_rate(n);
    if (n == 0) slope_ = slope_of_turning();
    if (n > 0) {
      Real known = 0;
      for (int j = 2; j <= n; ++j) known += leaver_->size[j] * (n - j + 1) * angle_[n - j + 1];
      angle_[n] = (known - rate.y) / slope_;
      rate = leaving_rate(n);
    }
    leaver_->size[n + 1] = rate.x / (n + 1);
  }
  /// Change of the turning rate with the angle where the slip leaves.
  Real slope_of_turning() const {
    const Pair<Real> u = leaver_->unit[0], ahead{-u.y, u.x};
    Frictions<Real> f{{0, 0}, {0, 0}};
    if (leaver_ == &c_) {
      f.cushion = -u_w_ * ahead;
      if (table_pulls()) f.table = (u_s_ * ball_.cosine * f.cushion.y) * s_.unit[0];
    } else {
      f.table = (-u_s_ * press_[0]) * ahead;
    }
    const Velocities<Real> r = change(0, f);
    return dot(ahead, leaver_ == &c_ ? ball_.cushion_slip(r) : ball_.table_slip(r));
  }

  /// Impulse for a unit of the variable.
  Real pace(int n) {
    if (leaves_) return only(1, n);
    const bool c = cushion_ == Contact::kSlips, s = table_state_ == Contact::kSlips;
    if (!c && !s) return only(1, n);
    if (!s) return c_.size[n] / pace_cushion_;
    if (!c) return s_.size[n] / pace_table_;
    divisor_[n] = pace_cushion_ * s_.size[n] + pace_table_ * c_.size[n];
    inverse_[n] = reciprocal(divisor_, inverse_, n);
    both_[n] = product(c_.size, s_.size, n);
    return product(both_, inverse_, n);
  }

  void advance(int n) {
    pace_[n] = pace(n);
    speed_[n] = sign_ * y[n][kVy];
    const Frictions<Real> f{{product(d_.x, pace_, n), product(d_.y, pace_, n)},
                            {product(t_.x, pace_, n), product(t_.y, pace_, n)}};
    const Velocities<Real> r = change(pace_[n], f);
    for (int i = 0; i < kVelocities; ++i) y[n + 1][i] = r[i] / (n + 1);
    y[n + 1][kImpulse] = pace_[n] / (n + 1);
    y[n + 1][kWork] = ball_.cosine * product(speed_, pace_, n) / (n + 1);
  }

 public:
  std::array<State<Real>, kOrder + 1> y;

 private:
  const Contacts<Real>& ball_;
  const Real u_w_, u_s_;
  // Change of a slip with friction: the cushion's along and up, the table's with those two, its
  // own.
  const Real along_, rising_, crossed_, pressed_, table_;
  const Real pace_cushion_, pace_table_;
  Contact cushion_ = Contact::kNoFriction, table_state_ = Contact::kNoFriction;
  bool leaves_ = false;
  Slip c_, s_;
  Slip* leaver_ = nullptr;
  Real sign_ = 1, slope_ = 0;
  PairSeries d_, t_, drive_;
  Series press_, divisor_, inverse_, pace_, both_, speed_, angle_;
};

}  // namespace cushion
}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_BALL_CUSHION_EXPANSION_H_
