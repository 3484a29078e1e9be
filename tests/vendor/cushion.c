/* Both impacts of one folder in C. */
#include <math.h>
#include <stdio.h>

#include "carom.h"

int main(void) {
  const carom_cushion_params pool = {0.028575, 0.170097, 0.2, 0.2, 0.85, 0.036576};
  const carom_params balls = {0.028575, 0.170097, 0.2, 0.2, 0.05, 0.95};
  double roll[6] = {0.0, 1.0, 0.0, -1.0 / 0.028575, 0.0, 0.0};
  const double normal[2] = {0.0, 1.0};
  double cue[9] = {0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0};
  double ball[9] = {0.0, 0.05715, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  int failed = carom_cushion_collide(&pool, roll, normal, roll) != CAROM_OK;
  failed += !(fabs(roll[1] + 0.8042818992213045) < 1e-6);
  failed += carom_cushion_collide(&pool, roll, normal, roll) != CAROM_SEPARATING;
  failed += carom_collide(&balls, cue, ball, cue, ball) != CAROM_OK;
  failed += CAROM_TILTED != 3;
  printf("%s and %s: %d failures\n", carom_cushion_kernel(), carom_kernel(), failed);
  return failed;
}
