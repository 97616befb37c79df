#include "tripatch/estimate/circle.h"

#include <algorithm>
#include <cmath>

#include "tripatch/math/linear.h"

namespace tripatch {

Circle circle_along(const std::vector<Vec3>& points, const Vec3& middle, const Vec3& u, const Vec3& v) {
  const Index n = static_cast<Index>(points.size());
  Eigen::MatrixXd a(n, 3), b(n, 1);
  for (Index k = 0; k < n; ++k) {
    const Vec3 d = points[k] - middle;
    a.row(k) << 2 * d.dot(u), 2 * d.dot(v), 1;
    b(k, 0) = a.row(k).head<2>().squaredNorm() / 4;
  }
  const Eigen::MatrixXd x = least_squares(a, b);
  return {middle + x(0, 0) * u + x(1, 0) * v, std::sqrt(std::max(x(2, 0) + x.topRows<2>().squaredNorm(), 0.0))};
}

}  // namespace tripatch
