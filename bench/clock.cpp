#include "clock.h"

#if defined(__linux__)
#include <sched.h>
#endif

namespace carom_bench {
namespace {

constexpr int kChains = 4000;
constexpr int kAdditions = 50;  // in a chain

// Each addition waits for the one before it. It adds a register to itself: some CPUs do without
// time what adds a constant. Returns how many there were, or 0 where it is not known how to write
// them.
double add_in_chains() {
#if defined(__x86_64__) || defined(__aarch64__)
  std::uint64_t x = 1;
  for (int i = 0; i < kChains; ++i) {
#if defined(__x86_64__)
    asm volatile(".rept 50\n\tadd %0, %0\n\t.endr" : "+r"(x) : : "cc");
#else
    asm volatile(".rept 50\n\tadd %0, %0, %0\n\t.endr" : "+r"(x));
#endif
  }
  return static_cast<double>(kChains) * kAdditions;
#else
  return 0.0;
#endif
}

}  // namespace

double core_ghz() {
  double best = 0.0;
  for (int run = 0; run < 20; ++run) {
    const Stopwatch watch;
    const double additions = add_in_chains();
    const double ghz = additions / watch.spent().ns;
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
