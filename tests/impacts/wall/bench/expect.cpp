#include "impact.h"

namespace carom_bench {

SolveAll solver(const Asked& /*asked*/) {
  return each([](const CaseRow& row) {
    const long double x = row[kPuck], y = row[kPuck + 1], n_x = row[kNormal],
                      n_y = row[kNormal + 1];
    const long double v_n = x * n_x + y * n_y, change = v_n > 0 ? (1 + row[kE]) * v_n : 0;
    return ExpectedRow{static_cast<double>(x - change * n_x), static_cast<double>(y - change * n_y),
                       v_n > 0 ? 0.0 : 1.0, 0.0};
  });
}

}  // namespace carom_bench
