/* Forces each kernel in turn: prints target, kernel, and the answer bit for bit; then whether a
 * call to the unit itself gives the same. C99. */
#include <stdio.h>

#include "carom.h"

int carom_zen3_collide(const carom_params *p, const double *ball1, const double *ball2,
                       double *out1, double *out2);
int carom_x86_64_v2_collide(const carom_params *p, const double *ball1, const double *ball2,
                            double *out1, double *out2);

typedef int (*Collide)(const carom_params *, const double *, const double *, double *, double *);

/* Sums over many collisions, so that two kernels that round differently differ. */
static double sum_of(const carom_params *p, Collide collide, int *status) {
  double balls[18] = {0.0,  0.0,    0.0, 0.3, 1.5, 0.0, -20.0, 3.0, 12.0,
                      0.02, 0.0535, 0.0, 0.0, 0.0, 0.0, 0.0,   0.0, 0.0};
  double out[18], sum = 0.0;
  int i, j;
  for (i = 0; i < 50; ++i) {
    balls[3] = 0.3 + 0.01 * i;
    *status = collide(p, balls, balls + 9, out, out + 9);
    for (j = 0; j < 18; ++j) sum += out[j];
  }
  return sum;
}

int main(void) {
  const carom_params p = {0.028575, 0.170097, 0.2, 0.2, 0.05, 0.95};
  const Collide units[2] = {carom_zen3_collide, carom_x86_64_v2_collide};
  size_t i;
  int status;
  const double first = sum_of(&p, carom_collide, &status);
  printf("%s %s %a %d\n", carom_target(), carom_kernel(), first, status);
  for (i = 0; carom_target_name(i) != NULL; ++i) {
    double through, direct;
    if (!carom_use_target(carom_target_name(i))) {
      printf("%s cannot\n", carom_target_name(i));
      continue;
    }
    through = sum_of(&p, carom_collide, &status);
    direct = sum_of(&p, units[i], &status);
    printf("%s %s %a %d\n", carom_target(), carom_kernel(), through, through == direct);
  }
  return 0;
}
