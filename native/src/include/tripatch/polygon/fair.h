// The fairest patch over a polygon among those that meet the surroundings just as well. It is as in
// fairing/fairing.h, with these functions of the polygon.
//   - the interior term bubble^2 times polynomials of (u, v),
//   - the second derivative across each side, 1/2 phi_i^2 (cubic side weight) times a polynomial of t_i,
//   - the slopes alpha and beta of each side between the corners: phi_i (side weight) times (a r + b c')(t_i).
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/energy_problem.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/polygon/surface.h"

namespace tripatch {

/// Conditions on the inside that are met exactly: the patch goes through `point` at `uv`, and has this normal there where one is given.
struct InnerPoint {
  Vec2 uv = Vec2::Zero();
  Vec3 point = Vec3::Zero();
  std::optional<Vec3> normal;
};

/// What is the same at the nodes wherever a patch is pulled to inside.
struct PolygonAtNodes {
  std::vector<Derivatives> blend;  ///< derivatives of the patch before it meets any points
  RowMajor slopes;                 ///< and of what the free slopes add, as an EnergyProblem has them
};

/// The same by nodes a direction, for patches of one boundary that differ by their points alone; from any thread.
class KnownAtNodes {
public:
  std::shared_ptr<const PolygonAtNodes> find(int nodes) const;
  void add(int nodes, std::shared_ptr<const PolygonAtNodes> at_nodes);

private:
  mutable std::mutex mutex_;
  std::map<int, std::shared_ptr<const PolygonAtNodes>> by_nodes_;
};

/// A patch of `boundary` that keeps G1 to `sides`, and what is asked of it besides.
struct PolygonBase {
  SideList sides;
  PolygonBoundary boundary;
  SurfacePtr blend, lift;           ///< the patch before it meets points, and what makes it meet them; none: no points
  std::vector<bool> slopes_free;    ///< by side; empty: all
  std::vector<bool> position_only;  ///< by side: the derivative across is free in all directions; empty: none
  std::vector<bool> curvature;      ///< by side: curvature that is followed by least squares; empty: none
  std::vector<InnerPoint> through;  ///< met by `patch`: what is added vanishes there
  std::shared_ptr<KnownAtNodes> known = std::make_shared<KnownAtNodes>();

  SurfacePtr patch() const { return lift ? sum(blend, lift) : blend; }
};

/// An energy of a surface over a polygon, as energy() for a triangle.
double polygon_energy(const Surface& surface, const PolygonDomain& domain, Fairing of, double size);

/// The same from derivatives at the nodes of a quadrature.
double weighed_energy(const std::vector<Derivatives>& all, const std::vector<double>& weights, Fairing of, double size);

/// The largest distance between points of the border.
double polygon_size(const Surface& surface, const PolygonDomain& domain);

/// Degrees of freedom as FairingOptions counts them; its `curvature`, `automatic`, `position_only`, `slopes_free` and `center` are not
/// read. `measured` is the same base on smoothed sides.
struct PolygonFairResult {
  SurfacePtr patch;
  double before = 0, after = 0;
  Index folds = 0;
  bool gave_up = false;
  Messages warnings;
};
PolygonFairResult fair_polygon(const PolygonBase& base, const PolygonBase& measured, const FairingOptions& options);

/// Least-norm multiples of the squared bubble that, added to the patch, make it meet the points; none for none.
SurfacePtr lift_to(const SurfacePtr& patch, const PolygonDomain& domain, const std::vector<InnerPoint>& points, double size);
/// The patch with them.
SurfacePtr with_points(const SurfacePtr& patch, const PolygonDomain& domain, const std::vector<InnerPoint>& points, double size);

/// Places of a grid over the polygon where the patch faces away from what its sides show, and neighbors whose normals are 60 degrees or more
/// apart.
Index count_polygon_folds(const Surface& patch, const PolygonDomain& domain, const SideList& sides);

/// As derivatives_across: first and second derivative along the outward normal at parameters of side i.
std::vector<Across> derivatives_across(const Surface& patch, const PolygonDomain& domain, int i, std::span<const double> t,
                                       int order = 2);
/// As meet_curvature of a triangle's sides.
SurfacePtr meet_curvature(const SurfacePtr& patch, const PolygonDomain& domain, const SideList& sides,
                          const std::vector<bool>& wanted);
/// The sides that have a q and agree with their neighbors' curvature at both corners.
std::vector<bool> curvature_agrees(const SideList& sides);

}  // namespace tripatch
