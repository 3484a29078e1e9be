// The fixed-step oracle in double as a candidate kernel: what the tests of carom_bench and of the
// verdicts run in place of an emitted kernel. CAROM_PROBE_MODEL names a preset of exact_solver.h,
// CAROM_PROBE_N the number of steps.
#include <algorithm>
#include <cstddef>

#include "fixed_step.h"

#ifndef CAROM_PROBE_MODEL
#define CAROM_PROBE_MODEL kMathavan2014
#endif
#ifndef CAROM_PROBE_N
#define CAROM_PROBE_N 1000
#endif

extern "C" int carom_probe_steps(const double params[6], const double ball1[9],
                                 const double ball2[9], double out1[9], double out2[9], int steps) {
  const carom_oracle::Params p{params[0], params[1], params[2], params[3], params[4], params[5]};
  const auto result = carom_oracle::solve_fixed_step<double>(p, carom_oracle::CAROM_PROBE_MODEL,
                                                             ball1, ball2, steps);
  std::copy_n(ball1, 3, out1);
  std::copy_n(ball2, 3, out2);
  std::copy_n(result.outcome.v1, 3, out1 + 3);
  std::copy_n(result.outcome.w1, 3, out1 + 6);
  std::copy_n(result.outcome.v2, 3, out2 + 3);
  std::copy_n(result.outcome.w2, 3, out2 + 6);
  return result.outcome.status;
}

extern "C" int carom_probe_collide(const double params[6], const double ball1[9],
                                   const double ball2[9], double out1[9], double out2[9]) {
  return carom_probe_steps(params, ball1, ball2, out1, out2, CAROM_PROBE_N);
}

extern "C" std::size_t carom_probe_batch(const double params[6], const double* u_b, std::size_t n,
                                         const double* const in[18], double* const out[12],
                                         unsigned char* status) {
  std::size_t good = 0;
  for (std::size_t i = 0; i < n; ++i) {
    double own[6], ball1[9], ball2[9], out1[9], out2[9];
    std::copy_n(params, 6, own);
    if (u_b != nullptr) own[4] = u_b[i];
    for (int k = 0; k < 9; ++k) {
      ball1[k] = in[k][i];
      ball2[k] = in[9 + k][i];
    }
    const int code = carom_probe_collide(own, ball1, ball2, out1, out2);
    for (int k = 0; k < 6; ++k) {
      out[k][i] = out1[3 + k];
      out[6 + k][i] = out2[3 + k];
    }
    if (status != nullptr) status[i] = static_cast<unsigned char>(code);
    good += code == 0 ? 1 : 0;
  }
  return good;
}

extern "C" const char* carom_probe_kernel() { return "oracle"; }
