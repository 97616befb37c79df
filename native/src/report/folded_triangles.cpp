#include "tripatch/report/folded_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "tripatch/math/interruption.h"

namespace tripatch {

Index count_folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces) {
  const Index n = vertices.rows();
  const auto at = [&](Index v) -> Vec3 { return v < n ? vertices.row(v) : added.row(v - n); };
  std::vector<Vec3> normals;                           // of the triangles; zero where one has no area
  std::vector<std::tuple<Index, Index, Index>> edges;  // lower vertex, higher vertex, triangle
  for (Index f = 0; f < faces.size(); ++f) {
    check_interruption();
    const auto face = faces[f];
    for (std::size_t k = 2; k < face.size(); ++k) {
      const std::array<Index, 3> corner = {face[0], face[k - 1], face[k]};
      const Vec3 a = at(corner[0]);
      for (int i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(corner[i], corner[(i + 1) % 3]);
        edges.emplace_back(low, high, static_cast<Index>(normals.size()));
      }
      normals.push_back((at(corner[1]) - a).cross(at(corner[2]) - a).stableNormalized());
    }
  }
  std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) {
    check_interruption();
    return a < b;
  });
  const double cosine = std::cos(folded_degrees * M_PI / 180);
  Index count = 0;
  for (std::size_t k = 0, first = 0; k < edges.size(); ++k) {
    const auto& [low, high, triangle] = edges[k];
    if (std::get<0>(edges[first]) != low || std::get<1>(edges[first]) != high) first = k;
    if (k > first) count += normals[triangle].dot(normals[std::get<2>(edges[first])]) < cosine;
  }
  return count;
}

}  // namespace tripatch
