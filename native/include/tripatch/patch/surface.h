// A surface over the triangle: batch evaluation of position and derivatives. Everything that a fill, a report or a blend asks of
// a patch, a Bezier triangle or a caller's own surface.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>

#include "tripatch/math/jet.h"
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
  /// The same into n x 3 numbers each; positions: null where only normals are asked for.
  void positions_and_normals(const PointsRef& b, double* positions, double* normals) const;
};

using SurfacePtr = std::shared_ptr<const Surface>;

/// The first row of b (n x 3) that is no point of the triangle: not finite, or by more than `off` below 0 or not summing to 1.
std::optional<Index> first_outside(const PointsRef& b, double off);

/// Moves barycentric coordinates b (n x 3) to where the surface is nearest to points (n x 3): Gauss-Newton from where they are, kept
/// in the triangle. Returns the distances.
Eigen::VectorXd nearest(const Surface& surface, const Points& points, Points& b);
/// From a place (u, v) of a surface over a plane to a point, and Gauss-Newton's step from there to where the surface comes nearest to it;
/// not finite where it has no tangents.
struct Foot {
  Vec3 off;
  Vec2 step;
};
Foot foot_at(const Surface& surface, const Vec2& place, const Vec3& point);

/// a + b, point by point.
SurfacePtr sum(SurfacePtr a, SurfacePtr b);

/// A surface whose formula is 0/0 at the three vertices and, where the data disagree, a cone next to them, so that derivatives of
/// order m lose digits like 1 / rho^m at the distance rho. Position is the formula's own (at a vertex the corner). Derivatives of
/// order m within vertex_radius[m] of a vertex are those at that distance on the same ray (at the vertex: the mean of the two sides'): all
/// are finite, and the tangent plane is the cone's.
class VertexSafeSurface : public Surface {
public:
  /// In b_j + b_k: far enough for the rounding of that derivative, near enough for the tangent plane.
  static constexpr std::array<double, max_order + 1> vertex_radius = {1e-30, 1e-8, 1e-5, 1e-4, 1e-3};

  void evaluate(const double* b, Index n, int order, double* out) const final;

protected:
  /// As evaluate(), never called at a vertex. Throws InvalidArgument for an order it cannot give.
  virtual void evaluate_regular(const double* b, Index n, int order, double* out) const = 0;
  virtual Vec3 corner(int i) const = 0;

private:
  void evaluate_some(const double* b, Index n, int order, double* out) const;
};

/// Calls f(std::integral_constant<int, order>): from an order known at run time to a template argument.
template <int Lowest, int Highest, class F>
void with_order(int order, const F& f) {
  if constexpr (Lowest > Highest) {
    throw InvalidArgument("derivatives must be from 0 to " + std::to_string(Highest));
  } else {
    if (order == Lowest) return f(std::integral_constant<int, Lowest>());
    with_order<Lowest + 1, Highest>(order, f);
  }
}

/// One formula for all orders: a construction derives from this with itself as Derived and defines
///   `template <int N> JetPoint<N> at(const Barycentric<N>& b) const;` (never called at a vertex, where rays and weights are 0/0)
///   `Vec3 corner(int i) const;`
template <class Derived>
class JetSurface : public VertexSafeSurface {
protected:
  void evaluate_regular(const double* b, Index n, int order, double* out) const override {
    with_order<0, max_order>(order, [&](auto constant) { one_by_one<constant.value>(b, n, out); });
  }

private:
  template <int N>
  void one_by_one(const double* b, Index n, double* out) const {
    const Derived& self = *static_cast<const Derived*>(this);
    for (Index k = 0; k < n; ++k) out = store(self.template at<N>(Barycentric<N>(b + 3 * k)), out);
  }
};

}  // namespace tripatch
