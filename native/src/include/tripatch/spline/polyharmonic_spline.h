// The surface of a hole's surroundings as a Gaussian field over a plane: a polyharmonic spline through samples, or near them where
// they are noisy, with a standard deviation at every point.
//   - intrinsic: polynomials of a degree below the order m are free, the rest has the generalised covariance (-1)^m r^(2m-2) log r
//     (Duchon 1977; Matheron 1973; Wahba 1990, "Spline models for observational data").
//   - order and nugget (the variance of the samples' noise) by restricted likelihood (Patterson and Thompson 1971); orders that are
//     nearly as likely are averaged.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/math/polyharmonic.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

struct FieldOptions {
  std::vector<double> orders = {
      2.5, 3.5, 5.5};  ///< halves are fastest; those with more free polynomials than a third of the samples are left out
  /// Scene units: the length of an edge. Likelihoods of orders are compared as if free polynomials were known to about that.
  double unit = 1;
  /// Where there are more samples, kernels are around so many of them alone, the first, which also decide on order and nugget, and all
  /// are fitted: the time grows with their number and the square of this one.
  Index centers = 1500;
};

struct DecidingSamples;

/// A surface over a plane: rows of Surface::evaluate are (u, v, not read), derivatives are by (u, v).
class PolyharmonicSpline final : public Surface {
public:
  /// Through or near samples (n x 3, scene units) at points of the plane (n x 2). Throws InvalidArgument for fewer than four, for a
  /// number that is not finite, and for points on a line.
  PolyharmonicSpline(const PlanePoints& points, const Points& samples, const FieldOptions& options);

  void evaluate(const double* b, Index n, int order, double* out) const override;

  /// Standard deviation at points, scene units, of the true surface along the directions (n x 3, of unit length). The true surface is
  /// a field of each order, or of a higher one, as likely as the samples tell: it deviates from its mean, and that from this surface.
  Eigen::VectorXd deviation(const PlanePoints& points, const Points& directions) const;

  /// Standard deviation of the samples' noise, scene units; 0: the samples are met.
  double noise() const { return noise_; }
  /// 0 to 1: how much the lowest two orders are taken instead of the likeliest, because the samples are rough.
  double roughness() const { return roughness_; }
  /// Of the polyharmonic splines, by their share in the average.
  double mean_order() const { return mean_order_; }
  double likelihood() const { return likelihood_; }  ///< logarithm, of the likeliest order

  /// One order of the average.
  struct Part {
    double order = 0;
    double share = 0;
    double nugget = 0;           ///< in units of the kernel, in normalised coordinates; 0: the samples are met
    double used_nugget = 0;      ///< at least as much as doubles need
    Eigen::MatrixXd weights;     ///< n x 3, of the kernel around each sample, or each center
    Eigen::MatrixXd polynomial;  ///< q x 3
    double variance = 0;         ///< of the kernel's unit, scene units squared
  };
  const std::vector<Part>& parts() const { return parts_; }

private:
  PlanePoints normalised(const PlanePoints& points) const;
  void turn_back(int order, double* jet) const;
  void weigh(double unit);  ///< the parts, whose shares are how likely each is
  template <int N>
  void jets(const Part& part, const double* rows, Index n, double* out) const;

  Eigen::RowVector2d middle_;
  Eigen::Matrix2d axes_;       // of normalised coordinates, in columns
  Eigen::RowVector3d origin_;  // of the samples
  double size_ = 1;
  PlanePoints points_;  // normalised: the samples' places, or those of the centers
  std::vector<Part> parts_;
  std::optional<PolyharmonicSum> sum_;  // of the parts, by normalised coordinates
  double noise_ = 0, roughness_ = 0, mean_order_ = 0, likelihood_ = 0;
  std::shared_ptr<const DecidingSamples> deciding_;  // what tells of the orders
};

}  // namespace tripatch
