// How often does a shot go in? A rolling cue ball cuts an object ball towards a pocket; aim, speed
// and friction vary from shot to shot. Collisions go through the batch function, kBatch at a time.
//
//   monte_carlo [COLLISIONS [AIM ERROR IN DEGREES]]
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "carom.hpp"

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadius = 0.028575;       // m
constexpr double kRun = 0.8;               // m that the cue ball runs
constexpr double kCut = 30.0 * kPi / 180;  // of the shot as it is meant
constexpr double kSpeed = 2.0;             // m/s
constexpr double kSpeedNoise = 0.05;       // share
constexpr double kFriction = 0.05;
constexpr double kFrictionNoise = 0.01;
constexpr double kToPocket = 1.0;     // m that the object ball runs
constexpr double kPocketHalf = 0.03;  // m: it may pass the pocket's middle this far beside
constexpr std::size_t kBatch = 10000;
constexpr carom::Parameters kCloth = {kRadius, 0.17, 0.2, 0.2, kFriction, 0.95};

// The cue ball where it touches the object ball, which rests at the origin; the meant shot runs
// along y. One that misses is made to part from it, and so is refused.
carom::Ball cue_ball(double aim_error, double speed) {
  const double d_x = std::sin(aim_error), d_y = std::cos(aim_error);
  const double to_x = 2 * kRadius * std::sin(kCut), to_y = 2 * kRadius * std::cos(kCut) + kRun;
  const double beside = to_x * d_y - to_y * d_x;
  const double square = 4 * kRadius * kRadius - beside * beside;
  const double back = square > 0 ? std::sqrt(square) : 0.0;
  if (square <= 0) speed = -speed;
  carom::Ball ball;
  ball.position = {-back * d_x - beside * d_y, -back * d_y + beside * d_x, 0.0};
  ball.velocity = {speed * d_x, speed * d_y, 0.0};
  ball.angular_velocity = {-ball.velocity.y / kRadius, ball.velocity.x / kRadius, 0.0};
  return ball;
}

// One ball of many collisions: nine columns.
struct Balls {
  std::vector<std::vector<double>> columns =
      std::vector<std::vector<double>>(9, std::vector<double>(kBatch));
  void set(std::size_t i, const carom::Ball& ball) {
    for (std::size_t k = 0; k < 9; ++k) columns[k][i] = carom::doubles(ball)[k];
  }
  template <class T>
  carom::Vectors<T> vectors(std::size_t k) {
    return {columns[k], columns[k + 1], columns[k + 2]};
  }
  carom::BallColumns before() {
    return {vectors<const double>(0), vectors<const double>(3), vectors<const double>(6)};
  }
  carom::VelocityColumns after() { return {vectors<double>(3), vectors<double>(6)}; }
};

struct Tally {
  std::size_t shots = 0, missed = 0, potted = 0;
  double sum = 0.0, squares = 0.0;  // of the object ball's direction against the meant one
  std::chrono::duration<double> colliding{};
};

class Table {
 public:
  explicit Table(double aim_noise) : aim_noise_(aim_noise) {
    const carom::Result meant = carom::collide(kCloth, cue_ball(0.0, kSpeed), carom::Ball{});
    pocket_ = std::atan2(meant.ball2.velocity.x, meant.ball2.velocity.y);
  }

  void batch(Tally& tally) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      cue_.set(i, cue_ball(aim_noise_ * normal_(random_), kSpeed * noisy(kSpeedNoise)));
      object_.set(i, carom::Ball{});
      u_b_[i] = std::fabs(kFriction + kFrictionNoise * normal_(random_));
    }
    const Clock::time_point start = Clock::now();
    carom::collide(kCloth, cue_.before(), object_.before(), cue_.after(), object_.after(), status_,
                   u_b_);
    tally.colliding += Clock::now() - start;
    for (std::size_t i = 0; i < kBatch; ++i) count(i, tally);
  }

 private:
  double noisy(double share) { return std::fabs(1.0 + share * normal_(random_)); }

  void count(std::size_t i, Tally& tally) const {
    ++tally.shots;
    if (status_[i] != carom::CollisionStatus::ok) {
      ++tally.missed;
      return;
    }
    const double off = std::atan2(object_.columns[3][i], object_.columns[4][i]) - pocket_;
    tally.sum += off;
    tally.squares += off * off;
    if (std::fabs(off) * kToPocket < kPocketHalf) ++tally.potted;
  }

  std::mt19937_64 random_{20141};
  std::normal_distribution<double> normal_;
  double aim_noise_, pocket_ = 0.0;
  Balls cue_, object_;
  std::vector<double> u_b_ = std::vector<double>(kBatch);
  std::vector<carom::CollisionStatus> status_ = std::vector<carom::CollisionStatus>(kBatch);
};

void show_progress(std::size_t done, std::size_t all) {
  constexpr int width = 40;
  const int full = static_cast<int>(width * done / all);
  std::fprintf(stderr, "\r[%.*s%*s] %zu of %zu", full, "########################################",
               width - full, "", done, all);
  if (done >= all) std::fputc('\n', stderr);
}

void report(const Tally& tally) {
  const double shots = static_cast<double>(tally.shots);
  const double hits = shots - static_cast<double>(tally.missed);
  const double share = static_cast<double>(tally.potted) / shots;
  const double mean = tally.sum / hits;
  const double deviation = std::sqrt(tally.squares / hits - mean * mean);
  std::printf("%s\n", carom::kernel());
  std::printf("%zu shots, %zu missed the ball\n", tally.shots, tally.missed);
  std::printf("potted: %.2f %% +- %.2f %%\n", 100 * share,
              100 * std::sqrt(share * (1 - share) / shots));
  std::printf("object ball's direction: %.3f +- %.3f degrees off the pocket\n", mean * 180 / kPi,
              deviation * 180 / kPi);
  std::printf("%.0f ns a collision\n", 1e9 * tally.colliding.count() / shots);
}

}  // namespace

int main(int argc, char** argv) {
  const double collisions = argc > 1 ? std::atof(argv[1]) : 1e6;
  const double degrees = argc > 2 ? std::atof(argv[2]) : 0.3;
  if (!(collisions >= kBatch && collisions <= 1e12 && degrees >= 0 && degrees < 45)) {
    std::fprintf(stderr, "usage: monte_carlo [COLLISIONS, %zu or more [AIM ERROR IN DEGREES]]\n",
                 kBatch);
    return 2;
  }
  const std::size_t batches = static_cast<std::size_t>(collisions) / kBatch;
  Table table(degrees * kPi / 180);
  Tally tally;
  for (std::size_t b = 0; b < batches; ++b) {
    table.batch(tally);
    show_progress((b + 1) * kBatch, batches * kBatch);
  }
  report(tally);
  return 0;
}
