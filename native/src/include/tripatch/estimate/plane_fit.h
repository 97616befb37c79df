// Tangent planes from heights around a point: local polynomials of degree 5 whose noise, truncation and coefficients have variance
// components that are estimated from all heights of a hole (empirical Bayes: MacKay 1992, Bayesian interpolation).
// docs/mathematics/surroundings.md has the formulas.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <utility>
#include <vector>

#include "tripatch/estimate/heights.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/types.h"

namespace tripatch {

/// The heights around one rim vertex over its first guess of a tangent plane. Lengths are in the units of the local mesh.
struct Stencil {
  Vec3 e1, e2, e3;   ///< along the rim, outward, normal
  double depth = 1;  ///< of a row of faces, in edges: y is over it
  Index points = 0;
  std::vector<SampleBlock> heights;  ///< of the points, y over depth
  double faces = 0;                  ///< slope across the rim of the faces next to it
  double faces_noise = 0;            ///< its variance over that of the noise
  double slope_noise = 1;            ///< of the rim's own direction: variance over that of the noise,
  int slope_order = 4;               ///< and what its interpolation leaves out: (derivative of this degree x slope_truncation)
  double slope_truncation = 0;
};

/// Variances of what the heights consist of: everything that decides between smoothing and precision.
struct VarianceComponents {
  double noise = tolerance::same;  ///< of a height
  double truncation = 1;           ///< over radius^(2 degree + 2): of what the polynomial leaves out
  std::array<double, fit_degree + 1> term = {1, 100, 1, 1, 1, 1};  ///< of the derivatives of each degree
  double tilt = 100;                                               ///< of the slope across the rim against the faces next to it
};

/// Coefficients of the terms of 1, x, y, x^2, xy, y^2, ..., which are the derivatives of the height.
struct PlaneFit {
  using Column = Eigen::Matrix<double, fit_terms, 1>;

  Column mean, prior;  ///< coefficients, inverse variances
};

/// Room for fits that is used again and again, and what the last one leaves in it.
struct FitRoom {
  Workspace heights;
  RowsOf24 rows;
  std::vector<std::pair<double, Index>> order;
  /// r of the weighted x^i y^j and their prior = q r, in column fit_terms the heights likewise.
  SquareOf24 root = SquareOf24::Zero();
  Reciprocals over;               ///< of its diagonal
  PlaneFit::Column prior, mean;   ///< of the terms
  bool normal_equations = false;  ///< made the root, and know the mean to some digits only
};

PlaneFit fit_plane(const Stencil& stencil, const VarianceComponents& components, FitRoom& room);
/// The mean of a fit just made to its last digits.
void refine(const Stencil& stencil, FitRoom& room, PlaneFit& fit);

/// How well the fit just made is known.
struct FitVariances {
  Eigen::Matrix2d slopes;  ///< covariance of the slopes along and across
  double bend;             ///< variance of the second derivative across
};
FitVariances variances_of(const FitRoom& room);

/// Logarithm of the density that a fit just made predicts for a height over its frame: `at` is the point in it (x, y, height). share: how much the
/// point counted in the fit, which is taken back (leave-one-out cross-validation).
double predicted_density(const PlaneFit& fit, const FitRoom& room, const VarianceComponents& components, const Vec3& at,
                         double share);

/// The components that make the heights of all stencils, by side, likeliest. radius: mean distance of the points; bend: squared
/// curvature that the faces show.
VarianceComponents estimate_components(const std::array<std::vector<Stencil>, 3>& stencils, double radius, double bend);

}  // namespace tripatch
