// A round hole with rings of triangles around it, which several tests of creases bend.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "tripatch/creases/features.h"
#include "tripatch/math/angle.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch::testing {

/// Rings of triangles around a round hole in the plane, lifted; of n spokes, 0 and n / 2 lie along x. The rim is the first ring.
struct Rings {
  Index n;
  Points vertices;
  Faces faces;
  std::vector<Index> rim;

  Rings(const std::vector<double>& radii, const std::function<Vec3(double, double)>& lift, Index spokes = 24) : n(spokes) {
    const Index rows = static_cast<Index>(radii.size());
    vertices.resize(rows * n, 3);
    for (Index j = 0; j < rows; ++j)
      for (Index k = 0; k < n; ++k) {
        const double a = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n),
                     y = k % (n / 2) == 0 ? 0 : radii[j] * std::sin(a);
        vertices.row(j * n + k) = lift(radii[j] * std::cos(a), y);
      }
    for (Index k = 0; k < n; ++k) rim.push_back(k);
    for (Index j = 0; j + 1 < rows; ++j)
      for (Index k = 0; k < n; ++k) {
        const Index a = j * n + k, b = j * n + (k + 1) % n;
        faces.add(std::array<Index, 3>{b, a, a + n});
        faces.add(std::array<Index, 3>{b, a + n, b + n});
      }
  }
  Mesh mesh() const { return {vertices, faces}; }
  Features features() const { return find_features(mesh(), Connectivity(mesh()), rim); }
  /// Degrees between the faces at the edge of spoke 0 from ring j on.
  double bend(Index j) const {
    const Connectivity around(mesh());
    const auto normal = [&](Index a, Index b) { return area_vector(mesh(), around.face(*around.edge(a, b))); };
    return degrees_between(normal(j * n, j * n + n), normal(j * n + n, j * n));
  }
};

/// Two planes that meet in the x axis, each so many degrees below the horizontal.
inline Vec3 roof(double x, double y, double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return {x, std::cos(a) * y, -std::sin(a) * std::abs(y)};
}

inline std::vector<double> radii(double step, int rings) {
  std::vector<double> all;
  for (int j = 0; j <= rings; ++j) all.push_back(0.5 + step * j);
  return all;
}

}  // namespace tripatch::testing
