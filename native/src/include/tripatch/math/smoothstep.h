// The smooth step from 0 to 1.
#pragma once

#include <algorithm>

namespace tripatch {

/// 0 up to x = 0, 1 from x = 1 on, between them the cubic whose slope is 0 at both.
inline double smoothstep(double x) {
  const double u = std::clamp(x, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

}  // namespace tripatch
