// What the fuzzers share: bytes to collisions, and the end of a run that found something.
#ifndef CAROM_FUZZ_FUZZ_INPUT_H_
#define CAROM_FUZZ_FUZZ_INPUT_H_

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "kernel_table.h"

namespace carom_fuzz {

/// A collision as the C ABI takes it.
struct Case {
  carom::Parameters p;
  double balls[18];
};

/// Bytes of a fuzzer, taken from the front; zero when they run out.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  template <class Number>
  Number take() {
    Number value{};
    const std::size_t count = size_ < sizeof value ? size_ : sizeof value;
    if (count > 0) std::memcpy(&value, data_, count);
    data_ += count;
    size_ -= count;
    return value;
  }

  /// A number from low to high.
  double within(double low, double high) {
    return low + (high - low) * (take<std::uint16_t>() / 65535.0);
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// Any 24 doubles: most are no collision.
inline Case any_case(Bytes& bytes) {
  Case c{};
  double* const values[] = {&c.p.R, &c.p.M, &c.p.u_s1, &c.p.u_s2, &c.p.u_b, &c.p.e_b};
  for (double* value : values) *value = bytes.take<double>();
  for (double& value : c.balls) value = bytes.take<double>();
  return c;
}

/// A collision of the envelope of real use. Bits of `shape` take values where something ends (no
/// friction, no spin, rolling, gearing, ball 2 at rest), so that they are as likely as others.
inline Case real_case(Bytes& bytes) {
  Case c{};
  const unsigned shape = bytes.take<std::uint32_t>();
  const auto chosen = [shape](int bit) { return (shape >> bit & 1u) != 0; };
  c.p.R = bytes.within(0.025, 0.035);
  c.p.M = bytes.within(0.13, 0.3);
  c.p.u_s1 = chosen(0) ? 0.0 : bytes.within(0.0, 1.0);
  c.p.u_s2 = chosen(1) ? c.p.u_s1 : bytes.within(0.0, 1.0);
  c.p.u_b = chosen(2) ? 0.0 : bytes.within(0.0, 0.6);
  c.p.e_b = chosen(3) ? (chosen(4) ? 0.0 : 1.0) : bytes.within(0.0, 1.0);
  const double angle = chosen(5) ? 0.0 : bytes.within(-3.14159, 3.14159);
  const double cut = chosen(6) ? 0.0 : bytes.within(-1.5707, 1.5707);
  const double speed = std::pow(10.0, bytes.within(-6.0, 1.7));
  const double reach = 2.0 * c.p.R;
  c.balls[9] = reach * std::cos(angle);
  c.balls[10] = reach * std::sin(angle);
  c.balls[3] = speed * std::cos(angle + cut);
  c.balls[4] = speed * std::sin(angle + cut);
  for (int ball = 0; ball < 2; ++ball) {
    if (chosen(7 + ball)) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (!chosen(9 + axis)) {
        c.balls[9 * ball + 6 + axis] = bytes.within(-2.0, 2.0) * speed / c.p.R;
      }
    }
  }
  if (chosen(12)) {  // rolling
    c.balls[6] = -c.balls[4] / c.p.R;
    c.balls[7] = c.balls[3] / c.p.R;
  }
  if (chosen(13)) c.balls[8] = speed * std::sin(cut) / c.p.R;  // gearing: spin takes up the cut
  if (!chosen(14)) {
    c.balls[12] = bytes.within(-0.5, 0.5) * speed;
    c.balls[13] = bytes.within(-0.5, 0.5) * speed;
  }
  return c;
}

/// Any numbers, a collision of real use, or one of those with one number that is not.
inline Case some_case(Bytes& bytes) {
  const unsigned kind = bytes.take<std::uint8_t>();
  Case c = (kind & 1u) != 0 ? any_case(bytes) : real_case(bytes);
  if ((kind & 6u) == 6u) c.balls[bytes.take<std::uint8_t>() % 18] = bytes.take<double>();
  return c;
}

/// Print a finding so that it can be done again, to the last bit, and abort.
[[noreturn]] inline void found(const char* what, const carom::Row& row, const Case& c) {
  std::fprintf(stderr, "%s\nkernel %s\n", what, row.functions.name());
  std::fprintf(stderr, "R %a M %a u_s1 %a u_s2 %a u_b %a e_b %a\n", c.p.R, c.p.M, c.p.u_s1,
               c.p.u_s2, c.p.u_b, c.p.e_b);
  for (int i = 0; i < 18; ++i) std::fprintf(stderr, "%a%s", c.balls[i], i % 9 == 8 ? "\n" : " ");
  std::abort();
}

}  // namespace carom_fuzz

#endif  // CAROM_FUZZ_FUZZ_INPUT_H_
