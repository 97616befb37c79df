// Sides whose curvature a fair patch follows by least squares.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/quadratic.h"
#include "tripatch/math/dense_kernels.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

/// A mesh's curvature is known to the standard deviation Side::curvature_error; what lies within three of these costs little. Five let
/// the holes of docs/holebench.md at n = 8 end an eighth farther from the truth (docs/notes/fairing.md, the jump of curvature).
constexpr double tolerated_deviations = deviations::clear;

/// What may be added to a patch, at the points of its sides where curvature is compared.
struct SideBasis {
  static constexpr int points = count::dozen;  ///< of each side
  explicit SideBasis(std::span<const PiecewisePolynomial> slopes);

  std::vector<double> t;                ///< of the points: denser towards the corners
  Eigen::MatrixXd slope;                ///< there: the functions of alpha and beta
  std::vector<Eigen::MatrixXd> second;  ///< there, by side: second derivative across of each scalar function
};

/// A side that is followed, at the points of SideBasis::t.
struct FollowedSide {
  int i;
  Index first;                  ///< unknown of alpha's change; beta's come after it
  std::array<double, 2> scale;  ///< of r and c' in the unknowns
  double curvature_error;       ///< of the side, as Side has it
  std::array<SideForm, SideBasis::points> form;
  std::array<double, SideBasis::points> alpha, beta;  ///< of the base
  std::array<double, SideBasis::points> base;         ///< n . P_dd of the base
  /// What a change (a, b) of alpha, beta adds to n . P_dd is skew n . (a r' + b c'').
  std::array<double, SideBasis::points> skew;
  std::array<double, SideBasis::points> weight;
};

/// Side i of a patch whose derivatives across at the points t are given; `skew` stays undefined.
FollowedSide followed_side(const Side& side, int i, const PiecewisePolynomial& alpha, const PiecewisePolynomial& beta,
                           const std::vector<double>& t, const std::vector<Across>& across);

/// Jumps of normal curvature along sides that are followed by least squares. Unknowns are the coefficients of the scalar functions,
/// relative to the size of the hole, component by component, then those of alpha and beta on the sides.
class CurvatureFollowing {
public:
  /// Of a patch of so many sides; jumps are measured by what is tolerated of the sides' mean curvature. `basis` must outlive this.
  CurvatureFollowing(const SideBasis& basis, std::vector<FollowedSide> sides, int of, double size, double tolerance);

  bool any() const { return !sides_.empty(); }
  bool all() const { return static_cast<int>(sides_.size()) == of_; }

  /// The relative jumps of normal curvature along the sides followed, over what is tolerated, as rows whose squares sum to the mean
  /// square; their derivatives where `rows` is given. With alpha and beta free the surroundings' part is quadratic in them:
  /// n . P_dd = II(d, d), d = alpha r + beta c'.
  Eigen::VectorXd jumps(const Eigen::VectorXd& x, RowMajor* rows) const;
  /// Gauss-Newton's model of the sum of their squares.
  Quadratic linearized(const Eigen::VectorXd& x) const;

private:
  const SideBasis& basis_;
  std::vector<FollowedSide> sides_;
  int of_;
  double size_;  // of the hole, scene units
};

}  // namespace tripatch
