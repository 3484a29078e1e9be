#include "timing.h"

#include <algorithm>
#include <utility>

namespace carom_bench {
namespace {

// Calls with the stack lower by `bytes`.
template <class Call>
__attribute__((noinline)) Spent displaced(std::size_t bytes, const Call& call) {
  volatile char* const unused = static_cast<char*>(__builtin_alloca(bytes + 1));
  unused[0] = 0;
  const Spent spent = call();
  unused[bytes] = 0;
  return spent;
}

}  // namespace

Comparison::Comparison(std::vector<Entrant> entrants, std::size_t baseline, Workload* workload,
                       CoreWatch* core, double block_ns)
    : entrants_(std::move(entrants)),
      baseline_(baseline),
      workload_(workload),
      core_(core),
      block_ns_(block_ns) {
  entrants_.push_back(entrants_.at(baseline));
  series_.resize(entrants_.size());
  calibrate();
}

Spent Comparison::block(const Entrant& entrant, const Window& window) {
  return displaced(64 * (stack_() % 64), [&] { return called(entrant, window); });
}

Spent Comparison::called(const Entrant& entrant, const Window& window) {
  switch (entrant.mode) {
    case Mode::kBatch:
      return workload_->batch(entrant.library->batch(), window);
    case Mode::kLatency:
      return workload_->latency(entrant.library->collide(), window);
    case Mode::kThroughput:
      break;
  }
  return workload_->throughput(entrant.library->collide(), window);
}

// The least of three: what else runs may stretch a block tenfold, and the window that fits such a
// block is so small that it would time a kernel cold.
double Comparison::least_of_blocks(const Entrant& entrant, const Window& window) {
  double least = block(entrant, window).ns;
  for (int i = 0; i < 2; ++i) least = std::min(least, block(entrant, window).ns);
  return least;
}

double Comparison::ns_per_collision(const Entrant& entrant) {
  std::size_t size = workload_->smallest();
  block(entrant, {0, size});
  for (;; size *= 2) {
    const double ns = least_of_blocks(entrant, {0, size});
    if (ns >= block_ns_ / 4 || size == workload_->largest()) return ns / static_cast<double>(size);
  }
}

void Comparison::calibrate() {
  std::vector<double> ns;
  for (const Entrant& entrant : entrants_) ns.push_back(ns_per_collision(entrant));
  const auto fitting = [&](double each) {
    std::size_t size = workload_->largest();
    while (size > workload_->smallest() && each * static_cast<double>(size) > 1.4 * block_ns_) {
      size /= 2;
    }
    return size;
  };
  const std::size_t shared = fitting(ns[baseline_]);
  for (std::size_t i = 0; i < ns.size(); ++i) {
    const bool shares = ns[i] >= ns[baseline_] / 4 || i == entrants_.size() - 1;
    series_[i].window = shares ? shared : std::max(shared, fitting(ns[i]));
  }
}

void Comparison::round(std::size_t number) {
  const Window shared = workload_->rotating(number, series_[baseline_].window);
  for (std::size_t k = 0; k < entrants_.size(); ++k) {
    const std::size_t i = number % 2 == 0 ? k : entrants_.size() - 1 - k;
    const bool shares = series_[i].window == shared.size;
    const Window window = shares ? shared : workload_->around(shared, series_[i].window);
    const double before = core_->wait();
    // After the others' code and data: a quarter of the block untimed, so that it is timed warm; of
    // other cases, so that their branches are not learned.
    const std::size_t some = std::max(workload_->smallest(), window.size / 4);
    block(entrants_[i], workload_->rotating((window.start + window.size) / some, some));
    const Spent spent = block(entrants_[i], window);
    series_[i].looks.push_back(std::max(before, core_->look()));
    series_[i].ns.push_back(spent.ns / static_cast<double>(window.size));
    series_[i].ticks.push_back(spent.ticks / static_cast<double>(window.size));
  }
}

}  // namespace carom_bench
