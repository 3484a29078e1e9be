#include "cases.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <istream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "case_rows.h"
#include "impact.h"
#include "random.h"

namespace carom_bench {
namespace {

// ---------------------------------------------------------------------------------------- CSV

const char* const kNumberColumns[] = {"R",   "M",   "u_s1", "u_s2", "u_b", "e_b", "r1x", "r1y",
                                      "r1z", "v1x", "v1y",  "v1z",  "w1x", "w1y", "w1z", "r2x",
                                      "r2y", "r2z", "v2x",  "v2y",  "v2z", "w2x", "w2y", "w2z"};
constexpr int kNumbers = 24;

std::string trimmed(const std::string& text) {
  const char* const blank = " \t\r";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t end = line.find(',', begin);
    fields.push_back(trimmed(line.substr(begin, end - begin)));
    if (end == std::string::npos) return fields;
    begin = end + 1;
  }
}

class CaseReader {
 public:
  CaseReader(std::istream& in, std::string name) : in_(in), name_(std::move(name)) {}

  std::vector<Case> read() {
    read_header();
    std::vector<Case> cases;
    while (next_line()) {
      if (!trimmed(text_).empty()) cases.push_back(row());
    }
    if (in_.bad()) throw std::runtime_error(name_ + ": cannot be read to its end");
    return cases;
  }

 private:
  bool next_line() {
    ++line_;
    return static_cast<bool>(std::getline(in_, text_));
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error(name_ + ": line " + std::to_string(line_) + ": " + what);
  }
  [[noreturn]] void fail_at(const std::string& column, const std::string& what) const {
    fail("column '" + column + "': " + what);
  }

  void read_header() {
    if (!next_line()) fail("is empty; expected a header with id, kind, R, M, ... w2z");
    if (text_.compare(0, 3, "\xEF\xBB\xBF") == 0) text_.erase(0, 3);
    const std::vector<std::string> names = split(text_);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (!column_.emplace(names[i], i).second && is_needed(names[i])) {
        fail_at(names[i], "appears twice; expected once");
      }
    }
    width_ = names.size();
    need("id");
    need("kind");
    for (const char* name : kNumberColumns) need(name);
  }

  static bool is_needed(const std::string& name) {
    if (name == "id" || name == "kind") return true;
    for (const char* number : kNumberColumns) {
      if (name == number) return true;
    }
    return false;
  }

  void need(const std::string& name) const {
    if (column_.count(name) != 0) return;
    fail("column '" + name +
         "' is missing; expected a header with id, kind, R, M, u_s1, u_s2, "
         "u_b, e_b, r1x..w1z, r2x..w2z");
  }

  Case row() {
    fields_ = split(text_);
    if (fields_.size() != width_) {
      fail(std::to_string(fields_.size()) + " fields; expected " + std::to_string(width_) +
           " as in the header");
    }
    Case c{};
    c.id = integer("id");
    c.kind = field("kind");
    double x[kNumbers];
    for (int i = 0; i < kNumbers; ++i) x[i] = number(kNumberColumns[i]);
    c.params = {x[0], x[1], x[2], x[3], x[4], x[5]};
    for (int i = 0; i < 9; ++i) {
      c.ball1[i] = x[6 + i];
      c.ball2[i] = x[15 + i];
    }
    return c;
  }

  const std::string& field(const std::string& name) const { return fields_[column_.at(name)]; }

  template <class T>
  T parse(const std::string& name, const char* expected) const {
    const std::string& text = field(name);
    const char* begin = text.data();
    const char* const end = begin + text.size();
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') ++begin;
    T value{};
    const auto result = std::from_chars(begin, end, value);
    if (result.ec == std::errc::result_out_of_range) {
      fail_at(name, "'" + text + "' is out of range; expected " + expected);
    }
    if (result.ec != std::errc() || result.ptr != end) {
      fail_at(name, "'" + text + "' is not a number; expected " + expected);
    }
    return value;
  }
  long integer(const std::string& name) const { return parse<long>(name, "an integer"); }
  double number(const std::string& name) const {
    return parse<double>(name, "a decimal number such as 0.25 or 1e-3");
  }

