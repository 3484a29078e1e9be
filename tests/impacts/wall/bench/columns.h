// A puck and a wall: the columns of cases and outcomes, and how a kernel is called.
#ifndef CAROM_TESTS_IMPACTS_WALL_COLUMNS_H_
#define CAROM_TESTS_IMPACTS_WALL_COLUMNS_H_

#include <array>
#include <cstddef>

namespace carom_bench {

enum CaseColumn : std::size_t { kR, kE, kPuck, kNormal = kPuck + 2, kCaseColumns = kNormal + 2 };

constexpr std::array<const char*, 2> kParameterNames{"R", "e"};
constexpr std::size_t kVaried = kE, kRadius = kR, kResults = 2;
constexpr std::array<std::size_t, 0> kSpins{};
constexpr std::array<std::size_t, 2> kChanged{0, 1};
constexpr std::array<std::size_t, 2> kFed{kPuck, kPuck + 1}, kFeeding{0, 1};

using CollideFunction = int (*)(const double params[2], const double puck[2],
                                const double normal[2], double out[2]);
using StepsFunction = int (*)(const double params[2], const double puck[2], const double normal[2],
                              double out[2], int steps);

inline int call(CollideFunction collide, const double* row, double* results) {
  return collide(row, row + kPuck, row + kNormal, results);
}
inline int call(StepsFunction collide, int steps, const double* row, double* results) {
  return collide(row, row + kPuck, row + kNormal, results, steps);
}

}  // namespace carom_bench

#endif  // CAROM_TESTS_IMPACTS_WALL_COLUMNS_H_
