// The unknowns of one hole, and its energies as functions of them.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/fairing/curvature_following.h"
#include "tripatch/fairing/fairing.h"
#include "tripatch/fairing/fairing_space.h"
#include "tripatch/fairing/quadratic.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

/// What makes a field of any length as long as the hole; 0 where it vanishes.
double scale_to(double size, const PiecewisePolynomial& field);

/// What the derivative across a side may gain, each times the functions of t: r and c' times `scale`, or, where the side asks for its
/// position only, any direction as long as the hole; nothing where alpha and beta are held (scale 0).
std::vector<PiecewisePolynomial> slope_directions(const Side& side, const std::array<double, 2>& scale, bool position_only,
                                                  double size);

/// Where alpha falls below this part of what it was, the patch is about to turn back over its side.
constexpr double min_alpha_kept = share::tenth;

/// How much of `added` a side's alpha can gain until it falls below that part.
double alpha_reach(const PiecewisePolynomial& alpha, const PiecewisePolynomial& added);

/// Where the unknowns of a hole stand: `interior` coefficients of scalar functions for each component, then on each side `slopes`
/// coefficients for each direction that its derivative across may gain.
struct Unknowns {
  double size = 0;  ///< of the hole, scene units; coefficients are relative to it
  Index interior = 0;
  int slopes = 0;
  Index slopes_count = 0;                           ///< on all sides
  std::array<Index, 3> first = {};                  ///< of each side's slopes among all
  std::array<std::array<double, 2>, 3> scale = {};  ///< of r and c'; 0: alpha and beta are held
};

/// Unknowns are the interior coefficients, component by component, then alpha and beta of each side (see Unknowns). `base` must
/// outlive this.
class FairingProblem final : public EnergyProblem {
public:
  FairingProblem(const FairingBase& base, const FairingOptions& options, int nodes);

  /// What the unknowns add to the center of the patch, three rows; none where the center is free.
  Eigen::MatrixXd held() const override;
  /// The unknowns of a problem whose interior term is of the same degree or lower as those of this one.
  Eigen::VectorXd raised(const FairingProblem& lower, const Eigen::VectorXd& x) const;
  const CurvatureFollowing& following() const override { return *following_; }
  double reach(const Eigen::VectorXd& x) const override;
  /// What x adds to a patch of these sides.
  SurfacePtr correction(const Eigen::VectorXd& x, const Sides& sides) const;
  /// No side lets its slope go.
  bool meets_planes() const {
    const std::array<bool, 3>& free = options_.position_only;
    return !free[0] && !free[1] && !free[2];
  }

private:
  FairingProblem(const FairingBase& base, const FairingOptions& options, const FairingSpace& shared);
  void add_slopes(Index node);
  std::vector<PiecewisePolynomial> directions_of(const Side& side, int i) const;
  std::size_t take_directions(int i);
  CurvatureFollowing followed(const FairingBase& base) const;
  PiecewisePolynomial combination(const Eigen::VectorXd& x, int i, std::size_t direction) const;

  const FairingSpace& shared_;
  const Sides& sides_;
  const Boundary& boundary_;
  Unknowns unknowns_;
  std::array<std::vector<PiecewisePolynomial>, 3> directions_;
  std::optional<CurvatureFollowing> following_;
};

}  // namespace tripatch