  std::istream& in_;
  std::string name_, text_;
  long line_ = 0;
  std::size_t width_ = 0;
  std::map<std::string, std::size_t> column_;
  std::vector<std::string> fields_;
};

// ----------------------------------------------------------------------------------- the kinds

/// Velocity v and R w of a ball in the frame (r, f, u) of the collision; all in m/s.
struct Motion {
  double vx = 0, vy = 0, sx = 0, sy = 0, sz = 0;

  // Rolling is spin = 1, back spin at the same rate is spin = -1.
  void roll(double spin) {
    sx = -spin * vy;
    sy = spin * vx;
  }
};

/// A case under construction.
struct Draft {
  Params p;
  Motion b1, b2;
  double distance = 0;   // from the origin, m; 0 is anywhere on the table
  bool aligned = false;  // line of centres along an axis, where no direction is rounded
  bool may_swap = false;
};

struct Preset {
  double R, M, u_s, e;
};
constexpr Preset kPresets[] = {{0.028575, 0.170097, 0.20, 0.95},
                               {0.02625, 0.1406, 0.21, 0.89},
                               {0.03075, 0.21, 0.18, 0.93},
                               {0.034, 0.28, 0.22, 0.92}};

Draft table_draft(Random& rng) {
  const Preset& t = kPresets[rng.below(4)];
  Draft d;
  d.p = {t.R, t.M, t.u_s, t.u_s, rng.uniform(0.02, 0.12), t.e};
  return d;
}

void aim(Random& rng, double speed, double cut, Motion* b) {
  b->vx = rng.sign() * speed * sine(cut);
  b->vy = speed * sine(kRightAngle - cut);
}

// low, high: powers of ten of the speed.
Draft ordinary(Random& rng, double low, double high) {
  Draft d = table_draft(rng);
  d.p.u_b = rng.decades(-2, -0.83);
  d.p.e_b = std::min(1.0, d.p.e_b + rng.uniform(-0.06, 0.06));
  if (rng.chance(0.2)) d.p.u_s2 = rng.uniform(0.05, 0.4);
  const double speed = rng.decades(low, high);
  const double cut = rng.uniform(0, 83) * kDegree;
  aim(rng, speed, cut, &d.b1);
  return d;
}

Draft rolling_vs_rest(Random& rng) {
  Draft d = ordinary(rng, -1.3, 0.9);
  d.b1.roll(1);
  return d;
}
Draft stun_vs_rest(Random& rng) { return ordinary(rng, -1.3, 0.9); }
Draft draw_vs_rest(Random& rng) {
  Draft d = ordinary(rng, -1.3, 0.9);
  d.b1.roll(-rng.uniform(0.2, 1.2));
  d.b1.sz = rng.uniform(-0.3, 0.3) * d.b1.vy;
  return d;
}
Draft side_vs_rest(Random& rng) {
  Draft d = ordinary(rng, -1.3, 0.9);
  d.b1.roll(rng.uniform(-0.5, 1));
  d.b1.sz = rng.uniform(-1.2, 1.2) * (d.b1.vy + 0.3 * std::fabs(d.b1.vx));
  return d;
}

void spin_freely(Random& rng, double most, Motion* b) {
  b->sx = rng.uniform(-most, most);
  b->sy = rng.uniform(-most, most);
  b->sz = rng.uniform(-most, most);
}

// The second ball runs anywhere, but so that the two approach.
void second_runs(Random& rng, Draft* d) {
  const double v = std::fabs(d->b1.vx) + d->b1.vy;
  d->b2.vx = rng.uniform(-1, 1) * v;
  d->b2.vy = rng.uniform(-1, 0.99) * d->b1.vy;
  spin_freely(rng, v, &d->b2);
  d->may_swap = true;
}

