// What JavaScript calls: the table of kernels by row, and numbers through one stretch of memory.
#include "kernel_table.h"

#define CAROM_EXPORT(name) extern "C" __attribute__((export_name(#name), visibility("default")))

extern "C" unsigned char __heap_base;  // where the linker's own data ends

namespace {

constexpr std::size_t kInputs = 18, kOutputs = 12;
constexpr std::size_t kCushionInputs = 8, kCushionOutputs = 6;

std::size_t length(const char* text) {
  std::size_t n = 0;
  while (text[n] != '\0') ++n;
  return n;
}

}  // namespace

CAROM_EXPORT(rows) std::size_t rows() { return carom::kRowCount; }
CAROM_EXPORT(model) const char* model(std::size_t row) { return carom::kRows[row].model; }
CAROM_EXPORT(kernel) const char* kernel(std::size_t row) {
  return carom::kRows[row].functions.name();
}
CAROM_EXPORT(steps) int steps(std::size_t row) { return carom::kRows[row].steps; }
CAROM_EXPORT(budget) double budget(std::size_t row) { return carom::kRows[row].budget; }
CAROM_EXPORT(length) std::size_t text_length(const char* text) { return length(text); }

/// Where JavaScript may write: from here to the end of the memory, which it grows as it needs.
CAROM_EXPORT(place) unsigned char* place() {
  const auto at = reinterpret_cast<std::size_t>(&__heap_base);
  return reinterpret_cast<unsigned char*>((at + 15) / 16 * 16);
}

/// One collision in place: `balls` is 18 numbers. `steps` 0: the kernel's own number.
CAROM_EXPORT(collide)
int collide(std::size_t row, const carom::Parameters* p, double* balls, int steps) {
  const carom::Row& r = carom::kRows[row];
  double *const one = balls, *const two = balls + kInputs / 2;
  if (steps > 0) return r.collide_steps(*p, one, two, one, two, steps);
  return r.functions.collide(*p, one, two, one, two);
}

/// n collisions: columns of n numbers one after the other, 18 in and 12 out; how many were OK.
CAROM_EXPORT(collide_batch)
std::size_t collide_batch(std::size_t row, const carom::Parameters* p, std::size_t n,
                          const double* in, double* out, unsigned char* status) {
  const double* columns[kInputs];
  double* outcomes[kOutputs];
  for (std::size_t j = 0; j < kInputs; ++j) columns[j] = in + j * n;
  for (std::size_t j = 0; j < kOutputs; ++j) outcomes[j] = out + j * n;
  return carom::kRows[row].functions.batch(*p, nullptr, n, columns, outcomes, status);
}

// The same of a ball and a cushion.
CAROM_EXPORT(cushion_rows) std::size_t cushion_rows() { return carom::kCushionRowCount; }
CAROM_EXPORT(cushion_model) const char* cushion_model(std::size_t row) {
  return carom::kCushionRows[row].model;
}
CAROM_EXPORT(cushion_kernel) const char* cushion_kernel(std::size_t row) {
  return carom::kCushionRows[row].functions.name();
}
CAROM_EXPORT(cushion_steps) int cushion_steps(std::size_t row) {
  return carom::kCushionRows[row].steps;
}
CAROM_EXPORT(cushion_budget) double cushion_budget(std::size_t row) {
  return carom::kCushionRows[row].budget;
}

/// One impact in place: `ball` is 6 numbers, then 2 of the normal.
CAROM_EXPORT(cushion_collide)
int cushion_collide(std::size_t row, const carom::CushionParameters* p, double* ball, int steps) {
  const carom::CushionRow& r = carom::kCushionRows[row];
  const double* const normal = ball + kCushionOutputs;
  if (steps > 0) return r.collide_steps(*p, ball, normal, ball, steps);
  return r.functions.collide(*p, ball, normal, ball);
}

/// n impacts: columns of n numbers one after the other, 8 in and 6 out; how many were OK.
CAROM_EXPORT(cushion_collide_batch)
std::size_t cushion_collide_batch(std::size_t row, const carom::CushionParameters* p, std::size_t n,
                                  const double* in, double* out, unsigned char* status) {
  const double* columns[kCushionInputs];
  double* outcomes[kCushionOutputs];
  for (std::size_t j = 0; j < kCushionInputs; ++j) columns[j] = in + j * n;
  for (std::size_t j = 0; j < kCushionOutputs; ++j) outcomes[j] = out + j * n;
  return carom::kCushionRows[row].functions.batch(*p, nullptr, n, columns, outcomes, status);
}
