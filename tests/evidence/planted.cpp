// A kernel with a flaw that was put there: the oracle in double, off by 5e-6 in a small corner.
#include <cstddef>

#include "exact_solver.h"

extern "C" {
int carom_probe_collide(const double params[6], const double ball1[9], const double ball2[9],
                        double out1[9], double out2[9]) {
  const carom_oracle::Params p{params[0], params[1], params[2], params[3], params[4], params[5]};
  const auto end =
      carom_oracle::solve_exact_as<double>(p, carom_oracle::kMathavan2014, ball1, ball2);
  for (int i = 0; i < 3; ++i) {
    out1[i] = ball1[i];
    out2[i] = ball2[i];
    out1[3 + i] = end.v1[i];
    out1[6 + i] = end.w1[i];
    out2[3 + i] = end.v2[i];
    out2[6 + i] = end.w2[i];
  }
  const bool flawed = p.u_b > 0.5 && p.u_s2 > 0.8 && p.e_b >= 1e-3 && p.e_b < 1.3e-3;
  if (end.status == 0 && flawed) out1[3] += 5e-6 * (ball1[4] - ball2[4]);
  return end.status;
}
}
