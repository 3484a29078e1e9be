// A ball between a cushion's nose and the table: what an impulse at either contact does to the
// ball, from forces and levers, and the slip at either contact.
//
// Source: Mathavan, Jackson, Parkin, Proc. IMechE C 224 (2010) 1863-1873,
// doi 10.1243/09544062JMES1964. Axes: y into the cushion, z up, x = y cross z.
#ifndef CAROM_TESTS_ORACLE_BALL_CUSHION_CONTACTS_H_
#define CAROM_TESTS_ORACLE_BALL_CUSHION_CONTACTS_H_

#include <array>

#include "real.h"

namespace carom_oracle {
namespace cushion {

/// v_x, v_y and R w_x, R w_y, R w_z, m/s.
enum { kVx, kVy, kRx, kRy, kRz, kVelocities };
template <class Real>
using Velocities = std::array<Real, kVelocities>;

template <class Real>
class Contacts {
 public:
  using Vector = std::array<Real, 3>;

  /// `height` of the nose above the table in radii, 0 to 2.
  explicit Contacts(Real height)
      : sine(height - 1),
        cosine(square_root(1 - sine * sine)),
        nose_{0, cosine, sine},
        up_{0, -sine, cosine},
        push(by({0, -cosine, -sine}, nose_)),
        along(by({1, 0, 0}, nose_)),
        rising(by(up_, nose_)),
        table_x(by({1, 0, 0}, kFoot)),
        table_y(by({0, 1, 0}, kFoot)) {}

  /// Along x, and up the cushion's face.
  Pair<Real> cushion_slip(const Velocities<Real>& y) const {
    const Vector v = point(y, nose_);
    return {v[0], v[1] * up_[1] + v[2] * up_[2]};
  }
  Pair<Real> table_slip(const Velocities<Real>& y) const {
    const Vector v = point(y, kFoot);
    return {v[0], v[1]};
  }
  /// How hard the table presses, for friction d at the cushion: nothing moves up or down.
  Real press(Pair<Real> d) const { return sine - cosine * d.y; }

 private:
  static constexpr Vector kFoot{0, 0, -1};

  static Vector turned(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static Vector point(const Velocities<Real>& y, const Vector& lever) {
    const Vector spin = turned({y[kRx], y[kRy], y[kRz]}, lever);
    return {y[kVx] + spin[0], y[kVy] + spin[1], spin[2]};
  }
  static Velocities<Real> by(const Vector& force, const Vector& lever) {
    const Vector torque = turned(lever, force);
    constexpr Real kInverseInertia = Real(5) / 2;
    return {force[0], force[1], kInverseInertia * torque[0], kInverseInertia * torque[1],
            kInverseInertia * torque[2]};
  }

 public:
  const Real sine, cosine;

 private:
  const Vector nose_, up_;

 public:
  /// Changes for a unit impulse / M: the cushion's push, and friction at either contact.
  const Velocities<Real> push, along, rising, table_x, table_y;
};

}  // namespace cushion
}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_BALL_CUSHION_CONTACTS_H_
