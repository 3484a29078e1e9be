#include "workload.h"

#include <algorithm>
#include <cstring>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

namespace carom_bench {
namespace {

// std::shuffle differs between libraries; the bias of the remainder is below 1e-15.
void shuffle(std::vector<CaseRow>* rows, std::mt19937_64* random) {
  for (std::size_t left = rows->size(); left > 1; --left) {
    std::swap((*rows)[left - 1], (*rows)[(*random)() % left]);
  }
}

std::uint64_t bits(double x) {
  std::uint64_t value;
  std::memcpy(&value, &x, sizeof(value));
  return value;
}

// As bits: adding 0.0 * carry would spread a NaN, and turn -0.0 into 0.0.
void add_bits(double* x, std::uint64_t carry) {
  const std::uint64_t sum = bits(*x) + carry;
  std::memcpy(x, &sum, sizeof(sum));
}

// A zero that the compiler does not know to be one.
std::uint64_t opaque_zero() {
  volatile std::uint64_t zero = 0;
  return zero;
}

std::vector<CaseRow> checked(std::vector<CaseRow> rows, std::size_t unit) {
  if (rows.size() < unit) {
    throw std::runtime_error("timing needs at least " + std::to_string(unit) + " cases, not " +
                             std::to_string(rows.size()));
  }
  return rows;
}

}  // namespace

std::vector<CaseRow> shuffled(std::vector<CaseRow> rows, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  shuffle(&rows, &random);
  return rows;
}

std::vector<CaseRow> shuffled_again_and_again(const std::vector<CaseRow>& rows, std::size_t times,
                                              std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<CaseRow> all, order = rows;
  for (std::size_t i = 0; i < times; ++i) {
    shuffle(&order, &random);
    all.insert(all.end(), order.begin(), order.end());
  }
  return all;
}

Workload::Workload(std::vector<CaseRow> rows, std::size_t unit)
    : rows_(checked(std::move(rows), unit)), unit_(unit), batch_(with_shared_parameters(rows_)) {}

std::size_t Workload::largest() const {
  std::size_t size = unit_;
  while (size * 2 <= rows_.size()) size *= 2;
  return size;
}

Window Workload::rotating(std::size_t round, std::size_t size) const {
  const std::size_t windows = (rows_.size() + size - 1) / size;
  return {std::min((round % windows) * size, rows_.size() - size), size};
}

Window Workload::around(const Window& inner, std::size_t size) const {
  return {std::min(inner.start / size * size, rows_.size() - size), size};
}

Spent Workload::throughput(CollideFunction collide, const Window& window) {
  Results results;
  const CaseRow* row = rows_.data() + window.start;
  const CaseRow* const end = row + window.size;
  const Stopwatch watch;
  for (; row != end; ++row) {
    call(collide, row->data(), results.data());
  }
  return watch.spent();
}

Spent Workload::batch(BatchFunction function, const Window& window) {
  const Stopwatch watch;
  batch_.call(function, window.start, window.size);
  return watch.spent();
}

Spent Workload::latency(CollideFunction collide, const Window& window) {
  Results results{};
  const std::uint64_t zero = opaque_zero();
  std::uint64_t carry = 0;
  const Stopwatch watch;
  for (std::size_t i = 0; i < window.size; ++i) {
    double* case_ = rows_[window.start + i].data();
    for (std::size_t column : kFed) add_bits(case_ + column, carry);
    call(collide, case_, results.data());
    carry = (bits(results[kFeeding[0]]) | bits(results[kFeeding[1]])) & zero;
  }
  return watch.spent();
}

}  // namespace carom_bench
