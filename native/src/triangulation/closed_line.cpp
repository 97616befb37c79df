#include "tripatch/triangulation/closed_line.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tripatch/math/tolerances.h"
#include "tripatch/report/crossings.h"

namespace tripatch {

ClosedLine::ClosedLine(Points points, std::vector<Index> vertices) : points_(std::move(points)), vertices_(std::move(vertices)) {
  vertices_.push_back(vertices_.front());
  along_ = points_(vertices_, Eigen::all);
  for (Index k = 0; k + 1 < along_.rows(); ++k) lengths_.push_back((along_.row(k + 1) - along_.row(k)).norm());
}

bool ClosedLine::goes_through(const std::array<Index, 3>& triangle) const {
  const std::array<Vec3, 3> p = {points_.row(triangle[0]), points_.row(triangle[1]), points_.row(triangle[2])};
  const Vec3 u = p[1] - p[0], v = p[2] - p[0], normal = u.cross(v).stableNormalized();
  if (normal.isZero()) return false;
  const double longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), (p[2] - p[1]).squaredNorm()}));
  const Eigen::ArrayXd heights = (along_ * normal).array() - p[0].dot(normal);
  const auto is_corner = [&](Index k) { return std::find(triangle.begin(), triangle.end(), vertices_[k]) != triangle.end(); };
  for (Index k = 0; k + 1 < heights.size(); ++k) {
    if ((heights[k] > 0) == (heights[k + 1] > 0) || is_corner(k) || is_corner(k + 1)) continue;
    if (passage(along_.row(k), along_.row(k + 1), p, normal, tolerance::same * std::max(longest, lengths_[k]))) return true;
  }
  return false;
}

}  // namespace tripatch
