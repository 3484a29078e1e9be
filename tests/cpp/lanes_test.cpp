// One lane vocabulary held to plain C++, lane by lane. tests/emission/test_lanes.py renders the
// files that are included by quotes, builds this once for each vocabulary and runs it, under an
// emulator where need be. So it has no dependency. It prints each function and how often it was
// compared.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <type_traits>
#if defined(__x86_64__)
#include <immintrin.h>
#else
#include <arm_neon.h>
#endif

#include "begin.inc"

#define CAROM_INLINE inline __attribute__((always_inline))

namespace {
namespace lanes {
#include "vocabulary.inc"
}  // namespace lanes

#include "facts.inc"  // kEstimateError, kFused, CAROM_CONVERTS

using lanes::kLanes;
using lanes::Mask;
using lanes::Number;
using lanes::Real;

typedef std::numeric_limits<Number> Limits;
typedef std::conditional<sizeof(Number) == 8, std::uint64_t, std::uint32_t>::type Word;

constexpr Number kInfinity = Limits::infinity();
constexpr Number kNan = Limits::quiet_NaN();
constexpr Number kSmallest = Limits::denorm_min();
constexpr Number of(double x) { return static_cast<Number>(x); }
constexpr Number kValues[] = {
    of(0.0),    of(-0.0),       of(1.0),        of(-1.0),      of(0.1),
    of(-0.3),   of(2.5),        of(3e7),        of(-7e-9),     kSmallest,
    -kSmallest, 20 * kSmallest, Limits::min(),  Limits::max(), -Limits::max() / 1000,
    kInfinity,  -kInfinity,     kNan,           of(1e-36),     of(1e-20),
    of(1e20),   of(0.9999999),  of(-1234.5678), of(4.0 / 3.0)};
constexpr int kCount = sizeof kValues / sizeof kValues[0];

int failures = 0;
long compared = 0;
constexpr std::uint64_t kWhole = ~std::uint64_t{0} >> (64 - kLanes);  // a bit for every lane

struct Lanes {
  Number at[kLanes];
};

// Values such that over `start` each lane meets each value.
Lanes values_from(int start, int stride) {
  Lanes out;
  for (int i = 0; i < kLanes; ++i) out.at[i] = kValues[(start + i * stride) % kCount];
  return out;
}

Word bits_of(Number x) {
  Word bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  return bits;
}
bool same_bits(Number a, Number b) { return bits_of(a) == bits_of(b); }
bool same(Number a, Number b) { return same_bits(a, b) || (std::isnan(a) && std::isnan(b)); }

void check(bool good, const char* name, int i, double a, double b, double got, double want) {
  ++compared;
  if (good) return;
  if (++failures <= 20) {
    std::printf("%s, lane %d of (%a, %a): got %a, want %a\n", name, i, a, b, got, want);
  }
}

Lanes out_of(Real x) {
  Lanes out;
  lanes::store(out.at, x);
  return out;
}

void report(const char* name) {
  std::printf("%-18s %ld lanes\n", name, compared);
  compared = 0;
}

// A function of lanes, and the same of numbers. (Lambdas would not get the target's attribute.)
#define CAROM_ONE(Name, of_lanes, of_numbers)            \
  struct Name {                                          \
    static Real of(Real a) { return of_lanes; }          \
    static Number plain(Number a) { return of_numbers; } \
  };
#define CAROM_TWO(Name, Result, Plain, of_lanes, of_numbers)      \
  struct Name {                                                   \
    static Result of(Real a, Real b) { return of_lanes; }         \
    static Plain plain(Number a, Number b) { return of_numbers; } \
  };
CAROM_TWO(Add, Real, Number, a + b, a + b)
CAROM_TWO(Subtract, Real, Number, a - b, a - b)
CAROM_TWO(Multiply, Real, Number, a* b, a* b)
CAROM_TWO(Divide, Real, Number, a / b, a / b)
CAROM_TWO(Min, Real, Number, lanes::smaller(a, b), a < b ? a : b)
CAROM_TWO(Max, Real, Number, lanes::larger(a, b), a > b ? a : b)
CAROM_TWO(Copysign, Real, Number, lanes::copysign(a, b), std::copysign(a, b))
CAROM_ONE(Negative, -a, -a)
CAROM_ONE(Sqrt, lanes::sqrt(a), std::sqrt(a))
CAROM_ONE(Abs, lanes::absolute(a), std::fabs(a))
CAROM_TWO(Less, Mask, bool, lanes::lt(a, b), a < b)
CAROM_TWO(LessEqual, Mask, bool, lanes::le(a, b), a <= b)
CAROM_TWO(Greater, Mask, bool, lanes::gt(a, b), a > b)
CAROM_TWO(GreaterEqual, Mask, bool, lanes::ge(a, b), a >= b)
CAROM_TWO(Equal, Mask, bool, lanes::eq(a, b), a == b)

template <class Function>
void one(const char* name) {
  for (int start = 0; start < kCount; ++start) {
    const Lanes a = values_from(start, 1);
    const Lanes got = out_of(Function::of(lanes::load(a.at)));
    for (int i = 0; i < kLanes; ++i) {
      const Number want = Function::plain(a.at[i]);
      check(same(got.at[i], want), name, i, a.at[i], 0.0, got.at[i], want);
    }
  }
  report(name);
}

template <class Function>
void two(const char* name) {
  for (int start = 0; start < kCount; ++start) {
    for (int other = 0; other < kCount; ++other) {
      const Lanes a = values_from(start, 1), b = values_from(other, 5);
      const Lanes got = out_of(Function::of(lanes::load(a.at), lanes::load(b.at)));
      for (int i = 0; i < kLanes; ++i) {
        const Number want = Function::plain(a.at[i], b.at[i]);
        check(same(got.at[i], want), name, i, a.at[i], b.at[i], got.at[i], want);
      }
    }
  }
  report(name);
}

template <class Function>
void compare(const char* name) {
  for (int start = 0; start < kCount; ++start) {
    for (int other = 0; other < kCount; ++other) {
      const Lanes a = values_from(start, 1), b = values_from(other, 5);
      const Mask mask = Function::of(lanes::load(a.at), lanes::load(b.at));
      const std::uint64_t bits = lanes::mask_bits(mask);
      const Lanes chosen = out_of(lanes::select(mask, lanes::load(a.at), lanes::load(b.at)));
      const Lanes kept = out_of(lanes::where(mask, lanes::load(a.at)));
      bool some = false, every = true;
      for (int i = 0; i < kLanes; ++i) {
        const bool want = Function::plain(a.at[i], b.at[i]);
        some = some || want;
        every = every && want;
        check(((bits >> i) & 1u) == want, name, i, a.at[i], b.at[i], (bits >> i) & 1u, want);
        const Number pick = want ? a.at[i] : b.at[i];
        check(same_bits(chosen.at[i], pick), "select", i, a.at[i], b.at[i], chosen.at[i], pick);
        const Number keep = want ? a.at[i] : of(0.0);
        check(same_bits(kept.at[i], keep), "where", i, a.at[i], b.at[i], kept.at[i], keep);
      }
      check((bits & ~kWhole) == 0, "mask_bits", 0, 0, 0, static_cast<double>(bits), 0);
      check(lanes::any(mask) == some, "any", 0, 0, 0, lanes::any(mask), some);
      check(lanes::all(mask) == every, "all", 0, 0, 0, lanes::all(mask), every);
      check(lanes::none(mask) == !some, "none", 0, 0, 0, lanes::none(mask), !some);
    }
  }
  report(name);
}

void three() {
  for (int start = 0; start < kCount; ++start) {
    for (int other = 0; other < kCount; ++other) {
      for (int third = 0; third < kCount; ++third) {
        const Lanes a = values_from(start, 1), b = values_from(other, 5), c = values_from(third, 7);
        const Lanes got =
            out_of(lanes::fma(lanes::load(a.at), lanes::load(b.at), lanes::load(c.at)));
        for (int i = 0; i < kLanes; ++i) {
          const Number product = a.at[i] * b.at[i];
          const Number want = kFused ? std::fma(a.at[i], b.at[i], c.at[i]) : product + c.at[i];
          check(same(got.at[i], want), "fma", i, a.at[i], b.at[i], got.at[i], want);
        }
      }
    }
  }
  report("fma");
}

void masks() {
  for (std::uint64_t i = 0; i <= kWhole && i < 4096; ++i) {
    const std::uint64_t p = (kLanes <= 12 ? i : i * 0x9e3779b97f4a7c15u >> 3) & kWhole;
    const std::uint64_t q = (p * 2654435761u >> 7) & kWhole;
    Lanes a, b;
    for (int j = 0; j < kLanes; ++j) {
      a.at[j] = (p >> j) & 1u;
      b.at[j] = (q >> j) & 1u;
    }
    const Mask m = lanes::gt(lanes::load(a.at), lanes::real(0.5));
    const Mask n = lanes::gt(lanes::load(b.at), lanes::real(0.5));
    const struct {
      const char* name;
      std::uint64_t got, want;
    } rows[] = {{"both", lanes::mask_bits(lanes::both(m, n)), p & q},
                {"either", lanes::mask_bits(lanes::either(m, n)), p | q},
                {"but_not", lanes::mask_bits(lanes::but_not(m, n)), p & ~q},
                {"inverse", lanes::mask_bits(lanes::inverse(m)), ~p & kWhole}};
    const Lanes packed = out_of(lanes::compress(lanes::lane_numbers(), m));
    int front = 0;
    const double of_mask = static_cast<double>(p);
    for (int j = 0; j < kLanes; ++j) {
      if (((p >> j) & 1u) == 0) continue;
      check(packed.at[front] == j, "compress", front, of_mask, 0, packed.at[front], j);
      ++front;
    }
    check(lanes::count(m) == front, "count", 0, of_mask, 0, lanes::count(m), front);
    for (const auto& row : rows) {
      check(row.got == row.want, row.name, 0, of_mask, static_cast<double>(q),
            static_cast<double>(row.got), static_cast<double>(row.want));
    }
  }
  for (int n = 0; n <= kLanes + 1; ++n) {
    const std::uint64_t want = n >= kLanes ? kWhole : (std::uint64_t{1} << n) - 1;
    const std::uint64_t got = lanes::mask_bits(lanes::first_lanes(n));
    check(got == want, "first_lanes", 0, n, 0, static_cast<double>(got), static_cast<double>(want));
  }
  check(lanes::all(lanes::mask_of(true)), "mask_of", 0, 1, 0, 0, 1);
  check(lanes::none(lanes::mask_of(false)), "mask_of", 0, 0, 0, 1, 0);
  report("masks");
}

// Loads and stores at every offset, and what they must leave alone.
void memory() {
  for (int offset = 0; offset < 9; ++offset) {
    for (std::uint64_t p = 0; p <= kWhole && p < 300; ++p) {
      Number from[kLanes + 16], to[kLanes + 16], where[kLanes + 16];
      for (int i = 0; i < kLanes + 16; ++i) {
        from[i] = of(i + 0.5);
        to[i] = where[i] = of(-1.0 - i);
      }
      Lanes a;
      for (int i = 0; i < kLanes; ++i) a.at[i] = (p >> i) & 1u;
      const Mask m = lanes::gt(lanes::load(a.at), lanes::real(0.5));
      lanes::store(to + offset, lanes::load(from + offset));
      lanes::store_where(where + offset, m, lanes::load(from + offset));
      for (int i = 0; i < kLanes + 16; ++i) {
        const int n = i - offset;
        const bool in = n >= 0 && n < kLanes;
        const double whole = in ? from[i] : -1.0 - i;
        const double part = in && ((p >> n) & 1u) ? from[i] : -1.0 - i;
        check(to[i] == whole, "store", n, offset, 0, to[i], whole);
        check(where[i] == part, "store_where", n, offset, static_cast<double>(p), where[i], part);
      }
    }
  }
  const Lanes numbers = out_of(lanes::lane_numbers());
  const Lanes broadcast = out_of(lanes::real(-0.0));
  for (int i = 0; i < kLanes; ++i) {
    check(numbers.at[i] == i, "lane_numbers", i, 0, 0, numbers.at[i], i);
    check(same_bits(broadcast.at[i], -0.0), "real", i, 0, 0, broadcast.at[i], -0.0);
    check(lanes::lane(lanes::lane_numbers(), i) == i, "lane", i, 0, 0, 0, i);
    const Lanes changed = out_of(lanes::set_lane(lanes::lane_numbers(), i, 77.0));
    for (int j = 0; j < kLanes; ++j) {
      const double want = j == i ? 77.0 : j;
      check(changed.at[j] == want, "set_lane", j, i, 0, changed.at[j], want);
    }
  }
  report("load and store");
}

// Doubles from floats and back, at every offset: rounded as a cast rounds.
void conversions() {
#if CAROM_CONVERTS
  float from[kCount + kLanes + 8], to[kCount + kLanes + 8];
  for (int start = 0; start < kCount; ++start) {
    const Lanes a = values_from(start, 1);
    for (int i = 0; i < kCount + kLanes + 8; ++i) {
      from[i] = static_cast<float>(kValues[(start + i) % kCount]);
      to[i] = -77.0F;
    }
    const Lanes got = out_of(lanes::load(from + start));
    lanes::store(to + start, lanes::load(a.at));
    for (int i = 0; i < kCount + kLanes + 8; ++i) {
      const int n = i - start;
      const bool in = n >= 0 && n < kLanes;
      const double want = in ? static_cast<double>(static_cast<float>(a.at[n])) : -77.0;
      check(same(to[i], want), "store of floats", n, start, 0, to[i], want);
      if (in) check(same(got.at[n], from[i]), "load of floats", n, start, 0, got.at[n], from[i]);
    }
  }
  report("conversions");
#endif
}

// What holds to within a bound: it prints the largest error found.
void estimates() {
  double worst = 0.0;
  double worst_power = 0.0;
  double x = 1e-36;
  while (x < 1e36 / 1.3) {  // the last ones are below 1e36
    Lanes a;
    for (int i = 0; i < kLanes; ++i) a.at[i] = of(x = x * 1.0037);
    const Lanes got = out_of(lanes::rsqrt_estimate(lanes::load(a.at)));
    for (int i = 0; i < kLanes; ++i) {
      const double error = std::fabs(got.at[i] * std::sqrt(static_cast<double>(a.at[i])) - 1.0);
      worst = error > worst ? error : worst;
      check(error <= kEstimateError, "rsqrt_estimate", i, a.at[i], 0, error, kEstimateError);
    }
    for (int n = 1; n <= 64; n += 7) {
      const Lanes root = out_of(lanes::power(lanes::load(a.at), n));
      for (int i = 0; i < kLanes; ++i) {
        const double error =
            std::fabs(root.at[i] / std::pow(static_cast<double>(a.at[i]), n / 64.0) - 1.0);
        worst_power = error > worst_power ? error : worst_power;
        check(error <= 0.0625, "power", i, a.at[i], n, error, 0.0625);
      }
    }
  }
  const Lanes zero = out_of(lanes::rsqrt_estimate(lanes::real(0.0)));
  const Lanes nan = out_of(lanes::rsqrt_estimate(lanes::real(kNan)));
  for (int i = 0; i < kLanes; ++i) {
    check(zero.at[i] == kInfinity, "rsqrt_estimate", i, 0, 0, zero.at[i], kInfinity);
    check(std::isnan(nan.at[i]), "rsqrt_estimate", i, kNan, 0, nan.at[i], kNan);
  }
  std::printf("rsqrt_estimate is off by %.3g at most, power by %.3g\n", worst, worst_power);
  report("estimates");
}

void powers_of_two() {
  for (int e = Limits::min_exponent; e < Limits::max_exponent - 1; ++e) {
    const Number power = std::ldexp(of(1.0), e);
    Lanes a;
    for (int i = 0; i < kLanes; ++i) a.at[i] = power * of(1.0 + i / (kLanes + 0.001));
    const Real down = lanes::power_of_two(lanes::load(a.at));
    const Lanes got = out_of(down), inverse = out_of(lanes::inverse_of_power(down));
    for (int i = 0; i < kLanes; ++i) {
      check(got.at[i] == power, "power_of_two", i, a.at[i], 0, got.at[i], power);
      check(inverse.at[i] == of(1.0) / power, "inverse_of_power", i, power, 0, inverse.at[i],
            1 / power);
    }
  }
  report("powers of two");
}

int run_all() {
  two<Add>("+");
  two<Subtract>("-");
  two<Multiply>("*");
  two<Divide>("/");
  two<Min>("min");
  two<Max>("max");
  two<Copysign>("copysign");
  one<Negative>("negative");
  one<Sqrt>("sqrt");
  one<Abs>("abs");
  compare<Less>("lt");
  compare<LessEqual>("le");
  compare<Greater>("gt");
  compare<GreaterEqual>("ge");
  compare<Equal>("eq");
  three();
  masks();
  memory();
  conversions();
  estimates();
  powers_of_two();
  std::printf("%d lanes, %d failures\n", kLanes, failures);
  return failures == 0 ? 0 : 1;
}

}  // namespace

int main() { return run_all(); }

#include "end.inc"
