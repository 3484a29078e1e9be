#include <nanobind/stl/array.h>

#include <cmath>

#include "cushion.h"
#include "parameters.h"

namespace carom {

namespace {

constexpr double kDegrees = 57.295779513082320877;  // of a radian
constexpr const char* kText =
    "What an impact on a cushion is given besides the ball: its radius R (m) and mass M (kg),\n"
    "sliding friction u_s with the table, friction u_w and restitution e_c with the cushion, each\n"
    "from 0 to 1, and the height h (m) of the cushion's nose above the table, from R to below 2 "
    "R.\n"
    "The nose's angle above the centre, asin(h/R - 1), and atan u_s and atan u_w are below 90\n"
    "degrees together: else compression need not end. ValueError names a number that is out of\n"
    "its range. Parameters do not change; they compare, hash, copy and pickle by value.";

constexpr const char* kInit =
    "def __init__(self, R: float = 0.028575, M: float = 0.170097, u_s: float = 0.2, "
    "u_w: float = 0.2, e_c: float = 0.85, h: float = 0.036576) -> None";

constexpr const char* kReplace =
    "def replace(self, *, R: float = ..., M: float = ..., u_s: float = ..., u_w: float = ..., "
    "e_c: float = ..., h: float = ...) -> CushionParameters";

using State = std::array<double, kCushionRangeCount>;

CushionParameters made_of(const State& v) {
  return require_in_ranges(CushionParameters{v[0], v[1], v[2], v[3], v[4], v[5]});
}

void make(CushionParameters* self, nb::handle R, nb::handle M, nb::handle u_s, nb::handle u_w,
          nb::handle e_c, nb::handle h) {
  const std::array<nb::handle, kCushionRangeCount> given = {R, M, u_s, u_w, e_c, h};
  State values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    values[i] = number_of(given[i], kCushionRanges[i].name);
  }
  new (self) CushionParameters(made_of(values));
}

nb::dict keywords_of(const CushionParameters& p) {
  nb::dict named;
  const State values = values_of(p);
  for (std::size_t i = 0; i < values.size(); ++i) named[kCushionRanges[i].name] = values[i];
  return named;
}

nb::object replaced(const CushionParameters& p, const nb::kwargs& changes) {
  nb::dict named = keywords_of(p);
  named.update(changes);
  return nb::type<CushionParameters>()(**named);
}

std::string printed(const CushionParameters& p) {
  std::string text;
  for (const auto& [name, value] : keywords_of(p)) {
    text += (text.empty() ? "" : ", ") + nb::cast<std::string>(name) + "=" + text_of(value);
  }
  return "CushionParameters(" + text + ")";
}

}  // namespace

std::array<double, kCushionRangeCount> values_of(const CushionParameters& p) {
  return {p.R, p.M, p.u_s, p.u_w, p.e_c, p.h};
}

const CushionParameters& require_in_ranges(const CushionParameters& p) {
  const State values = values_of(p);
  for (std::size_t i = 0; i < values.size(); ++i) require_in_range(values[i], kCushionRanges[i]);
  if (!(p.h >= p.R && p.h < 2.0 * p.R)) {
    refuse_value("h = " + text_of(p.h) + " is out of range: expected R = " + text_of(p.R) +
                 " to below 2 R");
  }
  const double sum = std::asin((p.h - p.R) / p.R) + std::atan(p.u_s) + std::atan(p.u_w);
  if (!(sum * kDegrees < 90.0)) {
    refuse_value("h, u_s, u_w: asin(h/R - 1) + atan u_s + atan u_w is " + limit(sum * kDegrees) +
                 " degrees; expected below 90");
  }
  return p;
}

void bind_cushion_parameters(nb::module_& m) {
  nb::class_<CushionParameters> made(m, "CushionParameters", kText);
  made.def("__init__", &make, "R"_a.none() = 0.028575, "M"_a.none() = 0.170097,
           "u_s"_a.none() = 0.2, "u_w"_a.none() = 0.2, "e_c"_a.none() = 0.85,
           "h"_a.none() = 0.036576, nb::sig(kInit))
      .def_ro("R", &CushionParameters::R, "radius of the ball, m")
      .def_ro("M", &CushionParameters::M, "mass of the ball, kg")
      .def_ro("u_s", &CushionParameters::u_s, "sliding friction of the ball and the table")
      .def_ro("u_w", &CushionParameters::u_w, "friction of the ball and the cushion")
      .def_ro("e_c", &CushionParameters::e_c, "restitution between the ball and the cushion")
      .def_ro("h", &CushionParameters::h, "height of the cushion's nose above the table, m")
      .def("replace", &replaced, nb::sig(kReplace), "The same with some numbers replaced.")
      .def("__replace__", &replaced,
           nb::sig("def __replace__(self, **changes: float) -> CushionParameters"))
      .def(
          "__eq__",
          [](const CushionParameters& a, const CushionParameters& b) {
            return values_of(a) == values_of(b);
          },
          nb::is_operator(), nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def("__hash__",
           [](const CushionParameters& p) {
             return nb::hash(nb::make_tuple(p.R, p.M, p.u_s, p.u_w, p.e_c, p.h));
           })
      .def("__getstate__", [](const CushionParameters& p) { return values_of(p); })
      .def("__setstate__", [](CushionParameters& p,
                              const State& state) { new (&p) CushionParameters(made_of(state)); })
      .def("__repr__", &printed);
}

}  // namespace carom
