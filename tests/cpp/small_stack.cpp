// small_stack KERNEL.so ROWS N: batches of 1 and of 5000 collisions in a thread whose stack is 128
// KiB, as musl's are unless a program asks for more, with a page below it that may not be touched.
// How much of it was written? ROWS: 24 doubles each, as bench/impacts/ball_ball has them.
#include <dlfcn.h>
#include <pthread.h>
#include <sys/mman.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace {

using Batch = std::size_t (*)(const void*, const double*, std::size_t, const double* const*,
                              double* const*, unsigned char*);
constexpr std::size_t kMost = 5000, kStack = 128 << 10, kPage = 64 << 10;
constexpr unsigned char kClean = 0xA5;

struct Work {
  Batch batch;
  const double* parameters;
  const double* in[18];
  double* out[12];
  std::size_t n, good;
};

void* run(void* given) {
  Work& work = *static_cast<Work*>(given);
  work.good = work.batch(work.parameters, nullptr, work.n, work.in, work.out, nullptr);
  return nullptr;
}

}  // namespace

int main(int count, char** words) {
  if (count != 4) return 2;
  void* library = dlopen(words[1], RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return std::puts(dlerror()), 2;
  const std::size_t n = std::strtoul(words[3], nullptr, 10);
  std::vector<double> rows(24 * n), columns(18 * kMost), out(12 * kMost);
  std::FILE* file = std::fopen(words[2], "rb");
  if (file == nullptr || std::fread(rows.data(), sizeof(double), rows.size(), file) != rows.size())
    return 2;
  for (std::size_t j = 0; j < 18; ++j) {
    for (std::size_t i = 0; i < kMost; ++i) columns[j * kMost + i] = rows[(i % n) * 24 + 6 + j];
  }
  Work work{};
  work.batch = reinterpret_cast<Batch>(dlsym(library, "carom_collide_batch"));
  work.parameters = rows.data();
  for (std::size_t j = 0; j < 18; ++j) work.in[j] = &columns[j * kMost];
  for (std::size_t j = 0; j < 12; ++j) work.out[j] = &out[j * kMost];
  void* whole =
      mmap(nullptr, kPage + kStack, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (whole == MAP_FAILED || mprotect(whole, kPage, PROT_NONE) != 0) return 2;
  unsigned char* stack = static_cast<unsigned char*>(whole) + kPage;
  pthread_attr_t small;
  pthread_attr_init(&small);
  if (pthread_attr_setstack(&small, stack, kStack) != 0) return 2;
  for (const std::size_t some : {std::size_t{1}, kMost}) {
    std::memset(stack, kClean, kStack);
    work.n = some;
    pthread_t thread;
    if (pthread_create(&thread, &small, run, &work) != 0) return 2;
    pthread_join(thread, nullptr);
    std::size_t clean = 0;
    while (clean < kStack && stack[clean] == kClean) ++clean;
    std::printf("ran %zu collisions, %zu of them good; took %zu bytes\n", some, work.good,
                kStack - clean);
  }
  return 0;
}
