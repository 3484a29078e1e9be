// Many collisions of two balls at once, in lanes of doubles: as solve_exact_as<double>, in a third
// of the time. The series of a step are expanded for all lanes together; everything else of a
// collision is done by itself, and a lane whose collision is over takes the next.
#ifndef CAROM_TESTS_ORACLE_EXACT_LANES_H_
#define CAROM_TESTS_ORACLE_EXACT_LANES_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "exact_solver.h"

namespace carom_oracle {
namespace detail {

constexpr int kLanes = 8;
/// A number for each lane. Copying is written out so that none is passed in registers, whose size
/// depends on the instruction set.
struct Pack {
  typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));
  Lanes lanes;

  Pack() : lanes{} {}
  Pack(const Pack& other) : lanes(other.lanes) {}
  explicit Pack(const Lanes& given) : lanes(given) {}
  Pack& operator=(const Pack& other) {
    lanes = other.lanes;
    return *this;
  }

  Pack& operator+=(const Pack& b) {
    lanes += b.lanes;
    return *this;
  }
  Pack& operator-=(const Pack& b) {
    lanes -= b.lanes;
    return *this;
  }
  friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.lanes + b.lanes); }
  friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.lanes - b.lanes); }
  friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.lanes * b.lanes); }
  friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.lanes / b.lanes); }
  friend Pack operator-(const Pack& a) { return Pack(-a.lanes); }
  friend Pack operator*(const Pack& a, double b) { return Pack(a.lanes * b); }
  friend Pack operator-(double a, const Pack& b) { return Pack(a - b.lanes); }
  friend Pack operator/(double a, const Pack& b) { return Pack(a / b.lanes); }
};

inline Pack square_root(const Pack& x) {
  Pack root;
  for (int i = 0; i < kLanes; ++i) root.lanes[i] = std::sqrt(x.lanes[i]);
  return root;
}
// A division takes ten times as long, and half a unit in the last place of a term is of no account.
inline Pack quotient(const Pack& a, int n) { return a * (1.0 / n); }

using LaneSeries = Expansion<Pack, Impact<double>::kOrder>;
using LaneEquations = Equations<Pack>;

// The same text for each instruction set: -ffp-contract=off gives the same bits on all of them.
#define CAROM_EXPAND(name, attributes)                                                 \
  attributes inline void name(const LaneEquations& of, const LaneSeries::State& start, \
                              LaneSeries* series) {                                    \
    series->expand(of, start);                                                         \
  }
CAROM_EXPAND(expand_usual, )
#if defined(__x86_64__)
CAROM_EXPAND(expand_avx2, __attribute__((target("avx2"), flatten)))
CAROM_EXPAND(expand_avx512, __attribute__((target("avx512f"), flatten)))
#endif
#undef CAROM_EXPAND

using Expand = void (*)(const LaneEquations&, const LaneSeries::State&, LaneSeries*);
inline Expand widest_expansion() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx512f")) return expand_avx512;
  if (__builtin_cpu_supports("avx2")) return expand_avx2;
#endif
  return expand_usual;
}

inline void set_lane(const Equations<double>& from, int lane, LaneEquations* to) {
  for (int k = 0; k < 2; ++k) {
    to->inverse_mass[k].lanes[lane] = from.inverse_mass[k];
    to->pace[k].lanes[lane] = from.pace[k];
  }
  to->u_b.lanes[lane] = from.u_b;
  to->u_s.lanes[lane] = from.u_s;
  to->press_sign.lanes[lane] = from.press_sign;
  to->table.lanes[lane] = from.table;
  to->forward.lanes[lane] = from.forward;
}

/// Runs collisions that press the same ball to their ends.
class LaneRunner {
 public:
  void run(const std::vector<Impact<double>*>& impacts) {
    std::array<Impact<double>*, kLanes> in_lane{};
    std::size_t next = 0;
    for (;;) {
      int busy = 0;
      for (int lane = 0; lane < kLanes; ++lane) {
        Impact<double>*& impact = in_lane[lane];
        while (impact == nullptr || !impact->needs_series()) {
          impact = next < impacts.size() ? impacts[next++] : nullptr;
          if (impact == nullptr) break;
        }
        if (impact == nullptr) continue;
        load(*impact, lane);
        ++busy;
      }
      if (busy == 0) return;
      expand_(equations_, start_, &series_);
      for (int lane = 0; lane < kLanes; ++lane) {
        if (in_lane[lane] == nullptr) continue;
        in_lane[lane]->step_along([&](int n, int i) { return series_.y[n][i].lanes[lane]; });
      }
    }
  }

 private:
  void load(const Impact<double>& impact, int lane) {
    equations_.model = impact.equations().model;
    equations_.pressed = impact.equations().pressed;
    set_lane(impact.equations(), lane, &equations_);
    for (int i = 0; i < kUnknowns; ++i) start_[i].lanes[lane] = impact.state()[i];
  }

  Expand expand_ = widest_expansion();
  LaneEquations equations_{};
  LaneSeries::State start_{};
  LaneSeries series_;
};

}  // namespace detail

/// Runs all collisions to their ends.
inline void run_in_lanes(std::vector<detail::Collision<double>>* collisions) {
  std::array<std::vector<detail::Impact<double>*>, 2> by_pressed;
  for (auto& collision : *collisions) {
    if (auto* impact = collision.impact()) {
      by_pressed[impact->equations().pressed].push_back(impact);
    }
  }
  detail::LaneRunner runner;
  for (const auto& impacts : by_pressed) runner.run(impacts);
}

}  // namespace carom_oracle

#endif  // CAROM_TESTS_ORACLE_EXACT_LANES_H_
