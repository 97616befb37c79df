// Points inside a hole that a surface over a plane meets exactly, and normals there: what is added to the surface is a polyharmonic
// spline with these conditions (Hermite-Birkhoff interpolation, Wu 1992), which leaves the surface and its slopes along the rim as they
// are.
#pragma once

#include <array>
#include <vector>

#include "tripatch/math/jet.h"
#include "tripatch/math/plane.h"
#include "tripatch/patch/surface.h"
#include "tripatch/patch/through.h"

namespace tripatch {

/// Where a surface over a plane comes nearest to each point: by Gauss-Newton from the nearest middle of `triangles` (rows of uv), kept
/// inside them and off their border.
PlanePoints nearest_places(const Surface& surface, const PlanePoints& uv, const std::vector<std::array<Index, 3>>& triangles,
                           const std::vector<Through>& points);

/// A surface over a plane, to be added to another.
class HermiteCorrection final : public Surface {
public:
  /// Nothing along the rim (places of its vertices), nor its derivatives; at places (a row for each point) what `surface` lacks to go
  /// through the points, with their normals. planes: normals at the rim's vertices, which the surface shall have there; zero, or no
  /// rows: those that it has. Throws a Refusal where two points have one place.
  HermiteCorrection(const Surface& surface, const PlanePoints& rim, const PlanePoints& places, const std::vector<Through>& points,
                    const Points& planes = Points(0, 3));

  void evaluate(const double* b, Index n, int order, double* out) const override;

  /// Standard deviations at points, once the surface is known at the places: of those before, at points and at places.
  Eigen::VectorXd deviation_left(const PlanePoints& points, const Eigen::VectorXd& at_points,
                                 const Eigen::VectorXd& at_places) const;

private:
  static constexpr Index free = jet_size(2);  // polynomials of degree 2
  PlanePoints normalised(const PlanePoints& points) const { return (points.rowwise() - middle_) / size_; }
  /// Values of the basis, or their derivatives by one normalised coordinate, at normalised points: a row each.
  Eigen::MatrixXd basis(const PlanePoints& at, int axis = -1) const;
  Eigen::MatrixXd conditions() const;
  Eigen::MatrixXd leaning(const Surface& surface, const PlanePoints& rim, const Points& planes) const;
  template <int N>
  void jets(const double* b, Index n, double* out) const;
  Index count() const { return values_.rows() + 2 * slopes_.rows() + free; }

  Eigen::RowVector2d middle_;
  double size_ = 1;
  PlanePoints values_;            // normalised: of the rim, then places
  PlanePoints slopes_;            // of the rim, then places with a normal
  Index met_ = 0, held_ = 0;      // of the values and of the slopes, how many are places
  Eigen::MatrixXd cardinal_;      // coefficients of what is 1 in one condition: values at places first, slopes by u and v then
  Eigen::MatrixXd coefficients_;  // x 3
};

}  // namespace tripatch
