// The surface over a plane with the rim that bounds what is filled of it.
#pragma once

#include <utility>

#include "tripatch/math/plane.h"
#include "tripatch/patch/surface.h"
#include "tripatch/types.h"

namespace tripatch {

/// Rows of evaluate are (u, v, not read), derivatives are by (u, v).
class PlanePatch final : public Surface {
public:
  PlanePatch(SurfacePtr surface, PlanePoints rim) : surface_(std::move(surface)), rim_(std::move(rim)) {}
  void evaluate(const double* b, Index n, int order, double* out) const override { surface_->evaluate(b, n, order, out); }
  /// Places of the rim's vertices, of islands those after them.
  const PlanePoints& rim() const { return rim_; }
  const SurfacePtr& surface() const { return surface_; }

private:
  SurfacePtr surface_;
  PlanePoints rim_;
};

}  // namespace tripatch
