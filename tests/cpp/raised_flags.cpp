// raised_flags KERNEL.so ROWS N [trap]: which floating-point exceptions do calls and batches of N
// cases raise? ROWS: 24 doubles each, as bench/impacts/ball_ball has them. With `trap` they are
// unmasked: the process dies of the first.
#include <dlfcn.h>
#include <fenv.h>

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

namespace {

struct Params {
  double R, M, u_s1, u_s2, u_b, e_b;
};
using Call = int (*)(const Params*, const double*, const double*, double*, double*);
using Batch = std::size_t (*)(const Params*, const double*, std::size_t, const double* const*,
                              double* const*, unsigned char*);
constexpr int kBad = FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW;

int raised_by_call(Call call, const double* row, int* status) {
  Params p;
  std::memcpy(&p, row, sizeof p);
  double one[9], two[9];
  feclearexcept(FE_ALL_EXCEPT);
  *status = call(&p, row + 6, row + 15, one, two);
  return fetestexcept(kBad);
}

// `n` cases from `first` on, with the parameters of the first of them but each its own u_b.
int raised_by_batch(Batch batch, const std::vector<double>& rows, std::size_t first,
                    std::size_t n) {
  std::vector<double> in(18 * n), out(12 * n), u_b(n);
  std::vector<unsigned char> status(n);
  const double* from[18];
  double* to[12];
  for (std::size_t j = 0; j < 18; ++j) {
    from[j] = &in[j * n];
    for (std::size_t i = 0; i < n; ++i) in[j * n + i] = rows[(first + i) * 24 + 6 + j];
  }
  for (std::size_t j = 0; j < 12; ++j) to[j] = &out[j * n];
  for (std::size_t i = 0; i < n; ++i) u_b[i] = rows[(first + i) * 24 + 4];
  Params p;
  std::memcpy(&p, &rows[first * 24], sizeof p);
  feclearexcept(FE_ALL_EXCEPT);
  batch(&p, u_b.data(), n, from, to, status.data());
  return fetestexcept(kBad);
}

void say(const char* what, std::size_t where, int flags) {
  std::printf("%s %zu:%s%s%s\n", what, where, flags & FE_INVALID ? " invalid" : "",
              flags & FE_DIVBYZERO ? " division" : "", flags & FE_OVERFLOW ? " overflow" : "");
}

}  // namespace

int main(int count, char** words) {
  if (count < 4) return 2;
  void* library = dlopen(words[1], RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) return std::puts(dlerror()), 2;
  const auto call = reinterpret_cast<Call>(dlsym(library, "carom_collide"));
  const auto batch = reinterpret_cast<Batch>(dlsym(library, "carom_collide_batch"));
  const std::size_t n = std::strtoul(words[3], nullptr, 10);
  std::vector<double> rows(24 * n);
  std::FILE* file = std::fopen(words[2], "rb");
  if (file == nullptr || std::fread(rows.data(), sizeof(double), rows.size(), file) != rows.size())
    return 2;

  int calls = 0, batches = 0;
  std::size_t statuses[5] = {};
  for (std::size_t i = 0; i < n; ++i) {
    int status;
    if (const int flags = raised_by_call(call, &rows[24 * i], &status)) {
      if (calls++ < 5) say("call", i, flags);
    }
    ++statuses[status];
  }
  if (count > 4) feenableexcept(kBad);
  const auto try_batch = [&](std::size_t first, std::size_t some) {
    if (const int flags = raised_by_batch(batch, rows, first, some)) {
      if (batches++ < 5) std::printf("n = %zu, ", some), say("batch from", first, flags);
    }
  };
  for (std::size_t some = 1; some <= 70; ++some) try_batch((some * 37) % (n - some), some);
  for (std::size_t i = 0; i < n; i += 7) try_batch(i, 1);
  try_batch(0, n);
  std::printf("%zu cases (status 0: %zu, 1: %zu, 2: %zu, 3: %zu): %d calls and %d batches raise\n",
              n, statuses[0], statuses[1], statuses[2], statuses[3], calls, batches);
  return calls + batches > 0;
}
