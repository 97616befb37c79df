#include "tripatch/constructions/blend.h"

#include <algorithm>

#include "tripatch/boundary/side.h"

namespace tripatch {
std::vector<double> feet(const double* b, Index n, int i, const Vec3& direction) {
  std::vector<double> f(3 * n);
  for (Index k = 0; k < n; ++k)
    for (int x = 0; x < 3; ++x) f[3 * k + x] = x == i ? 0.0 : b[3 * k + x] - b[3 * k + i] * direction[x];
  return f;
}

std::array<Vec3, 3> common_corners(const std::array<SurfacePtr, 3>& surfaces) {
  const Points vertices = Points::Identity(3, 3);
  std::array<Points, 3> at;
  double size = 0;
  for (int i = 0; i < 3; ++i) {
    if (!surfaces[i]) throw InvalidArgument("surface " + std::to_string(i) + " is missing");
    at[i] = surfaces[i]->positions(vertices);
    if (!at[i].allFinite()) throw InvalidArgument("surface " + std::to_string(i) + " is not finite at its corners");
    for (int k = 0; k < 3; ++k) size = std::max(size, (at[i].row(k) - at[i].row((k + 1) % 3)).norm());
  }
  std::array<Vec3, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const int a = (k + 1) % 3, b = (k + 2) % 3;  // the two surfaces that carry the sides at corner k
    const double gap = (at[a].row(k) - at[b].row(k)).norm();
    if (!(gap <= sides_meet * size))
      throw InvalidArgument("surfaces " + std::to_string(a) + " and " + std::to_string(b) + " " + gap_at_corner(k, gap));
    corners[k] = at[a].row(k);
  }
  return corners;
}

}  // namespace tripatch
