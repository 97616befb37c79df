#include "tripatch/constructions/triangular_coons.h"

#include <utility>

#include "tripatch/constructions/curve_surface.h"

namespace tripatch {
namespace {

class TriangularCoons final : public CurveSurface<TriangularCoons> {
public:
  using CurveSurface::CurveSurface;

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
};

}  // namespace

SurfacePtr triangular_coons(std::array<PiecewisePolynomial, 3> curves) {
  return std::make_shared<TriangularCoons>(std::move(curves));
}

}  // namespace tripatch
