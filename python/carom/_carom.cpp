// The binding: kernels of the table as a Python class, with NumPy arrays in and out. Signatures are
// written for type checkers (which cannot tell a third array that is u_b from one that is ball2);
// `tools/stubs.py` makes _carom.pyi of them.
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include "cushion.h"
#include "kernel.h"
#include "parameters.h"

namespace carom {

namespace {

constexpr const char* kKernelText =
    "A collision kernel, chosen by contact model and by error budget or number of steps.\n\n"
    "model: mathavan2014, bottom_slip or pooltool. max_error: budget relative to the relative\n"
    "speed of the balls (default 1e-6); the fastest kernel that keeps it is taken. steps:\n"
    "instead of a budget, N of the fixed-step scheme of pooltool, 1 to 100000000. target:\n"
    "the CPU whose code runs, as x86-64-v3 or armv8; by default the best that this one runs.\n"
    "Raises ValueError naming what there is, RuntimeError where the CPU lacks the target.\n"
    "Kernels compare, hash, copy and pickle by what they were asked for.";

constexpr const char* kInit =
    "def __init__(self, model: str = 'mathavan2014', *, max_error: float | None = None, "
    "steps: int | None = None, target: str | None = None) -> None";

constexpr const char* kCollide =
    "def collide(self, parameters: Parameters, ball1: carom.types.Ball, ball2: carom.types.Ball)"
    " -> tuple[carom.types.Array, carom.types.Array, Status]";
constexpr const char* kCollideText =
    "One collision: (ball1, ball2, status). A ball is 3 by 3 numbers, an array or lists:\n"
    "position (m), velocity (m/s), angular velocity (rad/s), z up. What came in is left as\n"
    "it is. Anything but status OK leaves velocities as they came. The interpreter lock is\n"
    "released for 10000 steps and more.";

constexpr const char* kInto =
    "def collide_into(self, parameters: Parameters, ball1: carom.types.Ball, "
    "ball2: carom.types.Ball, out1: carom.types.Array, out2: carom.types.Array) -> Status";
constexpr const char* kIntoText =
    "As collide, into float64 arrays (3, 3) of the caller's, which may be those that come in.";

constexpr const char* kBatch =
    "def collide_batch(self, parameters: Parameters, balls: carom.types.Table, *, "
    "u_b: carom.types.Friction | None = None, out: carom.types.Array | None = None, "
    "status: carom.types.Statuses | None = None) -> tuple[carom.types.Array, carom.types.Statuses]";
constexpr const char* kBatchText =
    "n collisions: (out, status). balls: numbers of shape (18, n), rows r1x to w2z, or (n, 18);\n"
    "out: (12, n), rows v1x to w2z, or (n, 12); status: uint8 of n. 18 by 18 numbers are taken\n"
    "as (18, n). u_b: friction of all, or of each collision. out and status may be given.\n"
    "Columns that are contiguous are not copied, all others are in blocks. The interpreter lock\n"
    "is released meanwhile. Batches go in lanes (other numbers of steps than 1000: call by call):\n"
    "as exact as collide, though rounded otherwise; what a collision gives depends on itself\n"
    "alone, to the last bit. The kernel keeps the memory of the results that were dropped last\n"
    "for those of the next batch, as long as it lives itself; a result holds its own size alone.";

constexpr const char* kPairs =
    "def collide_batch(self, parameters: Parameters, ball1: carom.types.Balls, "
    "ball2: carom.types.Balls, *, u_b: carom.types.Friction | None = None, "
    "status: carom.types.Statuses | None = None)"
    " -> tuple[carom.types.Array, carom.types.Array, carom.types.Statuses]";
constexpr const char* kPairsText =
    "n collisions of two arrays (n, 3, 3) of balls, as collide takes them: (ball1, ball2, status).";

void make(Kernel* self, nb::handle model, nb::handle max_error, nb::handle steps,
          nb::handle target) {
  new (self) Kernel(request_of(model, max_error, steps, target));
}

// The call whose second argument is a table; an array of three dimensions is for the other one.
nb::tuple batch(const Kernel& kernel, nb::handle parameters, nb::handle balls, nb::handle u_b,
                nb::handle out, nb::handle status) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  const bool paired = !u_b.is_none() && out.is_none() && !nb::isinstance<nb::float_>(u_b) &&
                      nb::cast<int>(numpy.attr("ndim")(u_b)) > 1;
  if (paired) throw nb::next_overload();
  return kernel.collide_batch(parameters, balls, u_b, out, status);
}

}  // namespace

void bind_kernel(nb::module_& m) {
  nb::class_<Kernel> made(m, "Kernel", kKernelText);
  made.def("__init__", &make, "model"_a.none() = "mathavan2014", nb::kw_only(),
           "max_error"_a = nb::none(), "steps"_a = nb::none(), "target"_a = nb::none(),
           nb::sig(kInit))
      .def("collide", &Kernel::collide, "parameters"_a.none(), "ball1"_a.none(), "ball2"_a.none(),
           nb::sig(kCollide), kCollideText)
      .def("collide_into", &Kernel::collide_into, "parameters"_a.none(), "ball1"_a.none(),
           "ball2"_a.none(), "out1"_a.none(), "out2"_a.none(), nb::sig(kInto), kIntoText)
      .def("collide_batch", &batch, "parameters"_a.none(), "balls"_a.none(), "u_b"_a = nb::none(),
           "out"_a = nb::none(), "status"_a = nb::none(), nb::sig(kBatch), kBatchText)
      .def("collide_batch", &Kernel::collide_pairs, "parameters"_a.none(), "ball1"_a.none(),
           "ball2"_a.none(), "u_b"_a = nb::none(), "status"_a = nb::none(), nb::sig(kPairs),
           kPairsText);
  bind_common(made, "Kernel");
}

}  // namespace carom

NB_MODULE(_carom, m) {
  m.attr("version") = CAROM_VERSION;
  nanobind::enum_<carom::Status>(
      m, "Status", nanobind::is_arithmetic(),
      "What became of a collision; anything but OK leaves velocities as they came.")
      .value("OK", carom::Status::kOk, "they have collided")
      .value("SEPARATING", carom::Status::kSeparating, "they do not approach each other")
      .value("BAD_INPUT", carom::Status::kBadInput,
             "not finite, coincident centres, no normal, or a friction of a batch out of range")
      .value("TILTED", carom::Status::kTilted,
             "the line of centres rises by more than 1e-6 of its length");
  carom::bind_parameters(m);
  carom::bind_kernel(m);
  carom::bind_cushion_parameters(m);
  carom::bind_cushion_kernel(m);
}
