// The quadric that points lie on: sphere, ellipsoid, cylinder, cone, paraboloid, hyperboloid. Parts made by machines are of these, and a hole
// in one is known as well as its surroundings are.
#pragma once

#include <optional>

#include "tripatch/types.h"

namespace tripatch {

/// f(x) = 0 for a polynomial of degree 2 in three variables, fitted by least squares.
class Quadric {
public:
  /// Nothing where points tell none: fewer than twice as many as it has coefficients.
  static std::optional<Quadric> through(const Points& points);

  /// The same points moved onto it along its gradient.
  Points nearest(const Points& points) const;
  /// (n x 3) unit normals, each on the side of another direction.
  Points normals(const Points& points, const Points& directions) const;
  /// Standard deviation at points on it, scene units: all that the points it was fitted to leave may be one error that continues. Infinite
  /// where it bends within `edge`, as where two planes meet.
  Eigen::VectorXd deviation(const Points& points, double edge) const;

private:
  Vec3 gradient(const Vec3& x) const { return twice_ * x + along_; }
  Vec3 local(const Points& points, Index k) const { return (Vec3(points.row(k)) - middle_) / size_; }

  Vec3 middle_;  // of the points: coordinates are from there, over size_
  double size_ = 1, left_ = 0,
         bend_ = 0;        // what the points leave of f, and how much its gradient turns on a unit of length at most
  Eigen::Matrix3d twice_;  // second derivatives of f
  Vec3 along_;
  double constant_ = 0;
  Eigen::MatrixXd root_;  // upper triangle: root' root is the points' normal matrix over their number
};

}  // namespace tripatch
