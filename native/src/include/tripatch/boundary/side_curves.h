// The curves of a side in a plain mesh: through the rim vertices, tangent to the planes and bending as the surface does.
#pragma once

#include <array>

#include "tripatch/boundary/side.h"
#include "tripatch/estimate/side_draft.h"

namespace tripatch {

/// The cubic spline through the positions.
PiecewisePolynomial curve_through(const SideDraft& side);

/// Position, derivative across and second derivative across, in scene units: one unit of the drafts is `scale` of them. noise: variance
/// of a position, in the drafts' units.
Sides side_curves(const std::array<SideDraft, 3>& drafts, double scale, double noise);

}  // namespace tripatch
