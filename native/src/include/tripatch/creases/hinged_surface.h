// Surfaces over plane domains that meet at creases, as one surface over one plane: each domain is laid next to its neighbor so that
// the ends of their crease fall on each other.
#pragma once

#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// A rigid motion of the plane: x -> turn x + shift.
struct PlaneMotion {
  Eigen::Matrix2d turn = Eigen::Matrix2d::Identity();
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();

  PlanePoints of(const PlanePoints& p) const { return (p * turn.transpose()).rowwise() + shift.transpose(); }
  PlanePoints back(const PlanePoints& p) const { return (p.rowwise() - shift.transpose()) * turn; }
};

class HingedSurface final : public Surface {
public:
  struct Part {
    SurfacePtr surface;   ///< rows (u, v, not read) in its own plane
    PlanePoints polygon;  ///< its border there
    PlaneMotion motion;   ///< from there to the common plane
  };
  explicit HingedSurface(std::vector<Part> parts) : parts_(std::move(parts)) {}

  void evaluate(const double* b, Index n, int order, double* out) const override;
  /// The part in whose polygon a point lies, or to whose polygon it is nearest.
  std::size_t part_of(const Eigen::RowVector2d& point) const;

private:
  std::vector<Part> parts_;
};

}  // namespace tripatch
