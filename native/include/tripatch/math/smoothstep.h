// From 0 to 1 without a corner.
#pragma once

#include <algorithm>

namespace tripatch {

/// x^2 (3 - 2 x): 0 up to x = 0, 1 from x = 1 on, once continuously differentiable.
inline double smoothstep(double x) {
  const double u = std::clamp(x, 0.0, 1.0);
  return u * u * (3 - 2 * u);
}

}  // namespace tripatch
