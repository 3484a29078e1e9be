// Batches in any layout: a line of numbers for each column of a kernel, with a step from one
// collision to the next. Lines of step 1 are used where they lie; others are gathered in blocks.
#ifndef CAROM_PYTHON_COLUMNS_H_
#define CAROM_PYTHON_COLUMNS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace carom {

template <class Value, std::size_t kCount>
struct Lines {
  std::array<Value*, kCount> at;
  std::array<std::int64_t, kCount> step;

  bool contiguous() const {
    return std::all_of(step.begin(), step.end(), [](std::int64_t each) { return each == 1; });
  }

  /// Lines `first` to `first + count`, of numbers that are `between` apart.
  void set(std::size_t first, std::size_t count, Value* start, std::int64_t between,
           std::int64_t to_next) {
    for (std::size_t j = 0; j < count; ++j) {
      at[first + j] = start + static_cast<std::int64_t>(j) * between;
      step[first + j] = to_next;
    }
  }
};

/// Lines of the vectors `first` to `end` of balls (n, vectors, 3), from line `at` on.
template <class Value, std::size_t kCount, class Array>
void set_vectors(Lines<Value, kCount>& lines, std::size_t at, const Array& balls, std::size_t first,
                 std::size_t end) {
  for (std::size_t row = first; row < end; ++row) {
    Value* const start = balls.data() + static_cast<std::int64_t>(row) * balls.stride(1);
    lines.set(at + 3 * (row - first), 3, start, balls.stride(2), balls.stride(0));
  }
}

using Inputs = Lines<const double, 18>;
using Outputs = Lines<double, 12>;
using CushionInputs = Lines<const double, 8>;
using CushionOutputs = Lines<double, 6>;

constexpr std::size_t kBlock = 2048;  // collisions that are gathered at once: what lanes work on

/// Calls run(first, count, in, out) with columns that are contiguous, block by block.
template <std::size_t kIn, std::size_t kOut, class Run>
void in_blocks(const Lines<const double, kIn>& balls, const Lines<double, kOut>& results,
               std::size_t n, const Run& run) {
  if (balls.contiguous() && results.contiguous()) {
    run(std::size_t{0}, n, balls.at, results.at);
    return;
  }
  // Columns are apart by no power of two.
  std::vector<std::array<double, kBlock + 8>> block(kIn + kOut);
  std::array<const double*, kIn> in;
  std::array<double*, kOut> out;
  for (std::size_t j = 0; j < kIn; ++j) in[j] = block[j].data();
  for (std::size_t j = 0; j < kOut; ++j) out[j] = block[kIn + j].data();
  for (std::size_t first = 0; first < n; first += kBlock) {
    const std::size_t count = std::min(kBlock, n - first);
    for (std::size_t i = 0; i < count; ++i) {
      const auto place = static_cast<std::int64_t>(first + i);
      for (std::size_t j = 0; j < kIn; ++j) block[j][i] = balls.at[j][place * balls.step[j]];
    }
    run(first, count, in, out);
    for (std::size_t i = 0; i < count; ++i) {
      const auto place = static_cast<std::int64_t>(first + i);
      for (std::size_t j = 0; j < kOut; ++j) results.at[j][place * results.step[j]] = out[j][i];
    }
  }
}

}  // namespace carom

#endif  // CAROM_PYTHON_COLUMNS_H_
