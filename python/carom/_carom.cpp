// The binding: kernels of the table as a Python class, with NumPy arrays in and out.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "kernel_table.h"
#include "result_memory.h"

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using carom::Parameters;
using carom::Row;

using BallIn = nb::ndarray<const double, nb::shape<3, 3>, nb::c_contig, nb::device::cpu>;
using BallOut = nb::ndarray<double, nb::shape<3, 3>, nb::c_contig, nb::device::cpu>;
using ColumnsIn = nb::ndarray<const double, nb::shape<18, -1>, nb::device::cpu>;
using ColumnsOut = nb::ndarray<double, nb::shape<12, -1>, nb::device::cpu>;
using Frictions = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
using Statuses = nb::ndarray<unsigned char, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

constexpr double kDefaultError = 1e-6;
constexpr int kMostSteps = 100000000;
constexpr std::size_t kBlock =
    2048;  // collisions that are gathered at once: what lanes of floats work on

std::string text_of(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

// All values that a column of the table has, for messages.
template <class Column>
std::string listed(Column column) {
  std::vector<std::string> seen;
  for (std::size_t i = 0; i < carom::kRowCount; ++i) {
    const std::string value = column(carom::kRows[i]);
    if (!value.empty() && std::find(seen.begin(), seen.end(), value) == seen.end()) {
      seen.push_back(value);
    }
  }
  std::string text;
  for (const std::string& value : seen) text += (text.empty() ? "" : ", ") + value;
  return text;
}

std::string budgets() {
  return listed([](const Row& row) { return row.budget > 0.0 ? text_of(row.budget) : ""; });
}

// The loosest, so fastest, kernel that keeps what is asked for; the CPU's best level of x86-64.
const Row& find_row(const std::string& model, std::optional<double> max_error, bool fixed,
                    const std::optional<std::string>& target) {
  const Row* best = nullptr;
  bool model_known = false, target_known = !target, runs = false;
  for (std::size_t i = 0; i < carom::kRowCount; ++i) {
    const Row& row = carom::kRows[i];
    if (row.model != model || row.unequal) continue;
    model_known = true;
    if (target && *target != row.target) continue;
    target_known = true;
    if (fixed != (row.steps > 0) || !row.runs()) continue;
    runs = true;
    if (!fixed && !(row.budget <= *max_error)) continue;
    if (best == nullptr || row.budget > best->budget) best = &row;
  }
  if (best != nullptr) return *best;
  if (!model_known) {
    const std::string names = listed([](const Row& row) { return row.model; });
    throw nb::value_error(("model '" + model + "': there is none; there are " + names).c_str());
  }
  if (!target_known) {
    const std::string names = listed([](const Row& row) { return row.target; });
    throw nb::value_error(("target '" + *target + "': there is none; there are " + names).c_str());
  }
  if (!runs) {
    throw std::runtime_error("this CPU does not run " + target.value_or("x86-64-v2") + " code");
  }
  throw nb::value_error(
      ("max_error " + text_of(*max_error) + ": no kernel is as exact; there are " + budgets())
          .c_str());
}

[[noreturn]] void refuse(const char* text) { throw nb::value_error(text); }

// That of balls of two masses beside one of equal balls; nullptr where there is none.
const Row* unequal_row(const Row& equal) {
  for (std::size_t i = 0; i < carom::kRowCount; ++i) {
    const Row& row = carom::kRows[i];
    const bool same = std::string(row.model) == equal.model && row.runs == equal.runs;
    if (row.unequal && same && row.budget == equal.budget) return &row;
  }
  return nullptr;
}

// Has ball 1 another mass? Where neither is a number they are both refused by any kernel.
bool is_unequal(const Parameters& p) {
  return p.M1 != p.M && !(std::isnan(p.M1) && std::isnan(p.M));
}

// M1 is shown where it was given.
std::string repr(const Parameters& p) {
  return "Parameters(R=" + text_of(p.R) + ", M=" + text_of(p.M) + ", u_s1=" + text_of(p.u_s1) +
         ", u_s2=" + text_of(p.u_s2) + ", u_b=" + text_of(p.u_b) + ", e_b=" + text_of(p.e_b) +
         (is_unequal(p) ? ", M1=" + text_of(p.M1) : "") + ")";
}

constexpr const char* kOneMass =
    "M1: only kernels with max_error and of the models mathavan2014 and bottom_slip take balls of "
    "two masses; leave M1 out, or name such a kernel";

/// One kernel, chosen by model and by error budget or steps.
class Kernel {
 public:
  Kernel(const std::string& model, std::optional<double> max_error, std::optional<int> steps,
         const std::optional<std::string>& target)
      : row_(find_row(model, max_error ? max_error : kDefaultError, steps.has_value(), target)),
        unequal_(unequal_row(row_)),
        steps_(steps.value_or(0)),
        empty_(nb::module_::import_("numpy").attr("empty")) {
    if (max_error && steps) refuse("max_error and steps exclude each other: name one of them");
    if (steps && (*steps < 1 || *steps > kMostSteps)) refuse("steps: expected 1 to 100000000");
  }

  const char* model() const { return row_.model; }
  const char* target() const { return row_.target; }
  const char* name() const { return row_.functions.name(); }
  int lanes() const { return steps_ == row_.steps ? row_.lanes : 1; }
  std::optional<int> steps() const { return steps_ > 0 ? std::optional(steps_) : std::nullopt; }
  std::optional<double> max_error() const {
    return row_.budget > 0.0 ? std::optional(row_.budget) : std::nullopt;
  }

  int one(const Parameters& p, const double* ball1, const double* ball2, double* out1,
          double* out2) const {
    const Row& row = row_for(p);
    if (steps_ == row.steps) return row.functions.collide(p, ball1, ball2, out1, out2);
    return row_.collide_steps(p, ball1, ball2, out1, out2, steps_);
  }

  nb::tuple collide(const Parameters& p, const BallIn& ball1, const BallIn& ball2) const {
    const nb::object both1 = empty_(shape_), both2 = empty_(shape_);
    const auto out1 = nb::cast<BallOut>(both1), out2 = nb::cast<BallOut>(both2);
    const int status = one(p, ball1.data(), ball2.data(), out1.data(), out2.data());
    return nb::make_tuple(both1, both2, status);
  }

  int collide_into(const Parameters& p, const BallIn& ball1, const BallIn& ball2, BallOut& out1,
                   BallOut& out2) const {
    return one(p, ball1.data(), ball2.data(), out1.data(), out2.data());
  }

  nb::tuple collide_batch(const Parameters& p, const ColumnsIn& balls,
                          const std::optional<Frictions>& u_b, std::optional<ColumnsOut> out,
                          std::optional<Statuses> status) const {
    const std::size_t n = balls.shape(1);
    if (u_b && u_b->shape(0) != n) refuse("u_b: expected one number a collision");
    if (out && out->shape(1) != n) refuse("out: expected 12 rows of as many columns as balls has");
    if (status && status->shape(0) != n) refuse("status: expected one byte a collision");
    const Row& row = row_for(p);
    make_missing(n, out, status);
    const double* const friction = u_b ? u_b->data() : nullptr;
    {
      const nb::gil_scoped_release release;
      batch(row, p, friction, balls, *out, status->data(), n);
    }
    return nb::make_tuple(*out, *status);
  }

 private:
  const Row& row_for(const Parameters& p) const {
    if (!is_unequal(p)) return row_;
    if (unequal_ == nullptr) refuse(kOneMass);
    return *unequal_;
  }

  // Those of the result arrays that the caller did not give, a block each: one may outlive the
  // other.
  void make_missing(std::size_t n, std::optional<ColumnsOut>& out,
                    std::optional<Statuses>& status) const {
    if (!out) out = nb::cast<ColumnsOut>(made<double>(spare_columns_, {12, n}, 12 * n));
    if (!status) status = nb::cast<Statuses>(made<unsigned char>(spare_statuses_, {n}, n));
  }

  template <class Value>
  static nb::object made(const std::shared_ptr<carom::Spare>& spare,
                         std::initializer_list<std::size_t> shape, std::size_t count) {
    auto lent = std::make_unique<carom::Lent>(spare, count * sizeof(Value));
    void* const start = lent->block().start();
    const nb::capsule owner(lent.release(),
                            [](void* p) noexcept { delete static_cast<carom::Lent*>(p); });
    return nb::cast(nb::ndarray<nb::numpy, Value>(start, shape, owner));
  }

  // Columns that are contiguous are used where they lie; others are gathered block by block.
  void batch(const Row& row, const Parameters& p, const double* u_b, const ColumnsIn& balls,
             ColumnsOut& out, unsigned char* status, std::size_t n) const {
    std::array<const double*, 18> in;
    std::array<double*, 12> to;
    if (balls.stride(1) == 1 && out.stride(1) == 1) {
      for (std::size_t j = 0; j < 18; ++j) in[j] = balls.data() + j * balls.stride(0);
      for (std::size_t j = 0; j < 12; ++j) to[j] = out.data() + j * out.stride(0);
      run(row, p, u_b, n, in, to, status);
      return;
    }
    std::vector<std::array<double, kBlock + 8>> block(30);  // columns apart by no power of two
    for (std::size_t j = 0; j < 18; ++j) in[j] = block[j].data();
    for (std::size_t j = 0; j < 12; ++j) to[j] = block[18 + j].data();
    for (std::size_t first = 0; first < n; first += kBlock) {
      const std::size_t count = std::min(kBlock, n - first);
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < 18; ++j) block[j][i] = balls(j, first + i);
      }
      run(row, p, u_b != nullptr ? u_b + first : nullptr, count, in, to, status + first);
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < 12; ++j) out(j, first + i) = block[18 + j][i];
      }
    }
  }

  void run(const Row& row, const Parameters& p, const double* u_b, std::size_t n,
           const std::array<const double*, 18>& in, const std::array<double*, 12>& out,
           unsigned char* status) const {
    if (steps_ == row.steps) {
      row.functions.batch(p, u_b, n, in.data(), out.data(), status);
      return;
    }
    Parameters each = p;
    for (std::size_t i = 0; i < n; ++i) {
      double ball1[9], ball2[9];
      for (std::size_t j = 0; j < 9; ++j) {
        ball1[j] = in[j][i];
        ball2[j] = in[j + 9][i];
      }
      if (u_b != nullptr) each.u_b = u_b[i];
      status[i] = static_cast<unsigned char>(one(each, ball1, ball2, ball1, ball2));
      for (std::size_t j = 0; j < 6; ++j) {
        out[j][i] = ball1[j + 3];
        out[j + 6][i] = ball2[j + 3];
      }
    }
  }

  const Row& row_;
  const Row* unequal_;  // for balls of two masses, or nullptr
  int steps_;
  std::shared_ptr<carom::Spare> spare_columns_ = std::make_shared<carom::Spare>();
  std::shared_ptr<carom::Spare> spare_statuses_ = std::make_shared<carom::Spare>();
  nb::object empty_;
  nb::tuple shape_ = nb::make_tuple(3, 3);
};

}  // namespace

