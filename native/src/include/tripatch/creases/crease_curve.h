// The curve on which a crease continues across a hole: a Gaussian process along it through the vertices that the crease has on both
// sides, or near them where they are noisy. The same as PolyharmonicSpline in one dimension: polynomials of a degree below the order m are free,
// the covariance is (-1)^m |t|^(2m-1) (Wahba 1990), order and nugget by restricted likelihood.
#pragma once

#include <Eigen/Core>

#include "tripatch/types.h"

namespace tripatch {

class CreaseCurve {
public:
  /// before (n x 3): the crease up to the hole, its rim vertex last; after (m x 3): from the other rim vertex on. Three points or
  /// more, no two of them that follow each other the same. unit: the length of an edge. The parameter is the length along the curve.
  CreaseCurve(const Points& before, const Points& after, double unit);

  /// Of the piece in the hole, scene units.
  double length() const { return gap_; }
  /// Points of that piece at shares of its length, 0 to 1.
  Points at(const Eigen::VectorXd& shares) const;
  /// Their standard deviation in any direction across the curve, scene units.
  Eigen::VectorXd deviation(const Eigen::VectorXd& shares) const;
  /// Which order was taken: 2 to 5.
  int order() const { return order_; }

private:
  void choose(double unit);
  /// Of the samples in values at shares (s x n); variance: over that of the process, if asked for.
  Eigen::MatrixXd weights(const Eigen::VectorXd& shares, Eigen::VectorXd* variance) const;
  double normalised(double along) const { return (along - middle_) / half_; }

  Points samples_;
  Eigen::VectorXd t_;  // of the samples, normalised
  double gap_ = 0, middle_ = 0, half_ = 1;
  int order_ = 2;
  double nugget_ = 0, variance_ = 0;
};

}  // namespace tripatch
