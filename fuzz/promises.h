// What carom.h promises of every outcome, however it was asked for.
#ifndef CAROM_FUZZ_PROMISES_H_
#define CAROM_FUZZ_PROMISES_H_

#include <initializer_list>

#include "fuzz_input.h"

namespace carom_fuzz {

constexpr int kOk = 0, kTilted = 3;
constexpr double kMostChange = 20.0;  // times |v1 - v2|; 6 are possible, coarse steps overshoot

/// Both balls after a collision, and its status.
struct Outcome {
  double balls[18];
  int status;
};

inline bool same(const double* a, const double* b, std::size_t count) {
  return std::memcmp(a, b, count * sizeof(double)) == 0;
}

/// The largest difference of two outcomes, in speeds (m/s; spins as R w), relative to |v1 - v2|.
inline double apart(const Outcome& a, const Outcome& b, const Case& c) {
  const double relative = std::hypot(c.balls[12] - c.balls[3], c.balls[13] - c.balls[4]);
  double most = 0.0;
  for (int i = 0; i < 18; ++i) {
    const double unit = i % 9 < 6 ? 1.0 : c.p.R;
    most = std::fmax(most, std::fabs(a.balls[i] - b.balls[i]) * unit);
  }
  return most / relative;
}

// pooltool's axes are not orthogonal then, and change even what no impulse changes.
inline bool tilted(const Case& c) {
  const double x = c.balls[9] - c.balls[0], y = c.balls[10] - c.balls[1];
  return std::fabs(c.balls[11] - c.balls[2]) > 1e-9 * std::hypot(x, y);
}

/// Stops the run unless an outcome has a known status, is the input where that is not OK, and else
/// is finite and changes by no more than a collision can.
inline void check_promises(const carom::Row& row, const Case& c, const Outcome& o) {
  if (o.status < kOk || o.status > kTilted) found("no such status", row, c);
  if (!same(o.balls, c.balls, 3) || !same(o.balls + 9, c.balls + 9, 3)) {
    found("a ball was moved", row, c);
  }
  if (o.status != kOk) {
    if (!same(o.balls, c.balls, 18)) found("not as it came, though refused", row, c);
    return;
  }
  for (double value : o.balls) {
    if (!std::isfinite(value)) found("not finite", row, c);
  }
  if (tilted(c)) return;
  const double* const b = c.balls;
  const double relative = std::hypot(std::hypot(b[12] - b[3], b[13] - b[4]), b[14] - b[5]);
  double fastest = 0.0;
  for (int i : {3, 4, 5, 12, 13, 14}) fastest = std::fmax(fastest, std::fabs(b[i]));
  for (int i : {6, 7, 8, 15, 16, 17}) fastest = std::fmax(fastest, c.p.R * std::fabs(b[i]));
  const double most = kMostChange * relative + 1e-9 * fastest;
  for (int i = 0; i < 18; ++i) {
    const double unit = i % 9 < 6 ? 1.0 : c.p.R;
    if (std::fabs(o.balls[i] - b[i]) * unit > most) found("changed by too much", row, c);
  }
}

/// A batch of one collision.
inline Outcome alone(const carom::Row& row, const Case& c) {
  const double* in[18];
  double* out[12];
  Outcome o{};
  std::memcpy(o.balls, c.balls, sizeof o.balls);
  for (int j = 0; j < 18; ++j) in[j] = &c.balls[j];
  for (int j = 0; j < 12; ++j) out[j] = &o.balls[j < 6 ? j + 3 : j + 6];
  unsigned char status = 0;
  row.functions.batch(c.p, nullptr, 1, in, out, &status);
  o.status = status;
  return o;
}

}  // namespace carom_fuzz

#endif  // CAROM_FUZZ_PROMISES_H_
