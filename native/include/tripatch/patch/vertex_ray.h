// Rays from a vertex to the opposite side: the surfaces of which side-vertex patches and blends are made.
#pragma once

#include "tripatch/boundary/ribbon.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

enum class RayDegree {
  quadratic,  ///< position of the vertex, position and slope of the side
  cubic,      ///< also the tangent plane of the vertex, mixed linearly from its two side tangents (Nielson's D_i)
  quintic,    ///< also second derivatives at both ends, such that those of all three rays agree at the corners
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
    if (degree_ == RayDegree::quintic) {
      const Jet<N> uu = square(u), suu = s * uu, suuu = suu * u, ssu = ss * u, sssu = s * ssu;
      return (u * uu * (1.0 + 3.0 * s + 6.0 * ss)) * JetPoint<N>(corner_[i_]) + (suuu * (1.0 + 3.0 * s)) * vertex_slope +
             (0.5 * (s * suuu)) * polynomial(vertex_second_, t) + (ss * s * (10.0 - 15.0 * s + 6.0 * ss)) * c -
             (sssu * (4.0 - 3.0 * s)) * side_slope + (0.5 * (sssu * u)) * polynomial(side_second_, t);
    }
    return (square(u) * (1.0 + 2.0 * s)) * JetPoint<N>(corner_[i_]) + (s * square(u)) * vertex_slope +
           (ss * (3.0 - 2.0 * s)) * c - (ss * u) * side_slope;
  }

private:
  /// Coefficients of 1, t, t^2, t^3.
  using Cubic = std::array<Vec3, 4>;
  template <int N>
  static JetPoint<N> polynomial(const Cubic& a, const Jet<N>& t) {
    JetPoint<N> p(a[3]);
    for (int k = 2; k >= 0; --k) p = t * p + JetPoint<N>(a[k]);
    return p;
  }

  int i_;
  RayDegree degree_;
  Ribbon ribbon_;
  std::array<Vec3, 3> corner_;
  Vec3 to_next_, to_previous_;         ///< slopes of the rays along the two sides at the vertex, the inward part included
  Cubic vertex_second_, side_second_;  ///< quintic: second derivatives at the ends of the ray at t
};

}  // namespace tripatch
