// Kernels timed against each other: in turn, in short blocks, on the same cases.
#ifndef CAROM_BENCH_TIMING_H_
#define CAROM_BENCH_TIMING_H_

#include <cstddef>
#include <random>
#include <string>
#include <vector>

#include "clock.h"
#include "core_watch.h"
#include "kernel_library.h"
#include "workload.h"

namespace carom_bench {

enum class Mode { kThroughput, kBatch, kLatency };

/// A kernel in a comparison. The library must outlive it.
struct Entrant {
  std::string name;
  const KernelLibrary* library;
  Mode mode;
};

/// What was measured of an entrant: per round, for one collision.
struct Series {
  std::vector<double> ns, ticks;
  std::vector<double> looks;  ///< at the core, the worse of before and after a block
  std::size_t window = 0;     ///< collisions in a block
};

/// Entrants that are timed in every round. The baseline is timed twice a round, the second time as
/// a control: whatever lies between the two is noise.
class Comparison {
 public:
  /// `baseline` is an index of `entrants`; `block_ns` is what a block should take. Calibrates,
  /// which warms up. The workload and the watch must outlive this.
  Comparison(std::vector<Entrant> entrants, std::size_t baseline, Workload* workload,
             CoreWatch* core, double block_ns);

  /// A block of each entrant, from first to last in even rounds, from last to first in odd ones.
  /// Each waits for the core to be alone, and is warmed up, untimed: what is wanted is the time of
  /// many collisions in a row.
  /// Entrants that need at least a quarter of the baseline's block take the baseline's window of
  /// cases; faster ones take a longer window around it.
  void round(std::size_t number);

  /// As given, then the control.
  const std::vector<Entrant>& entrants() const { return entrants_; }
  const std::vector<Series>& series() const { return series_; }

 private:
  /// Each time at another place of the stack: how it lies to the constants and arrays, whose
  /// addresses may look the same by their last 12 bits, is worth 4 % and differs by process.
  Spent block(const Entrant& entrant, const Window& window);
  Spent called(const Entrant& entrant, const Window& window);
  double least_of_blocks(const Entrant& entrant, const Window& window);  // ns
  double ns_per_collision(const Entrant& entrant);
  void calibrate();

  std::vector<Entrant> entrants_;
  std::vector<Series> series_;
  std::size_t baseline_;
  Workload* workload_;
  CoreWatch* core_;
  double block_ns_;
  std::minstd_rand stack_;
};

}  // namespace carom_bench

#endif  // CAROM_BENCH_TIMING_H_
