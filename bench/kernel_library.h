// A candidate kernel in a shared library.
#ifndef CAROM_BENCH_KERNEL_LIBRARY_H_
#define CAROM_BENCH_KERNEL_LIBRARY_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "columns.h"

namespace carom_bench {

/// n collisions with the same parameters, but for the varied one, one each unless null. Structure
/// of arrays as in carom.h. Returns how many have status 0.
using BatchFunction = std::size_t (*)(const double* params, const double* varied, std::size_t n,
                                      const double* const* in, double* const* out,
                                      unsigned char* status);
/// Of a library with a trace: where the blocks of code that ran so far stand; returns how many.
using TraceFunction = std::size_t (*)(const std::uint32_t** blocks);

/// An open shared library with the carom_probe_* functions; closed when it goes out of scope.
class KernelLibrary {
 public:
  /// Throws std::runtime_error naming the file if it cannot be loaded or has no
  /// carom_probe_collide.
  explicit KernelLibrary(const std::string& path);

  CollideFunction collide() const { return collide_; }
  /// Throws std::runtime_error if the kernel has no batch function.
  BatchFunction batch() const;
  /// Throws std::runtime_error if the kernel is no fixed-step kernel.
  StepsFunction steps() const;
  /// Throws std::runtime_error if the library keeps no trace.
  TraceFunction trace() const;
  /// The name that the kernel gives itself, or an empty string.
  std::string kernel() const;

 private:
  struct Close {
    void operator()(void* handle) const;
  };
  template <class Function>
  Function find(const char* symbol) const;
  template <class Function>
  Function need(Function function, const char* symbol) const;

  std::string path_;
  std::unique_ptr<void, Close> handle_;
  CollideFunction collide_;
};

}  // namespace carom_bench

#endif  // CAROM_BENCH_KERNEL_LIBRARY_H_
