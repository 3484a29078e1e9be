// What batches of any impact give back: arrays in memory of their kernel's, statuses, frictions.
#ifndef CAROM_PYTHON_RESULTS_H_
#define CAROM_PYTHON_RESULTS_H_

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>

#include "arguments.h"
#include "result_memory.h"

namespace carom {

using Memory = std::shared_ptr<Spare>;

/// A new array in memory of the kernel's: one may outlive the other.
template <class Value>
nb::object made(const Memory& spare, std::initializer_list<std::size_t> shape) {
  std::size_t count = sizeof(Value);
  for (const std::size_t each : shape) count *= each;
  auto lent = std::make_unique<Lent>(spare, count);
  void* const start = lent->block().start();
  const nb::capsule owner(lent.release(), [](void* p) noexcept { delete static_cast<Lent*>(p); });
  return nb::cast(nb::ndarray<nb::numpy, Value>(start, shape, owner));
}

/// The table that a caller gave for results, or a new one; a row for each of `across` numbers.
inline nb::object table_for(nb::handle given, const Memory& spare, std::size_t across,
                            std::size_t along, Places& places) {
  nb::object to = nb::borrow(given);
  if (to.is_none()) to = made<double>(spare, {across, along});
  if (!nb::try_cast(to, places, false)) refuse_type("out", given, "a writable float64 array");
  if (places.ndim() != 2 || places.shape(0) != across || places.shape(1) != along) {
    const std::string shape = std::to_string(across) + ", " + std::to_string(along);
    refuse_value("out: expected shape (" + shape + "); " + words_for(given) + " came");
  }
  return to;
}

inline nb::object statuses_for(nb::handle given, const Memory& spare, std::size_t n) {
  if (given.is_none()) return made<unsigned char>(spare, {n});
  Statuses status;
  if (!nb::try_cast(given, status, false)) {
    refuse_type("status", given, "a writable uint8 array of shape (n,), contiguous");
  }
  if (status.shape(0) != n) {
    refuse_value("status: expected one byte a collision, " + std::to_string(n) + "; " +
                 std::to_string(status.shape(0)) + " came");
  }
  return nb::borrow(given);
}

/// Is it one number, not a sequence of them?
inline bool is_single(nb::handle given) {
  const bool single = PyNumber_Check(given.ptr()) != 0 && !nb::hasattr(given, "__len__");
  return single || (nb::hasattr(given, "ndim") && nb::cast<int>(given.attr("ndim")) == 0);
}

/// A friction for each of n collisions, contiguous. `name`: of the argument.
inline Numbers each_of(nb::handle given, const char* name, std::size_t n) {
  static constexpr const char* kNeed = "a number, or one number a collision, of shape (n,)";
  Numbers numbers = numbers_of(given, name, kNeed);
  if (numbers.ndim() != 1) refuse_type(name, given, kNeed);
  if (numbers.shape(0) != n) {
    refuse_value(std::string(name) + ": expected one number a collision, " + std::to_string(n) +
                 "; " + std::to_string(numbers.shape(0)) + " came");
  }
  if (n > 1 && numbers.stride(0) != 1) {
    numbers = numbers_of(doubles_of(given, name, kNeed), "", "");
  }
  return numbers;
}

}  // namespace carom

#endif  // CAROM_PYTHON_RESULTS_H_
