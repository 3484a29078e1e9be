// Both impacts of one folder, by their types: a straight roll into the cushion, then two balls.
#include <cmath>
#include <cstdio>
#include <vector>

#include "carom.hpp"

namespace {

int failures = 0;

void require(bool holds, const char* what) {
  if (holds) return;
  std::printf("FAILED: %s\n", what);
  ++failures;
}

}  // namespace

int main() {
  const double R = 0.028575;
  const carom::CushionParameters pool = {R, 0.170097, 0.2, 0.2, 0.85, 0.036576};
  carom::Motion roll;
  roll.velocity.y = 1.0;
  roll.angular_velocity.x = -1.0 / R;
  const carom::CushionResult back = carom::collide(pool, roll, carom::Normal{0.0, 1.0});
  require(back.status == carom::CushionStatus::ok, "the roll collides");
  require(std::fabs(back.ball.velocity.y + 0.8042818992213045) < 1e-6,
          "a roll comes back with .804 of its speed");
  std::printf("%s: %.9f\n", carom::cushion_kernel(), back.ball.velocity.y);

  carom::Motion leaving = roll;
  leaving.velocity.y = -1.0;
  require(carom::collide(pool, leaving, {}).status == carom::CushionStatus::separating,
          "a leaving ball");
  carom::CushionParameters low = pool;
  low.h = 0.9 * R;
  require(carom::collide(low, roll, {}).status == carom::CushionStatus::bad_input,
          "a nose below the centre");

  const std::size_t n = 5;
  std::vector<double> one(n, 1.0), zero(n, 0.0), spin(n, -1.0 / R), u_w(n, 0.2);
  std::vector<double> out[6];
  for (std::vector<double>& column : out) column.resize(n);
  std::vector<carom::CushionStatus> statuses(n);
  const carom::MotionColumns before = {{zero, one, zero}, {spin, zero, zero}};
  const carom::VelocityColumns after = {{out[0], out[1], out[2]}, {out[3], out[4], out[5]}};
  const auto good =
      carom::collide(pool, before, carom::NormalColumns{zero, one}, after, statuses, u_w);
  require(good.has_value() && *good == n, "a batch counts");
  for (std::size_t i = 0; i < n; ++i) {
    require(statuses[i] == carom::CushionStatus::ok, "a batch has statuses");
    require(std::fabs(out[1][i] + 0.8042818992213045) < 1e-6, "a batch gives what a call gives");
  }
  const carom::Span<const double> few(one.data(), n - 1);
  require(!carom::collide(pool, before, carom::NormalColumns{zero, few}, after).has_value(),
          "columns of other lengths");

  carom::Ball cue, ball;
  cue.velocity.y = 1.0;
  ball.position.y = 2 * R;
  const carom::Parameters balls = {R, 0.170097, 0.2, 0.2, 0.05, 0.95};
  require(carom::collide(balls, cue, ball).status == carom::CollisionStatus::ok,
          "two balls collide");
  std::printf("%s\n%d failures\n", carom::kernel(), failures);
  return failures == 0 ? 0 : 1;
}
