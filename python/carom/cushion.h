// carom.CushionKernel and carom.CushionParameters: a ball that runs into a cushion.
#ifndef CAROM_PYTHON_CUSHION_H_
#define CAROM_PYTHON_CUSHION_H_

#include <array>
#include <cstddef>

#include "row_kernel.h"

namespace carom {

/// Raises ValueError where a number is out of its range, or several together, with its name.
const CushionParameters& require_in_ranges(const CushionParameters& p);
std::array<double, kCushionRangeCount> values_of(const CushionParameters& p);

class CushionKernel : public RowKernel<CushionRow> {
 public:
  explicit CushionKernel(const Request& request);

  nb::tuple collide(nb::handle parameters, nb::handle ball, nb::handle normal) const;
  /// `columns`: (8, n), or (n, 8), whose results are (n, 6).
  nb::tuple collide_batch(nb::handle parameters, nb::handle columns, nb::handle u_w, nb::handle out,
                          nb::handle status) const;
  /// Balls (n, 2, 3), as are the results, and normals (n, 2).
  nb::tuple collide_balls(nb::handle parameters, nb::handle balls, nb::handle normals,
                          nb::handle u_w, nb::handle status) const;

 private:
  int one(const CushionParameters& p, const double* ball, const double* normal, double* out) const;
  void batch(CushionParameters p, nb::handle u_w, const CushionInputs& in,
             const CushionOutputs& out, Statuses status) const;
  void run(const CushionParameters& p, const double* u_w, std::size_t n,
           const std::array<const double*, 8>& in, const std::array<double*, 6>& out,
           unsigned char* status) const;
};

void bind_cushion_parameters(nb::module_& m);
void bind_cushion_kernel(nb::module_& m);

}  // namespace carom

#endif  // CAROM_PYTHON_CUSHION_H_
