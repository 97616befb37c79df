// A try as the fill that it makes, and how well that is known.
#pragma once

#include "tripatch/spline/plane_attempt.h"

namespace tripatch {

PlaneFill completed(const Attempt& result, const PlaneRim& rim, const Disc& disc);

}  // namespace tripatch
