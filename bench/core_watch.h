// Whether a core is this thread's alone.
//
// A core's hardware threads share its issue slots and split its buffers. On a virtual machine the
// other thread may be another machine's, which no counter of this one shows; it comes and goes
// within milliseconds or stays for seconds, and a kernel takes 1.2 (scalar) to 1.5 (lanes) times as
// long beside it. What does show it is how fast operations pass that wait for nothing but a slot.
#ifndef CAROM_BENCH_CORE_WATCH_H_
#define CAROM_BENCH_CORE_WATCH_H_

#include <functional>

namespace carom_bench {

/// Clocks of the core for an operation that waits for nothing: a fourth to an eighth where the core
/// is alone, whatever its frequency. Over some 30 microseconds. 1 where it is not known how to
/// measure it.
double clocks_per_operation();

/// Looks at the core that the thread runs on, and waits until no other works on it.
class CoreWatch {
 public:
  /// `patience_ns`: what all calls of `wait` may take together. Looks for a few milliseconds, to
  /// learn what the core does when it is alone.
  explicit CoreWatch(double patience_ns, std::function<double()> probe = clocks_per_operation);

  /// Clocks an operation takes now.
  double look();
  /// Looks until the core is alone or the patience is used up; returns the last look.
  double wait();
  /// Was the core alone at a look? By the least of all looks until now; so it is always where
  /// others never leave.
  bool alone(double look) const;

 private:
  std::function<double()> probe_;
  double patience_ns_;
  double least_;
};

}  // namespace carom_bench

#endif  // CAROM_BENCH_CORE_WATCH_H_
