#include "tripatch/polygon/of_three.h"

#include <Eigen/LU>
#include <memory>
#include <utility>

#include "tripatch/math/jet.h"

namespace tripatch {

namespace {

/// Barycentric coordinates are linear in (u, v): Taylor series change as polynomials do.
class OverTriangle final : public Surface {
public:
  OverTriangle(const PolygonDomain& domain, SurfacePtr patch) : patch_(std::move(patch)), origin_(domain.corner(2)) {
    Eigen::Matrix2d edges;
    edges << domain.corner(0) - origin_, domain.corner(1) - origin_;
    to_barycentric_ = edges.inverse();
  }

  void evaluate(const double* uv, Index n, int order, double* out) const override {
    Points b(n, 3);
    for (Index k = 0; k < n; ++k) {
      b.row(k).head<2>() = to_barycentric_ * (Vec2(uv[3 * k], uv[3 * k + 1]) - origin_);
      b(k, 2) = 1 - b(k, 0) - b(k, 1);
    }
    patch_->evaluate(b.data(), n, order, out);
    with_order<0, max_order>(order, [&](auto constant) {
      for (Index k = 0; k < n; ++k) change<constant.value>(out + k * 3 * jet_size(constant.value));
    });
  }

private:
  /// A series in (b0, b1) to one in (u, v).
  template <int N>
  void change(double* series) const {
    const auto& a = to_barycentric_;
    const Jet<N> b0 = Jet<N>::linear(0, a(0, 0), a(0, 1)), b1 = Jet<N>::linear(0, a(1, 0), a(1, 1));
    JetPoint<N> sum;
    for (int x = 0; x < 3; ++x) sum.x[x] = Jet<N>(0.0);
    Jet<N> first = 1.0;
    for (int i = 0; i <= N; ++i, first *= b0) {
      Jet<N> both = first;
      for (int j = 0; i + j <= N; ++j, both *= b1)
        for (int x = 0; x < 3; ++x) sum.x[x] += series[3 * jet_index(i, j) + x] * both;
    }
    store(sum, series);
  }

  SurfacePtr patch_;
  Vec2 origin_;
  Eigen::Matrix2d to_barycentric_;
};

}  // namespace

SurfacePtr over_domain(const PolygonDomain& domain, SurfacePtr patch) {
  return std::make_shared<OverTriangle>(domain, std::move(patch));
}

}  // namespace tripatch
