// Sides whose curvature a fair patch follows by least squares.
#pragma once

#include <array>
#include <vector>

#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/fairing.h"
#include "tripatch/fairing/fairing_space.h"
#include "tripatch/fairing/quadratic.h"

namespace tripatch {

/// Where the unknowns of a hole stand: `interior` coefficients of scalar functions for each component, then on each side `slopes`
/// coefficients for each direction that its derivative across may gain.
struct Unknowns {
  double size = 0;  ///< of the hole, scene units; coefficients are relative to it
  Index interior = 0;
  int slopes = 0;
  Index slopes_count = 0;                           ///< on all sides
  std::array<Index, 3> first = {};                  ///< of each side's slopes among all
  std::array<std::array<double, 2>, 3> scale = {};  ///< of r and c'; 0: alpha and beta are held

  Index count() const { return 3 * interior + slopes_count; }
};

class CurvatureFollowing final : public CurvatureJumps {
public:
  CurvatureFollowing(const FairingSpace& space, const Unknowns& unknowns, const FairingBase& base, const FairingOptions& options);

  bool any() const override { return !sides_.empty(); }
  bool all() const override { return sides_.size() == 3; }

  /// The relative jumps of normal curvature along the sides followed, over what is tolerated, as rows whose squares sum to the mean
  /// square; their derivatives where `rows` is given. With alpha and beta free the surroundings' part is quadratic in them:
  /// n . P_dd = II(d, d), d = alpha r + beta c', and what a change (a, b) of alpha, beta adds to n . P_dd of a patch whose slopes are
  /// carried by slope_kernel is 2 (1/2 - t) n . (a r' + b c'').
  Eigen::VectorXd jumps(const Eigen::VectorXd& x, RowMajor* rows) const override;

private:
  /// At the points of FairingSpace::side_t.
  struct Followed {
    int i;
    std::array<SideForm, FairingSpace::side_points> form;
    std::array<double, FairingSpace::side_points> alpha, beta;
    std::array<double, FairingSpace::side_points> base;  // n . P_dd of the base
    std::array<double, FairingSpace::side_points> weight;
  };

  const FairingSpace& space_;
  Unknowns unknowns_;
  std::vector<Followed> sides_;
};

}  // namespace tripatch
