#include "tripatch/constructions/side_vertex.h"

#include "tripatch/patch/vertex_ray.h"

namespace tripatch {
namespace {

class SideVertex final : public JetSurface<SideVertex> {
public:
  SideVertex(const Boundary& boundary, RayDegree degree)
      : rays_{VertexRay(boundary, 0, degree), VertexRay(boundary, 1, degree), VertexRay(boundary, 2, degree)} {}

  Vec3 corner(int i) const override { return rays_[i].corner(i); }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    const std::array<Jet<N>, 3> w = side_weights(b);
    JetPoint<N> p;
    for (int i = 0; i < 3; ++i) p += w[i] * rays_[i].at(b);
    return p;
  }

private:
  std::array<VertexRay, 3> rays_;
};

}  // namespace

SurfacePtr side_vertex(const Boundary& boundary) { return std::make_shared<SideVertex>(boundary, RayDegree::cubic); }

SurfacePtr curved_side_vertex(const Boundary& boundary) { return std::make_shared<SideVertex>(boundary, RayDegree::quintic); }

}  // namespace tripatch
