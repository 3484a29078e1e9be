// The outcome of a ball's impact on a cushion in the limit of a vanishing step.
//
// Independent of the kernels under test: it integrates the ball's full velocities (not the reduced
// slips) with Taylor series of high order in a regularised time, and takes friction at either
// contact as set-valued: a contact sticks as long as the friction that this needs is within its
// cone, and leaves where it is not. The table never pulls in the model `clamped`.
#ifndef CAROM_TESTS_ORACLE_BALL_CUSHION_EXACT_IMPACT_H_
#define CAROM_TESTS_ORACLE_BALL_CUSHION_EXACT_IMPACT_H_

#include <algorithm>
#include <cmath>

#include "expansion.h"

namespace carom_oracle {
namespace cushion {

/// What happened on the way. `met`: both slips were zero at once.
struct Events {
  int sticks_cushion, sticks_table, lifts, releases;
  bool met, gave_up;
};

template <class Real>
class ExactImpact {
 public:
  /// `start`: scaled to order one, approaching. `restitution`: e_c. `clamped`: the table only
  /// pushes.
  ExactImpact(const Contacts<Real>& contacts, Real u_w, Real u_s, Real restitution, bool clamped,
              const Velocities<Real>& start)
      : ball_(contacts),
        u_w_(u_w),
        u_s_(u_s),
        e_(restitution),
        clamped_(clamped),
        y_(),
        start_normal_(start[kVy]),
        expansion_(contacts, u_w, u_s),
        mode_{u_w == 0 ? Contact::kNoFriction : Contact::kSlips,
              u_s == 0 ? Contact::kNoFriction : Contact::kSlips} {
    std::copy(start.begin(), start.end(), y_.begin());
    Real most = 0;
    for (const Real& v : start) most = std::max(most, absolute(v));
    set_slip(kCushionX, meant(contacts.cushion_slip(start), most));
    set_slip(kTableX, meant(contacts.table_slip(start), most));
  }

  void run() {
    while (!done_) {
      const bool c_gone = is_gone(mode_.cushion, c(), 16), s_gone = is_gone(mode_.table, s(), 64);
      if (c_gone && s_gone) {
        both_at_rest();
      } else if (c_gone && mode_.cushion == Contact::kSlips) {
        cushion_at_rest();
      } else if (s_gone && mode_.table == Contact::kSlips && !lifted()) {
        table_at_rest();
      } else {
        smooth_step();
      }
      count_step();
    }
  }

  const State<Real>& state() const { return y_; }
  const Events& events() const { return events_; }
  Real compression_impulse() const { return compression_impulse_; }
  int steps() const { return steps_; }

 private:
  using Series = typename Expansion<Real>::Series;
  static constexpr Real kEps = epsilon<Real>();
  static constexpr Real kNoise = 64 * kEps;  // of a press, a cone's reserve
  static constexpr int kMaxSteps = 40000;

  /// A slip that the rounding of the velocities to doubles could have made is none: where the table
  /// pulls, its direction would decide all that follows.
  static Pair<Real> meant(Pair<Real> slip, Real largest_speed) {
    constexpr Real kRounding = epsilon<double>();
    return size_of(slip) <= 2 * kRounding * largest_speed ? Pair<Real>{0, 0} : slip;
  }
  Pair<Real> c() const { return cushion_slip(y_); }
  Pair<Real> s() const { return table_slip(y_); }
  void set_slip(int first, Pair<Real> slip) {
    y_[first] = slip.x;
    y_[first + 1] = slip.y;
  }
  // Below some roundings a slip, being a difference of numbers of order one, is rounding only.
  static bool is_gone(Contact contact, Pair<Real> slip, int roundings) {
    if (contact == Contact::kNoFriction) return false;
    return contact == Contact::kSticks || size_of(slip) <= roundings * kEps;
  }
  static Pair<Real> unit(Pair<Real> a) { return (1 / size_of(a)) * a; }
  Pair<Real> table_direction() const {
    return mode_.table == Contact::kSlips ? unit(s()) : Pair<Real>{0, 0};
  }
  Real press(Pair<Real> d) const {
    const Real n = ball_.press(d);
    return clamped_ && n < 0 ? Real(0) : n;
  }
  Pair<Real> cushion_friction() const {
    if (mode_.cushion == Contact::kSlips) return -u_w_ * unit(c());
    return mode_.cushion == Contact::kCreeps ? -u_w_ * mode_.creeping : Pair<Real>{0, 0};
  }

  /// Has the cushion's friction taken the ball's weight off the table? At the very limit the
  /// turning of the slip decides.
  bool lifted() const {
    if (!clamped_ || mode_.cushion == Contact::kSticks || mode_.table != Contact::kSlips) {
      return false;
    }
    const Pair<Real> d = cushion_friction();
    const Real n = ball_.press(d);
    if (absolute(n) > kNoise / 2 || mode_.cushion != Contact::kSlips) return n < 0;
    const Pair<Real> turning = ball_.cushion_slip(expansion_.rate({d, Pair<Real>{0, 0}}));
    return !(c().x * cross(c(), turning) > 0);
  }

