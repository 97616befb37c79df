// The angle between two vectors, by atan2: exact for small angles and for those near 180 degrees, where acos loses half of the digits.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "tripatch/types.h"

namespace tripatch {

/// Radians, 0 to pi; 0 where one of them vanishes. The vectors may be of any length.
inline double angle_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }
/// The same in the plane.
inline double angle_in_plane(const Vec2& a, const Vec2& b) { return std::abs(std::atan2(a[0] * b[1] - a[1] * b[0], a.dot(b))); }

inline double degrees_between(const Vec3& a, const Vec3& b) { return angle_between(a, b) * 180 / std::numbers::pi; }

}  // namespace tripatch
