// What Python gives, as numbers. An error says which argument it is about, what came and what is
// needed; arrays that are as kernels want them are taken where they lie, others are converted.
#ifndef CAROM_PYTHON_ARGUMENTS_H_
#define CAROM_PYTHON_ARGUMENTS_H_

#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>

#include <optional>
#include <string>

#include "kernel_table.h"

namespace carom {

namespace nb = nanobind;
using namespace nb::literals;

using BallArray = nb::ndarray<const double, nb::shape<3, 3>, nb::c_contig, nb::device::cpu>;
using BallPlace = nb::ndarray<double, nb::shape<3, 3>, nb::c_contig, nb::device::cpu>;
using Numbers = nb::ndarray<const double, nb::device::cpu>;
using Places = nb::ndarray<double, nb::device::cpu>;
using Statuses = nb::ndarray<unsigned char, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

/// As Python prints it.
inline std::string text_of(nb::handle value) {
  return nb::cast<std::string>(value.attr("__str__")());
}

/// With all of its digits.
inline std::string text_of(double value) { return text_of(nb::float_(value)); }

/// What came, in words: `a float32 array of shape (3, 2)`, or the name of a type.
inline std::string words_for(nb::handle given) {
  if (nb::hasattr(given, "dtype") && nb::hasattr(given, "shape")) {
    return "a " + text_of(given.attr("dtype")) + " array of shape " + text_of(given.attr("shape"));
  }
  return text_of(given.type().attr("__name__"));
}

[[noreturn]] inline void refuse_type(const char* name, nb::handle given, const std::string& need) {
  throw nb::type_error(
      (std::string(name) + ": expected " + need + "; " + words_for(given) + " came").c_str());
}

[[noreturn]] inline void refuse_value(const std::string& text) {
  throw nb::value_error(text.c_str());
}

inline double number_of(nb::handle given, const char* name) {
  double value = 0.0;
  const bool is_text = nb::isinstance<nb::str>(given) || nb::isinstance<nb::bytes>(given);
  if (is_text || !nb::try_cast(given, value)) refuse_type(name, given, "a number");
  return value;
}

inline std::optional<double> optional_number(nb::handle given, const char* name) {
  if (given.is_none()) return std::nullopt;
  return number_of(given, name);
}

inline std::optional<std::string> optional_text(nb::handle given, const char* name) {
  if (given.is_none()) return std::nullopt;
  if (!nb::isinstance<nb::str>(given)) refuse_type(name, given, "a str");
  return nb::cast<std::string>(given);
}

inline const Parameters& parameters_of(nb::handle given) {
  Parameters* found = nullptr;
  if (!nb::try_cast(given, found, false) || found == nullptr) {
    refuse_type("parameters", given, "carom.Parameters");
  }
  return *found;
}

/// What is to be named of an argument: itself, or the array that a list was made into.
inline nb::handle shown_of(nb::handle given, nb::handle array) {
  const bool is_list = nb::isinstance<nb::list>(given) || nb::isinstance<nb::tuple>(given);
  return is_list ? array : given;
}

/// A NumPy array of doubles, converted from any real numbers; nothing that has none is.
inline nb::object doubles_of(nb::handle given, const char* name, const std::string& need) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  nb::object array;
  try {
    array = numpy.attr("asarray")(given);
  } catch (nb::python_error&) {  // rows of unequal length
    refuse_type(name, given, need);
  }
  const std::string kind = nb::cast<std::string>(array.attr("dtype").attr("kind"));
  if (kind != "f" && kind != "i" && kind != "u") {
    refuse_type(name, shown_of(given, array), need);
  }
  return numpy.attr("ascontiguousarray")(array, "dtype"_a = "float64");
}

/// An array of a fixed shape; lists are converted.
template <class Array>
Array array_of(nb::handle given, const char* name, const char* need) {
  Array array;
  if (nb::try_cast(given, array, false)) return array;
  const nb::object converted = doubles_of(given, name, need);
  if (!nb::try_cast(converted, array, false)) refuse_type(name, shown_of(given, converted), need);
  return array;
}

inline BallArray ball_of(nb::handle given, const char* name) {
  return array_of<BallArray>(given, name,
                             "numbers of shape (3, 3): position, velocity, angular velocity");
}

inline BallPlace ball_place(nb::handle given, const char* name) {
  BallPlace ball;
  if (!nb::try_cast(given, ball, false)) {
    refuse_type(name, given, "a writable float64 array of shape (3, 3), contiguous as C has it");
  }
  return ball;
}

inline Numbers numbers_of(nb::handle given, const char* name, const std::string& need) {
  Numbers numbers;
  if (nb::try_cast(given, numbers, false)) return numbers;
  if (!nb::try_cast(doubles_of(given, name, need), numbers, false)) refuse_type(name, given, need);
  return numbers;
}

/// Arrays (n, `vectors`, 3): the balls of a batch.
inline Numbers balls_of(nb::handle given, const char* name, const char* need, std::size_t vectors) {
  Numbers balls = numbers_of(given, name, need);
  if (balls.ndim() != 3 || balls.shape(1) != vectors || balls.shape(2) != 3) {
    refuse_type(name, given, need);
  }
  return balls;
}

}  // namespace carom

#endif  // CAROM_PYTHON_ARGUMENTS_H_
