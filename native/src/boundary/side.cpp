#include "tripatch/boundary/side.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

namespace tripatch {

Vec3 Side::normal(double t) const { return r(t).cross(c.derivative_at(t)).stableNormalized(); }

double check_curves(const std::array<PiecewisePolynomial, 3>& curves) {
  double size = 0;
  for (const PiecewisePolynomial& c : curves) {
    const Vec3 a = c(0);
    for (double t : {0.25, 0.5, 0.75, 1.0}) size = std::max(size, (c(t) - a).norm());
  }
  if (!(size > 0)) throw Refusal("The three sides have no length");
  for (int i = 0; i < 3; ++i) {
    const double gap = (curves[i](1) - curves[(i + 1) % 3](0)).norm();
    if (!(gap <= 1e-6 * size))
      throw Refusal("Sides " + std::to_string(i) + " and " + std::to_string((i + 1) % 3) + " do not meet at corner " +
                    std::to_string((i + 2) % 3) + ": the gap is " + std::to_string(gap));
  }
  return size;
}

double check_sides(const Sides& sides) { return check_curves({sides[0].c, sides[1].c, sides[2].c}); }

}  // namespace tripatch
