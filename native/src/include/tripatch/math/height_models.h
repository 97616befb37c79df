// Heights over a plane from few samples.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "tripatch/math/jet.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/types.h"

namespace tripatch {

/// Samples of HeightSpline: two rings around eight edges have about forty vertices. The time grows with the cube.
constexpr std::size_t max_height_samples = count::many_places;
/// Polynomials to degree 2.
constexpr int quadric_terms = jet_size(2);
using QuadricTerms = Eigen::Matrix<double, quadric_terms, 1>;

/// The quadric of least squares through samples (x, y, height).
class HeightQuadric {
public:
  /// rim: how many samples are the rim's, which come first.
  HeightQuadric(const std::vector<Vec3>& samples, std::size_t rim);
  /// Height, and its slopes by the two axes.
  Vec3 at(const Vec2& place) const;
  /// Root mean square by which samples of the rim are missed by what all others tell.
  double error() const { return error_; }

private:
  QuadricTerms fit_;
  double error_ = 0;
};

/// Likewise the polyharmonic spline of order 5/2, whose kernel is the cube of the distance and whose free polynomials go to degree 2.
class HeightSpline {
public:
  /// `samples` must outlive it: more than quadric_terms, no more than max_height_samples.
  HeightSpline(const std::vector<Vec3>& samples, std::size_t rim);
  Vec3 at(const Vec2& place) const;
  /// Infinite where the samples do not determine it.
  double error() const { return error_; }

private:
  static constexpr int most = static_cast<int>(max_height_samples);

  const std::vector<Vec3>& samples_;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, most, 1> weights_;
  QuadricTerms polynomials_;
  double error_ = 0;
};

}  // namespace tripatch
