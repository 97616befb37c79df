#include "tripatch/fairing/folds.h"

#include <cmath>

#include "tripatch/math/angle.h"
#include "tripatch/math/triangular_grid.h"

namespace tripatch {
namespace {

/// How far to both sides of a kink, in the side's parameter, a patch is looked at. A choice: far more than rounding, far less than a row.
constexpr double beside_kink = 1e-6;

}  // namespace

FoldCounter::FoldCounter(const Sides& sides) : rim_(sides) {
  for (int k = 0; k < 3; ++k)
    clear_[k] = degrees_between(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)) < folds_one_plane;
  for (int i = 0; i < 3; ++i)
    for (double t : kinks_of(sides[i])) {
      const double row = t * fold_grid_rows;
      if (std::abs(row - std::round(row)) < beside_kink) on_kinks_.push_back({i, static_cast<Index>(std::round(row))});
      if (planes_apart(sides[i], t) < folds_one_plane) continue;
      creases_.emplace_back(Eigen::RowVector3d::Zero());
      creases_.back()[(i + 1) % 3] = 1 - t;
      creases_.back()[(i + 2) % 3] = t;
    }
}

FoldCounter::FoldCounter(const Kinks& kinks, const std::array<bool, 3>& tangent) : FoldCounter(kinks.sides()) {
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
  for (const auto& [i, row] : on_kinks_) {
    std::array<Index, 3> rows = {};
    rows[(i + 1) % 3] = fold_grid_rows - row;
    rows[(i + 2) % 3] = row;
    Eigen::RowVector3d at(rows[0], rows[1], rows[2]), along = Eigen::RowVector3d::Zero();
    at /= fold_grid_rows;
    along[(i + 1) % 3] = -beside_kink;
    along[(i + 2) % 3] = beside_kink;
    Points beside(2, 3);
    beside << at - along, at + along;
    const Points seen = patch.normals(beside);
    const Vec3 rim = rim_.at(at.data());
    const Index worse = seen.row(1).dot(rim) < seen.row(0).dot(rim) ? 1 : 0;
    normals.row(TriangularGrid{fold_grid_rows}.at(rows[1], rows[2])) = seen.row(worse);
  }
}

Index FoldCounter::operator()(const Surface& patch) const {
  static const Points b = TriangularGrid{fold_grid_rows}.barycentric();
  const SurfacePtr given(SurfacePtr(), &patch), seen = kinks_ ? kinks_->restored(given, tangent_) : given;
  Points normals = seen->normals(b);
  look_at_both_sides(*seen, normals);
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
