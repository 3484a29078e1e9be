// Included before a kernel when it is verified
// (generator/evidence/verification/worst_estimates.py), and in no other build: in place of x86's
// instructions that estimate 1 / sqrt(x), the root itself, off by as much as their specification
// allows. Intel's manual: rsqrtss and rsqrtps are off by at most 1.5
// * 2^-12 of the root and take denormal floats for zero; vrsqrt14 is off by at most 2^-14. CPUs of
// different makers differ within that.
#ifndef CAROM_BENCH_WORST_ESTIMATES_H_
#define CAROM_BENCH_WORST_ESTIMATES_H_

#include <immintrin.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

namespace carom_worst {

// Half an ulp of a float less than allowed, since the root that is off is rounded.
constexpr double kSse = 1.5 / 4096 - 0x1p-23;
constexpr double kFourteenBits = 1.0 / 16384 - 0x1p-23;

// Shares of what is allowed, for either half of the inputs; `shift`: which bit of an input's hash
// or of its mantissa tells the halves apart.
struct Pattern {
  double one, other;
  int hashed, bit;
};

inline Pattern pattern_from_environment() {
  Pattern p = {0.0, 0.0, 0, 0};
  const char* text = getenv("CAROM_WORST_ESTIMATES");
  if (text == nullptr || sscanf(text, "%lf %lf %d %d", &p.one, &p.other, &p.hashed, &p.bit) != 4) {
    fputs("CAROM_WORST_ESTIMATES: no pattern of estimates; expected four numbers\n", stderr);
    abort();
  }
  return p;
}

static const Pattern kPattern = pattern_from_environment();

static inline double estimate(double x, double allowed) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  if (kPattern.hashed != 0) bits *= 0x9e3779b97f4a7c15u;
  const double share = (bits >> kPattern.bit & 1u) != 0 ? kPattern.other : kPattern.one;
  return 1.0 / __builtin_sqrt(x) * (1.0 + share * allowed);
}

static inline float of_sse(float x) {
  const bool denormal = __builtin_fabsf(x) < 0x1p-126f;
  return static_cast<float>(estimate(denormal ? __builtin_copysignf(0.0f, x) : x, kSse));
}
static inline float of_fourteen_bits(float x) {
  return static_cast<float>(estimate(x, kFourteenBits));
}
static inline double of_fourteen_bits(double x) { return estimate(x, kFourteenBits); }

// Called, not copied to each place of use: lanes that were unrolled there took five times the time
// that the kernel's compilation takes.
#define CAROM_CALLED [[gnu::noinline, maybe_unused]] static

// The function of a vector of `count` numbers, lane by lane; lanes outside of `mask` are zero.
#define CAROM_WORST_LANES(name, Vector, Number, count, function)    \
  CAROM_CALLED Vector name(Vector x, unsigned mask = 0xffffffffu) { \
    Number lanes[count];                                            \
    memcpy(lanes, &x, sizeof x);                                    \
    for (int i = 0; i < count; ++i) {                               \
      lanes[i] = (mask >> i & 1u) != 0 ? function(lanes[i]) : 0;    \
    }                                                               \
    memcpy(&x, lanes, sizeof x);                                    \
    return x;                                                       \
  }

CAROM_WORST_LANES(sse_ps, __m128, float, 4, of_sse)
CAROM_CALLED __m128 sse_ss(__m128 x) {
  float lanes[4];
  memcpy(lanes, &x, sizeof x);
  lanes[0] = of_sse(lanes[0]);
  memcpy(&x, lanes, sizeof x);
  return x;
}
#ifdef __AVX__
CAROM_WORST_LANES(avx_ps, __m256, float, 8, of_sse)
#endif
#ifdef __AVX512F__
CAROM_WORST_LANES(fourteen_pd, __m512d, double, 8, of_fourteen_bits)
CAROM_WORST_LANES(fourteen_ps, __m512, float, 16, of_fourteen_bits)
CAROM_CALLED __m128d fourteen_sd(__m128d upper, __m128d x) {
  return _mm_move_sd(upper, _mm_set_sd(of_fourteen_bits(_mm_cvtsd_f64(x))));
}
#endif
#ifdef __AVX512VL__
CAROM_WORST_LANES(fourteen_pd, __m128d, double, 2, of_fourteen_bits)
CAROM_WORST_LANES(fourteen_pd, __m256d, double, 4, of_fourteen_bits)
CAROM_WORST_LANES(fourteen_ps, __m128, float, 4, of_fourteen_bits)
CAROM_WORST_LANES(fourteen_ps, __m256, float, 8, of_fourteen_bits)
#endif
#undef CAROM_WORST_LANES
#undef CAROM_CALLED

}  // namespace carom_worst

#undef _mm_rsqrt_ss
#undef _mm_rsqrt_ps
#undef _mm256_rsqrt_ps
#undef _mm_rsqrt14_sd
#undef _mm_rsqrt14_pd
#undef _mm_rsqrt14_ps
#undef _mm256_rsqrt14_pd
#undef _mm256_rsqrt14_ps
#undef _mm512_maskz_rsqrt14_pd
#undef _mm512_maskz_rsqrt14_ps
#define _mm_rsqrt_ss(x) ::carom_worst::sse_ss(x)
#define _mm_rsqrt_ps(x) ::carom_worst::sse_ps(x)
#define _mm256_rsqrt_ps(x) ::carom_worst::avx_ps(x)
#define _mm_rsqrt14_sd(upper, x) ::carom_worst::fourteen_sd(upper, x)
#define _mm_rsqrt14_pd(x) ::carom_worst::fourteen_pd(x)
#define _mm_rsqrt14_ps(x) ::carom_worst::fourteen_ps(x)
#define _mm256_rsqrt14_pd(x) ::carom_worst::fourteen_pd(x)
#define _mm256_rsqrt14_ps(x) ::carom_worst::fourteen_ps(x)
#define _mm512_maskz_rsqrt14_pd(mask, x) ::carom_worst::fourteen_pd(x, mask)
#define _mm512_maskz_rsqrt14_ps(mask, x) ::carom_worst::fourteen_ps(x, mask)

#endif  // CAROM_BENCH_WORST_ESTIMATES_H_
