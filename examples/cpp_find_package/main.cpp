// A rolling cue ball, three balls that it may hit: a batch in columns, in place, with spans.
#include <array>
#include <cstdio>
#include <vector>

#include "carom.hpp"

int main() {
  constexpr std::size_t n = 3;
  const carom::Parameters cloth = {0.028575, 0.170097, 0.2,
                                   0.2,      0.05,     0.95};  // R M u_s1 u_s2 u_b e_b
  const std::vector<double> zero(n);
  // Velocity and angular velocity; the last cue ball rolls away.
  const double w = 1.5 / cloth.R;
  std::array<std::vector<double>, 6> cue = {zero, {1.5, 1.5, -1.5}, zero, {-w, -w, w}, zero, zero};
  std::array<std::vector<double>, 6> object = {zero, zero, zero, zero, zero, zero};
  const std::vector<double> x = {0.02, 0.0, 0.02};
  const std::vector<double> y = {0.0535, 0.05715, 0.0535};

  std::array<carom::CollisionStatus, n> statuses{};
  const auto collided = carom::collide(
      cloth, {{zero, zero, zero}, {cue[0], cue[1], cue[2]}, {cue[3], cue[4], cue[5]}},
      {{x, y, zero}, {object[0], object[1], object[2]}, {object[3], object[4], object[5]}},
      {{cue[0], cue[1], cue[2]}, {cue[3], cue[4], cue[5]}},
      {{object[0], object[1], object[2]}, {object[3], object[4], object[5]}}, statuses);
  if (!collided || *collided != 2 || statuses[2] != carom::CollisionStatus::separating) return 1;
  for (std::size_t i = 0; i < *collided; ++i) {
    std::printf("the object ball leaves with %.4f %.4f m/s\n", object[0][i], object[1][i]);
  }
  return 0;
}