Draft both_moving(Random& rng) {
  Draft d = ordinary(rng, -1.3, 0.9);
  spin_freely(rng, std::fabs(d.b1.vx) + d.b1.vy, &d.b1);
  second_runs(rng, &d);
  return d;
}
Draft break_shot(Random& rng) {
  Draft d = ordinary(rng, 0.9, 1.11);
  d.b1.roll(1);
  d.b1.sz = rng.uniform(-1, 1);
  return d;
}

Draft shot(Random& rng) {
  Draft d = table_draft(rng);
  const double speed = rng.uniform(0.3, 5);
  const double cut = rng.uniform(0.3, 75) * kDegree;
  aim(rng, speed, cut, &d.b1);
  return d;
}
Draft spun_shot(Random& rng) {
  Draft d = shot(rng);
  d.b1.roll(rng.uniform(-1, 1.1));
  d.b1.sz = rng.uniform(-1, 1) * d.b1.vy;
  return d;
}

Draft gearing_exact(Random& rng) {
  Draft d = shot(rng);
  d.b1.sz = d.b1.vx;
  d.aligned = rng.chance(0.5);
  return d;
}
Draft gearing_near(Random& rng) {
  Draft d = shot(rng);
  double x, z;
  rng.direction(&x, &z);
  const double c = rng.decades(-15, -3);
  d.b1.sz = d.b1.vx - c * x;
  d.b1.sx = c * z;
  if (rng.chance(0.5)) second_runs(rng, &d);
  d.b1.sz += -d.b2.vx - d.b2.sz;
  d.b1.sx -= d.b2.sx;
  return d;
}
Draft grazing(Random& rng) {
  Draft d = table_draft(rng);
  const double off = rng.decades(-2, 0.7) * kDegree;
  const double v = rng.uniform(0.3, 5);
  d.b1.vx = rng.sign() * v * sine(kRightAngle - off);
  d.b1.vy = v * sine(off);
  d.b1.roll(rng.chance(0.5) ? 1 : rng.uniform(-1, 1));
  if (rng.chance(0.5)) d.b1.sz = rng.uniform(-1, 1) * v;
  return d;
}
Draft slow(Random& rng) {
  Draft d = spun_shot(rng);
  const double k = rng.decades(-6, -3);
  for (double* x : {&d.b1.vx, &d.b1.vy, &d.b1.sx, &d.b1.sy, &d.b1.sz}) *x *= k;
  return d;
}
Draft fast(Random& rng) {
  Draft d = spun_shot(rng);
  const double k = rng.uniform(8, 10);
  for (double* x : {&d.b1.vx, &d.b1.vy, &d.b1.sx, &d.b1.sy, &d.b1.sz}) *x *= k;
  return d;
}
Draft sticks(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.u_b = rng.uniform(0.2, 0.6);
  d.b1.roll(rng.uniform(-0.3, 0.3));
  d.b1.sz = d.b1.vx * rng.uniform(0.7, 1.1);
  return d;
}
// Back spin that leaves the slip of the pressed ball near zero, at the top point or the bottom.
Draft flip(Random& rng) {
  Draft d = shot(rng);
  d.b1.roll(-rng.uniform(0.7, 1.05));
  d.b1.sz = rng.uniform(-1, 1) * d.b1.vy;
  if (!rng.chance(0.5)) return d;
  d.b1.roll(1);
  d.b2.vy = -d.b1.vy * rng.uniform(0, 0.5);
  d.b2.vx = d.b2.vy * rng.uniform(-0.2, 0.2);
  return d;
}

Draft head_on(Random& rng, double spin) {
  Draft d = table_draft(rng);
  d.b1.vy = rng.uniform(0.3, 5);
  d.b1.roll(spin);
  d.aligned = rng.chance(0.5);
  return d;
}
Draft headon_stun(Random& rng) { return head_on(rng, 0); }
Draft headon_roll(Random& rng) { return head_on(rng, rng.uniform(0.1, 1)); }
Draft headon_draw(Random& rng) { return head_on(rng, -rng.uniform(0.1, 1.5)); }

