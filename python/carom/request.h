// What a kernel is asked for by, whatever collides, and which of the table answers.
#ifndef CAROM_PYTHON_REQUEST_H_
#define CAROM_PYTHON_REQUEST_H_

#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>

#include <optional>
#include <string>
#include <tuple>

#include "arguments.h"
#include "kernel_table.h"

namespace carom {

constexpr int kMostSteps = 100000000;
constexpr int kLongSteps = 10000;  // of a call that takes so long that other threads are let run

/// What became of a collision: as in carom.h.
enum class Status : int { kOk = 0, kSeparating = 1, kBadInput = 2, kTilted = 3 };

/// What a kernel is asked for by; `target` where it was named.
struct Request {
  std::string model;
  std::optional<double> max_error;
  std::optional<int> steps;
  std::optional<std::string> target;
};

/// With the default budget where no goal is named. Raises ValueError where it cannot be.
Request checked(Request request);

/// Raises ValueError naming what there is, RuntimeError where the CPU does not run it.
const Row& find_row(const Request& request);
const CushionRow& find_cushion_row(const Request& request);

/// What Python gives a kernel's constructor.
inline Request request_of(nb::handle model, nb::handle max_error, nb::handle steps,
                          nb::handle target) {
  Request request;
  if (!nb::isinstance<nb::str>(model)) refuse_type("model", model, "a str");
  request.model = nb::cast<std::string>(model);
  request.max_error = optional_number(max_error, "max_error");
  if (!steps.is_none()) {
    int value = 0;
    if (!nb::try_cast(steps, value)) {
      refuse_type("steps", steps, "a whole number, 1 to 100000000");
    }
    request.steps = value;
  }
  request.target = optional_text(target, "target");
  return request;
}

/// How a kernel of class `type` prints.
template <class AnyKernel>
std::string text_of_kernel(const char* type, const AnyKernel& kernel) {
  const std::string goal = kernel.steps() ? "steps=" + std::to_string(*kernel.steps())
                                          : "max_error=" + text_of(*kernel.max_error());
  return std::string(type) + "('" + kernel.model() + "', " + goal + ", target='" + kernel.target() +
         "')";
}

using KernelState =
    std::tuple<std::string, std::optional<double>, std::optional<int>, std::optional<std::string>>;

template <class AnyKernel>
KernelState state_of(const AnyKernel& kernel) {
  const Request& request = kernel.request();
  return {request.model, request.max_error, request.steps, request.target};
}

/// What classes of kernels have in common in Python: properties, comparison, hash, pickles, print.
template <class AnyKernel>
void bind_common(nb::class_<AnyKernel>& made, const char* type) {
  made.def_prop_ro("model", &AnyKernel::model, "the contact model")
      .def_prop_ro("target", &AnyKernel::target, "the CPU whose code runs")
      .def_prop_ro("name", &AnyKernel::name, "in the grammar of kernel names")
      .def_prop_ro("lanes", &AnyKernel::lanes, "collisions that a vector of collide_batch holds")
      .def_prop_ro("steps", &AnyKernel::steps, "N, or None")
      .def_prop_ro("max_error", &AnyKernel::max_error, "the budget that the kernel keeps, or None")
      .def(
          "__eq__", [](const AnyKernel& a, const AnyKernel& b) { return a == b; },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__",
           [](const AnyKernel& kernel) {
             return nb::hash(nb::make_tuple(kernel.model(), kernel.target(), kernel.steps(),
                                            kernel.max_error()));
           })
      .def("__getstate__", &state_of<AnyKernel>)
      .def("__setstate__",
           [](AnyKernel& kernel, const KernelState& state) {
             const auto& [model, max_error, steps, target] = state;
             new (&kernel) AnyKernel(Request{model, max_error, steps, target});
           })
      .def("__repr__", [type](const AnyKernel& kernel) { return text_of_kernel(type, kernel); });
}

}  // namespace carom

#endif  // CAROM_PYTHON_REQUEST_H_
