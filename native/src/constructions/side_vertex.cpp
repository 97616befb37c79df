#include "tripatch/constructions/side_vertex.h"

#include "tripatch/patch/vertex_ray.h"

namespace tripatch {
namespace {

template <RayDegree Degree>
class SideVertex final : public PackedSurface<SideVertex<Degree>>, public FormulaSurface {
public:
  explicit SideVertex(const Boundary& boundary)
      : rays_{VertexRay(boundary, 0, Degree), VertexRay(boundary, 1, Degree), VertexRay(boundary, 2, Degree)} {}

  Vec3 corner(int i) const override { return rays_[i].corner(i); }
  const PointFormula* formula() const override { return &formula_; }

  template <int N, class P>
  TRIPATCH_ANY_PACK void plane(const P (&b)[3], TangentPlane<N, P>& sum) const {
    Plane<N, P> weights[3];
    set_zero<N>(sum);
    weights_of_sides<2>(b, weights);
    for (int i = 0; i < 3; ++i) rays_[i].template add_plane<N, Degree>(OnRay<N, P>(b, i), weights[i], sum);
  }

  template <int N, class P>
  TRIPATCH_ANY_PACK PointOf<N, P> jets(const PlaceOf<N, P>& b) const {
    const Rays<N, P> rays(b);
    JetOf<N, P> w[3];
    set_side_weights<2>(b, rays, w);
    PointOf<N, P> p = {};
    for (int i = 0; i < 3; ++i) add_product<N, P>(w[i], rays_[i].at(rays.s[i], rays.t[i]), p);
    return p;
  }

private:
  std::array<VertexRay, 3> rays_;
  PointFormula formula_{[this] {
    PointTerms terms;
    for (int i = 0; i < 3; ++i) terms.rays[i] = rays_[i].terms();
    return terms;
  }};
};

}  // namespace

SurfacePtr side_vertex(const Boundary& boundary) { return std::make_shared<SideVertex<RayDegree::cubic>>(boundary); }

SurfacePtr curved_side_vertex(const Boundary& boundary) { return std::make_shared<SideVertex<RayDegree::quintic>>(boundary); }

}  // namespace tripatch