Draft plastic(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.e_b = 0;
  return d;
}
Draft elastic(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.e_b = 1;
  return d;
}
Draft no_table_friction(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.u_s1 = d.p.u_s2 = 0;
  return d;
}
Draft no_ball_friction(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.u_b = 0;
  return d;
}
Draft huge_spin(Random& rng) {
  Draft d = shot(rng);
  const double most = 2000 * d.p.R;
  spin_freely(rng, most, &d.b1);
  spin_freely(rng, most * (rng.chance(0.5) ? 3 : 1), &d.b2);
  return d;
}
Draft asym_table(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.u_s1 = rng.uniform(0.1, 1);
  d.p.u_s2 = rng.decades(-3, 0);
  return d;
}
Draft tiny_slip_pressed(Random& rng) {
  Draft d = shot(rng);
  d.b1.roll(1);
  double x, y;
  rng.direction(&x, &y);
  const double v = rng.decades(-12, -4);
  d.b2.vx = v * x;
  d.b2.vy = v * y;
  return d;
}
Draft far_from_origin(Random& rng) {
  Draft d = spun_shot(rng);
  d.distance = rng.decades(2.5, 4);
  return d;
}

// ----------------------------------------------------------------- kinds beyond the reference

/// Sets the motions from the slips: c between the balls, s of ball 2 (pressed when c_z < 0) on the
/// table, at the top or the bottom point, and the speed of approach.
void set_slips(Random& rng, double cx, double cz, double sx, double sy, bool top, Draft* d) {
  const double approach = d->b1.vy;
  const double side = top ? 1 : -1;
  d->b2.vx = rng.uniform(-0.5, 0.5) * approach;
  d->b2.vy = rng.uniform(-1, 0.5) * approach;
  if (d->aligned) d->b2.vx = 0;
  d->b2.sy = side * (sx - d->b2.vx);
  d->b2.sx = side * (d->b2.vy - sy);
  d->b1.vy = d->b2.vy + approach;
  d->b1.sx = cz - d->b2.sx;
  d->b1.vx = d->b2.vx + rng.uniform(-1, 1) * approach;
  d->b1.sz = d->b1.vx - d->b2.vx - cx;
  d->b1.sy = rng.uniform(-1, 1) * approach;
}

/// Impulse (per mass) after which the slip (cx, cz) is gone when the table has no friction.
double sticking_impulse(double cx, double cz, double rate_z, double u_b) {
  constexpr int kHalf = 400;
  constexpr double kStep = 6.0 / (2 * kHalf);
  double sum = 0;
  for (int i = 0; i <= 2 * kHalf; ++i) {
    const double decay = power_of_10(-0.4342944819032518 * i * kStep);
    double d7 = decay * decay * decay;
    d7 *= d7 * decay;
    const double x = cx * d7;
    const double z = cz * (rate_z > 5.5 ? d7 / decay : d7 / (decay * decay));
    const double weight = i == 0 || i == 2 * kHalf ? 1 : (i % 2 == 0 ? 2 : 4);
    sum += weight * std::sqrt(x * x + z * z);
  }
  return sum * kStep / 3 / u_b;
}

