#include "tripatch/constructions/nielson_blend.h"

#include "tripatch/constructions/blend.h"
#include "tripatch/patch/vertex_ray.h"

namespace tripatch {
namespace {

class NielsonBlend final : public VertexSafeSurface {
public:
  explicit NielsonBlend(const std::array<SurfacePtr, 3>& surfaces) : surfaces_(surfaces), corner_(common_corners(surfaces)) {}

private:
  Vec3 corner(int i) const override { return corner_[i]; }

  void evaluate_regular(const double* b, Index n, int order, double* out) const override {
    with_order<0, max_order>(order, [&](auto constant) { run<constant.value>(b, n, out); });
  }

  template <int N>
  void run(const double* b, Index n, double* out) const {
    constexpr Index stride = 3 * jet_size(N);
    std::array<std::vector<double>, 3> series;
    for (int i = 0; i < 3; ++i) {
      series[i].resize(n * stride);
      surfaces_[i]->evaluate(b, n, N, series[i].data());
    }
    for (Index k = 0; k < n; ++k) {
      const std::array<Jet<N>, 3> w = side_weights(Barycentric<N>(b + 3 * k));
      JetPoint<N> p;
      for (int i = 0; i < 3; ++i) p += w[i] * load<N>(&series[i][k * stride]);
      out = store(p, out);
    }
  }

  std::array<SurfacePtr, 3> surfaces_;
  std::array<Vec3, 3> corner_;
};

}  // namespace

SurfacePtr nielson_blend(const std::array<SurfacePtr, 3>& surfaces) { return std::make_shared<NielsonBlend>(surfaces); }

SurfacePtr nielson_blend(const Boundary& boundary) {
  std::array<SurfacePtr, 3> rays;
  for (int i = 0; i < 3; ++i) rays[i] = std::make_shared<VertexRay>(boundary, i, RayDegree::quadratic);
  return nielson_blend(rays);
}

}  // namespace tripatch
