// Where a patch folds over itself.
#pragma once

#include <array>
#include <vector>

#include "tripatch/fairing/kinks.h"
#include "tripatch/patch/rim_normals.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// Folds on a 64 x 64 grid: points with (P_1 x P_2) . n <= 0, n the side-weight blend of the rim's normals, and neighbors whose
/// normals are 60 degrees or more apart, but for the neighborhood of corners and kinks whose planes differ.
/// Edges of that grid on a side: neighbors on a hemisphere are 3 degrees apart.
constexpr Index fold_grid_rows = 64;

class FoldCounter {
public:
  /// Of patches between these sides.
  explicit FoldCounter(const Sides& sides);
  /// Of patches between the rounded sides of `kinks` (which must outlive this), counted when they are restored.
  FoldCounter(const Kinks& kinks, const std::array<bool, 3>& tangent);

  Index operator()(const Surface& patch) const;

private:
  bool beside_crease(const Eigen::RowVector3d& b) const;

  const Kinks* kinks_ = nullptr;
  std::array<bool, 3> tangent_ = {};
  RimNormals rim_;
  std::array<bool, 3> clear_;  // corner: one tangent plane for both sides
  std::vector<Eigen::RowVector3d> creases_;
};

inline Index count_folds(const Surface& patch, const Sides& sides) { return FoldCounter(sides)(patch); }

}  // namespace tripatch
