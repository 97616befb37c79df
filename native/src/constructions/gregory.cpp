#include "tripatch/constructions/gregory.h"

namespace tripatch {
namespace {

class Gregory final : public JetSurface<Gregory> {
public:
  explicit Gregory(const Boundary& boundary) {
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const Ribbon& j_side = boundary.ribbons[j];  // b_j = 0, runs to vertex i
      const Ribbon& k_side = boundary.ribbons[k];  // b_k = 0, runs from vertex i
      Corner& at = corners_[i];
      // D_v = -v_s d + (v_{s+2} + v_s / 2) c' on side s. From side k along side j: v = e_k - e_i; from side j along side k:
      // v = e_j - e_i.
      at.along_k = k_side.c;
      at.across_k = 0.5 * k_side.c.derivative() - k_side.d;
      at.along_j = j_side.c.reversed();
      at.across_j = ((-1.0) * j_side.d - 0.5 * j_side.c.derivative()).reversed();
      at.position = k_side.c(0);
      at.x_k = at.along_k.derivative_at(0);
      at.x_j = at.across_j(0);
      at.y_k = at.across_k(0);
      at.y_j = at.along_j.derivative_at(0);
      at.xy_k = at.across_k.derivative_at(0);
      at.xy_j = at.across_j.derivative_at(0);
    }
  }

  Vec3 corner(int i) const override { return corners_[i].position; }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    for (int i = 0; i < 3; ++i) {
      const Jet<N>&x = b[(i + 1) % 3], &y = b[(i + 2) % 3];
      p += (square(b[i]) * (3.0 - 2.0 * b[i] + 6 * (x * y))) * corners_[i].at(x, y);
    }
    return p;
  }

private:
  /// The Boolean sum of two Taylor lofts at a corner, x along side k (y = 0), y along side j (x = 0). What both sides say about
  /// the corner is subtracted once; where they disagree, rationally: first derivatives with the weights x^2 and y^2, twists as
  /// Gregory does.
  struct Corner {
    PiecewisePolynomial along_k, across_k, along_j, across_j;
    Vec3 position, x_k, x_j, y_k, y_j, xy_k, xy_j;  ///< derivatives at the corner, by side

    template <int N>
    JetPoint<N> at(const Jet<N>& x, const Jet<N>& y) const {
      JetPoint<N> p = compose(along_k, x) + y * compose(across_k, x) + compose(along_j, y) + x * compose(across_j, y);
      // K agrees with side k's data on x = 0 and with side j's on y = 0: there the other loft must come back alone
      const Jet<N> r = reciprocal(x + y), u = x * r, v = y * r;
      const Jet<N> m = square(v) * reciprocal(square(u) + square(v));
      p -= JetPoint<N>(position) + x * (JetPoint<N>(x_j) + m * JetPoint<N>(x_k - x_j)) +
           y * (JetPoint<N>(y_j) + m * JetPoint<N>(y_k - y_j)) + (x * y) * (JetPoint<N>(xy_j) + v * JetPoint<N>(xy_k - xy_j));
      return p;
    }
  };

  std::array<Corner, 3> corners_;
};

}  // namespace

SurfacePtr gregory(const Boundary& boundary) { return std::make_shared<Gregory>(boundary); }

}  // namespace tripatch
