// What kernels of all impacts have in common: a row of the table, and how batches are read and run.
#ifndef CAROM_PYTHON_ROW_KERNEL_H_
#define CAROM_PYTHON_ROW_KERNEL_H_

#include <memory>
#include <optional>

#include "columns.h"
#include "request.h"
#include "results.h"

namespace carom {

/// The friction of each of n collisions; nullopt where there is one for all, which goes to `p`.
template <class AnyParameters>
std::optional<Numbers> frictions(AnyParameters& p, double AnyParameters::* varied, const char* name,
                                 nb::handle given, std::size_t n) {
  if (given.is_none()) return std::nullopt;
  if (is_single(given)) {
    p.*varied = number_of(given, name);
    require_in_ranges(p);
    return std::nullopt;
  }
  return each_of(given, name, n);
}

/// Calls run(frictions, n, in, out, statuses) block by block, without the interpreter's lock.
template <std::size_t kIn, std::size_t kOut, class Run>
void run_unlocked(const std::optional<Numbers>& each, const Lines<const double, kIn>& in,
                  const Lines<double, kOut>& out, Statuses status, const Run& run) {
  const double* const friction = each ? each->data() : nullptr;
  const nb::gil_scoped_release release;
  in_blocks(in, out, status.shape(0),
            [&](std::size_t first, std::size_t count, const auto& from, const auto& to) {
              run(friction != nullptr ? friction + first : nullptr, count, from, to,
                  status.data() + first);
            });
}

/// A row of the table, called with its own number of steps or another one.
template <class AnyRow>
class RowKernel {
 public:
  const Request& request() const { return request_; }
  const char* model() const { return row_.model; }
  const char* target() const { return row_.target; }
  const char* name() const { return row_.functions.name(); }
  int lanes() const { return steps_ == row_.steps ? row_.lanes : 1; }
  std::optional<int> steps() const { return steps_ > 0 ? std::optional(steps_) : std::nullopt; }
  std::optional<double> max_error() const {
    return row_.budget > 0.0 ? std::optional(row_.budget) : std::nullopt;
  }
  bool operator==(const RowKernel& other) const {
    return &row_ == &other.row_ && steps_ == other.steps_;
  }

 protected:
  /// `find`: the row that answers a request. `vectors`: of three numbers each, in a ball.
  RowKernel(const Request& request, const AnyRow& (*find)(const Request&), int vectors)
      : request_(checked(request)),
        row_(find(request_)),
        steps_(request_.steps.value_or(0)),
        empty_(nb::module_::import_("numpy").attr("empty")),
        shape_(nb::make_tuple(vectors, 3)) {}

  nb::object new_ball() const { return empty_(shape_); }

  /// A table (kIn, n), or (n, kIn), whose results are (kOut, n) or (n, kOut), and statuses.
  /// Calls batch(in, out, statuses).
  template <std::size_t kIn, std::size_t kOut, class Batch>
  nb::tuple through_table(const char* name, nb::handle table, const char* need, nb::handle out,
                          nb::handle status, const Batch& batch) const {
    const Numbers given = numbers_of(table, name, need);
    if (given.ndim() != 2) refuse_type(name, table, need);
    const bool rows = given.shape(0) != kIn;
    if (rows && given.shape(1) != kIn) refuse_type(name, table, need);
    const std::size_t n = given.shape(rows ? 0 : 1);
    const std::size_t across = rows ? n : kOut, along = rows ? kOut : n;
    Places places;
    const nb::object to = table_for(out, spare_out_, across, along, places);
    const nb::object marks = statuses_for(status, spare_statuses_, n);
    Lines<const double, kIn> in;
    Lines<double, kOut> results;
    in.set(0, kIn, given.data(), given.stride(rows ? 1 : 0), given.stride(rows ? 0 : 1));
    results.set(0, kOut, places.data(), places.stride(rows ? 1 : 0), places.stride(rows ? 0 : 1));
    batch(in, results, nb::cast<Statuses>(marks));
    return nb::make_tuple(to, marks);
  }

  Request request_;
  const AnyRow& row_;
  int steps_;
  Memory spare_out_ = std::make_shared<Spare>();
  Memory spare_statuses_ = std::make_shared<Spare>();

 private:
  nb::object empty_;
  nb::tuple shape_;
};

}  // namespace carom

#endif  // CAROM_PYTHON_ROW_KERNEL_H_
