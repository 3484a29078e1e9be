// A ball and a cushion: the columns of cases and outcomes, and how a kernel is called.
#ifndef CAROM_BENCH_IMPACTS_BALL_CUSHION_COLUMNS_H_
#define CAROM_BENCH_IMPACTS_BALL_CUSHION_COLUMNS_H_

#include <array>
#include <cstddef>

namespace carom_bench {

/// Columns of a case: R (m), M (kg), u_s at the table, u_w at the cushion, e_c, h of the nose above
/// the table (m), then the ball's velocity (m/s) and angular velocity (rad/s), three each, and the
/// level normal into the cushion, two.
enum CaseColumn : std::size_t {
  kR,
  kM,
  kUs,
  kUw,
  kEc,
  kH,
  kBall,
  kNormal = kBall + 6,
  kCaseColumns = kNormal + 2
};

constexpr std::array<const char*, 6> kParameterNames{"R", "M", "u_s", "u_w", "e_c", "h"};
constexpr std::size_t kVaried = kUw;  ///< of which a batch may have one for each collision
constexpr std::size_t kRadius = kR;   ///< a new one scales the spins
constexpr std::array<std::size_t, 3> kSpins{9, 10, 11};

/// What a call gives: out, which may be the ball that it is given.
constexpr std::size_t kResults = 6;
/// Which of its numbers an outcome has; and which of in[8] each replaces.
constexpr std::array<std::size_t, 6> kChanged{0, 1, 2, 3, 4, 5};
/// Columns that wait for the last outcome where each collision does, v_x and v_y, and the results
/// that they wait for: vx and wz.
constexpr std::array<std::size_t, 2> kFed{kBall, kBall + 1}, kFeeding{0, 5};

/// One collision. params: R (m), M (kg), u_s, u_w, e_c, h (m); ball and normal as in carom.h.
/// Returns the status of carom.h.
using CollideFunction = int (*)(const double params[6], const double ball[6],
                                const double normal[2], double out[6]);
/// As CollideFunction, with `steps` fixed steps instead of the number that the kernel was made for.
using StepsFunction = int (*)(const double params[6], const double ball[6], const double normal[2],
                              double out[6], int steps);

/// A call for one case; `results` may be the place in the case that they replace.
inline int call(CollideFunction collide, const double* row, double* results) {
  return collide(row, row + kBall, row + kNormal, results);
}
inline int call(StepsFunction collide, int steps, const double* row, double* results) {
  return collide(row, row + kBall, row + kNormal, results, steps);
}

}  // namespace carom_bench

#endif  // CAROM_BENCH_IMPACTS_BALL_CUSHION_COLUMNS_H_
