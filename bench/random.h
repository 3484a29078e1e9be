// Random numbers and elementary functions that are the same with every standard library.
#ifndef CAROM_BENCH_RANDOM_H_
#define CAROM_BENCH_RANDOM_H_

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace carom_bench {

// The elementary functions are written out because libm's last digit differs between systems.
inline double exp_series(double x) {
  double term = 1, sum = 1;
  for (int n = 1; n < 26; ++n) {
    term *= x / n;
    sum += term;
  }
  return sum;
}

inline double power_of_10(double x) {
  const double bits = x * 3.321928094887362;
  const double whole = std::floor(bits);
  return std::ldexp(exp_series((bits - whole) * 0.6931471805599453), static_cast<int>(whole));
}

inline double sine(double x) {
  double term = x, sum = x;
  for (int n = 2; n < 30; n += 2) {
    term *= -x * x / (n * (n + 1));
    sum += term;
  }
  return sum;
}

constexpr double kRightAngle = 1.5707963267948966;
constexpr double kDegree = kRightAngle / 90;

/// xoshiro256** (Blackman, Vigna, doi 10.1145/3460772), seeded by splitmix64. Never draw twice in
/// one expression or argument list: compilers differ in which draw comes first.
class Random {
 public:
  explicit Random(std::uint64_t seed) {
    for (std::uint64_t& s : state_) s = splitmix(&seed);
  }

  std::uint64_t bits() {
    const std::uint64_t result = rotate(state_[1] * 5, 7) * 9;
    const std::uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = rotate(state_[3], 45);
    return result;
  }

  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  /// 10^x, x uniform.
  double decades(double low, double high) { return power_of_10(uniform(low, high)); }
  bool chance(double p) { return unit() < p; }
  double sign() { return chance(0.5) ? 1 : -1; }
  double signed_decades(double low, double high) {
    const double s = sign();
    return s * decades(low, high);
  }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(bits() % n); }

  /// Uniform direction in the plane.
  void direction(double* x, double* y) {
    double a, b, s;
    do {
      a = uniform(-1, 1);
      b = uniform(-1, 1);
      s = a * a + b * b;
    } while (s > 1 || s < 0.01);
    *x = a / std::sqrt(s);
    *y = b / std::sqrt(s);
  }

 private:
  static std::uint64_t rotate(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }
  static std::uint64_t splitmix(std::uint64_t* x) {
    std::uint64_t z = (*x += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  std::uint64_t state_[4];
};

}  // namespace carom_bench

#endif  // CAROM_BENCH_RANDOM_H_
