#include "impact.h"
#include "random.h"

namespace carom_bench {

std::vector<MadeCase> made_cases(std::uint64_t seed, std::size_t n, bool /*mixed*/) {
  Random rng(seed);
  std::vector<MadeCase> made(n);
  for (MadeCase& one : made) {
    one.kind = "plain";
    one.row[kR] = rng.uniform(0.02, 0.04);
    one.row[kE] = rng.uniform(0, 1);
    one.row[kPuck] = rng.uniform(-5, 5);
    one.row[kPuck + 1] = rng.uniform(-5, 5);
    rng.direction(&one.row[kNormal], &one.row[kNormal + 1]);
  }
  return made;
}

}  // namespace carom_bench