// The slip vanishes just before or after the end of compression or of the collision.
Draft near_sticking_end(Random& rng) {
  Draft d = table_draft(rng);
  d.b1.vy = rng.decades(-1, 1);
  double cx, cz;
  rng.direction(&cx, &cz);
  cz = -std::fabs(cz);
  if (rng.chance(0.3)) cz = cx * rng.decades(-14, -1);
  const double off = rng.chance(0.5) ? rng.signed_decades(-14, -1) : rng.uniform(-0.05, 0.05);
  const double end = (rng.chance(0.3) ? 0.5 : (1 + d.p.e_b) / 2) * d.b1.vy * (1 + off);
  const double scale = end / sticking_impulse(cx, cz, rng.chance(0.5) ? 5 : 6, d.p.u_b);
  if (rng.chance(0.4)) d.p.u_s1 = d.p.u_s2 = rng.chance(0.5) ? 0 : rng.decades(-12, -2);
  const double v = d.b1.vy;
  const double sx = rng.uniform(-1, 1) * v;
  const double sy = rng.uniform(-1, 1) * v;
  set_slips(rng, cx * scale, cz * scale, sx, sy, false, &d);
  d.may_swap = true;
  return d;
}

// The table slip of the pressed ball passes zero at a distance of 1e-12 to 1e-1 of the approach.
Draft near_crossing(Random& rng) {
  Draft d = table_draft(rng);
  if (rng.chance(0.3)) d.p.u_b = rng.uniform(0.02, 0.3);
  if (rng.chance(0.3)) d.p.u_s2 = rng.uniform(0.2, 1);
  d.b1.vy = rng.decades(-1, 1);
  const bool top = rng.chance(0.3);
  const double v = d.b1.vy, miss = rng.signed_decades(-12, -1) * v;
  double dx = 0, dz = 1;
  // Straight on, the path is straight and the miss is what is asked for; else it bends by u_s u_b.
  d.aligned = rng.chance(0.5);
  if (!d.aligned) rng.direction(&dx, &dz);
  dz = std::fabs(dz);
  const double c = v * rng.decades(-0.3, 1);
  const double ax = -d.p.u_b * dx;
  const double ay = 1 + (top ? -2.5 : 2.5) * d.p.u_b * dz;
  const double q = rng.uniform(0.02, 0.98) * (1 + d.p.e_b) / 2 * v;
  const double size = std::sqrt(ax * ax + ay * ay);
  const double sx = -ax * q - miss * ay / size, sy = -ay * q + miss * ax / size;
  set_slips(rng, -dx * c, -dz * c, sx, sy, top, &d);
  d.may_swap = true;
  return d;
}

// As tiny_slip_pressed, down to rounding, with spin and against any shot.
Draft start_tiny_slip(Random& rng) {
  Draft d = spun_shot(rng);
  d.b1.roll(rng.uniform(0.05, 1.5));
  double x, y;
  rng.direction(&x, &y);
  const double v = rng.decades(-18, -2);
  d.b2.vx = v * x;
  d.b2.vy = v * y;
  spin_freely(rng, rng.chance(0.5) ? v : 0, &d.b2);
  d.may_swap = true;
  return d;
}
Draft stress_friction(Random& rng) {
  Draft d = both_moving(rng);
  d.p.u_b = rng.uniform(0.15, 0.6);
  d.p.u_s1 = rng.uniform(0.2, 1);
  d.p.u_s2 = rng.uniform(0.2, 1);
  return d;
}

