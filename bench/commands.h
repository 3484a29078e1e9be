// The subcommands of carom_bench. Each throws std::runtime_error with one line that says which file
// or value is wrong.
#ifndef CAROM_BENCH_COMMANDS_H_
#define CAROM_BENCH_COMMANDS_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "impact.h"

namespace carom_bench {

/// Writes random cases, with chosen parameters set to one value for all.
struct MakeCases {
  bool mixed = true;  ///< the mixture of real shots and hard kinds; else all kinds in turn
  std::uint64_t seed = 1;
  std::size_t count = 4096;
  std::string out;
  std::string kinds;               ///< file for the kinds, one a line; empty: none
  std::vector<std::string> fixed;  ///< "R=0.028575"
};
void make_cases(const MakeCases& options);

/// Computes what must come out, by the oracles.
struct Expect {
  std::string cases, out;
  Asked asked;
  std::vector<std::string> more;  ///< "mass_ratio=2"
  unsigned threads = 0;           ///< 0: one a core
};
void expect(const Expect& options);

/// Runs a kernel on every case.
struct Run {
  std::string kernel, cases, out;
  int steps = 0;          ///< 0: as the kernel was made
  bool batch = false;     ///< through the batch function, cases with equal parameters together
  bool in_place = false;  ///< the outcome overwrites the input
  std::string trace;      ///< file for the blocks of code that ran, uint32 each; empty: none
};
void run(const Run& options);

/// Times the kernels of a plan against each other.
struct Time {
  std::string plan, result;
};
void time_plan(const Time& options);

/// Shares a batch over threads, one to as many as there are cores, and prints how that scales.
/// Throws too where the outcomes differ from those of one thread.
struct Threads {
  std::string kernel, cases;
  std::size_t count = 32768;  ///< collisions in the batch, the cases over and over
  int rounds = 30;            ///< the best of them counts
  unsigned most = 0;          ///< threads; 0: one a core
};
void threads(const Threads& options);

}  // namespace carom_bench

#endif  // CAROM_BENCH_COMMANDS_H_