NB_MODULE(_carom, m) {
  nb::class_<Parameters>(m, "Parameters",
                         "Radius R (m) and mass M (kg) of both balls, sliding friction of ball 1\n"
                         "and of ball 2 with the table, friction and restitution between the\n"
                         "balls, each from 0 to 1. M1: mass of ball 1 where it is another than M,\n"
                         "from a tenth of M to ten times as much; for kernels with max_error of\n"
                         "the models mathavan2014 and bottom_slip, whose batches then go call by\n"
                         "call. What is out of range makes status BAD_INPUT.")
      .def(
          "__init__",
          [](Parameters* self, double R, double M, double u_s1, double u_s2, double u_b, double e_b,
             std::optional<double> M1) {
            new (self) Parameters{R, M, u_s1, u_s2, u_b, e_b, M1.value_or(M)};
          },
          "R"_a = 0.028575, "M"_a = 0.170097, "u_s1"_a = 0.2, "u_s2"_a = 0.2, "u_b"_a = 0.05,
          "e_b"_a = 0.95, nb::kw_only(), "M1"_a = nb::none())
      .def_ro("R", &Parameters::R)
      .def_ro("M", &Parameters::M)
      .def_ro("M1", &Parameters::M1)
      .def_ro("u_s1", &Parameters::u_s1)
      .def_ro("u_s2", &Parameters::u_s2)
      .def_ro("u_b", &Parameters::u_b)
      .def_ro("e_b", &Parameters::e_b)
      .def("__repr__", &repr);

  nb::class_<Kernel>(
      m, "Kernel",
      "A collision kernel, chosen by contact model and by error budget or number of steps.\n\n"
      "model: mathavan2014, bottom_slip or pooltool. max_error: budget relative to the relative\n"
      "speed of the balls (default 1e-6); the fastest kernel that keeps it is taken. steps:\n"
      "instead of a budget, N of the fixed-step scheme of pooltool, 1 to 100000000. target:\n"
      "x86-64-v2, -v3 or -v4; by default the best that the CPU runs. Raises ValueError naming\n"
      "what there is, RuntimeError where the CPU lacks the target.")
      .def(nb::init<const std::string&, std::optional<double>, std::optional<int>,
                    const std::optional<std::string>&>(),
           "model"_a = "mathavan2014", nb::kw_only(), "max_error"_a = nb::none(),
           "steps"_a = nb::none(), "target"_a = nb::none())
      .def_prop_ro("model", &Kernel::model)
      .def_prop_ro("target", &Kernel::target, "the level of x86-64 whose code runs")
      .def_prop_ro("name", &Kernel::name, "in the grammar of kernel names")
      .def_prop_ro("lanes", &Kernel::lanes, "collisions that a vector of collide_batch holds")
      .def_prop_ro("steps", &Kernel::steps, "N, or None")
      .def_prop_ro("max_error", &Kernel::max_error, "the budget that the kernel keeps, or None")
      .def("collide", &Kernel::collide, "parameters"_a, "ball1"_a, "ball2"_a,
           "One collision: (ball1, ball2, status). A ball is a float64 array of shape (3, 3):\n"
           "position (m), velocity (m/s), angular velocity (rad/s), z up. What came in is left\n"
           "as it is. Anything but status OK leaves velocities as they came.")
      .def("collide_into", &Kernel::collide_into, "parameters"_a, "ball1"_a, "ball2"_a,
           "out1"_a.noconvert(), "out2"_a.noconvert(),
           "As collide, into arrays of the caller's, which may be those that come in; the status.")
      .def(
          "collide_batch", &Kernel::collide_batch, "parameters"_a, "balls"_a, "u_b"_a = nb::none(),
          "out"_a.noconvert() = nb::none(), "status"_a.noconvert() = nb::none(),
          "n collisions: (out, status). balls: float64 of shape (18, n), rows r1x..w2z; out:\n"
          "(12, n), rows v1x..w2z; status: uint8 of n. Rows that are contiguous are not copied;\n"
          "other strides do, as x.T of an array (n, 18). u_b: one friction a collision. out and\n"
          "status may be given. The interpreter lock is released meanwhile. Batches go in lanes\n"
          "(other numbers of steps than 1000: call by call): as exact as collide, though rounded\n"
          "otherwise; what a collision gives depends on itself alone, to the last bit. The kernel\n"
          "keeps the memory of the results that were dropped last for those of the next batch, as\n"
          "long as it lives itself; a result holds its own size alone.");
}
