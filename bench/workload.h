// Cases to time kernels on, and the loops that are timed.
#ifndef CAROM_BENCH_WORKLOAD_H_
#define CAROM_BENCH_WORKLOAD_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "batch.h"
#include "case_rows.h"
#include "clock.h"
#include "kernel_library.h"

namespace carom_bench {

/// The rows in random order; the same for the same seed, with every standard library.
std::vector<CaseRow> shuffled(std::vector<CaseRow> rows, std::uint64_t seed);

/// The rows `times` times over, each time in another order.
std::vector<CaseRow> shuffled_again_and_again(const std::vector<CaseRow>& rows, std::size_t times,
                                              std::uint64_t seed);

/// A run of consecutive cases.
struct Window {
  std::size_t start, size;
};

/// A list of cases that windows are cut from. Windows have `unit` times a power of two cases.
class Workload {
 public:
  /// At least `unit` rows. Throws std::runtime_error if there are fewer.
  Workload(std::vector<CaseRow> rows, std::size_t unit);

  std::size_t size() const { return rows_.size(); }
  std::size_t smallest() const { return unit_; }
  std::size_t largest() const;

  /// The window of `size` for a round: all of the list in turn.
  Window rotating(std::size_t round, std::size_t size) const;
  /// The window of `size`, at least as large as `inner`, that holds it.
  Window around(const Window& inner, std::size_t size) const;

  /// Collisions independent of each other.
  Spent throughput(CollideFunction collide, const Window& window);
  /// The same by a batch function, all with the parameters of the list's first case but the varied
  /// one.
  Spent batch(BatchFunction function, const Window& window);
  /// Each collision waits for the last one's outcome: columns kFed are changed by a zero that is
  /// made from it.
  Spent latency(CollideFunction collide, const Window& window);

 private:
  std::vector<CaseRow> rows_;
  std::size_t unit_;
  Batch batch_;
};

}  // namespace carom_bench

#endif  // CAROM_BENCH_WORKLOAD_H_
