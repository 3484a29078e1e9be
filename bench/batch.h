// Cases as the structure of arrays that batch functions take.
#ifndef CAROM_BENCH_BATCH_H_
#define CAROM_BENCH_BATCH_H_

#include <array>
#include <cstddef>
#include <new>
#include <vector>

#include "case_rows.h"
#include "kernel_library.h"

namespace carom_bench {

/// Allocates whole cache lines: a vector of doubles that straddles two costs a lane kernel up to 4
/// %, and where malloc puts an array differs by process.
template <class T>
struct CacheLines {
  using value_type = T;
  static constexpr std::align_val_t kLine{64};

  CacheLines() = default;
  template <class U>
  explicit CacheLines(const CacheLines<U>& /*other*/) {}

  T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), kLine)); }
  void deallocate(T* p, std::size_t /*n*/) { ::operator delete(p, kLine); }
  bool operator==(const CacheLines& /*other*/) const { return true; }
  bool operator!=(const CacheLines& /*other*/) const { return false; }
};

/// Collisions that share all parameters but the varied one, with room for what comes out.
class Batch {
 public:
  /// Shared parameters (the varied one is the first case's) of at least one row; the rows' own
  /// parameters, other than that, are ignored.
  explicit Batch(const std::vector<CaseRow>& rows);

  std::size_t size() const { return status_.size(); }

  /// Calls `function` on [start, start + n) and returns what it returns. `each_varied`: hand over
  /// an array of the varied parameter; otherwise null.
  std::size_t call(BatchFunction function, std::size_t start, std::size_t n,
                   bool each_varied = true);

  /// What came out for case i.
  OutcomeRow outcome(std::size_t i) const;

  /// Lets what comes out overwrite the velocities that go in, as carom.h allows.
  void alias();

 private:
  using Column = std::vector<double, CacheLines<double>>;

  const Column& outcome_column(std::size_t k) const;

  std::array<double, kParameters> params_;
  Column varied_;
  std::array<Column, kBodies> in_;
  std::array<Column, kOutcomes> out_;
  std::vector<unsigned char> status_;
  bool aliased_ = false;
};

/// The rows as they are when all take the first row's parameters but the varied one; spins are
/// scaled so that
/// R w stays what it was.
std::vector<CaseRow> with_shared_parameters(std::vector<CaseRow> rows);

/// Sets parameter `column` ; a new radius scales the spins so that R w stays
/// what it was.
void set_parameter(CaseRow* row, std::size_t column, double value);

}  // namespace carom_bench

#endif  // CAROM_BENCH_BATCH_H_
