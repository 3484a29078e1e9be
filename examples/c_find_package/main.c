/* A rolling cue ball hits a resting ball; C99. */
#include <stdio.h>

#include "carom.h"

int main(void) {
  const carom_params cloth = {0.028575, 0.170097, 0.2, 0.2, 0.05, 0.95}; /* R M u_s1 u_s2 u_b e_b */
  double cue[9] = {0.0, 0.0, 0.0, 0.0, 1.5, 0.0, -1.5 / 0.028575, 0.0, 0.0};
  double object[9] = {0.02, 0.0535, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  if (carom_collide(&cloth, cue, object, cue, object) != CAROM_OK) return 1;
  printf("%s\nthe object ball leaves with %.4f %.4f m/s\n", carom_kernel(), object[3], object[4]);
  return 0;
}
