// Two balls: the columns of cases and outcomes, and how a kernel is called.
#ifndef CAROM_BENCH_IMPACTS_BALL_BALL_COLUMNS_H_
#define CAROM_BENCH_IMPACTS_BALL_BALL_COLUMNS_H_

#include <array>
#include <cstddef>

namespace carom_bench {

/// Columns of a case: R (m), M (kg), u_s1, u_s2, u_b, e_b, then position (m), velocity (m/s) and
/// angular velocity (rad/s) of ball 1 and of ball 2, three each.
enum CaseColumn : std::size_t {
  kR,
  kM,
  kUs1,
  kUs2,
  kUb,
  kEb,
  kBall1,
  kBall2 = kBall1 + 9,
  kCaseColumns = kBall2 + 9
};

constexpr std::array<const char*, 6> kParameterNames{"R", "M", "u_s1", "u_s2", "u_b", "e_b"};
constexpr std::size_t kVaried = kUb;  ///< of which a batch may have one for each collision
constexpr std::size_t kRadius = kR;   ///< a new one scales the spins
constexpr std::array<std::size_t, 6> kSpins{12, 13, 14, 21, 22, 23};

/// What a call gives: out1 and out2, which may be the two balls that it is given.
constexpr std::size_t kResults = 18;
/// Which of its numbers an outcome has, in the order v1, w1, v2, w2; and which of in[18] each
/// replaces.
constexpr std::array<std::size_t, 12> kChanged{3, 4, 5, 6, 7, 8, 12, 13, 14, 15, 16, 17};
/// Columns that wait for the last outcome where each collision does, ball 1's x and v_x, and the
/// results that they wait for: v1x and w2z.
constexpr std::array<std::size_t, 2> kFed{kBall1, kBall1 + 3}, kFeeding{3, 17};

/// One collision. params: R (m), M (kg), u_s1, u_s2, u_b, e_b; balls as in carom.h. Returns the
/// status of carom.h.
using CollideFunction = int (*)(const double params[6], const double ball1[9],
                                const double ball2[9], double out1[9], double out2[9]);
/// As CollideFunction, with `steps` fixed steps instead of the number that the kernel was made for.
using StepsFunction = int (*)(const double params[6], const double ball1[9], const double ball2[9],
                              double out1[9], double out2[9], int steps);

/// A call for one case; `results` may be the place in the case that they replace.
inline int call(CollideFunction collide, const double* row, double* results) {
  return collide(row, row + kBall1, row + kBall2, results, results + 9);
}
inline int call(StepsFunction collide, int steps, const double* row, double* results) {
  return collide(row, row + kBall1, row + kBall2, results, results + 9, steps);
}

}  // namespace carom_bench

#endif  // CAROM_BENCH_IMPACTS_BALL_BALL_COLUMNS_H_
