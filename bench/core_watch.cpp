#include "core_watch.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "clock.h"

namespace carom_bench {
namespace {

constexpr int kFirstLooks = 200;
constexpr double kMuchMore = 1.35;  // beside another thread it is twice as much

#if defined(__x86_64__) || defined(__aarch64__)
constexpr int kRepeats = 200;
constexpr int kRuns = 16;

// Nanoseconds for an operation.
template <class Operations>
double each_ns(int count, const Operations& operations) {
  const Stopwatch watch;
  for (int i = 0; i < kRepeats; ++i) operations();
  return watch.spent().ns / (kRepeats * count);
}

double slot_ns() {
  return each_ns(60, [] { asm volatile(".rept 60\n\tnop\n\t.endr"); });
}

// Each waits for the one before it, one a clock: another thread does not change that.
double clock_ns() {
  std::uint64_t x = 1;
  return each_ns(10, [&x] {
#if defined(__x86_64__)
    asm volatile(".rept 10\n\tadd %0, %0\n\t.endr" : "+r"(x) : : "cc");
#else
    asm volatile(".rept 10\n\tadd %0, %0, %0\n\t.endr" : "+r"(x));
#endif
  });
}
#endif

}  // namespace

double clocks_per_operation() {
#if defined(__x86_64__) || defined(__aarch64__)
  // The mean, as another thread may work for microseconds and pause for as long; but the clock's
  // best run, as an interrupt stretches one.
  double slots = 0.0, clock = std::numeric_limits<double>::infinity();
  for (int run = 0; run < kRuns; ++run) {
    slots += slot_ns();
    clock = std::min(clock, clock_ns());
  }
  return slots / kRuns / clock;
#else
  return 1.0;
#endif
}

CoreWatch::CoreWatch(double patience_ns, std::function<double()> probe)
    : probe_(std::move(probe)),
      patience_ns_(patience_ns),
      least_(std::numeric_limits<double>::infinity()) {
  for (int i = 0; i < kFirstLooks; ++i) look();
}

double CoreWatch::look() {
  const double now = probe_();
  least_ = std::min(least_, now);
  return now;
}

double CoreWatch::wait() {
  const Stopwatch watch;
  double now = look();
  while (!alone(now) && watch.spent().ns < patience_ns_) now = look();
  patience_ns_ = std::max(0.0, patience_ns_ - watch.spent().ns);
  return now;
}

bool CoreWatch::alone(double look) const { return look <= kMuchMore * least_; }

}  // namespace carom_bench
