// The unknowns of one hole, and its energies as functions of them.
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "tripatch/fairing/curvature_following.h"
#include "tripatch/fairing/fairing.h"
#include "tripatch/fairing/fairing_space.h"
#include "tripatch/fairing/quadratic.h"

namespace tripatch {

/// What makes a field of any length as long as the hole; 0 where it vanishes.
double scale_to(double size, const PiecewisePolynomial& field);

/// How much of `added` side i's alpha can gain until it falls below a tenth of what it was.
double alpha_reach(const Boundary& boundary, int i, const PiecewisePolynomial& added);

/// Unknowns are the interior coefficients, component by component, then alpha and beta of each side (see Unknowns). `base` must
/// outlive this.
class FairingProblem {
public:
  FairingProblem(const FairingBase& base, const FairingOptions& options, int nodes);

  const FairingOptions& options() const { return options_; }
  Index count() const { return unknowns_.count(); }
  Index scalars() const { return 3 * unknowns_.interior; }  ///< those before alpha and beta
  /// What the unknowns add to the center of the patch, three rows; none where the center is free.
  Eigen::MatrixXd held() const;
  /// The unknowns of a problem whose interior term is of the same degree or lower as those of this one.
  Eigen::VectorXd raised(const FairingProblem& lower, const Eigen::VectorXd& x) const;
  /// A person's hand is on it.
  bool controlled() const { return options_.tension > 0 || options_.center; }
  const CurvatureFollowing& following() const { return *following_; }

  /// The integral of w |D^order P|^2 over the size squared: thin_plate (2), third_derivative (3), tension (1).
  Quadratic quadratic(int order) const;
  /// minimum_variation and quadric_variation at x.
  std::pair<double, double> variation(const Eigen::VectorXd& x) const;
  /// Gauss-Newton's model about x of minimum_variation (0) and quadric_variation (1), those that are wanted.
  std::array<Quadratic, 2> linearized(const Eigen::VectorXd& x, const std::array<bool, 2>& wanted) const;

  /// How much of x can be added until alpha falls below a tenth of what it was.
  double reach(const Eigen::VectorXd& x) const;
  bool open(const Eigen::VectorXd& x) const { return reach(x) >= 1; }
  /// What x adds to a patch of these sides.
  SurfacePtr correction(const Eigen::VectorXd& x, const Sides& sides) const;

private:
  void add_slopes(Index node);
  std::vector<Derivatives> derivatives(Index from, Index to, const Eigen::VectorXd& x) const;
  std::array<Quadratic, 2> linearized(const Eigen::VectorXd& x, const std::array<bool, 2>& wanted, Index from, Index to) const;
  std::vector<PiecewisePolynomial> directions_of(const Side& side, int i) const;
  std::size_t take_directions(int i);
  PiecewisePolynomial combination(const Eigen::VectorXd& x, int i, std::size_t direction) const;

  const FairingSpace& shared_;
  std::vector<Derivatives> base_;  // of the base, at the nodes
  const Sides& sides_;
  const Boundary& boundary_;
  FairingOptions options_;
  Unknowns unknowns_;
  std::array<std::vector<PiecewisePolynomial>, 3> directions_;
  std::optional<CurvatureFollowing> following_;
  RowMajor basis_;  // derivatives of what the slopes add, 27 rows a node
};

}  // namespace tripatch
