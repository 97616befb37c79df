// Unit vectors, where there are many of them.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "tripatch/types.h"

namespace tripatch {

/// Squares of lengths between it and its inverse can be divided by.
inline constexpr double unit_overflow = 1e250;

/// Of a vector of any length; zero stays zero. As stableNormalized(), which has three divisions more.
inline Vec3 unit_vector(const Vec3& v) {
  const double squared = v.squaredNorm();
  const bool far_from_overflow = squared > 1 / unit_overflow && squared < unit_overflow;
  return far_from_overflow ? Vec3(v * (1 / std::sqrt(squared))) : v.stableNormalized();
}

}  // namespace tripatch
