#include "clock.h"

#if defined(__linux__)
#include <sched.h>
#endif

namespace carom_bench {
namespace {

constexpr int kChains = 20000;
constexpr int kAdditions = 10;  // in a chain

// Each addition waits for the one before it, whatever the compiler would like.
std::uint64_t add_in_chains() {
  std::uint64_t x = 0;
  for (int i = 0; i < kChains; ++i) {
#if defined(__x86_64__)
    for (int j = 0; j < kAdditions; ++j) asm volatile("add $1, %0" : "+r"(x) : : "cc");
#elif defined(__aarch64__)
    for (int j = 0; j < kAdditions; ++j) asm volatile("add %0, %0, #1" : "+r"(x));
#endif
  }
  return x;
}

}  // namespace

double core_ghz() {
  double best = 0.0;
  for (int run = 0; run < 20; ++run) {
    const Stopwatch watch;
    const std::uint64_t additions = add_in_chains();
    const double ghz = static_cast<double>(additions) / watch.spent().ns;
    best = ghz > best ? ghz : best;
  }
  return best;
}

int pin_to_one_cpu() {
#if defined(__linux__)
  const int cpu = sched_getcpu();
  if (cpu < 0 || cpu >= CPU_SETSIZE) return -1;
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(cpu, &set);
  return sched_setaffinity(0, sizeof(set), &set) == 0 ? cpu : -1;
#else
  return -1;
#endif
}

}  // namespace carom_bench
