// The kernels that the module carries; the table itself is generated (generator/clients).
#ifndef CAROM_PYTHON_KERNEL_TABLE_H_
#define CAROM_PYTHON_KERNEL_TABLE_H_

#include <cstddef>

namespace carom {

/// As carom_params of the scene `any`: m, kg, and four coefficients from 0 to 1. M1, the mass of
/// ball 1, is for rows that are `unequal` alone; there M is that of ball 2.
struct Parameters {
  double R, M, u_s1, u_s2, u_b, e_b, M1;
};

/// The C ABI of a kernel (carom.h), with the parameters of every prefix as one type.
struct Functions {
  int (*collide)(const Parameters& p, const double* ball1, const double* ball2, double* out1,
                 double* out2);
  std::size_t (*batch)(const Parameters& p, const double* u_b, std::size_t n,
                       const double* const* in, double* const* out, unsigned char* status);
  const char* (*name)();
};

/// One kernel: for a model and either fixed steps or an error budget, on one target.
struct Row {
  const char* model;
  const char* target;
  bool (*runs)();  // does this CPU have what the target needs?
  bool unequal;    // of balls of two masses?
  int steps;       // N of a fixed-step kernel, else 0
  double budget;   // of an exact kernel, else 0
  int lanes;       // numbers in a vector of its batches
  Functions functions;
  int (*collide_steps)(const Parameters& p, const double* ball1, const double* ball2, double* out1,
                       double* out2, int steps);  // fixed-step kernels alone
};

extern const Row kRows[];
extern const std::size_t kRowCount;

/// As carom_cushion_params of the scene `any`: m, kg, three coefficients from 0 to 1, m.
struct CushionParameters {
  double R, M, u_s, u_w, e_c, h;
};

/// The C ABI of a kernel of a ball and a cushion.
struct CushionFunctions {
  int (*collide)(const CushionParameters& p, const double* ball, const double* normal, double* out);
  std::size_t (*batch)(const CushionParameters& p, const double* u_w, std::size_t n,
                       const double* const* in, double* const* out, unsigned char* status);
  const char* (*name)();
};

/// As Row, of a ball and a cushion.
struct CushionRow {
  const char* model;
  const char* target;
  bool (*runs)();
  int steps;
  double budget;
  int lanes;
  CushionFunctions functions;
  int (*collide_steps)(const CushionParameters& p, const double* ball, const double* normal,
                       double* out, int steps);
};

extern const CushionRow kCushionRows[];
extern const std::size_t kCushionRowCount;

/// What kernels take: the numbers of Parameters in their order, then how heavy ball 1 may be.
struct Range {
  const char* name;
  double low, high;
};

constexpr std::size_t kRangeCount = 6;
extern const Range kRanges[kRangeCount];
extern const Range kMassRatio;

constexpr std::size_t kCushionRangeCount = 6;
extern const Range kCushionRanges[kCushionRangeCount];

}  // namespace carom

#endif  // CAROM_PYTHON_KERNEL_TABLE_H_
