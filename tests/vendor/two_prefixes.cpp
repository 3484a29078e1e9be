// Two vendored copies in one program: the exact kernel and fixed steps, told apart by prefix.
#include <cmath>
#include <cstdio>

#include "fixed.hpp"
#include "smooth.hpp"

int main() {
  const fixed::Parameters p = {0.028575, 0.170097, 0.2, 0.2, 0.05, 0.95};
  const smooth::Parameters q = {0.028575, 0.170097, 0.2, 0.2, 0.05, 0.95};
  fixed::Ball cue;
  cue.velocity = {0.2, 1.5, 0.0};
  cue.angular_velocity = {-52.5, 0.0, 12.0};
  fixed::Ball object;
  object.position = {0.02, 0.0535, 0.0};
  const smooth::Ball same_cue = {{0.0, 0.0, 0.0}, {0.2, 1.5, 0.0}, {-52.5, 0.0, 12.0}};
  const smooth::Ball same_object = {{0.02, 0.0535, 0.0}, {}, {}};
  const fixed::Result one = fixed::collide(p, cue, object);
  const smooth::Result other = smooth::collide(q, same_cue, same_object);
  if (!one || !other) return 1;
  const double difference = std::fabs(one.ball2.velocity.y - other.ball2.velocity.y);
  std::printf("%s\n%s\n%.3g\n", fixed::kernel(), smooth::kernel(), difference);
  return difference > 0.0 && difference < 2e-3 ? 0 : 1;
}
