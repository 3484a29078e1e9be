// The motion during an impact as power series, for any state of the two contacts.
#ifndef CAROM_TESTS_ORACLE_BALL_CUSHION_EXPANSION_H_
#define CAROM_TESTS_ORACLE_BALL_CUSHION_EXPANSION_H_

#include <algorithm>
#include <cmath>

#include "contacts.h"
#include "power_series.h"

namespace carom_oracle {
namespace cushion {

/// What a contact does. kCreeps: it slips so little, or begins to slip, that friction turns the
/// slip much faster than anything else changes: its direction is where it does not turn.
enum class Contact { kNoFriction, kSlips, kSticks, kCreeps };

/// Unknowns beside the velocities: the slips (which small velocities would round away), normal
/// impulse / M, and the work / M of the phase.
enum { kCushionX = kVelocities, kCushionY, kTableX, kTableY, kImpulse, kWork, kUnknowns };
template <class Real>
using State = std::array<Real, kUnknowns>;

template <class Real>
Pair<Real> cushion_slip(const State<Real>& y) {
  return {y[kCushionX], y[kCushionY]};
}
template <class Real>
Pair<Real> table_slip(const State<Real>& y) {
  return {y[kTableX], y[kTableY]};
}

/// Friction at the cushion and at the table, for one unit of the cushion's push.
template <class Real>
struct Frictions {
  Pair<Real> cushion, table;
};

/// What the contacts do from here on. `creeping`: nearly the direction of the slip that creeps.
template <class Real>
struct Mode {
  Contact cushion, table;
  bool restitution = false;
  Pair<Real> creeping{0, 0};
  bool creeps() const { return cushion == Contact::kCreeps || table == Contact::kCreeps; }
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
        table_(contacts.table_slip(contacts.table_x).x) {}

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
  /// or the impulse where a contact creeps: then the slip's direction is a series of its own, the
  /// slow solution of a stiff equation. That need not converge, but its terms fall at first.
  /// False: a creeping slip is too large for that.
  bool expand(const State<Real>& start, const Mode<Real>& mode) {
    mode_ = mode;
    y[0] = start;
    if (!mode.creeps()) {
      all_orders();
      return true;
    }
    creeper_ = mode.cushion == Contact::kCreeps ? &c_ : &s_;
    creeper_->size = Series{};
    creeper_->size[0] = size_of(creeper_ == &c_ ? cushion_slip(start) : table_slip(start));
    creeper_->unit.set(0, mode.creeping);
    angle_ = Series{};
    for (int pass = 0; pass < kOrder / 2; ++pass) {
      const Series before = angle_;
      const Pair<Real> unit = creeper_->unit[0];
      all_orders();
      const Real moved = absolute(cross(unit, creeper_->unit[0]));
      const Real turned = absolute(angle_[1] - before[1]) * creeper_->size[0];
      if (creeper_->size[0] * moved <= epsilon<Real>() && turned <= -slope_ * epsilon<Real>()) {
        return true;
      }
    }
    return false;
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
  /// Of the slip that creeps: its size, its direction at the start, and how often friction turned
  /// it round by a radian in a step of h.
  const Series& creeping_slip() const { return creeper_->size; }
  /// Size of the other contact's slip, if it slips, too. It is a root, which does not see zeros.
  Series slip_beside_creep() const {
    if (mode_.cushion == Contact::kSlips) return lacking_last(c_.size);
    if (mode_.table == Contact::kSlips) return lacking_last(s_.size);
    return Series{1};
  }
  Pair<Real> creeping_unit() const { return creeper_->unit[0]; }
  Real turns_in(Real h) const { return -slope_ * h / creeper_->size[0]; }

  /// A step whose terms of the highest orders are below `tolerance`, at most `most`.
  Real step(Real speed, long double tolerance, long double most) const {
    long double h = most;  // whose range the terms may need
    for (int n = kOrder - 1; n <= kOrder; ++n) {
      Real term = absolute(y[n][kWork]) / speed;
      for (int i = 0; i <= kImpulse; ++i) term = std::max(term, absolute(y[n][i]));
      if (term > 0) h = std::min(h, std::pow(tolerance / static_cast<long double>(term), 1.0L / n));
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
  static bool pulls(Contact contact) {
    return contact == Contact::kSlips || contact == Contact::kCreeps;
  }

  static void slip(int n, Pair<Real> value, Slip* s) {
    s->vector.set(n, value);
    s->size[n] = root(s->size, square(s->vector.x, n) + square(s->vector.y, n), n);
    s->inverse[n] = reciprocal(s->size, s->inverse, n);
    s->unit.set(n, {product(s->vector.x, s->inverse, n), product(s->vector.y, s->inverse, n)});
  }
  void all_orders() {
    for (int n = 0; n < kOrder; ++n) {
      if (mode_.cushion == Contact::kSlips) slip(n, cushion_slip(y[n]), &c_);
      if (mode_.table == Contact::kSlips) slip(n, table_slip(y[n]), &s_);
      if (!mode_.creeps()) {
        forces(n);
      } else if (n == 0) {
        find_direction();
      } else {
        turn(n);
      }
      advance(n);
    }
  }

  void forces(int n) {
    Pair<Real> d{0, 0}, t{0, 0};
    if (pulls(mode_.cushion)) d = -u_w_ * c_.unit[n];
    if (mode_.cushion == Contact::kSticks) {
      const Real e_y = pulls(mode_.table) ? s_.unit.y[n] : Real(0);
      divisor_[n] = only(rising_, n) + u_s_ * pressed_ * ball_.cosine * e_y;
      inverse_[n] = reciprocal(divisor_, inverse_, n);
      press_[n] = held_press() * inverse_[n];
      d.y = (only(ball_.sine, n) - press_[n]) / ball_.cosine;
    } else {
      press_[n] = only(ball_.sine, n) - ball_.cosine * d.y;
    }
    if (pulls(mode_.table)) {
      t = {-u_s_ * product(press_, s_.unit.x, n), -u_s_ * product(press_, s_.unit.y, n)};
    }
    if (mode_.cushion == Contact::kSticks) d.x = -crossed_ * t.x / along_;
    if (mode_.table == Contact::kSticks) {
      t = {-crossed_ * d.x / table_, (only(ball_.cosine, n) - pressed_ * d.y) / table_};
    }
    d_.set(n, d);
    t_.set(n, t);
  }

  /// Coefficient n of the unit vector, from its angle.
  void unit_from_angle(int n) {
    if (n == 0) return;
    Pair<Real> sum{0, 0};
    for (int j = 1; j <= n; ++j) {
      const Pair<Real> u = creeper_->unit[n - j];
      sum = sum + (j * angle_[j]) * Pair<Real>{-u.y, u.x};
    }
    creeper_->unit.set(n, (Real(1) / n) * sum);
  }
  Pair<Real> creeper_slip(const Velocities<Real>& r) const {
    return creeper_ == &c_ ? ball_.cushion_slip(r) : ball_.table_slip(r);
  }
  /// Rate of the creeping slip, coefficient n, along its direction and across it.
  Pair<Real> creeping_rate(int n) {
    unit_from_angle(n);
    forces(n);
    drive_.set(n, creeper_slip(change(only(1, n), {d_[n], t_[n]})));
    const PairSeries& u = creeper_->unit;
    return {product(u.x, drive_.x, n) + product(u.y, drive_.y, n),
            product(u.x, drive_.y, n) - product(u.y, drive_.x, n)};
  }
  /// The slip is size(q) along the angle(q): size' and size angle' are given by the forces, which
  /// depend on the angle. Of the latter's coefficient n all is known but the angle's coefficient n
  /// and, times the size at the start, n + 1: that is taken from the pass before.
  void find_direction() {
    for (int i = 0; i < 60; ++i) {
      const Pair<Real> rate = creeping_rate(0), u = creeper_->unit[0];
      slope_ = slope_of_turning() - rate.x;
      const Real ahead = (creeper_->size[0] * angle_[1] - rate.y) / slope_;
      const Pair<Real> next{u.x - ahead * u.y, u.y + ahead * u.x};
      creeper_->unit.set(0, (1 / size_of(next)) * next);
      if (absolute(ahead) <= 2 * epsilon<Real>()) break;
    }
    creeper_->size[1] = creeping_rate(0).x;
  }
  void turn(int n) {
    const Series& size = creeper_->size;
    Real known = n + 1 < kOrder ? size[0] * (n + 1) * angle_[n + 1] : Real(0);
    for (int j = 2; j <= n; ++j) known += size[j] * (n - j + 1) * angle_[n - j + 1];
    angle_[n] = 0;
    angle_[n] = (known - creeping_rate(n).y) / (slope_ - n * size[1]);
    creeper_->size[n + 1] = creeping_rate(n).x / (n + 1);
  }
  /// Change of the turning rate with the angle, the forces' part.
  Real slope_of_turning() const {
    const Pair<Real> u = creeper_->unit[0], ahead{-u.y, u.x};
    Frictions<Real> f{{0, 0}, {0, 0}};
    if (creeper_ == &c_) {
      f.cushion = -u_w_ * ahead;
      if (pulls(mode_.table)) f.table = (u_s_ * ball_.cosine * f.cushion.y) * s_.unit[0];
      if (mode_.table == Contact::kSticks)
        f.table = sticking_table(f.cushion) + Real(-1) * sticking_table({0, 0});
    } else {
      f.table = (-u_s_ * press_[0]) * ahead;
    }
    return dot(ahead, creeper_slip(change(0, f)));
  }

  /// Impulse for a unit of the variable.
  Real pace(int n) {
    if (mode_.creeps()) return only(1, n);
    if (n == 0) set_paces();
    const bool c = mode_.cushion == Contact::kSlips, s = mode_.table == Contact::kSlips;
    if (!c && !s) return only(1, n);
    if (!s) return c_.size[n] / pace_cushion_;
    if (!c) return s_.size[n] / pace_table_;
    divisor_[n] = pace_cushion_ * s_.size[n] + pace_table_ * c_.size[n];
    inverse_[n] = reciprocal(divisor_, inverse_, n);
    both_[n] = product(c_.size, s_.size, n);
    return product(both_, inverse_, n);
  }

  void set_paces() {
    const Velocities<Real> r = rate({d_[0], t_[0]});
    pace_cushion_ = size_of(ball_.cushion_slip(r)) + along_ * u_w_;
    pace_table_ = size_of(ball_.table_slip(r)) + table_ * u_s_ * absolute(press_[0]);
  }

  void advance(int n) {
    pace_[n] = pace(n);
    speed_[n] = mode_.restitution ? -y[n][kVy] : y[n][kVy];
    const Frictions<Real> f{{product(d_.x, pace_, n), product(d_.y, pace_, n)},
                            {product(t_.x, pace_, n), product(t_.y, pace_, n)}};
    const Velocities<Real> r = change(pace_[n], f);
    const Pair<Real> c = ball_.cushion_slip(r), s = ball_.table_slip(r);
    const Real c_moves = mode_.cushion == Contact::kSticks ? 0 : 1;
    const Real s_moves = mode_.table == Contact::kSticks ? 0 : 1;
    State<Real> rate{};
    std::copy(r.begin(), r.end(), rate.begin());
    rate[kCushionX] = c_moves * c.x;
    rate[kCushionY] = c_moves * c.y;
    rate[kTableX] = s_moves * s.x;
    rate[kTableY] = s_moves * s.y;
    for (int i = 0; i < kImpulse; ++i) y[n + 1][i] = rate[i] / (n + 1);
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
  Real pace_cushion_ = 1, pace_table_ = 1;  // about how fast the slips change
  Mode<Real> mode_{Contact::kNoFriction, Contact::kNoFriction};
  Slip c_, s_;
  Slip* creeper_ = nullptr;
  Real slope_ = 0;
  PairSeries d_, t_, drive_;
  Series press_, divisor_, inverse_, pace_, both_, speed_, angle_;
};

}  // namespace cushion
}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_BALL_CUSHION_EXPANSION_H_
