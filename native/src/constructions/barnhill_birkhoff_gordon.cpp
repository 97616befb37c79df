#include "tripatch/constructions/barnhill_birkhoff_gordon.h"

namespace tripatch {
namespace {

/// Cubic Hermite basis on [0, 1]: value and slope at 0, value and slope at 1.
template <int N>
std::array<Jet<N>, 4> hermite(const Jet<N>& s) {
  const Jet<N> u = 1.0 - s, uu = square(u), ss = square(s);
  return {uu * (1.0 + 2.0 * s), s * uu, ss * (3.0 - 2.0 * s), -(ss * u)};
}

PiecewisePolynomial vector_polynomial(const std::vector<Vec3>& bernstein) {
  std::vector<double> net;
  for (const Vec3& p : bernstein) net.insert(net.end(), p.data(), p.data() + 3);
  return PiecewisePolynomial::bezier(net, 3);
}

/// Cubic with these values and slopes at 0 and 1.
PiecewisePolynomial cubic(const Vec3& a, const Vec3& da, const Vec3& b, const Vec3& db) {
  return vector_polynomial({a, a + da / 3, b - db / 3, b});
}

// Side i = a, its loft P_i: the line b_i = tau runs from side k (at t = 1 - tau, b_k = 0) to side j (at t = tau, b_j = 0), with the
// fraction sigma = b_k / (b_j + b_k). P_i meets sides j and k. What it misses on side i, the residual, is lofted along the lines
// parallel to side j (b_j = const) or to side k: P_j + P_i - P_j P_i = P_i + (P_j of the residual, which lives on side i alone).
class BarnhillBirkhoffGordon final : public JetSurface<BarnhillBirkhoffGordon> {
public:
  explicit BarnhillBirkhoffGordon(const Boundary& boundary) {
    for (int i = 0; i < 3; ++i) {
      const Ribbon& ribbon = boundary.ribbons[i];
      curve_[i] = ribbon.c;
      const PiecewisePolynomial dc = ribbon.c.derivative();
      // Derivatives along the lines that are parallel to side i + 2 and side i + 1 and meet side i, in the direction e_k - e_j:
      // D_v = -v_i d + (v_k + v_i / 2) c' for any direction v of the domain.
      along_next_[i] = ribbon.d - 0.5 * dc;               // v = e_{i+2} - e_i ... side i as the far end B of the loft P_{i+2}
      along_previous_[i] = (-1.0) * ribbon.d - 0.5 * dc;  // side i as the near end A of the loft P_{i+1}
    }
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      corner_[i] = curve_[k](0);
      const Vec3 a = curve_[k](1), da = along_previous_[k](1), b = curve_[j](0), db = along_next_[j](0);
      const PiecewisePolynomial loft = cubic(a, da, b, db);
      // d/dtau of the loft at tau = 0; ends and their lengths (1 - tau) move
      const PiecewisePolynomial by_tau = cubic(-curve_[k].derivative_at(1), -da - along_previous_[k].derivative_at(1),
                                               curve_[j].derivative_at(0), -db + along_next_[j].derivative_at(0));
      const std::array<double, 2> half_minus_t = {0.5, -0.5};
      const PiecewisePolynomial slope =
          PiecewisePolynomial::bezier(half_minus_t, 1) * loft.derivative() - by_tau;  // in the direction -delta_i
      const Ribbon& ribbon = boundary.ribbons[i];
      const PiecewisePolynomial value = ribbon.c - loft, across = ribbon.d - slope, along = value.derivative();
      // towards the inside along b_j = const (e_i - e_k) and along b_k = const (e_i - e_j)
      to_j_[i] = Residual(value, (-1.0) * across - 0.5 * along, 1);
      to_k_[i] = Residual(value, (-1.0) * across + 0.5 * along, 0);
    }
  }

  Vec3 corner(int i) const override { return corner_[i]; }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      p += (1.0 / 3) * loft(b, i) + (1.0 / 6) * (to_j_[i].at(b[i], b[j], b[k]) + to_k_[i].at(b[i], b[k], b[j]));
    }
    return p;
  }

private:
  /// What a loft misses on side i, carried along the lines on which `across` (j or k) is constant. At one end of the side those
  /// lines approach the neighboring side `across` = 0, which must not be disturbed. There a slope, a cross derivative or a twist
  /// of the residual is what the data of the two sides disagree about. It is let in by the weight across^2 / (b_i^2 + across^2),
  /// 1 on side i and 0 on the neighbor, with its first derivatives. For data that agree those terms vanish.
  struct Residual {
    PiecewisePolynomial value, inwards;  ///< the residual and its derivative along the line, without the parts below
    PiecewisePolynomial rough_value, rough_inwards;
    bool at_end = false;  ///< the parameter on side i is 1 - across, else across

    Residual() = default;
    Residual(const PiecewisePolynomial& v, const PiecewisePolynomial& q, int end) : at_end(end == 1) {
      const Vec3 zero = Vec3::Zero(), dv = v.derivative_at(end), q0 = q(end), dq = q.derivative_at(end);
      rough_value = at_end ? cubic(zero, zero, zero, dv) : cubic(zero, dv, zero, zero);
      rough_inwards = at_end ? cubic(zero, zero, q0, dq) : cubic(q0, dq, zero, zero);
      value = v - rough_value;
      inwards = q - rough_inwards;
    }

    template <int N>
    JetPoint<N> at(const Jet<N>& bi, const Jet<N>& across, const Jet<N>& rest) const {
      const Jet<N> length = bi + rest;
      const std::array<Jet<N>, 4> h = hermite(bi / length);
      const Jet<N> t = at_end ? 1.0 - across : across, scaled = h[1] * length;
      const Jet<N> sum = bi + across, m = square(across / sum);
      const Jet<N> weight = m / (square(bi / sum) + m);
      return h[0] * compose(value, t) + scaled * compose(inwards, t) +
             weight * (h[0] * compose(rough_value, t) + scaled * compose(rough_inwards, t));
    }
  };

  template <int N>
  JetPoint<N> loft(const Barycentric<N>& b, int i) const {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const Jet<N> length = b[j] + b[k];
    const std::array<Jet<N>, 4> h = hermite(b[k] / length);
    const Jet<N> tk = 1.0 - b[i];
    return h[0] * compose(curve_[k], tk) + (h[1] * length) * compose(along_previous_[k], tk) + h[2] * compose(curve_[j], b[i]) +
           (h[3] * length) * compose(along_next_[j], b[i]);
  }

  std::array<PiecewisePolynomial, 3> curve_, along_next_, along_previous_;
  std::array<Residual, 3> to_j_, to_k_;
  std::array<Vec3, 3> corner_;
};

}  // namespace

SurfacePtr barnhill_birkhoff_gordon(const Boundary& boundary) { return std::make_shared<BarnhillBirkhoffGordon>(boundary); }

}  // namespace tripatch
