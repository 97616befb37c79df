// A surface over the triangle: batch evaluation of position and derivatives. Everything that a fill, a report or a blend asks of
// a patch, a Bezier triangle or a caller's own surface.
#pragma once

#include <memory>

#include "tripatch/patch/jet.h"
#include "tripatch/patch/side_weights.h"
#include "tripatch/types.h"

namespace tripatch {

constexpr int max_order = 4;  ///< derivatives that every surface can give (blends need one more than they are asked for)

class Surface {
public:
  virtual ~Surface() = default;
  /// b: n x 3 barycentric coordinates, each row summing to 1. out: n x jet_size(order) x 3 Taylor coefficients in (b0, b1):
  /// P; then of db0, db1; db0^2, db0 db1, db1^2; ... (derivatives over i! j!). order 0 .. max_order. Finite everywhere.
  virtual void evaluate(const double* b, Index n, int order, double* out) const = 0;

  Points positions(const PointsRef& b) const;
  /// Unit normals P_b0 x P_b1 (the mesh's outer side for a patch in a rim).
  Points normals(const PointsRef& b) const;
  /// Both from one evaluation.
  std::pair<Points, Points> positions_and_normals(const PointsRef& b) const;
};

using SurfacePtr = std::shared_ptr<const Surface>;

/// One formula for all orders: a construction derives from this with itself as Derived and defines
///   template <int N> JetPoint<N> at(const Barycentric<N>& b) const;   (never called at a vertex, where rays and weights are 0/0)
///   Vec3 corner(int i) const;
/// At a vertex the position is the corner and the derivatives are the mean of those beside it on the two sides.
template <class Derived>
class JetSurface : public Surface {
public:
  void evaluate(const double* b, Index n, int order, double* out) const override {
    switch (order) {
      case 0: return run<0>(b, n, out);
      case 1: return run<1>(b, n, out);
      case 2: return run<2>(b, n, out);
      case 3: return run<3>(b, n, out);
      case 4: return run<4>(b, n, out);
      default: throw InvalidArgument("derivatives must be from 0 to 4");
    }
  }

private:
  template <int N>
  void run(const double* b, Index n, double* out) const {
    for (Index k = 0; k < n; ++k) {
      const Derived& self = *static_cast<const Derived*>(this);
      const int vertex = vertex_of(b + 3 * k);
      JetPoint<N> p;
      if (vertex < 0) {
        p = self.template at<N>(Barycentric<N>(b + 3 * k));
      } else {
        // The mean of the two sides close by, where the weights are exact: far enough for the rounding of the highest
        // derivative, near enough for the tangent plane.
        constexpr std::array<double, 5> distance = {1e-8, 1e-8, 1e-5, 1e-4, 1e-3};
        if constexpr (N > 0) {
          for (int side = 1; side < 3; ++side) {
            std::array<double, 3> beside = {0, 0, 0};
            beside[vertex] = 1 - distance[N];
            beside[(vertex + side) % 3] = distance[N];
            p += 0.5 * self.template at<N>(Barycentric<N>(beside.data()));
          }
        }
        const Vec3 corner = self.corner(vertex);
        for (int x = 0; x < 3; ++x) p.x[x].c[0] = corner[x];
      }
      for (int i = 0; i < Jet<N>::size; ++i)
        for (int x = 0; x < 3; ++x) *out++ = p.x[x].c[i];
    }
  }
};

}  // namespace tripatch
