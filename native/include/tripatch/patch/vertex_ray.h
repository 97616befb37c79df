// Rays from a vertex to the opposite side: the surfaces of which side-vertex patches and blends are made.
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

enum class RayDegree {
  quadratic,  ///< position of the vertex, position and slope of the side
  cubic,      ///< also the tangent plane of the vertex, mixed linearly from its two side tangents (Nielson's D_i)
};

/// The rays from vertex i to side i of a boundary: one constituent of a blend, with the side's position and slope.
class VertexRay final : public JetSurface<VertexRay> {
public:
  VertexRay(const Boundary& boundary, int i, RayDegree degree);

  /// Everywhere the vertex; elsewhere the ends of the side.
  Vec3 corner(int k) const override { return corner_[k]; }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    const Jet<N> s = b[(i_ + 1) % 3] + b[(i_ + 2) % 3];  // fraction of the ray, 0 at the vertex
    const Jet<N> t = ray_parameter(b, i_);
    JetPoint<N> c, dc;
    compose_with_derivative(ribbon_.c, t, c, dc);
    // d/ds = -delta_i + (t - 1/2) (along the side)
    const JetPoint<N> side_slope = compose(ribbon_.d, t) + (t - 0.5) * dc;
    const Jet<N> u = 1.0 - s;
    if (degree_ == RayDegree::quadratic) return square(u) * JetPoint<N>(corner_[i_]) + (s * (2.0 - s)) * c - (s * u) * side_slope;
    const JetPoint<N> vertex_slope = (1.0 - t) * JetPoint<N>(to_next_) + t * JetPoint<N>(to_previous_);
    const Jet<N> ss = square(s);
    return (square(u) * (1.0 + 2.0 * s)) * JetPoint<N>(corner_[i_]) + (s * square(u)) * vertex_slope +
           (ss * (3.0 - 2.0 * s)) * c - (ss * u) * side_slope;
  }

private:
  int i_;
  RayDegree degree_;
  Ribbon ribbon_;
  std::array<Vec3, 3> corner_;
  Vec3 to_next_, to_previous_;  ///< slopes of the rays along the two sides at the vertex, the inward part included
};

}  // namespace tripatch
