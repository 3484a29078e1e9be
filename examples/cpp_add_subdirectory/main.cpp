// A rolling cue ball hits a resting ball; C++ with types.
#include <cstdio>

#include "carom.hpp"

int main() {
  const carom::Parameters cloth = {0.028575, 0.170097, 0.2,
                                   0.2,      0.05,     0.95};  // R M u_s1 u_s2 u_b e_b
  carom::Ball cue;
  cue.velocity = {0.0, 1.5, 0.0};
  cue.angular_velocity = {-1.5 / cloth.R, 0.0, 0.0};
  carom::Ball object;
  object.position = {0.02, 0.0535, 0.0};

  const carom::Result after = carom::collide(cloth, cue, object);
  if (!after) return 1;
  const carom::Vector v = after.ball2.velocity;
  std::printf("%s\nthe object ball leaves with %.4f %.4f m/s\n", carom::kernel(), v.x, v.y);
  return 0;
}
