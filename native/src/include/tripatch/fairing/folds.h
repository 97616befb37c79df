// Where a patch folds over itself.
#pragma once

#include <array>
#include <vector>

#include "tripatch/fairing/kinks.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/rim_normals.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// Edges, on a side, of the grid on which folds of a triangle are counted: neighbors on a hemisphere are 3 degrees apart.
constexpr Index fold_grid_rows = count::many_places;
/// Neighbors of a grid fold whose normals have this cosine or less: 60 degrees, twenty times what those on a hemisphere are apart.
constexpr double folded_apart = share::half;
/// A grid of half as many rows, with all of the rim, decides that the whole grid has no fold if the normals agree. Neighbors must
/// have this cosine or more, 20 degrees (on a hemisphere they are 6 apart), and all normals this one or more to those of the rim,
/// 60 degrees. That held for all 2,200 patches that it took to be without folds, next to 1,200 with some.
constexpr double surely_together = 0.94, surely_facing = share::half;
/// Degrees between two planes, at a corner or kink, from which on every patch turns fast next to it: neighbors nearer to it than
/// `beside_crease` are not compared.
constexpr double folds_one_plane = angle::flat;
/// In barycentric coordinates (ten rows of that grid), or of a polygon's radius.
constexpr double beside_crease = 0.15;

/// Folds on a grid: points with (P_1 x P_2) . n <= 0, n the side-weight blend of the rim's normals, and neighbors whose normals are far
/// apart, but for the neighborhood of corners and kinks whose planes differ. On a kink of a side, and on the line
/// inwards along which a restored patch turns, it has a normal on either side: the one that folds sooner counts, whichever way the side runs.
class FoldCounter {
public:
  /// Of patches between these sides, or those of `kinks` as they are.
  explicit FoldCounter(const Sides& sides);
  explicit FoldCounter(const Kinks& kinks) : FoldCounter(kinks.sides(), kinks.parameters()) {}
  /// Of patches between the rounded sides of `kinks` (which must outlive this), counted when they are restored.
  FoldCounter(const Kinks& kinks, const std::array<bool, 3>& tangent);

  Index operator()(const Surface& patch) const;

private:
  FoldCounter(const Sides& sides, const std::array<std::vector<double>, 3>& kinks);
  bool surely_none(const Surface& patch) const;
  bool near_crease(const Eigen::RowVector3d& b) const;
  void look_at_both_sides(const Surface& patch, Points& normals) const;

  const Kinks* kinks_ = nullptr;
  std::array<bool, 3> tangent_ = {};
  RimNormals rim_;
  std::array<bool, 3> clear_;  // corner: one tangent plane for both sides
  std::vector<Eigen::RowVector3d> creases_;
  struct OnKink {
    int side;
    std::array<Index, 3> rows;  // barycentric coordinates
  };
  std::vector<OnKink> on_kinks_;  // points of the grid on kinks, and where what is restored there has its own
};

inline Index count_folds(const Surface& patch, const Sides& sides) { return FoldCounter(sides)(patch); }

}  // namespace tripatch