  void count_step() {
    if (++steps_ < kMaxSteps || done_) return;
    events_.gave_up = true;
    done_ = true;
  }

  void end_compression() {
    mode_.restitution = true;
    compression_impulse_ = y_[kImpulse];
    target_ = e_ * e_ * y_[kWork];
    y_[kWork] = 0;
    if (!(target_ > 0)) done_ = true;
  }

  /// A step so short that the error of holding every friction fixed, its square, is below rounding.
  void leap(const Frictions<Real>& f, Real slip_rate) {
    const Velocities<Real> r = expansion_.rate(f);
    Real dq = std::max(square_root(kEps) * start_normal_ / 100, 256 * kEps / slip_rate);
    const Real v = absolute(y_[kVy]), left = target_ - y_[kWork];
    if (v > 0) dq = std::min(dq, left / (v * ball_.cosine));
    for (int i = 0; i < kVelocities; ++i) y_[i] += dq * r[i];
    if (mode_.cushion != Contact::kSticks) set_slip(kCushionX, dq * ball_.cushion_slip(r));
    if (mode_.table != Contact::kSticks) set_slip(kTableX, dq * ball_.table_slip(r));
    y_[kImpulse] += dq;
    y_[kWork] += dq * ball_.cosine * (v + absolute(y_[kVy])) / 2;
    done_ = y_[kWork] >= target_;
  }

  void cushion_at_rest() {
    set_slip(kCushionX, {0, 0});
    const Pair<Real> e = table_direction();
    const Frictions<Real> held = expansion_.sticking_cushion(e);
    if (size_of(held.cushion) <= u_w_) {
      mode_.cushion = Contact::kSticks;
      ++events_.sticks_cushion;
      return;
    }
    mode_.cushion = Contact::kCreeps;
    mode_.creeping = way_out(e);
  }

  Frictions<Real> slipping(Pair<Real> along, Pair<Real> e) const {
    const Pair<Real> d = -u_w_ * along;
    return {d, (-u_s_ * press(d)) * e};
  }
  /// How the cushion's slip turns and grows if it is along `along`.
  Pair<Real> growth(Pair<Real> along, Pair<Real> e) const {
    const Pair<Real> rate = ball_.cushion_slip(expansion_.rate(slipping(along, e)));
    return {dot(along, rate), cross(along, rate)};
  }
  /// The direction in which a slip at the cushion that cannot stick grows without turning.
  Pair<Real> way_out(Pair<Real> e) const {
    constexpr int kDirections = 720;
    const auto direction = [](int i) {
      const double angle = 2 * 3.14159265358979323846 * (i + 0.5) / kDirections;
      return unit(Pair<Real>{Real(std::cos(angle)), Real(std::sin(angle))});
    };
    for (int i = 0; i < kDirections; ++i) {
      Pair<Real> low = direction(i), high = direction(i + 1);
      if (!(growth(low, e).y >= 0 && growth(high, e).y < 0)) continue;
      for (int k = 0; k < 130; ++k) {
        const Pair<Real> middle = unit(low + high);
        (growth(middle, e).y >= 0 ? low : high) = middle;
      }
      if (growth(low, e).x > 0) return low;
    }
    return {0, 1};
  }

  void table_at_rest() {
    set_slip(kTableX, {0, 0});
    const Pair<Real> d = cushion_friction(), held = expansion_.sticking_table(d);
    const Real most = u_s_ * press(d);
    if (size_of(held) <= most) {
      mode_.table = Contact::kSticks;
      ++events_.sticks_table;
      return;
    }
    mode_.table = Contact::kCreeps;
    mode_.creeping = unit(Real(-1) * held);
  }

  /// Both slips are zero, so that the ball neither approaches nor goes back: greatest compression.
  /// From here the table slips down (away from the cushion) or the cushion up, or both.
  void both_at_rest() {
    events_.met = true;
    set_slip(kCushionX, {0, 0});
    set_slip(kTableX, {0, 0});
    if (!mode_.restitution) end_compression();
    if (done_) return;
    const Pair<Real> down{0, -1}, up{0, 1};
    Frictions<Real> f = expansion_.sticking_cushion(down);
    const bool cushion_held = size_of(f.cushion) <= u_w_;
    bool table_held = false;
    if (!cushion_held) {
      f = slipping(up, down);
      const Pair<Real> held = expansion_.sticking_table(f.cushion);
      table_held = size_of(held) <= u_s_ * press(f.cushion);
      if (table_held) f.table = held;
    }
    set(cushion_held, &mode_.cushion, &events_.sticks_cushion);
    set(table_held, &mode_.table, &events_.sticks_table);
    const Velocities<Real> r = expansion_.rate(f);
    const Real c_rate = size_of(ball_.cushion_slip(r)), s_rate = size_of(ball_.table_slip(r));
    leap(f, table_held ? c_rate : s_rate);
  }
  static void set(bool held, Contact* contact, int* count) {
    if (held && *contact != Contact::kSticks) ++*count;
    *contact = held ? Contact::kSticks : Contact::kSlips;
  }

