#include "tripatch/constructions/gordon_coons.h"

#include <utility>

#include "tripatch/constructions/curve_surface.h"

namespace tripatch {
namespace {

class GordonCoons final : public CurveSurface<GordonCoons> {
public:
  using CurveSurface::CurveSurface;

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      // the line b_i = const meets side k, which runs from corner i, and side j, which runs to it
      const Jet<N> s = ray_parameter(b, i);
      p += (1.0 - s) * compose(curves_[k], 1.0 - b[i]) + s * compose(curves_[j], b[i]) - b[i] * JetPoint<N>(corner_[i]);
    }
    return 0.5 * p;
  }
};

}  // namespace

SurfacePtr gordon_coons(std::array<PiecewisePolynomial, 3> curves) { return std::make_shared<GordonCoons>(std::move(curves)); }

}  // namespace tripatch
