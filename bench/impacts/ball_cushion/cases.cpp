// Random cases of a ball and a cushion: ordinary shots, and what is hard about them by name.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "impact.h"
#include "random.h"

namespace carom_bench {
namespace {

/// R in m, M in kg, h (of the nose above the table) in m; u_s at the table, u_w at the cushion and
/// e_c without unit.
struct Params {
  double R, M, u_s, u_w, e_c, h;
};

/// A case under construction: velocity v and R w in the frame of the cushion, m/s.
struct Draft {
  Params p;
  double vx = 0, vy = 0, sx = 0, sy = 0, sz = 0;
  bool aligned = false;  // normal along an axis, where no direction is rounded

  double sine() const { return p.h / p.R - 1; }
  double cosine() const { return std::sqrt(1 - sine() * sine()); }
  // Rolling is spin = 1, back spin at the same rate is spin = -1.
  void roll(double spin) {
    sx = -spin * vy;
    sy = spin * vx;
  }
  void scale(double k) {
    for (double* x : {&vx, &vy, &sx, &sy, &sz}) *x *= k;
  }
  /// Spins from the slips at the nose and, along the cushion, at the table.
  void set_slips(double cx, double cz, double table_x) {
    sx = cz + sine() * vy;
    sy = vx - table_x;
    sz = (vx + sine() * sy - cx) / cosine();
  }
};

// Pool, the paper, carom, pooltool's snooker, pyramid.
constexpr Params kPresets[] = {{0.028575, 0.170097, 0.20, 0.20, 0.85, 0.036576},
                               {0.02625, 0.1406, 0.212, 0.14, 0.98, 0.03675},
                               {0.03075, 0.21, 0.20, 0.20, 0.85, 0.037},
                               {0.026194, 0.14, 0.50, 0.50, 0.85, 0.028},
                               {0.034, 0.28, 0.20, 0.20, 0.85, 0.0442}};
constexpr std::size_t kPaper = 1, kCarom = 2;

/// tan(theta + atan u_s + atan u_w) is finite: compression ends.
bool ends(const Params& p) {
  const double sine = p.h / p.R - 1, nose = sine / std::sqrt(1 - sine * sine);
  const double left = 1 - nose * p.u_s;
  return left > 0 && left > 1.01 * (nose + p.u_s) * p.u_w;
}
void let_it_end(Params* p) {
  while (!ends(*p)) {
    p->u_s *= 0.8;
    p->u_w *= 0.8;
  }
}

Params real_params(Random& rng) {
  Params p = kPresets[rng.below(5)];
  if (rng.chance(0.5)) return p;
  p.u_s = rng.uniform(0.1, 0.4);
  p.u_w = rng.uniform(0.05, 0.28);
  p.e_c = rng.uniform(0.55, 0.99);
  p.h = p.R * rng.uniform(1.2, 1.45);
  let_it_end(&p);
  return p;
}

void aim(Random& rng, double speed, double angle, Draft* d) {
  d->vx = rng.sign() * speed * sine(angle);
  d->vy = speed * sine(kRightAngle - angle);
}

Draft shot(Random& rng) {
  Draft d;
  d.p = real_params(rng);
  const double speed = rng.decades(-1.3, 0.9);
  const double angle = rng.uniform(0, 80) * kDegree;
  aim(rng, speed, angle, &d);
  return d;
}
void spin_freely(Random& rng, double most, Draft* d) {
  d->sx = rng.uniform(-most, most);
  d->sy = rng.uniform(-most, most);
  d->sz = rng.uniform(-most, most);
}

// ------------------------------------------------------------------------------ ordinary shots

Draft roll_angle(Random& rng) {
  Draft d = shot(rng);
  d.roll(1);
  return d;
}
Draft roll_side(Random& rng) {
  Draft d = roll_angle(rng);
  d.sz = rng.uniform(-2, 2) * (d.vy + 0.5 * std::fabs(d.vx));
  return d;
}
Draft stun(Random& rng) { return shot(rng); }
Draft stun_side(Random& rng) {
  Draft d = shot(rng);
  d.sz = rng.uniform(-2, 2) * (d.vy + 0.5 * std::fabs(d.vx));
  return d;
}
Draft draw(Random& rng) {
  Draft d = shot(rng);
  d.roll(-rng.uniform(0.3, 1.3));
  if (rng.chance(0.5)) d.sz = rng.uniform(-1, 1) * d.vy;
  return d;
}
Draft overspin(Random& rng) {
  Draft d = shot(rng);
  d.roll(rng.uniform(1.2, 3));
  if (rng.chance(0.5)) d.sz = rng.uniform(-1, 1) * d.vy;
  return d;
}
Draft sliding(Random& rng) {
  Draft d = shot(rng);
  d.roll(rng.uniform(0.1, 0.9));
  if (rng.chance(0.7)) d.sz = rng.uniform(-1, 1) * d.vy;
  return d;
}
Draft masse(Random& rng) {
  Draft d = shot(rng);
  spin_freely(rng, 3 * (d.vy + std::fabs(d.vx)), &d);
  return d;
}

/// Some shot of these.
Draft spun_shot(Random& rng) {
  constexpr Draft (*kShots[])(Random&) = {roll_angle, roll_side, stun, draw, sliding};
  return kShots[rng.below(5)](rng);
}

// ---------------------------------------------------------------------------------- hard kinds

Draft straight(Random& rng, double spin) {
  Draft d;
  d.p = real_params(rng);
  d.vy = rng.decades(-1, 0.8);
  d.roll(spin);
  d.aligned = rng.chance(0.5);
  return d;
}
Draft roll_straight(Random& rng) { return straight(rng, 1); }
Draft straight_spin(Random& rng) { return straight(rng, rng.uniform(-1.5, 3)); }
Draft paper(Random& rng) {
  constexpr double kSpeeds[] = {1, 2, 2.5};
  Draft d;
  d.p = kPresets[kPaper];
  const double speed = kSpeeds[rng.below(3)];
  const double angle = 2.0 * static_cast<double>(rng.below(45)) * kDegree;
  aim(rng, speed, angle, &d);
  d.roll(static_cast<double>(rng.below(4)) - 1);
  if (rng.chance(0.5)) d.sz = (static_cast<double>(rng.below(5)) - 2) * speed;
  d.aligned = true;
  return d;
}
Draft three_cushion(Random& rng) {
  Draft d;
  d.p = kPresets[kCarom];
  const double speed = rng.uniform(2, 6);
  const double angle = rng.uniform(20, 70) * kDegree;
  aim(rng, speed, angle, &d);
  d.roll(1);
  d.sz = rng.uniform(0.5, 2.5) * d.vx;
  return d;
}

// No slip at the nose: with little friction there it leaves at once, else it sticks.
Draft without_slip(Random& rng, double least, double most) {
  Draft d = straight(rng, 0);
  d.p.u_w = rng.uniform(least, most);
  if (rng.chance(0.5)) {  // dyadic: zero to the last digit
    d.p.R = 0.03125;
    d.p.h = d.p.R * (1 + 0.125 * static_cast<double>(1 + rng.below(4)));
    d.vy = std::ldexp(1.0, static_cast<int>(rng.below(6)) - 2);
    d.aligned = true;
    d.set_slips(0, 0, 0);
  } else {
    d.vx = rng.uniform(-1, 1) * d.vy;
    d.set_slips(0, 0, rng.uniform(-2, 2) * d.vy);
  }
  let_it_end(&d.p);
  return d;
}
Draft zero_start_slip(Random& rng) { return without_slip(rng, 0.01, 0.05); }
Draft stick_start(Random& rng) { return without_slip(rng, 0.3, 0.6); }
Draft stick_partway(Random& rng) {
  Draft d = shot(rng);
  d.p.u_w = rng.uniform(0.2, 0.6);
  let_it_end(&d.p);
  const double cx = rng.uniform(-0.5, 0.5) * d.vy;
  const double cz = rng.uniform(-0.4, 0.4) * d.vy;
  d.set_slips(cx, cz, rng.uniform(-2, 2) * d.vy);
  return d;
}

/// Friction that holds the nose while the table slips straight into (1) or out of (-1) the cushion.
double held_straight(const Draft& d, double way) {
  const double s = d.sine(), c = d.cosine();
  const double press = 3.5 * s / (2.5 + s * s + (2.5 - s) * d.p.u_s * c * way);
  return std::fabs(s - press) / c;
}
// Friction between what holds the nose before and after greatest compression: it sticks, and slips.
Draft stick_to_slip(Random& rng) {
  Draft d = shot(rng);
  d.p.h = d.p.R * rng.uniform(1.15, 1.43);
  d.p.u_s = rng.uniform(0.2, 0.5);
  const double before = held_straight(d, 1), after = held_straight(d, -1);
  d.p.u_w = before + rng.uniform(0.1, 0.95) * (after - before);
  const double cx = rng.uniform(-0.05, 0.05) * d.vy;
  const double cz = rng.uniform(-0.05, 0.05) * d.vy;
  d.set_slips(cx, cz, rng.signed_decades(-3, 0) * d.vy);
  return d;
}
// As much friction as holds the nose, or hardly less or more.
Draft stick_edge(Random& rng) {
  Draft d = stick_to_slip(rng);
  const double way = rng.sign();
  const double off = rng.signed_decades(-12, -1);
  d.p.u_w = held_straight(d, way) * (1 + off);
  const double near = rng.chance(0.5) ? 0 : rng.signed_decades(-9, -1);
  const double cx = near * d.vy;
  const double cz = rng.signed_decades(-6, -0.5) * d.vy;
  d.set_slips(cx, cz, near * rng.uniform(-1, 1) * d.vy);
  return d;
}
// The slip at the nose is gone near greatest compression, or near the end.
Draft stick_near_end(Random& rng) {
  Draft d = stick_partway(rng);
  const double s = d.sine(), c = d.cosine();
  const double rate = s * c + (2.5 + s * s) * d.p.u_w;
  const double off = rng.chance(0.5) ? rng.signed_decades(-10, -1) : rng.uniform(-0.3, 0.3);
  const double end = rng.chance(0.5) ? 1 : 1 + d.p.e_c;
  const double cz = -rate * end * d.vy / c * (1 + off);
  const double cx = rng.signed_decades(-10, 0) * cz;
  d.set_slips(cx, cz, rng.signed_decades(-6, 0.3) * d.vy);
  return d;
}
Draft table_stick(Random& rng) {
  Draft d = shot(rng);
  d.p.h = d.p.R * rng.uniform(1.38, 1.6);
  d.p.u_s = rng.uniform(0.45, 1);
  d.p.u_w = rng.uniform(0.03, 0.35);
  if (rng.chance(0.3)) d.vx = 0;
  d.roll(1);
  if (rng.chance(0.4)) d.sx = -rng.uniform(0.1, 1) * d.vy;
  if (rng.chance(0.4)) d.sz = rng.uniform(-1, 1) * d.vy;
  let_it_end(&d.p);
  return d;
}
// The slip at the nose passes zero at a distance of 1e-10 to 1e-2 of the speed.
Draft c_crossing(Random& rng) {
  Draft d = shot(rng);
  d.p.u_w = rng.uniform(0.03, 0.13);
  const double cx = rng.signed_decades(-10, -2) * d.vy;
  const double cz = -rng.uniform(0.01, 0.5) * d.vy;
  d.set_slips(cx, cz, rng.uniform(-2, 2) * d.vy);
  return d;
}
// As c_crossing at the table.
Draft s_crossing(Random& rng) {
  Draft d = shot(rng);
  d.roll(1);
  d.sx = -rng.uniform(0.1, 0.98) * d.vy;
  d.sy = d.vx - rng.signed_decades(-12, -2) * d.vy;
  if (rng.chance(0.5)) d.sz = rng.uniform(-1, 1) * d.vy;
  return d;
}
Draft gearing_x(Random& rng) {
  Draft d = spun_shot(rng);
  const double off = rng.chance(0.5) ? 0 : rng.signed_decades(-12, -2) * d.vy;
  d.sz = (d.vx + d.sine() * d.sy - off) / d.cosine();
  return d;
}
Draft tiny_slips(Random& rng) {
  Draft d = shot(rng);
  double x, z;
  rng.direction(&x, &z);
  const double size = rng.decades(-18, -8) * d.vy;
  d.set_slips(size * x, size * z, rng.uniform(-1, 1) * d.vy);
  if (rng.chance(0.5)) return d;
  // At the table in place of the nose, pressed: a table that pulls drives a slip on as it is.
  d.p.u_w = std::min(d.p.u_w, 0.95 * d.sine() / d.cosine());
  d.roll(1);
  d.sx += size * x;
  d.sy += size * z;
  return d;
}
Draft lifts(Random& rng) {
  Draft d = shot(rng);
  d.p.h = d.p.R * rng.uniform(1.02, 1.15);
  const double s = d.sine(), nose = s / d.cosine();
  d.p.u_w = std::min(0.6, nose * rng.uniform(1.05, 6));
  d.roll(rng.uniform(0.5, 4));
  if (rng.chance(0.7)) d.sz = rng.uniform(-1, 1) * d.vy;
  return d;
}
// The table's force is near zero at the start, or all the way.
Draft press_edge(Random& rng) {
  Draft d = shot(rng);
  d.p.h = d.p.R * rng.uniform(1.02, 1.4);
  const double nose = d.sine() / d.cosine();
  const double steep = rng.chance(0.3) ? 1 : rng.uniform(0.3, 1);  // -c_z / |c|
  d.p.u_w = std::min(0.6, nose / steep * (1 + rng.signed_decades(-12, -1)));
  let_it_end(&d.p);
  const double c = rng.decades(-2, 0.5) * d.vy;
  const double level = std::sqrt(1 - steep * steep);
  const double cx = rng.sign() * level * c;
  d.set_slips(cx, -steep * c, rng.signed_decades(-3, 0.3) * d.vy);
  return d;
}
Draft h_equal_R(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.h = d.p.R;
  if (rng.chance(0.3)) d.sx = 0;
  return d;
}
Draft high_cushion(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.h = d.p.R * rng.uniform(1.45, 1.6);
  let_it_end(&d.p);
  return d;
}
Draft uw_high(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.u_w = rng.uniform(0.3, 0.6);
  let_it_end(&d.p);
  return d;
}
// theta + atan u_s + atan u_w is short of 90 degrees by 0.01 to 8.
Draft near_jam(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.h = d.p.R * rng.uniform(1.1, 1.6);
  d.p.u_w = rng.uniform(0.2, 0.9);
  const double off = rng.decades(-2, 0.9) * kDegree;
  const double nose = d.sine() / d.cosine(), gap = sine(off) / sine(kRightAngle - off);
  const double two = (nose + gap) / (1 - nose * gap);
  d.p.u_s = std::max(0.0, std::min(1.0, (1 - two * d.p.u_w) / (two + d.p.u_w)));
  if (d.p.u_s == 0) let_it_end(&d.p);
  return d;
}
Draft grazing(Random& rng) {
  Draft d = spun_shot(rng);
  const double speed = rng.decades(-0.7, 1);
  const double off = rng.decades(-2, 0.7) * kDegree;
  aim(rng, speed, kRightAngle - off, &d);
  d.roll(rng.chance(0.5) ? 1 : rng.uniform(-1, 1));
  if (rng.chance(0.5)) d.sz = rng.uniform(-1.5, 1.5) * speed;
  return d;
}
Draft scaled(Random& rng, double low, double high) {
  Draft d = spun_shot(rng);
  const double speed = std::sqrt(d.vx * d.vx + d.vy * d.vy);
  d.scale(rng.decades(low, high) / speed);
  return d;
}
Draft slow(Random& rng) { return scaled(rng, -4, -2); }
Draft ultra_slow(Random& rng) { return scaled(rng, -9, -6); }
Draft fast(Random& rng) { return scaled(rng, 0.8, 1.08); }
Draft any_speed(Random& rng) { return scaled(rng, -6, 1.69); }
Draft spin_dominated(Random& rng) {
  Draft d = shot(rng);
  const double speed = rng.decades(-2, 0);
  d.scale(speed / std::sqrt(d.vx * d.vx + d.vy * d.vy));
  spin_freely(rng, rng.uniform(5, 20), &d);
  return d;
}
Draft us0(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.u_s = 0;
  return d;
}
Draft uw0(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.u_w = 0;
  return d;
}
Draft frictionless(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.u_s = d.p.u_w = 0;
  return d;
}
Draft little_friction(Random& rng) {
  Draft d = spun_shot(rng);
  const double least = rng.decades(-12, -2);
  (rng.chance(0.5) ? d.p.u_s : d.p.u_w) = least;
  return d;
}
Draft e0(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.e_c = 0;
  return d;
}
Draft e1(Random& rng) {
  Draft d = spun_shot(rng);
  d.p.e_c = 1;
  return d;
}
Draft restitution_edge(Random& rng) {
  Draft d = spun_shot(rng);
  const double e = rng.decades(-12, -1);
  d.p.e_c = rng.chance(0.5) ? e : 1 - e;
  return d;
}
Draft whole_envelope(Random& rng) {
  Draft d;
  const double R = rng.uniform(0.025, 0.035);
  const double M = rng.uniform(0.13, 0.3), u_s = rng.uniform(0, 0.5);
  const double u_w = rng.chance(0.8) ? rng.uniform(0, 0.3) : rng.uniform(0.3, 0.6);
  const double e_c = rng.uniform(0.5, 1);
  d.p = {R, M, u_s, u_w, e_c, R * rng.uniform(1, 1.45)};
  let_it_end(&d.p);
  const double speed = rng.decades(-2, 1.08);
  const double angle = rng.uniform(0, 89.99) * kDegree;
  aim(rng, speed, angle, &d);
  spin_freely(rng, rng.decades(-2, 1.3), &d);
  return d;
}

struct Kind {
  const char* name;
  Draft (*make)(Random&);
};
constexpr Kind kOrdinaryKinds[] = {{"roll_angle", roll_angle},
                                   {"roll_side", roll_side},
                                   {"stun", stun},
                                   {"stun_side", stun_side},
                                   {"draw", draw},
                                   {"overspin", overspin},
                                   {"sliding", sliding},
                                   {"masse", masse},
                                   {"three_cushion", three_cushion},
                                   {"whole_envelope", whole_envelope}};
constexpr Kind kHardKinds[] = {{"roll_straight", roll_straight},
                               {"straight_spin", straight_spin},
                               {"paper", paper},
                               {"zero_start_slip", zero_start_slip},
                               {"stick_start", stick_start},
                               {"stick_partway", stick_partway},
                               {"stick_to_slip", stick_to_slip},
                               {"stick_edge", stick_edge},
                               {"stick_near_end", stick_near_end},
                               {"table_stick", table_stick},
                               {"c_crossing", c_crossing},
                               {"s_crossing", s_crossing},
                               {"gearing_x", gearing_x},
                               {"tiny_slips", tiny_slips},
                               {"lifts", lifts},
                               {"press_edge", press_edge},
                               {"h_equal_R", h_equal_R},
                               {"high_cushion", high_cushion},
                               {"uw_high", uw_high},
                               {"near_jam", near_jam},
                               {"grazing", grazing},
                               {"slow", slow},
                               {"ultra_slow", ultra_slow},
                               {"fast", fast},
                               {"any_speed", any_speed},
                               {"spin_dominated", spin_dominated},
                               {"us0", us0},
                               {"uw0", uw0},
                               {"frictionless", frictionless},
                               {"little_friction", little_friction},
                               {"e0", e0},
                               {"e1", e1},
                               {"restitution_edge", restitution_edge}};
constexpr std::size_t kOrdinary = std::size(kOrdinaryKinds), kHard = std::size(kHardKinds);

const Kind& kind_at(std::size_t i) {
  return i < kOrdinary ? kOrdinaryKinds[i] : kHardKinds[i - kOrdinary];
}

MadeCase make_case(const Kind& kind, Random& rng) {
  const Draft d = kind.make(rng);
  double nx, ny;
  rng.direction(&nx, &ny);
  if (d.aligned) {
    const bool along_x = std::fabs(nx) > std::fabs(ny);
    nx = along_x ? (nx > 0 ? 1 : -1) : 0;
    ny = along_x ? 0 : (ny > 0 ? 1 : -1);
  }
  const Params& p = d.p;
  return {kind.name,
          {p.R, p.M, p.u_s, p.u_w, p.e_c, p.h, ny * d.vx + nx * d.vy, ny * d.vy - nx * d.vx, 0,
           (ny * d.sx + nx * d.sy) / p.R, (ny * d.sy - nx * d.sx) / p.R, d.sz / p.R, nx, ny}};
}

std::vector<MadeCase> random_cases(Random& rng, std::size_t n) {
  std::vector<MadeCase> cases;
  cases.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    cases.push_back(make_case(kind_at(i % (kOrdinary + kHard)), rng));
  }
  return cases;
}

// Two thirds are ordinary kinds of shot, in random order.
std::vector<MadeCase> mixed_cases(Random& rng, std::size_t n) {
  constexpr std::size_t kShots = 2 * kHard;
  std::vector<MadeCase> cases;
  cases.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t k = i % (kShots + kHard);
    cases.push_back(
        make_case(k < kShots ? kOrdinaryKinds[k % kOrdinary] : kHardKinds[k - kShots], rng));
  }
  for (std::size_t i = n; i > 1; --i) std::swap(cases[i - 1], cases[rng.below(i)]);
  return cases;
}

}  // namespace

std::vector<MadeCase> made_cases(std::uint64_t seed, std::size_t n, bool mixed) {
  Random rng(seed);
  return mixed ? mixed_cases(rng, n) : random_cases(rng, n);
}

}  // namespace carom_bench
