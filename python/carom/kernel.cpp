#include "kernel.h"

#include "parameters.h"

namespace carom {

namespace {

constexpr const char* kOneMass =
    "M1: only kernels with max_error and of the models mathavan2014 and bottom_slip take balls of "
    "two masses; leave M1 out, or name such a kernel";
constexpr const char* kBalls =
    "numbers of shape (18, n) or (n, 18), r1x to w2z, or two arguments of shape (n, 3, 3)";
constexpr const char* kPairs =
    "numbers of shape (n, 3, 3): position, velocity and angular velocity of n balls";

// That of balls of two masses beside one of equal balls; nullptr where there is none.
const Row* unequal_row(const Row& equal) {
  for (std::size_t i = 0; i < kRowCount; ++i) {
    const Row& row = kRows[i];
    const bool same = std::string(row.model) == equal.model && row.runs == equal.runs;
    if (row.unequal && same && row.budget == equal.budget) return &row;
  }
  return nullptr;
}

// A collision moves no ball.
void copy_places(const Numbers& from, const Places& to) {
  for (std::size_t i = 0; i < from.shape(0); ++i) {
    const double* const place = from.data() + static_cast<std::int64_t>(i) * from.stride(0);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      to.data()[9 * i + axis] = place[static_cast<std::int64_t>(axis) * from.stride(2)];
    }
  }
}

}  // namespace

Kernel::Kernel(const Request& request)
    : RowKernel(request, &find_row, 3), unequal_(unequal_row(row_)) {}

const Row& Kernel::row_for(const Parameters& p) const {
  if (!is_unequal(p)) return row_;
  if (unequal_ == nullptr) refuse_value(kOneMass);
  return *unequal_;
}

int Kernel::one(const Parameters& p, const double* ball1, const double* ball2, double* out1,
                double* out2) const {
  const Row& row = row_for(p);
  if (steps_ == row.steps) return row.functions.collide(p, ball1, ball2, out1, out2);
  return row_.collide_steps(p, ball1, ball2, out1, out2, steps_);
}

int Kernel::one_call(const Parameters& p, const double* ball1, const double* ball2, double* out1,
                     double* out2) const {
  if (steps_ < kLongSteps) return one(p, ball1, ball2, out1, out2);
  row_for(p);  // what it refuses needs the lock
  const nb::gil_scoped_release release;
  return one(p, ball1, ball2, out1, out2);
}

nb::tuple Kernel::collide(nb::handle parameters, nb::handle ball1, nb::handle ball2) const {
  const Parameters& p = parameters_of(parameters);
  const BallArray one = ball_of(ball1, "ball1"), two = ball_of(ball2, "ball2");
  const nb::object both1 = new_ball(), both2 = new_ball();
  const auto out1 = nb::cast<BallPlace>(both1), out2 = nb::cast<BallPlace>(both2);
  const int status = one_call(p, one.data(), two.data(), out1.data(), out2.data());
  return nb::make_tuple(both1, both2, static_cast<Status>(status));
}

Status Kernel::collide_into(nb::handle parameters, nb::handle ball1, nb::handle ball2,
                            nb::handle out1, nb::handle out2) const {
  const Parameters& p = parameters_of(parameters);
  const BallArray one = ball_of(ball1, "ball1"), two = ball_of(ball2, "ball2");
  const BallPlace to1 = ball_place(out1, "out1"), to2 = ball_place(out2, "out2");
  return static_cast<Status>(one_call(p, one.data(), two.data(), to1.data(), to2.data()));
}

nb::tuple Kernel::collide_batch(nb::handle parameters, nb::handle balls, nb::handle u_b,
                                nb::handle out, nb::handle status) const {
  const Parameters& p = parameters_of(parameters);
  return through_table<18, 12>("balls", balls, kBalls, out, status,
                               [&](const Inputs& in, const Outputs& to, const Statuses& marks) {
                                 batch(p, u_b, in, to, marks);
                               });
}

nb::tuple Kernel::collide_pairs(nb::handle parameters, nb::handle ball1, nb::handle ball2,
                                nb::handle u_b, nb::handle status) const {
  const Parameters& p = parameters_of(parameters);
  const Numbers one = balls_of(ball1, "ball1", kPairs, 3);
  const Numbers two = balls_of(ball2, "ball2", kPairs, 3);
  const std::size_t n = one.shape(0);
  if (two.shape(0) != n) {
    refuse_value("ball2: expected as many balls as ball1 has, " + std::to_string(n) + "; " +
                 std::to_string(two.shape(0)) + " came");
  }
  const nb::object to1 = made<double>(spare_out_, {n, 3, 3});
  const nb::object to2 = made<double>(spare_out2_, {n, 3, 3});
  const auto places1 = nb::cast<Places>(to1), places2 = nb::cast<Places>(to2);
  const nb::object marks = statuses_for(status, spare_statuses_, n);
  Inputs in;
  Outputs results;
  set_vectors(in, 0, one, 0, 3);
  set_vectors(in, 9, two, 0, 3);
  set_vectors(results, 0, places1, 1, 3);
  set_vectors(results, 6, places2, 1, 3);
  copy_places(one, places1);
  copy_places(two, places2);
  batch(p, u_b, in, results, nb::cast<Statuses>(marks));
  return nb::make_tuple(to1, to2, marks);
}

void Kernel::batch(Parameters p, nb::handle u_b, const Inputs& in, const Outputs& out,
                   Statuses status) const {
  const std::optional<Numbers> each = frictions(p, &Parameters::u_b, "u_b", u_b, status.shape(0));
  const Row& row = row_for(p);
  run_unlocked(each, in, out, status,
               [&](const double* friction, std::size_t n, const auto& from, const auto& to,
                   unsigned char* marks) { run(row, p, friction, n, from, to, marks); });
}

void Kernel::run(const Row& row, const Parameters& p, const double* u_b, std::size_t n,
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

}  // namespace carom
