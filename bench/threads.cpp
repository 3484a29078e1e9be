// An example of sharing a batch: kernels keep no state, so each thread takes a part of the arrays.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "batch.h"
#include "case_rows.h"
#include "clock.h"
#include "commands.h"
#include "kernel_library.h"

namespace carom_bench {
namespace {

// Thread t of `threads` takes [n t / threads, n (t + 1) / threads); the caller's thread is one of
// them.
void call_shared(Batch* batch, BatchFunction function, unsigned threads) {
  const std::size_t n = batch->size();
  const auto part = [&](unsigned t) {
    const std::size_t start = n * t / threads;
    batch->call(function, start, n * (t + 1) / threads - start);
  };
  std::vector<std::thread> others;
  for (unsigned t = 1; t < threads; ++t) others.emplace_back(part, t);
  part(0);
  for (std::thread& other : others) other.join();
}

double best_ns(Batch* batch, BatchFunction function, unsigned threads, int rounds) {
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const Stopwatch watch;
    call_shared(batch, function, threads);
    best = std::min(best, watch.spent().ns);
  }
  return best / static_cast<double>(batch->size());
}

bool same_outcomes(const Batch& a, const Batch& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    const OutcomeRow one = a.outcome(i), other = b.outcome(i);
    // Bits are meant: NaN is itself, and 0 is not -0.
    // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
    if (std::memcmp(one.data(), other.data(), sizeof(one)) != 0) return false;
  }
  return true;
}

std::vector<CaseRow> repeated(const std::vector<CaseRow>& rows, std::size_t count) {
  std::vector<CaseRow> all;
  all.reserve(count);
  while (all.size() < count) all.push_back(rows[all.size() % rows.size()]);
  return all;
}

}  // namespace

void threads(const Threads& options) {
  const KernelLibrary library(options.kernel);
  const auto rows = with_shared_parameters(read_case_rows(options.cases));
  Batch alone(repeated(rows, options.count));
  const double single = best_ns(&alone, library.batch(), 1, options.rounds);
  const unsigned most = options.most != 0 ? options.most : std::thread::hardware_concurrency();
  for (unsigned count = 1; count <= std::max(most, 1u); ++count) {
    Batch shared(repeated(rows, options.count));
    const double ns = best_ns(&shared, library.batch(), count, options.rounds);
    if (!same_outcomes(alone, shared)) {
      throw std::runtime_error(std::to_string(count) + " threads give other outcomes than one");
    }
    std::cout << count << " threads: " << ns << " ns a collision, " << single / ns
              << " times as fast as one\n";
  }
}

}  // namespace carom_bench
