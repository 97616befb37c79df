#include "tripatch/boundary/side.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

namespace tripatch {

Vec3 Side::normal(double t) const { return r(t).cross(c.derivative_at(t)).stableNormalized(); }

double check_sides(const Sides& sides) {
  double size = 0;
  for (const Side& side : sides) {
    const Vec3 a = side.c(0);
    for (double t : {0.25, 0.5, 0.75, 1.0}) size = std::max(size, (side.c(t) - a).norm());
  }
  if (!(size > 0)) throw Refusal("The three sides have no length");
  for (int i = 0; i < 3; ++i) {
    const double gap = (sides[i].c(1) - sides[(i + 1) % 3].c(0)).norm();
    if (!(gap <= 1e-6 * size))
      throw Refusal("Sides " + std::to_string(i) + " and " + std::to_string((i + 1) % 3) + " do not meet at corner " +
                    std::to_string((i + 2) % 3) + ": the gap is " + std::to_string(gap));
  }
  return size;
}

}  // namespace tripatch
