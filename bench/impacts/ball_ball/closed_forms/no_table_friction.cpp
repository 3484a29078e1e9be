// What one may use instead of an exact kernel: an inelastic impulse with Coulomb friction between
// the balls and none on the table, in closed form, as game physics and pooltool's default do. It is
// here to be timed beside exact kernels, on the cases that they are timed on; it answers another
// question.
//
// With c the slip at the contact and q = (1 + e_b) V / 2 the normal impulse over the mass, ball 1
// gets -min(u_b q, |c| / 7) c / |c| across the line of centres.
#include <cmath>
#include <cstddef>

#if defined(__clang__)
#define INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define INDEPENDENT _Pragma("GCC ivdep")
#endif

namespace {

constexpr std::size_t kBlock = 256;

struct Columns {
  const double* in[18];
  double* out[12];
};

// `count` collisions; v_n where they approach, else 0, to `approach`.
void collide_block(const double* params, const double* u_b, std::size_t count, const Columns& at,
                   double* approach) {
  const double R = params[0], half = 0.5 * (1.0 + params[5]), per_r = 1.0 / R;
  const double* const* in = at.in;
  double* const* out = at.out;
  const double own_u_b = params[4];
  INDEPENDENT
  for (std::size_t i = 0; i < count; ++i) {
    const double d_x = in[9][i] - in[0][i], d_y = in[10][i] - in[1][i];
    const double per_d = 1.0 / std::sqrt(d_x * d_x + d_y * d_y);
    const double f_x = d_x * per_d, f_y = d_y * per_d;
    const double v1x = in[3][i], v1y = in[4][i], v1z = in[5][i];
    const double w1x = in[6][i], w1y = in[7][i], w1z = in[8][i];
    const double v2x = in[12][i], v2y = in[13][i], v2z = in[14][i];
    const double w2x = in[15][i], w2y = in[16][i], w2z = in[17][i];
    const double v_x = v1x - v2x, v_y = v1y - v2y, v_z = v1z - v2z;
    const double v = v_x * f_x + v_y * f_y;
    const double c_x = v_x * f_y - v_y * f_x - R * (w1z + w2z);
    const double c_z = v_z + R * ((w1x + w2x) * f_y - (w1y + w2y) * f_x);
    const double most = v > 0.0 ? v : 0.0;
    const double q = half * most;
    const double per_c = 1.0 / std::sqrt(c_x * c_x + c_z * c_z + 1e-300);
    const double rubbed = (u_b != nullptr ? u_b[i] : own_u_b) * q * per_c;
    const double share = most > 0.0 ? (rubbed < 1.0 / 7.0 ? rubbed : 1.0 / 7.0) : 0.0;
    const double p_x = -share * c_x, p_z = -share * c_z;
    const double turn = 2.5 * per_r * p_z, w_x = turn * f_y, w_y = -turn * f_x;
    const double w_z = -2.5 * per_r * p_x;
    const double more_x = p_x * f_y - q * f_x, more_y = -p_x * f_x - q * f_y;
    out[0][i] = v1x + more_x;
    out[1][i] = v1y + more_y;
    out[2][i] = v1z + p_z;
    out[3][i] = w1x + w_x;
    out[4][i] = w1y + w_y;
    out[5][i] = w1z + w_z;
    out[6][i] = v2x - more_x;
    out[7][i] = v2y - more_y;
    out[8][i] = v2z - p_z;
    out[9][i] = w2x + w_x;
    out[10][i] = w2y + w_y;
    out[11][i] = w2z + w_z;
    approach[i] = most;
  }
}

}  // namespace

extern "C" {

std::size_t carom_probe_batch(const double params[6], const double* u_b, std::size_t n,
                              const double* const in[18], double* const out[12],
                              unsigned char* status) {
  double approach[kBlock];
  std::size_t good = 0;
  for (std::size_t first = 0; first < n; first += kBlock) {
    const std::size_t count = n - first < kBlock ? n - first : kBlock;
    Columns at{};
    for (int k = 0; k < 18; ++k) at.in[k] = in[k] + first;
    for (int k = 0; k < 12; ++k) at.out[k] = out[k] + first;
    collide_block(params, u_b != nullptr ? u_b + first : nullptr, count, at, approach);
    for (std::size_t i = 0; i < count; ++i) {
      const bool separates = !(approach[i] > 0.0);
      if (status != nullptr) status[first + i] = separates ? 1 : 0;
      good += separates ? 0 : 1;
    }
  }
  return good;
}

int carom_probe_collide(const double params[6], const double ball1[9], const double ball2[9],
                        double out1[9], double out2[9]) {
  const double* in[18];
  double* out[12];
  for (int k = 0; k < 9; ++k) {
    in[k] = ball1 + k;
    in[9 + k] = ball2 + k;
    out1[k] = ball1[k];
    out2[k] = ball2[k];
  }
  for (int k = 0; k < 6; ++k) {
    out[k] = out1 + 3 + k;
    out[6 + k] = out2 + 3 + k;
  }
  unsigned char status = 0;
  carom_probe_batch(params, nullptr, 1, in, out, &status);
  return status;
}
}
