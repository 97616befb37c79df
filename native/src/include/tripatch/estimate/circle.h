// The circle that points lie on as they are seen along an axis.
#pragma once

#include <vector>

#include "tripatch/types.h"

namespace tripatch {

struct Circle {
  Vec3 center;
  double radius;
};

/// By least squares of |p|^2 = 2 c . p + (radius^2 - |c|^2) in the plane through `middle` along u and v, unit and at right angles; the
/// radius is 0 where the points lie on no circle.
Circle circle_along(const std::vector<Vec3>& points, const Vec3& middle, const Vec3& u, const Vec3& v);

}  // namespace tripatch
