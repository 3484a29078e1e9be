// Memory of the arrays that collide_batch makes. New pages take the system longer to clear than
// lanes take to fill them, so a kernel keeps the block whose arrays were dropped last and gives it
// out again.
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

  void* at(std::size_t offset) { return static_cast<char*>(start_.get()) + offset; }
  std::size_t bytes() const { return bytes_; }

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
      return std::move(block_);
    }
    return std::make_unique<Block>(bytes);
  }
  void keep(std::unique_ptr<Block> block) { block_ = std::move(block); }

 private:
  std::unique_ptr<Block> block_;
};

/// A block in use by arrays; when the last of them goes, it is the spare one.
class Lent {
 public:
  Lent(std::shared_ptr<Spare> home, std::size_t bytes)
      : home_(std::move(home)), block_(home_->take(bytes)) {}
  ~Lent() { home_->keep(std::move(block_)); }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;

  Block& block() { return *block_; }

 private:
  std::shared_ptr<Spare> home_;
  std::unique_ptr<Block> block_;
};

}  // namespace carom

#endif  // CAROM_PYTHON_RESULT_MEMORY_H_