Draft with_slip(Random& rng, double cx, double cz) {
  Draft d = table_draft(rng);
  d.b1.vy = rng.decades(-1, 1);
  const double v = d.b1.vy, c = v * rng.decades(-2, 0.5);
  const double sx = rng.uniform(-1, 1) * v;
  const double sy = rng.uniform(-1, 1) * v;
  set_slips(rng, cx * c, cz * c, sx, sy, false, &d);
  d.may_swap = true;
  return d;
}
Draft slip_nearly_level(Random& rng) {
  const double cx = rng.sign();
  return with_slip(rng, cx, rng.signed_decades(-16, -1));
}
Draft slip_nearly_vertical(Random& rng) {
  const double cx = rng.signed_decades(-16, -1);
  return with_slip(rng, cx, rng.sign());
}
Draft slow_approach(Random& rng) {
  Draft d = both_moving(rng);
  d.b1.vy = d.b2.vy + rng.decades(-12, -2);
  return d;
}
Draft restitution_edge(Random& rng) {
  Draft d = both_moving(rng);
  const double e = rng.decades(-12, -1);
  d.p.e_b = rng.chance(0.5) ? e : 1 - e;
  return d;
}
Draft any_speed(Random& rng) {
  Draft d = spun_shot(rng);
  if (rng.chance(0.5)) second_runs(rng, &d);
  const double speed = std::sqrt(d.b1.vx * d.b1.vx + d.b1.vy * d.b1.vy);
  const double k = rng.decades(-6, 1.69) / speed;
  for (Motion* b : {&d.b1, &d.b2}) {
    for (double* x : {&b->vx, &b->vy, &b->sx, &b->sy, &b->sz}) *x *= k;
  }
  return d;
}
Draft whole_envelope(Random& rng) {
  Draft d = table_draft(rng);
  d.p = {rng.uniform(0.025, 0.035), rng.uniform(0.13, 0.3), rng.uniform(0, 0.5),
         rng.uniform(0, 0.5),       rng.uniform(0, 0.2),    rng.uniform(0.5, 1)};
  const double speed = rng.decades(-2, 1.2);
  const double cut = rng.uniform(0, 89.99) * kDegree;
  aim(rng, speed, cut, &d.b1);
  spin_freely(rng, rng.decades(-2, 1.3), &d.b1);
  if (rng.chance(0.5)) second_runs(rng, &d);
  return d;
}

struct Kind {
  const char* name;
  Draft (*make)(Random&);
};
constexpr Kind kOrdinaryKinds[] = {
    {"rolling_vs_rest", rolling_vs_rest}, {"stun_vs_rest", stun_vs_rest},
    {"draw_vs_rest", draw_vs_rest},       {"side_vs_rest", side_vs_rest},
    {"both_moving", both_moving},         {"break", break_shot}};
constexpr Kind kHardKinds[] = {{"gearing_exact", gearing_exact},
                               {"gearing_near", gearing_near},
                               {"grazing", grazing},
                               {"slow", slow},
                               {"fast", fast},
                               {"sticks", sticks},
                               {"flip", flip},
                               {"headon_stun", headon_stun},
                               {"headon_roll", headon_roll},
                               {"plastic", plastic},
                               {"elastic", elastic},
                               {"no_table_friction", no_table_friction},
                               {"no_ball_friction", no_ball_friction},
                               {"huge_spin", huge_spin},
                               {"asym_table", asym_table},
                               {"tiny_slip_pressed", tiny_slip_pressed},
                               {"far_from_origin", far_from_origin}};
constexpr Kind kFurtherKinds[] = {{"headon_draw", headon_draw},
                                  {"near_sticking_end", near_sticking_end},
                                  {"near_crossing", near_crossing},
                                  {"start_tiny_slip", start_tiny_slip},
                                  {"stress_friction", stress_friction},
                                  {"slip_nearly_level", slip_nearly_level},
                                  {"slip_nearly_vertical", slip_nearly_vertical},
                                  {"slow_approach", slow_approach},
                                  {"restitution_edge", restitution_edge},
                                  {"any_speed", any_speed},
                                  {"whole_envelope", whole_envelope}};

std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds(std::begin(kOrdinaryKinds), std::end(kOrdinaryKinds));
  kinds.insert(kinds.end(), std::begin(kHardKinds), std::end(kHardKinds));
  kinds.insert(kinds.end(), std::begin(kFurtherKinds), std::end(kFurtherKinds));
  return kinds;
}

// ----------------------------------------------------------------------------------- to world

void choose_axis(Random& rng, const Draft& d, double* x, double* y) {
  rng.direction(x, y);
  if (!d.aligned) return;
  const double sign = rng.sign();
  const bool along_x = rng.chance(0.5);
  *x = along_x ? sign : 0;
  *y = along_x ? 0 : sign;
}

