// Memory of the arrays that collide_batch makes. New pages take the system longer to clear than
// lanes take to fill them, so a kernel keeps the block whose array was dropped last and gives it
// out again. An array never holds more than its own size: what a block has beyond it is given back,
// and with the kernel goes what it kept, whatever arrays are still there.
#ifndef CAROM_PYTHON_RESULT_MEMORY_H_
#define CAROM_PYTHON_RESULT_MEMORY_H_

#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace carom {

/// Bytes at the start of a page, or of a huge one where they are many; their values are undefined.
class Block {
 public:
  explicit Block(std::size_t bytes) : bytes_(bytes) {
    const std::size_t page = bytes < kHuge ? kPage : kHuge;
    start_.reset(std::aligned_alloc(page, (bytes / page + 1) * page));
    if (start_ == nullptr) throw std::bad_alloc();
#if defined(__linux__)
    if (page == kHuge) madvise(start_.get(), bytes, MADV_HUGEPAGE);  // advice: it may be refused
#endif
  }

  void* start() { return start_.get(); }
  std::size_t bytes() const { return bytes_; }

  /// Gives the pages beyond the first `used` bytes back to the system, until they are written
  /// again.
  void give_back(std::size_t used) {
#if defined(__linux__)
    const std::size_t first = (used + kPage - 1) / kPage * kPage;
    if (first < bytes_) {
      madvise(static_cast<char*>(start_.get()) + first, bytes_ - first, MADV_DONTNEED);
    }
#else
    static_cast<void>(used);
#endif
  }

 private:
  static constexpr std::size_t kPage = std::size_t{1} << 12, kHuge = std::size_t{1} << 21;
  struct Free {
    void operator()(void* start) const { std::free(start); }
  };
  std::size_t bytes_;
  std::unique_ptr<void, Free> start_;
};

/// One spare block. Whoever calls holds the interpreter's lock.
class Spare {
 public:
  /// A block of at least so many bytes: the spare one where it fits and is at most twice as large.
  std::unique_ptr<Block> take(std::size_t bytes) {
    if (block_ != nullptr && block_->bytes() >= bytes && block_->bytes() / 2 <= bytes) {
      block_->give_back(bytes);
      return std::move(block_);
    }
    return std::make_unique<Block>(bytes);
  }
  void keep(std::unique_ptr<Block> block) { block_ = std::move(block); }

 private:
  std::unique_ptr<Block> block_;
};

/// A block in use by an array; when that goes, it is the spare one of its kernel, if that is there.
class Lent {
 public:
  Lent(const std::shared_ptr<Spare>& home, std::size_t bytes)
      : home_(home), block_(home->take(bytes)) {}
  ~Lent() {
    if (const std::shared_ptr<Spare> home = home_.lock()) home->keep(std::move(block_));
  }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;

  Block& block() { return *block_; }

 private:
  std::weak_ptr<Spare> home_;  // an array keeps no spare block alive
  std::unique_ptr<Block> block_;
};

}  // namespace carom

#endif  // CAROM_PYTHON_RESULT_MEMORY_H_
