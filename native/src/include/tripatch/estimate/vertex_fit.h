// What is known of the surface at a rim vertex.
#pragma once

#include <Eigen/Dense>
#include <numbers>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/types.h"

namespace tripatch {

constexpr double well_known =
    radians(share::little);  ///< deviation of a plane, less than which nobody sees: nothing else is looked at

/// The plane at a rim vertex.
struct VertexFit {
  Vec3 normal;
  Eigen::Matrix3d second;             ///< fundamental form
  Eigen::Matrix<double, 3, 2> frame;  ///< along and across,
  Eigen::Matrix2d covariance;         ///< in which the normal is known so well
  double slope_variances;             ///< their sum
  double bend_variance;               ///< of the second derivative across
  std::vector<double> density;        ///< logarithms, of what is predicted for each of the vertices nearest to it without itself
};

}  // namespace tripatch
