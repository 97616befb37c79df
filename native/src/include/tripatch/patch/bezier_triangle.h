// Bezier triangle: a polynomial surface over the triangle, given by its control net.
#pragma once

#include "tripatch/boundary/side.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

class BezierTriangle final : public Surface {
public:
  static constexpr int max_degree = 40;  ///< de Casteljau is stable at any degree; a limit only against absurd input

  /// net: (n + 1)(n + 2) / 2 points in the order (n,0,0), (n-1,1,0), (n-1,0,1), ..., (0,0,n).
  explicit BezierTriangle(Points net);

  int degree() const { return degree_; }
  const Points& net() const { return net_; }

  static Index net_size(int degree) { return Index(degree + 1) * (degree + 2) / 2; }
  /// Row of the control point (i, j, k) in a net of any degree i + j + k.
  static Index row(int /*i*/, int j, int k) { return Index(j + k) * (j + k + 1) / 2 + k; }

  /// By de Casteljau; derivatives from the blossom (Farin 1986, Computer Aided Geometric Design 3, 83-127).
  void evaluate(const double* b, Index n, int order, double* out) const override;

  BezierTriangle elevated() const;  ///< the same surface, one degree higher
  /// Derivative in a direction of the domain (components summing to 0): a net of one degree less (of degree 0 from degree 0).
  BezierTriangle derivative(const Vec3& direction) const;
  /// Control points of side i, from corner i + 1 to corner i + 2.
  Points side(int i) const;

private:
  int degree_ = 0;
  Points net_;
};

/// Row of the k-th control point of side i in a net of this degree, counted from corner i + 1.
Index side_row(int degree, int i, int k);

/// The same Bezier curve, one degree higher.
Points elevated_curve(const Points& curve);

/// Side i of a Bezier triangle that surrounds a hole, from corner i + 1 to corner i + 2 (reversed: back, with the triangle's own
/// normal). r and q are its first and second derivative in the direction delta_i, into the triangle. Exact.
Side side_of(const BezierTriangle& triangle, int i, bool reversed);

}  // namespace tripatch
