// What new vertices take over from the rim: UVs, colors, vertex weights, whatever is known at the rim.
//
// Sources: G. M. Nielson, The side-vertex method for interpolation in triangles, J. Approximation Theory 25 (1979);
// M. S. Floater, Mean value coordinates, Computer Aided Geometric Design 20 (2003).
#pragma once

#include <array>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// Rows of values, as many columns as a value has components.
using Values = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Interpolation of values that are given at both ends of every rim edge: end 2 e is the start of the edge from rim vertex e to the
/// next, 2 e + 1 its end. Along an edge they are linear; two edges may disagree at their common vertex, as at a UV seam. The
/// weights of a point sum to 1, and linear functions of its parameters come back.
class AttributeWeights {
public:
  /// rim (r x 3) and inside (k x 3): barycentric coordinates, those of the rim from corner 0 on. The transfinite side-vertex
  /// interpolant: with S_i the segment from corner i through the point to side i, the value is the mean of the three linear
  /// interpolants on S_0, S_1, S_2 weighted by (b_j b_k)^2 (Nielson 1979).
  /// rim (r x 2) and inside (k x 2): of a plane domain. Mean value coordinates in the polygon of the rim (Floater 2003); where it is
  /// not convex, weights may be negative. loops: of a rim with islands how many vertices each loop has, that around the others first.
  AttributeWeights(const Values& rim, const Values& inside, const std::vector<Index>& loops = {});

  Index points() const { return points_; }
  Index ends() const { return 2 * rim_; }
  /// Terms of a point: 12 over a triangle (an end may come twice), 2 r over a plane domain.
  Index terms() const { return plane_ ? 2 * rim_ : 12; }

  /// The ends that point k takes from, and their weights: terms() of each.
  void row(Index k, Index* ends, double* weights) const;
  /// The end of the largest weight (of equal ones the first term), for what cannot be blended.
  std::vector<Index> nearest() const;
  /// Values (k x d) at the points from values (2 r x d) at the ends. Throws InvalidArgument for another number of rows.
  Values blend(const Eigen::Ref<const Values>& at_ends) const;

private:
  void triangle_row(Index k, Index* ends, double* weights) const;
  void plane_row(Index k, Index* ends, double* weights) const;

  bool plane_ = false;
  Index rim_ = 0, points_ = 0;
  Values rim_parameters_, parameters_;
  std::vector<Index> next_, before_;  // vertices along the loops
  std::array<Index, 3> corner_ = {0, 0, 0};
  /// Of side i the parameter along it at its rim vertices, both corners included.
  std::array<std::vector<double>, 3> along_;
};

}  // namespace tripatch
