// Wall time and the processor's time stamp counter.
#ifndef CAROM_BENCH_CLOCK_H_
#define CAROM_BENCH_CLOCK_H_

#include <chrono>
#include <cstdint>

namespace carom_bench {

/// The time stamp counter, after all earlier instructions are done. It ticks at a constant rate,
/// not at that of the core. 0 where the processor has none that programs may read.
inline std::uint64_t ticks() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_lfence();
  const std::uint64_t now = __builtin_ia32_rdtsc();
  __builtin_ia32_lfence();
  return now;
#elif defined(__aarch64__)
  std::uint64_t now;
  asm volatile("isb\n\tmrs %0, cntvct_el0" : "=r"(now) : : "memory");
  return now;
#else
  return 0;
#endif
}

/// Time spent: nanoseconds of wall time and ticks of the time stamp counter.
struct Spent {
  double ns;
  double ticks;
};

/// Measures from its construction on.
class Stopwatch {
 public:
  Stopwatch() : start_(std::chrono::steady_clock::now()), start_ticks_(ticks()) {}

  Spent spent() const {
    const std::uint64_t now_ticks = ticks();
    const std::chrono::duration<double, std::nano> ns = std::chrono::steady_clock::now() - start_;
    return {ns.count(), static_cast<double>(now_ticks - start_ticks_)};
  }

 private:
  std::chrono::steady_clock::time_point start_;
  std::uint64_t start_ticks_;
};

/// The core's clock in GHz while it is busy: the best of several runs of additions that wait for
/// each other, one a cycle.
double core_ghz();

/// Keeps this thread on the CPU that it runs on; returns its number, or -1 if that is not possible.
int pin_to_one_cpu();

}  // namespace carom_bench

#endif  // CAROM_BENCH_CLOCK_H_