void place(Random& rng, const Draft& d, Case* c) {
  double fx, fy;
  choose_axis(rng, d, &fx, &fy);
  double x = rng.uniform(0, 1), y = rng.uniform(0, 2);
  if (d.distance != 0) {
    rng.direction(&x, &y);
    x *= d.distance;
    y *= d.distance;
  }
  c->ball1[0] = x;
  c->ball1[1] = y;
  c->ball2[0] = x + 2 * d.p.R * fx;
  c->ball2[1] = y + 2 * d.p.R * fy;
  c->ball1[2] = c->ball2[2] = d.p.R;
}

void to_world(const Motion& m, double fx, double fy, double R, double ball[9]) {
  ball[3] = fy * m.vx + fx * m.vy;
  ball[4] = -fx * m.vx + fy * m.vy;
  ball[5] = 0;
  ball[6] = (fy * m.sx + fx * m.sy) / R;
  ball[7] = (-fx * m.sx + fy * m.sy) / R;
  ball[8] = m.sz / R;
}

void swap_balls(Case* c) {
  std::swap(c->params.u_s1, c->params.u_s2);
  for (int i = 0; i < 9; ++i) std::swap(c->ball1[i], c->ball2[i]);
}

Case make_case(const Kind& kind, Random& rng) {
  const Draft d = kind.make(rng);
  Case c{};
  c.kind = kind.name;
  c.params = d.p;
  place(rng, d, &c);
  // The velocities follow the line of centres as the rounded positions give it.
  double fx = c.ball2[0] - c.ball1[0], fy = c.ball2[1] - c.ball1[1];
  const double length = std::sqrt(fx * fx + fy * fy);
  fx /= length;
  fy /= length;
  to_world(d.b1, fx, fy, d.p.R, c.ball1);
  to_world(d.b2, fx, fy, d.p.R, c.ball2);
  if (d.may_swap && rng.chance(0.5)) swap_balls(&c);
  return c;
}

}  // namespace

CaseRow to_row(const Case& one) {
  const Params& p = one.params;
  CaseRow row{p.R, p.M, p.u_s1, p.u_s2, p.u_b, p.e_b};
  std::copy_n(one.ball1, 9, row.begin() + kBall1);
  std::copy_n(one.ball2, 9, row.begin() + kBall2);
  return row;
}

std::vector<MadeCase> made_cases(std::uint64_t seed, std::size_t n, bool mixed) {
  std::vector<MadeCase> made;
  for (const Case& one : mixed ? mixed_cases(seed, n) : random_cases(seed, n)) {
    made.push_back({one.kind, to_row(one)});
  }
  return made;
}

std::vector<Case> read_cases(std::istream& in, const std::string& name) {
  return CaseReader(in, name).read();
}

std::vector<Case> read_cases(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be opened; expected a CSV file of cases");
  return read_cases(in, path);
}

std::vector<std::string> case_kinds() {
  std::vector<std::string> names;
  for (const Kind& kind : all_kinds()) names.push_back(kind.name);
  return names;
}

std::vector<Case> random_cases(std::uint64_t seed, std::size_t n) {
  Random rng(seed);
  const std::vector<Kind> kinds = all_kinds();
  std::vector<Case> cases;
  cases.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    cases.push_back(make_case(kinds[i % kinds.size()], rng));
    cases.back().id = static_cast<long>(i);
  }
  return cases;
}

std::vector<Case> mixed_cases(std::uint64_t seed, std::size_t n) {
  Random rng(seed);
  std::vector<Case> cases;
  cases.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = i % 47;
    cases.push_back(make_case(k < 30 ? kOrdinaryKinds[k % 6] : kHardKinds[k - 30], rng));
  }
  for (std::size_t i = n; i > 1; --i) std::swap(cases[i - 1], cases[rng.below(i)]);
  for (std::size_t i = 0; i < n; ++i) cases[i].id = static_cast<long>(i);
  return cases;
}

}  // namespace carom_bench
