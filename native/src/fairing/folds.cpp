#include "tripatch/fairing/folds.h"

#include "tripatch/math/angle.h"
#include "tripatch/math/triangular_grid.h"

namespace tripatch {
FoldCounter::FoldCounter(const Sides& sides) : rim_(sides) {
  for (int k = 0; k < 3; ++k)
    clear_[k] = degrees_between(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)) < folds_one_plane;
  for (int i = 0; i < 3; ++i)
    for (double t : kinks_of(sides[i])) {
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

Index FoldCounter::operator()(const Surface& patch) const {
  static const Points b = TriangularGrid{fold_grid_rows}.barycentric();
  const Points normals = kinks_ ? kinks_->restored({SurfacePtr(), &patch}, tangent_)->normals(b) : patch.normals(b);
  Index folds = 0;
  for (Index k = 0; k < b.rows(); ++k) {
    const double* at = b.row(k).data();
    folds += vertex_of(at) < 0 && !(normals.row(k).dot(rim_.at(at)) > 0);
  }
  TriangularGrid{fold_grid_rows}.for_edges([&](Index a, Index c) {
    const Vec3 p = normals.row(a), q = normals.row(c);
    folds += p.dot(q) <= folded_apart && p.norm() > 0 && q.norm() > 0 && !near_crease(b.row(a));
  });
  return folds;
}

}  // namespace tripatch
