#include "tripatch/patch/triangular_coons.h"

#include <utility>

namespace tripatch {
namespace {

class TriangularCoons final : public JetSurface<TriangularCoons> {
public:
  explicit TriangularCoons(std::array<PiecewisePolynomial, 3> curves) : curves_(std::move(curves)) {
    for (int i = 0; i < 3; ++i) corner_[i] = curves_[(i + 2) % 3](0);
  }

  Vec3 corner(int i) const override { return corner_[i]; }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      // side k leaves corner i towards corner j, side j comes back to it from corner k
      p += b[i] * (compose(curves_[k], b[j]) + compose(curves_[j], 1.0 - b[k]) - JetPoint<N>(corner_[i]));
    }
    return p;
  }

private:
  std::array<PiecewisePolynomial, 3> curves_;
  std::array<Vec3, 3> corner_;
};

}  // namespace

SurfacePtr triangular_coons(std::array<PiecewisePolynomial, 3> curves) {
  check_curves(curves);
  return std::make_shared<TriangularCoons>(std::move(curves));
}

}  // namespace tripatch
