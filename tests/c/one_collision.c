/* A C99 client of a generated kernel of the scene `any`: one collision and what must hold of it. */
#include <math.h>
#include <stdio.h>

#include "carom.h"

int main(void) {
  /* A rolling cue ball meets a resting ball, head on. */
  const carom_params p = {0.028575, 0.170097, 0.2, 0.2, 0.05, 0.95};
  const double ball1[9] = {0.0, 0.0, 0.028575, 0.0, 1.0, 0.0, -1.0 / 0.028575, 0.0, 0.0};
  const double ball2[9] = {0.0, 0.05715, 0.028575, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  double out1[9], out2[9];
  const int status = carom_collide(&p, ball1, ball2, out1, out2);
  printf("%s\nstatus %d, %.6f and %.6f m/s\n", carom_kernel(), status, out1[4], out2[4]);
  if (status != CAROM_OK) return 1;
  /* It keeps a little of its speed, and the other takes the most. */
  if (!(fabs(out1[4]) < 0.1 && out2[4] > 0.9 && out2[4] < 1.0)) return 1;
  return carom_collide(&p, ball2, ball1, out1, out2) == CAROM_OK ? 0 : 1;
}
