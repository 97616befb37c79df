// The unknowns of one hole over a polygon, and its energies as functions of them.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tripatch/polygon/fair.h"
#include "tripatch/polygon/space.h"

namespace tripatch {

/// Where the unknowns of the slopes stand after those of the scalar functions, and the lengths of their directions.
struct PolygonSlopes {
  std::vector<Index> first;                  ///< of each side among the fields
  std::vector<std::array<double, 2>> scale;  ///< of r and c'; 0: alpha and beta are held
};

class PolygonProblem final : public EnergyProblem {
public:
  PolygonProblem(const PolygonBase& base, const FairingOptions& options, int nodes);

  Eigen::MatrixXd held() const override { return held_; }
  const CurvatureFollowing& following() const override { return *following_; }
  double reach(const Eigen::VectorXd& x) const override;
  bool meets_planes() const;
  /// What x adds to a patch of these sides.
  SurfacePtr correction(const Eigen::VectorXd& x, const SideList& sides) const;

private:
  PolygonProblem(const PolygonBase& base, const FairingOptions& options, int nodes,
                 const std::shared_ptr<const PolygonSpace>& space);
  PolygonProblem(const PolygonBase& base, const FairingOptions& options, int nodes, std::shared_ptr<const PolygonSpace> space,
                 const std::shared_ptr<const PolygonAtNodes>& known);
  std::vector<PiecewisePolynomial> directions_of(const SideList& sides, int i) const;
  PiecewisePolynomial combination(const Eigen::VectorXd& x, int i, std::size_t direction) const;
  void add_slopes(int i, const std::vector<PiecewisePolynomial>& directions);
  void hold_points();
  CurvatureFollowing followed(const PolygonBase& base) const;

  std::shared_ptr<const PolygonSpace> space_;
  const PolygonBase& of_;
  PolygonSlopes slopes_;
  std::optional<CurvatureFollowing> following_;
  Eigen::MatrixXd held_;
};

}  // namespace tripatch
