// Throw of a stun shot as a picture: by how much friction between the balls turns the object ball
// away from the line of centres, over cut angle and speed. Friction falls with the slip between the
// balls (Alciatore, TP A.14), so each collision of the batch has its own u_b.
//
//   throw_map OUT.svg
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "carom.hpp"

namespace {

constexpr double kRadius = 0.028575;  // m
constexpr double kPi = 3.14159265358979323846;
constexpr int kCuts = 60;         // columns: 0 to 88.5 degrees
constexpr int kSpeeds = 40;       // rows: 0.1 to 10 m/s, each 12 % more
constexpr double kCutStep = 1.5;  // degrees
constexpr int kCell = 10;         // of the picture, in pixels

double cut_of(int column) { return kCutStep * column; }
double speed_of(int row) { return 0.1 * std::pow(100.0, row / (kSpeeds - 1.0)); }
double friction_of(double slip) { return 9.951e-3 + 0.108 * std::exp(-1.088 * slip); }

// Nine columns of n numbers: one ball of every collision.
class Balls {
 public:
  explicit Balls(std::size_t n) : columns_(9, std::vector<double>(n)) {}
  void set(std::size_t i, const carom::Ball& ball) {
    for (std::size_t k = 0; k < 9; ++k) columns_[k][i] = carom::doubles(ball)[k];
  }
  carom::BallColumns before() {
    return {vectors<const double>(0), vectors<const double>(3), vectors<const double>(6)};
  }
  carom::VelocityColumns after() { return {vectors<double>(3), vectors<double>(6)}; }
  double velocity_x(std::size_t i) const { return columns_[3][i]; }
  double velocity_y(std::size_t i) const { return columns_[4][i]; }

 private:
  template <class T>
  carom::Vectors<T> vectors(std::size_t k) {
    return {columns_[k], columns_[k + 1], columns_[k + 2]};
  }
  std::vector<std::vector<double>> columns_;
};

// Throw in degrees, row by row; empty where a collision was refused.
std::vector<double> throws() {
  constexpr std::size_t n = static_cast<std::size_t>(kCuts) * kSpeeds;
  const carom::Parameters cloth = {kRadius, 0.17, 0.2, 0.2, 0.05, 0.95};
  Balls cue(n);
  Balls object(n);
  std::vector<double> u_b(n);
  carom::Ball rest;
  rest.position = {0.0, 2.0 * kRadius, 0.0};  // so the line of centres is y
  for (std::size_t i = 0; i < n; ++i) {
    const double cut = cut_of(static_cast<int>(i) % kCuts) * kPi / 180.0;
    const double speed = speed_of(static_cast<int>(i) / kCuts);
    carom::Ball hit;
    hit.velocity = {speed * std::sin(cut), speed * std::cos(cut), 0.0};
    cue.set(i, hit);
    object.set(i, rest);
    u_b[i] = friction_of(hit.velocity.x);
  }
  const auto done =
      carom::collide(cloth, cue.before(), object.before(), cue.after(), object.after(), {}, u_b);
  if (!done || *done != n) return {};
  std::vector<double> angles(n);
  for (std::size_t i = 0; i < n; ++i) {
    angles[i] = std::atan2(object.velocity_x(i), object.velocity_y(i)) * 180.0 / kPi;
  }
  return angles;
}

// From dark blue over green to yellow.
void colour(double share, int rgb[3]) {
  static constexpr double kStops[4][3] = {
      {68, 1, 84}, {49, 104, 142}, {53, 183, 121}, {253, 231, 37}};
  const double place = 3.0 * std::min(std::max(share, 0.0), 1.0);
  const int stop = std::min(static_cast<int>(place), 2);
  for (int c = 0; c < 3; ++c) {
    rgb[c] = static_cast<int>(kStops[stop][c] +
                              (place - stop) * (kStops[stop + 1][c] - kStops[stop][c]));
  }
}

void cell(std::FILE* file, double x, double y, double width, double share) {
  int rgb[3];
  colour(share, rgb);
  std::fprintf(file, "<rect x='%g' y='%g' width='%g' height='%d' fill='#%02x%02x%02x'/>\n", x, y,
               width, kCell, rgb[0], rgb[1], rgb[2]);
}

void text(std::FILE* file, double x, double y, const char* words) {
  std::fprintf(file, "<text x='%g' y='%g'>%s</text>\n", x, y, words);
}

bool write_picture(const char* path, const std::vector<double>& angles, double most) {
  std::FILE* file = std::fopen(path, "w");
  if (file == nullptr) return false;
  constexpr int left = 60, top = 40, width = kCuts * kCell, height = kSpeeds * kCell;
  std::fprintf(
      file,
      "<svg xmlns='http://www.w3.org/2000/svg' width='%d' height='%d' font-family='sans-serif' "
      "font-size='12' shape-rendering='crispEdges'>\n<rect width='100%%' height='100%%' "
      "fill='white'/>\n",
      left + width + 90, top + height + 50);
  text(file, left, 22, "Throw of a stun shot in degrees");
  for (int row = 0; row < kSpeeds; ++row) {
    const double y = top + height - (row + 1) * kCell;
    for (int column = 0; column < kCuts; ++column) {
      const double angle = angles[static_cast<std::size_t>(row) * kCuts + column];
      cell(file, left + column * kCell, y, kCell, angle / most);
    }
  }
  char words[64];
  for (int column = 0; column < kCuts; column += 10) {
    std::snprintf(words, sizeof words, "%g&#176;", cut_of(column));
    text(file, left + column * kCell, top + height + 18, words);
  }
  text(file, left + width / 2.0 - 30, top + height + 40, "cut angle");
  for (int row = 0; row < kSpeeds; row += 13) {
    std::snprintf(words, sizeof words, "%.2g m/s", speed_of(row));
    text(file, 4, top + height - row * kCell, words);
  }
  for (int step = 0; step < 20; ++step) {
    cell(file, left + width + 20, top + height - (step + 1) * kCell * 2, 16, (step + 0.5) / 20);
    cell(file, left + width + 20, top + height - (step + 1) * kCell * 2 + kCell, 16,
         (step + 0.5) / 20);
  }
  std::snprintf(words, sizeof words, "%.1f", most);
  text(file, left + width + 40, top + 10, words);
  text(file, left + width + 40, top + height, "0");
  std::fputs("</svg>\n", file);
  return std::fclose(file) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: throw_map OUT.svg\n", stderr);
    return 2;
  }
  const std::vector<double> angles = throws();
  if (angles.empty()) {
    std::fputs("throw_map: a collision was refused\n", stderr);
    return 1;
  }
  const auto most = std::max_element(angles.begin(), angles.end());
  const int at = static_cast<int>(most - angles.begin());
  if (!write_picture(argv[1], angles, *most)) {
    std::fprintf(stderr, "throw_map: %s cannot be written\n", argv[1]);
    return 1;
  }
  std::printf("%d collisions by %s\nmost throw: %.2f degrees at a cut of %g degrees and %.2f m/s\n",
              kCuts * kSpeeds, carom::kernel(), *most, cut_of(at % kCuts), speed_of(at / kCuts));
  return 0;
}
