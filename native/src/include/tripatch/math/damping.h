// Levenberg and Marquardt's damping: the usual values.
#pragma once

namespace tripatch {

inline constexpr double damping_by = 10;  ///< what a step changes it by
inline constexpr int dampings_tried = 6;  ///< before a step is given up: the last is damped a hundred thousand times as much

}  // namespace tripatch
