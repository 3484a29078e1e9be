#include "cushion.h"

#include <nanobind/stl/string.h>

namespace carom {

namespace {

constexpr const char* kColumns =
    "numbers of shape (8, n) or (n, 8), vx to wz, nx, ny, or two arguments of shape (n, 2, 3) and "
    "(n, 2)";
constexpr const char* kBalls = "numbers of shape (n, 2, 3): velocity and angular velocity";
constexpr const char* kNormals = "numbers of shape (n, 2): level, into the cushion";

constexpr const char* kKernelText =
    "A kernel of impacts on a cushion, chosen by contact model and by error budget or number of\n"
    "steps.\n\n"
    "model: clamped, printed or pooltool. max_error: budget relative to the ball's speed (default\n"
    "1e-6); the fastest kernel that keeps it is taken; pooltool has none. steps: instead of a\n"
    "budget, max_steps of the fixed-step scheme of pooltool, 1 to 100000000. target: the CPU\n"
    "whose code runs, as x86-64-v3 or armv8; by default the best that this one runs.\n"
    "Raises ValueError naming what there is, RuntimeError where the CPU lacks the target.\n"
    "Kernels compare, hash, copy and pickle by what they were asked for.";

constexpr const char* kInit =
    "def __init__(self, model: str = 'clamped', *, max_error: float | None = None, "
    "steps: int | None = None, target: str | None = None) -> None";

constexpr const char* kCollide =
    "def collide(self, parameters: CushionParameters, ball: carom.types.Ball, "
    "normal: carom.types.Normal) -> tuple[carom.types.Array, Status]";
constexpr const char* kCollideText =
    "One impact: (ball, status). A ball is 2 by 3 numbers, an array or lists: velocity (m/s) and\n"
    "angular velocity (rad/s), z up. The normal is 2: level, into the cushion, of any length. "
    "What\n"
    "came in is left as it is. Anything but status OK leaves velocities as they came.";

constexpr const char* kBatch =
    "def collide_batch(self, parameters: CushionParameters, columns: carom.types.Table, *, "
    "u_w: carom.types.Friction | None = None, out: carom.types.Array | None = None, "
    "status: carom.types.Statuses | None = None) -> tuple[carom.types.Array, carom.types.Statuses]";
constexpr const char* kBatchText =
    "n impacts: (out, status). columns: numbers of shape (8, n), rows vx to wz, nx, ny, or (n, "
    "8);\n"
    "out: (6, n), rows vx to wz, or (n, 6); status: uint8 of n. 8 by 8 numbers are taken as (8, "
    "n).\n"
    "u_w: friction of all, or of each impact. out and status may be given. The interpreter lock "
    "is\n"
    "released meanwhile. What an impact gives depends on itself alone, to the last bit.";

constexpr const char* kPairs =
    "def collide_batch(self, parameters: CushionParameters, balls: carom.types.Balls, "
    "normals: carom.types.Table, *, u_w: carom.types.Friction | None = None, "
    "status: carom.types.Statuses | None = None)"
    " -> tuple[carom.types.Array, carom.types.Statuses]";
constexpr const char* kPairsText =
    "n impacts of an array (n, 2, 3) of balls, as collide takes them, with normals (n, 2): "
    "(balls,\n"
    "status).";

using Motion = nb::ndarray<const double, nb::shape<2, 3>, nb::c_contig, nb::device::cpu>;
using MotionPlace = nb::ndarray<double, nb::shape<2, 3>, nb::c_contig, nb::device::cpu>;
using Normal = nb::ndarray<const double, nb::shape<2>, nb::c_contig, nb::device::cpu>;

const CushionParameters& cushion_parameters_of(nb::handle given) {
  CushionParameters* found = nullptr;
  if (!nb::try_cast(given, found, false) || found == nullptr) {
    refuse_type("parameters", given, "carom.CushionParameters");
  }
  return *found;
}

void make(CushionKernel* self, nb::handle model, nb::handle max_error, nb::handle steps,
          nb::handle target) {
  new (self) CushionKernel(request_of(model, max_error, steps, target));
}

}  // namespace

CushionKernel::CushionKernel(const Request& request) : RowKernel(request, &find_cushion_row, 2) {}

int CushionKernel::one(const CushionParameters& p, const double* ball, const double* normal,
                       double* out) const {
  if (steps_ == row_.steps) return row_.functions.collide(p, ball, normal, out);
  return row_.collide_steps(p, ball, normal, out, steps_);
}

nb::tuple CushionKernel::collide(nb::handle parameters, nb::handle ball, nb::handle normal) const {
  const CushionParameters& p = cushion_parameters_of(parameters);
  const auto motion =
      array_of<Motion>(ball, "ball", "numbers of shape (2, 3): velocity and angular velocity");
  const auto into = array_of<Normal>(normal, "normal", "two numbers: level, into the cushion");
  const nb::object after = new_ball();
  const auto place = nb::cast<MotionPlace>(after);
  std::optional<nb::gil_scoped_release> release;
  if (steps_ >= kLongSteps) release.emplace();
  const int status = one(p, motion.data(), into.data(), place.data());
  release.reset();
  return nb::make_tuple(after, static_cast<Status>(status));
}

nb::tuple CushionKernel::collide_batch(nb::handle parameters, nb::handle columns, nb::handle u_w,
                                       nb::handle out, nb::handle status) const {
  const CushionParameters& p = cushion_parameters_of(parameters);
  return through_table<8, 6>("columns", columns, kColumns, out, status,
                             [&](const CushionInputs& in, const CushionOutputs& to,
                                 const Statuses& marks) { batch(p, u_w, in, to, marks); });
}

nb::tuple CushionKernel::collide_balls(nb::handle parameters, nb::handle balls, nb::handle normals,
                                       nb::handle u_w, nb::handle status) const {
  const CushionParameters& p = cushion_parameters_of(parameters);
  const Numbers given = balls_of(balls, "balls", kBalls, 2);
  const Numbers into = numbers_of(normals, "normals", kNormals);
  const std::size_t n = given.shape(0);
  if (into.ndim() != 2 || into.shape(1) != 2) refuse_type("normals", normals, kNormals);
  if (into.shape(0) != n) {
    refuse_value("normals: expected as many as there are balls, " + std::to_string(n) + "; " +
                 std::to_string(into.shape(0)) + " came");
  }
  const nb::object to = made<double>(spare_out_, {n, 2, 3});
  const auto places = nb::cast<Places>(to);
  const nb::object marks = statuses_for(status, spare_statuses_, n);
  CushionInputs in;
  CushionOutputs results;
  set_vectors(in, 0, given, 0, 2);
  in.set(6, 2, into.data(), into.stride(1), into.stride(0));
  set_vectors(results, 0, places, 0, 2);
  batch(p, u_w, in, results, nb::cast<Statuses>(marks));
  return nb::make_tuple(to, marks);
}

void CushionKernel::batch(CushionParameters p, nb::handle u_w, const CushionInputs& in,
                          const CushionOutputs& out, Statuses status) const {
  const std::optional<Numbers> each =
      frictions(p, &CushionParameters::u_w, "u_w", u_w, status.shape(0));
  run_unlocked(each, in, out, status,
               [&](const double* friction, std::size_t n, const auto& from, const auto& to,
                   unsigned char* marks) { run(p, friction, n, from, to, marks); });
}

void CushionKernel::run(const CushionParameters& p, const double* u_w, std::size_t n,
                        const std::array<const double*, 8>& in, const std::array<double*, 6>& out,
                        unsigned char* status) const {
  if (steps_ == row_.steps) {
    row_.functions.batch(p, u_w, n, in.data(), out.data(), status);
    return;
  }
  CushionParameters own = p;
  for (std::size_t i = 0; i < n; ++i) {
    double ball[6];
    for (std::size_t j = 0; j < 6; ++j) ball[j] = in[j][i];
    const double normal[2] = {in[6][i], in[7][i]};
    if (u_w != nullptr) own.u_w = u_w[i];
    status[i] = static_cast<unsigned char>(one(own, ball, normal, ball));
    for (std::size_t j = 0; j < 6; ++j) out[j][i] = ball[j];
  }
}

void bind_cushion_kernel(nb::module_& m) {
  nb::class_<CushionKernel> made(m, "CushionKernel", kKernelText);
  made.def("__init__", &make, "model"_a.none() = "clamped", nb::kw_only(),
           "max_error"_a = nb::none(), "steps"_a = nb::none(), "target"_a = nb::none(),
           nb::sig(kInit))
      .def("collide", &CushionKernel::collide, "parameters"_a.none(), "ball"_a.none(),
           "normal"_a.none(), nb::sig(kCollide), kCollideText)
      .def("collide_batch", &CushionKernel::collide_batch, "parameters"_a.none(),
           "columns"_a.none(), nb::kw_only(), "u_w"_a = nb::none(), "out"_a = nb::none(),
           "status"_a = nb::none(), nb::sig(kBatch), kBatchText)
      .def("collide_batch", &CushionKernel::collide_balls, "parameters"_a.none(), "balls"_a.none(),
           "normals"_a.none(), nb::kw_only(), "u_w"_a = nb::none(), "status"_a = nb::none(),
           nb::sig(kPairs), kPairsText);
  bind_common(made, "CushionKernel");
}

}  // namespace carom
