// Unit vectors, where there are many of them.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "tripatch/types.h"

namespace tripatch {

/// Of a vector of any length; zero stays zero. As stableNormalized(), which has three divisions more.
inline Vec3 unit_vector(const Vec3& v) {
  const double squared = v.squaredNorm();
  constexpr double overflow = 1e250;
  const bool far_from_overflow = squared > 1 / overflow && squared < overflow;
  return far_from_overflow ? Vec3(v * (1 / std::sqrt(squared))) : v.stableNormalized();
}

}  // namespace tripatch
