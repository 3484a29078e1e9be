// carom.Kernel: one kernel of the table, called with what Python gives.
#ifndef CAROM_PYTHON_KERNEL_H_
#define CAROM_PYTHON_KERNEL_H_

#include <array>
#include <cstddef>
#include <memory>

#include "row_kernel.h"

namespace carom {

class Kernel : public RowKernel<Row> {
 public:
  explicit Kernel(const Request& request);

  nb::tuple collide(nb::handle parameters, nb::handle ball1, nb::handle ball2) const;
  Status collide_into(nb::handle parameters, nb::handle ball1, nb::handle ball2, nb::handle out1,
                      nb::handle out2) const;
  /// `balls`: (18, n), or (n, 18), whose results are (n, 12).
  nb::tuple collide_batch(nb::handle parameters, nb::handle balls, nb::handle u_b, nb::handle out,
                          nb::handle status) const;
  /// Two arrays (n, 3, 3), as are the results.
  nb::tuple collide_pairs(nb::handle parameters, nb::handle ball1, nb::handle ball2, nb::handle u_b,
                          nb::handle status) const;

 private:
  const Row& row_for(const Parameters& p) const;
  int one(const Parameters& p, const double* ball1, const double* ball2, double* out1,
          double* out2) const;
  int one_call(const Parameters& p, const double* ball1, const double* ball2, double* out1,
               double* out2) const;
  void batch(Parameters p, nb::handle u_b, const Inputs& in, const Outputs& out,
             Statuses status) const;
  void run(const Row& row, const Parameters& p, const double* u_b, std::size_t n,
           const std::array<const double*, 18>& in, const std::array<double*, 12>& out,
           unsigned char* status) const;

  const Row* unequal_;  // for balls of two masses, or nullptr
  Memory spare_out2_ = std::make_shared<Spare>();
};

void bind_kernel(nb::module_& m);

}  // namespace carom

#endif  // CAROM_PYTHON_KERNEL_H_
