#include "parameters.h"

#include <nanobind/operators.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>

#include <utility>

namespace carom {

namespace {

constexpr const char* kText =
    "What a collision is given besides the balls: radius R (m) and mass M (kg) of both, sliding\n"
    "friction u_s1 of ball 1 and u_s2 of ball 2 with the table, friction u_b and restitution e_b\n"
    "between the balls, each from 0 to 1. M1 is the mass of ball 1 where it is another than M, "
    "from\n"
    "a tenth of M to ten times as much; it is for kernels with max_error of the models "
    "mathavan2014\n"
    "and bottom_slip, whose batches then go call by call. ValueError names a number that is out "
    "of\n"
    "its range. Parameters do not change; they compare, hash, copy and pickle by value.";

constexpr const char* kInit =
    "def __init__(self, R: float = 0.028575, M: float = 0.170097, u_s1: float = 0.2, "
    "u_s2: float = 0.2, u_b: float = 0.05, e_b: float = 0.95, *, M1: float | None = None) -> None";

constexpr const char* kReplace =
    "def replace(self, *, R: float = ..., M: float = ..., u_s1: float = ..., u_s2: float = ..., "
    "u_b: float = ..., e_b: float = ..., M1: float = ...) -> Parameters";

using State = std::pair<std::array<double, kRangeCount>, double>;

Parameters made_of(const std::array<double, kRangeCount>& v, double M1) {
  return require_in_ranges(Parameters{v[0], v[1], v[2], v[3], v[4], v[5], M1});
}

void make(Parameters* self, nb::handle R, nb::handle M, nb::handle u_s1, nb::handle u_s2,
          nb::handle u_b, nb::handle e_b, nb::handle M1) {
  const std::array<nb::handle, kRangeCount> given = {R, M, u_s1, u_s2, u_b, e_b};
  std::array<double, kRangeCount> values;
  for (std::size_t i = 0; i < kRangeCount; ++i) values[i] = number_of(given[i], kRanges[i].name);
  new (self) Parameters(made_of(values, optional_number(M1, "M1").value_or(values[1])));
}

nb::object replaced(const Parameters& p, const nb::kwargs& changes) {
  nb::dict named = keywords_of(p);
  named.update(changes);
  return nb::type<Parameters>()(**named);
}

}  // namespace

void bind_parameters(nb::module_& m) {
  nb::class_<Parameters> made(m, "Parameters", kText);
  made.def("__init__", &make, "R"_a.none() = 0.028575, "M"_a.none() = 0.170097,
           "u_s1"_a.none() = 0.2, "u_s2"_a.none() = 0.2, "u_b"_a.none() = 0.05,
           "e_b"_a.none() = 0.95, nb::kw_only(), "M1"_a = nb::none(), nb::sig(kInit))
      .def_ro("R", &Parameters::R, "radius of both balls, m")
      .def_ro("M", &Parameters::M, "mass of both balls, or of ball 2, kg")
      .def_ro("M1", &Parameters::M1, "mass of ball 1, kg")
      .def_ro("u_s1", &Parameters::u_s1, "sliding friction of ball 1 and the table")
      .def_ro("u_s2", &Parameters::u_s2, "sliding friction of ball 2 and the table")
      .def_ro("u_b", &Parameters::u_b, "friction between the balls")
      .def_ro("e_b", &Parameters::e_b, "restitution between the balls")
      .def("replace", &replaced, nb::sig(kReplace), "The same with some numbers replaced.")
      .def("__replace__", &replaced,
           nb::sig("def __replace__(self, **changes: float) -> Parameters"))
      .def(nb::self == nb::self, nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__",
           [](const Parameters& p) {
             return nb::hash(nb::make_tuple(p.R, p.M, p.u_s1, p.u_s2, p.u_b, p.e_b, p.M1));
           })
      .def("__getstate__", [](const Parameters& p) { return State(values_of(p), p.M1); })
      .def("__setstate__",
           [](Parameters& p, const State& state) {
             new (&p) Parameters(made_of(state.first, state.second));
           })
      .def("__repr__", &shown);
}

}  // namespace carom
