// A smooth reference of the surroundings, on which samples get the parameters where their normals meet it.
//
// A layout of triangles is only as smooth as the triangles: read as functions of it, the coordinates of the smoothest surface are
// noisy. The foot points of the same samples on a low polynomial are smooth functions of the surface, so that a field over them
// needs no noise and reproduces what is smooth to high order.
#pragma once

#include "tripatch/math/plane.h"

namespace tripatch {

class BaseSurface {
public:
  static constexpr int highest_degree = 6;
  /// Least squares through samples (n x 3) at points of the plane (n x 2); the degree is less where there are few samples.
  BaseSurface(const PlanePoints& points, const Points& samples, int degree = 4);

  /// For samples near `points`: where the normals of the polynomial that go through them start. Each moves by no more than the
  /// plane's extent.
  PlanePoints foot_points(PlanePoints points, const Points& samples) const;
  /// Root mean square of the samples' distance along its normals, scene units.
  double distance_across() const { return distance_across_; }

private:
  /// Position, the two derivatives, and the three second ones: uu, uv, vv.
  using Jet2 = Eigen::Matrix<double, 6, 3>;
  Jet2 jet_at(const Eigen::RowVector2d& point) const;

  Eigen::RowVector2d middle_;
  /// To coordinates from -1 to 1 in which the points are spread as far in all directions: of a strip a thousand times as long as wide powers of
  /// what lies across would be rounding. Which polynomials there are does not hang on them.
  Eigen::Matrix2d to_unit_;
  double size_, distance_across_ = 0;
  int degree_;
  Eigen::MatrixXd coefficients_;
};

}  // namespace tripatch
