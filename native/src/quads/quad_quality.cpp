#include <Eigen/Geometry>
#include <algorithm>

#include "tripatch/quads/quad_smoothing.h"

namespace tripatch {

QuadQuality quad_quality(const PointsRef& points, const Faces& faces) {
  QuadQuality quality;
  double sum = 0;
  Index count = 0;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    const std::size_t m = face.size();
    const auto at = [&](std::size_t k) { return Vec3(points.row(face[k % m])); };
    const Vec3 normal = m == 3 ? (at(1) - at(0)).cross(at(2) - at(0)).stableNormalized()
                               : (at(2) - at(0)).cross(at(3) - at(1)).stableNormalized();
    for (std::size_t k = 0; m == 4 && k < m; ++k) {
      const double sine = normal.dot((at(k + 1) - at(k)).stableNormalized().cross((at(k + m - 1) - at(k)).stableNormalized()));
      quality.least = std::min(quality.least, sine);
      sum += sine;
      ++count;
    }
  }
  if (count > 0) quality.mean = sum / static_cast<double>(count);
  return quality;
}

}  // namespace tripatch
