// Levenberg and Marquardt's damping: the usual values.
#pragma once

#include "tripatch/math/thresholds.h"

namespace tripatch {

inline constexpr double damping_by = factor::huge;  ///< what a step changes it by
inline constexpr int dampings_tried =
    count::half_dozen;  ///< before a step is given up: the last is damped a hundred thousand times as much

}  // namespace tripatch
