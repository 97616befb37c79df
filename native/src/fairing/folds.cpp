#include "tripatch/fairing/folds.h"

#include <cmath>

#include "tripatch/math/angle.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/math/triangular_grid.h"

namespace tripatch {
namespace {}  // namespace

FoldCounter::FoldCounter(const Sides& sides) : FoldCounter(sides, {kinks_of(sides[0]), kinks_of(sides[1]), kinks_of(sides[2])}) {}

FoldCounter::FoldCounter(const Sides& sides, const std::array<std::vector<double>, 3>& kinks) : rim_(sides) {
  for (int k = 0; k < 3; ++k)
    clear_[k] = degrees_between(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)) < folds_one_plane;
  for (int i = 0; i < 3; ++i)
    for (double t : kinks[i]) {
      for (Index inwards = 0; inwards <= fold_grid_rows; ++inwards) {  // along delta_i
        const double exact = t * fold_grid_rows - 0.5 * static_cast<double>(inwards);
        const Index row = std::lround(exact), other = fold_grid_rows - inwards - row;
        if (row < 1 || other < 1 || std::abs(exact - static_cast<double>(row)) > tolerance::same) continue;
        OnKink& point = on_kinks_.emplace_back();
        point.side = i;
        point.rows[i] = inwards;
        point.rows[(i + 1) % 3] = other;
        point.rows[(i + 2) % 3] = row;
      }
      if (planes_apart(sides[i], t) < folds_one_plane) continue;
      creases_.emplace_back(Eigen::RowVector3d::Zero());
      creases_.back()[(i + 1) % 3] = 1 - t;
      creases_.back()[(i + 2) % 3] = t;
    }
}

FoldCounter::FoldCounter(const Kinks& kinks, const std::array<bool, 3>& tangent) : FoldCounter(kinks) {
  if (!kinks.empty()) kinks_ = &kinks;
  tangent_ = tangent;
}

bool FoldCounter::near_crease(const Eigen::RowVector3d& b) const {
  for (int k = 0; k < 3; ++k)
    if (!clear_[k] && b[k] > 1 - beside_crease) return true;
  for (const Eigen::RowVector3d& crease : creases_)
    if ((b - crease).cwiseAbs().maxCoeff() < beside_crease) return true;
  return false;
}

void FoldCounter::look_at_both_sides(const Surface& patch, Points& normals) const {
  Points beside(2 * static_cast<Index>(on_kinks_.size()), 3);
  Index k = 0;
  for (const OnKink& point : on_kinks_)
    for (const double way : {-tolerance::same, tolerance::same}) {
      auto at = beside.row(k++);
      at << point.rows[0], point.rows[1], point.rows[2];
      at /= fold_grid_rows;
      at[(point.side + 1) % 3] -= way;
      at[(point.side + 2) % 3] += way;
    }
  const Points seen = patch.normals(beside);
  k = 0;
  for (const OnKink& point : on_kinks_) {
    const Eigen::RowVector3d middle = 0.5 * (beside.row(k) + beside.row(k + 1));
    const Vec3 rim = rim_.at(middle.data());
    normals.row(TriangularGrid{fold_grid_rows}.at(point.rows[1], point.rows[2])) =
        seen.row(seen.row(k + 1).dot(rim) < seen.row(k).dot(rim) ? k + 1 : k);
    k += 2;
  }
}

/// On a grid of half as many rows and on the whole rim, which nearly always tells it.
bool FoldCounter::surely_none(const Surface& patch) const {
  static constexpr TriangularGrid grid = {fold_grid_rows / 2};
  static const Points b = [] {
    Points all(grid.size() + 3 * grid.rows, 3);
    all.topRows(grid.size()) = grid.barycentric();
    all.bottomRows(3 * grid.rows).setZero();
    for (Index k = 0; k < grid.rows; ++k) {  // the rim's other points
      const double t = (2.0 * static_cast<double>(k) + 1) / fold_grid_rows;
      for (int i = 0; i < 3; ++i) {
        const Index row = grid.size() + 3 * k + i;
        all(row, i) = 1 - t;
        all(row, (i + 1) % 3) = t;
      }
    }
    return all;
  }();
  const Points normals = patch.normals(b);
  for (Index k = 0; k < b.rows(); ++k) {
    const double* at = b.row(k).data();
    if (vertex_of(at) >= 0) continue;
    const Vec3 rim = rim_.at(at);
    if (!(normals.row(k).dot(rim) >= surely_facing * rim.norm())) return false;
  }
  bool together = true;
  grid.for_edges([&](Index a, Index c) { together = together && normals.row(a).dot(normals.row(c)) >= surely_together; });
  return together;
}

Index FoldCounter::operator()(const Surface& patch) const {
  static const Points b = TriangularGrid{fold_grid_rows}.barycentric();
  const SurfacePtr given(SurfacePtr(), &patch), seen = kinks_ ? kinks_->restored(given, tangent_) : given;
  if (on_kinks_.empty() && surely_none(*seen)) return 0;
  Points normals = seen->normals(b);
  if (!on_kinks_.empty()) look_at_both_sides(*seen, normals);
  Index folds = 0;
  for (Index k = 0; k < b.rows(); ++k) {
    const double* at = b.row(k).data();
    folds += vertex_of(at) < 0 && !(normals.row(k).dot(rim_.at(at)) > 0);
  }
  TriangularGrid{fold_grid_rows}.for_edges([&](Index a, Index c) {
    const Vec3 p = normals.row(a), q = normals.row(c);
    folds += p.dot(q) <= folded_apart && p.norm() > 0 && q.norm() > 0 && !near_crease(b.row(a)) && !near_crease(b.row(c));
  });
  return folds;
}

}  // namespace tripatch
