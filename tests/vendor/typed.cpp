// The typed header: spans over vectors and arrays, in place, lengths that differ, statuses.
#include <array>
#include <cstdio>
#include <vector>

#include "carom.hpp"

static_assert(std::is_same_v<carom::Status, carom::CollisionStatus>, "the older name");

namespace {

struct Columns {
  std::array<std::vector<double>, 9> values;
  carom::BallColumns before() {
    return {{values[0], values[1], values[2]},
            {values[3], values[4], values[5]},
            {values[6], values[7], values[8]}};
  }
  carom::VelocityColumns after() {
    return {{values[3], values[4], values[5]}, {values[6], values[7], values[8]}};
  }
};

Columns columns(std::size_t n, const carom::Ball& ball) {
  const double* numbers = carom::doubles(ball);
  Columns made;
  for (std::size_t i = 0; i < 9; ++i) made.values[i].assign(n, numbers[i]);
  return made;
}

}  // namespace

int main() {
  const carom::Parameters p = {0.028575, 0.170097, 0.2, 0.2, 0.05, 0.95};
  carom::Ball cue, object;
  cue.velocity = {0.2, 1.5, 0.0};
  cue.angular_velocity = {-52.5, 0.0, 12.0};
  object.position = {0.02, 0.0535, 0.0};
  const carom::Result one = carom::collide(p, cue, object);
  if (one.status != carom::CollisionStatus::ok) return 1;
  if (carom::collide(p, one.ball1, one.ball2).status != carom::CollisionStatus::separating)
    return 2;

  constexpr std::size_t n = 7;
  Columns first = columns(n, cue);
  Columns second = columns(n, object);
  first.values[4][3] = -1.5;  // this one parts
  std::vector<carom::CollisionStatus> statuses(n);
  const std::vector<double> short_column(n - 1, 0.05);
  if (carom::collide(p, first.before(), second.before(), first.after(), second.after(), statuses,
                     short_column)) {
    return 3;
  }
  const std::optional<std::size_t> done =
      carom::collide(p, first.before(), second.before(), first.after(), second.after(), statuses);
  if (!done || *done != n - 1) return 4;
  for (std::size_t i = 0; i < n; ++i) {
    if (statuses[i] != (i == 3 ? carom::CollisionStatus::separating : carom::CollisionStatus::ok))
      return 5;
    const double error = second.values[4][i] - (i == 3 ? 0.0 : one.ball2.velocity.y);
    if (error > 3e-6 || error < -3e-6) return 6;
  }
  std::printf("%zu of %zu collided\n", *done, n);
  return 0;
}
