#include "tripatch/patch/side_vertex.h"

#include <utility>

namespace tripatch {
namespace {

class SideVertex final : public JetSurface<SideVertex> {
public:
  explicit SideVertex(Boundary boundary) : boundary_(std::move(boundary)) {
    for (int i = 0; i < 3; ++i) {
      // at vertex i: towards corner i + 1 along side i + 2, towards corner i + 2 back along side i + 1
      corner_[i] = boundary_.ribbons[(i + 2) % 3].c(0);
      to_next_[i] = boundary_.ribbons[(i + 2) % 3].c.derivative_at(0);
      to_previous_[i] = -boundary_.ribbons[(i + 1) % 3].c.derivative_at(1);
    }
  }

  Vec3 corner(int i) const { return corner_[i]; }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    const std::array<Jet<N>, 3> w = side_weights(b);
    JetPoint<N> p;
    for (int i = 0; i < 3; ++i) p += w[i] * ray(b, i);
    return p;
  }

private:
  /// The cubic Hermite ray from vertex i through b to side i.
  template <int N>
  JetPoint<N> ray(const Barycentric<N>& b, int i) const {
    const Jet<N> s = b[(i + 1) % 3] + b[(i + 2) % 3];  // fraction of the ray, 0 at the vertex
    const Jet<N> t = ray_parameter(b, i);
    const Ribbon& ribbon = boundary_.ribbons[i];
    JetPoint<N> c, dc;
    compose_with_derivative(ribbon.c, t, c, dc);
    // d/ds = -delta_i + (t - 1/2) (along the side)
    const JetPoint<N> side_slope = compose(ribbon.d, t) + (t - 0.5) * dc;
    const JetPoint<N> vertex_slope =
        (1.0 - t) * JetPoint<N>(to_next_[i]) + t * JetPoint<N>(to_previous_[i]) + JetPoint<N>(boundary_.inward[i]);
    const Jet<N> ss = square(s), u = 1.0 - s;
    return (square(u) * (1.0 + 2.0 * s)) * JetPoint<N>(corner_[i]) + (s * square(u)) * vertex_slope + (ss * (3.0 - 2.0 * s)) * c -
           (ss * u) * side_slope;
  }

  Boundary boundary_;
  std::array<Vec3, 3> corner_, to_next_, to_previous_;
};

}  // namespace

SurfacePtr side_vertex(Boundary boundary) { return std::make_shared<SideVertex>(std::move(boundary)); }

}  // namespace tripatch
