// What blends of whole surfaces share: surfaces evaluated in batches, read at b itself or at the feet of b on the sides.
#pragma once

#include <array>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

class RectangleSurface;

/// Taylor coefficients (jet_size(N) x 3, the layout of Surface::evaluate) as a jet.
template <int N>
JetPoint<N> load(const double* series) {
  JetPoint<N> p;
  for (int i = 0; i < Jet<N>::size; ++i)
    for (int x = 0; x < 3; ++x) p.x[x].c[i] = series[3 * i + x];
  return p;
}

/// The lower orders of a jet.
template <int M, int N>
Jet<M> truncated(const Jet<N>& a) {
  static_assert(M <= N);
  Jet<M> r;
  for (int i = 0; i < Jet<M>::size; ++i) r.c[i] = a.c[i];
  return r;
}

/// Derivative of a jet in a direction of the domain, v0 d/db0 + v1 d/db1; one order is lost.
template <int N>
Jet<N - 1> directional(const Jet<N>& a, double v0, double v1) {
  Jet<N - 1> r;
  for (int d = 0; d < N; ++d)
    for (int j = 0; j <= d; ++j) {
      const int i = d - j;
      r.c[jet_index(i, j)] = v0 * (i + 1) * a.c[jet_index(i + 1, j)] + v1 * (j + 1) * a.c[jet_index(i, j + 1)];
    }
  return r;
}

/// Reading a function at an affine image of b: from its Taylor coefficients at the image to those of the composition at b.
template <int N>
class Substitution {
public:
  Substitution() = default;
  /// The image's (b0, b1) move by x0 db0 + x1 db1 and y0 db0 + y1 db1.
  Substitution(double x0, double x1, double y0, double y1) {
    const Jet<N> x = Jet<N>::linear(0, x0, x1), y = Jet<N>::linear(0, y0, y1);
    Jet<N> powers_of_y(1.0);
    for (int j = 0; j <= N; ++j, powers_of_y *= y) {
      Jet<N> product = powers_of_y;
      for (int i = 0; i + j <= N; ++i, product *= x) terms_[jet_index(i, j)] = product;
    }
  }
  Jet<N> operator()(const Jet<N>& f) const {
    Jet<N> r;
    for (int d = 0; d <= N; ++d)  // terms of degree d stay of degree d
      for (int from = jet_size(d - 1); from < jet_size(d); ++from)
        for (int to = jet_size(d - 1); to < jet_size(d); ++to) r.c[to] += terms_[from].c[to] * f.c[from];
    return r;
  }

private:
  std::array<Jet<N>, Jet<N>::size> terms_;
};

/// A direction in which points are projected onto side i: the foot of b is b - b_i * direction, so direction[i] is 1.
using FootDirections = std::array<Vec3, 3>;
/// delta_i, at right angles to side i in the equilateral triangle.
inline FootDirections perpendicular_feet() { return {Vec3(1, -0.5, -0.5), Vec3(-0.5, 1, -0.5), Vec3(-0.5, -0.5, 1)}; }

/// The substitution that belongs to the foot on side i.
template <int N>
Substitution<N> foot_substitution(const Vec3& direction, int i) {
  // foot = b - b_i v; b_2 = 1 - b_0 - b_1
  const std::array<double, 2> g = {i == 0 ? 1.0 : i == 1 ? 0.0 : -1.0, i == 0 ? 0.0 : i == 1 ? 1.0 : -1.0};
  return {1 - direction[0] * g[0], -direction[0] * g[1], -direction[1] * g[0], 1 - direction[1] * g[1]};
}

/// Feet of n points on side i.
std::vector<double> feet(const double* b, Index n, int i, const Vec3& direction);

/// A rational Bezier triangle: a net as of BezierTriangle, and a weight above 0 for each of its points.
SurfacePtr rational_triangle(const Points& net, const std::vector<double>& weights);
/// A surface over a rectangle between three places (u, v) of its domain, as a surface over the triangle whose corners these are.
/// moved: by how much the corners are moved; linear between.
SurfacePtr triangle_on(std::shared_ptr<const RectangleSurface> surface, const std::array<Vec2, 3>& corners,
                       const std::array<Vec3, 3>& moved);

/// Three surfaces over one triangle, surface i carries side i: checks that they share the three corners, to 1e-6 of their size
/// (InvalidArgument names the corner and the surfaces otherwise), and returns these.
std::array<Vec3, 3> common_corners(const std::array<std::shared_ptr<const Surface>, 3>& surfaces);

}  // namespace tripatch