  struct Fall {
    Real where;
    bool happens;
  };
  static Fall fall(const Series& a, Real end) {
    Fall found{end, false};
    found.happens = first_fall(a, end, &found.where);
    return found;
  }
  static Series shifted(Series a, Real sign, Real by) {
    for (Real& term : a) term *= sign;
    a[0] += by;
    return a;
  }
  Series left_of_phase() const {
    return mode_.restitution ? shifted(expansion_.of(kWork), -1, target_) : expansion_.of(kVy);
  }

  /// A step of the series, to the first of the events that its state knows.
  void smooth_step() {
    const bool lifts = lifted();
    const bool off_table = lifts && ball_.press(cushion_friction()) < -kNoise / 2;
    if (off_table && !off_table_) ++events_.lifts;
    off_table_ = off_table;
    Mode<Real> mode = mode_;
    if (lifts) mode.table = Contact::kNoFriction;
    Real h = 0;
    if (!creep(mode, &h)) {
      expansion_.expand(y_, mode);
      h = step(6);  // beyond it the terms of exp(t) cancel too many digits
    }
    Contact* falls = nullptr;
    if (mode.cushion == Contact::kSticks) {
      limit(expansion_.cushion_reserve(), &mode_.cushion, &falls, &h);
    }
    if (mode.table == Contact::kSticks) limit(expansion_.table_reserve(), &mode_.table, &falls, &h);
    if (clamped_ && mode_.cushion == Contact::kSlips && mode_.table == Contact::kSlips) {
      const Fall turns = fall(shifted(expansion_.press(), lifts ? -1 : 1, kNoise), h);
      if (turns.happens) h = turns.where;
    }
    const Fall ends = fall(left_of_phase(), h);
    finish(ends, h, falls);
  }
  Real step(double most) const {
    return expansion_.step(start_normal_, static_cast<long double>(kEps) / 8, most);
  }
  /// A contact that begins to slip creeps, and so does one whose slip stays small: then many steps
  /// of the regularised time would be as long as one of the impulse.
  bool creep(const Mode<Real>& mode, Real* h) {
    const bool begins = mode.creeps();
    Mode<Real> slow = mode;
    if (!begins && !may_creep(&slow)) return false;
    if (!expansion_.expand(y_, slow)) return false;
    *h = step(1e3);
    if (!begins) {
      const Pair<Real> slip = slow.cushion == Contact::kCreeps ? c() : s();
      const bool settled = absolute(cross(expansion_.creeping_unit(), slip)) <= 4 * kEps;
      if (!settled || expansion_.turns_in(*h) < 20) return false;
    }
    *h = fall(expansion_.creeping_slip(), *h).where;
    const Series other = expansion_.slip_beside_creep();
    *h = fall(shifted(other, 1, -other[0] / 8), *h).where;
    if (mode_.cushion == Contact::kCreeps) mode_.cushion = Contact::kSlips;
    if (mode_.table == Contact::kCreeps) mode_.table = Contact::kSlips;
    return true;
  }
  /// Every few steps, where a slip is small beside all else.
  bool may_creep(Mode<Real>* mode) const {
    if (steps_ % 8 != 7) return false;
    const Real small = start_normal_ / 1000;
    const Real slip_c = size_of(c()), slip_s = size_of(s());
    const bool c_rules = mode->cushion == Contact::kSlips, s_rules = mode->table == Contact::kSlips;
    if (c_rules && slip_c < small && (!s_rules || slip_c < slip_s / 1000)) {
      mode->cushion = Contact::kCreeps;
      mode->creeping = unit(c());
      return true;
    }
    if (s_rules && slip_s < small && (!c_rules || slip_s < slip_c / 1000)) {
      mode->table = Contact::kCreeps;
      mode->creeping = unit(s());
      return true;
    }
    return false;
  }
  void limit(const Series& reserve, Contact* contact, Contact** falls, Real* h) const {
    const Fall found = fall(shifted(reserve, 1, kNoise), *h);
    if (!found.happens) return;
    *h = found.where;
    *falls = contact;
  }
  void finish(const Fall& ends, Real h, Contact* falls) {
    y_ = expansion_.at(ends.happens ? ends.where : h);
    if (ends.happens) {
      if (mode_.restitution) {
        done_ = true;
      } else {
        end_compression();
      }
    } else if (falls != nullptr) {
      *falls = Contact::kCreeps;
      ++events_.releases;
      mode_.creeping = falls == &mode_.cushion
                           ? unit(Real(-1) * expansion_.sticking_cushion(table_direction()).cushion)
                           : unit(Real(-1) * expansion_.sticking_table(cushion_friction()));
    }
  }

  const Contacts<Real>& ball_;
  const Real u_w_, u_s_, e_;
  const bool clamped_;
  State<Real> y_;
  const Real start_normal_;
  Expansion<Real> expansion_;
  Mode<Real> mode_;
  Real target_ = 0, compression_impulse_ = 0;
  bool done_ = false, off_table_ = false;
  int steps_ = 0;
  Events events_{};
};

}  // namespace cushion
}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_BALL_CUSHION_EXACT_IMPACT_H_
