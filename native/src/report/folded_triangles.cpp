#include "tripatch/report/folded_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <tuple>

#include "tripatch/math/interruption.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// An edge of a triangle by its lower and its higher vertex.
using TriangleEdge = std::tuple<Index, Index, Index>;

/// The same edges beside each other, the triangles of one in their order: by higher vertex without comparisons where that is one of the
/// fill's own, `first` and more; those of the mesh, whose numbers say nothing of how many there are, come last.
std::vector<TriangleEdge> by_edge(const std::vector<TriangleEdge>& edges, Index first, Index own) {
  std::vector<Index> end(own + 2, 0);
  const auto bucket = [&](const TriangleEdge& edge) { return std::get<1>(edge) < first ? own : std::get<1>(edge) - first; };
  for (const TriangleEdge& edge : edges) ++end[bucket(edge) + 1];
  for (Index b = 0; b <= own; ++b) end[b + 1] += end[b];
  std::vector<TriangleEdge> sorted(edges.size());
  std::vector<Index> next(end.begin(), end.end() - 1);
  for (const TriangleEdge& edge : edges) sorted[next[bucket(edge)]++] = edge;
  for (Index b = 0; b <= own; ++b) {
    if (b % 256 == 0) check_interruption();
    std::sort(sorted.begin() + end[b], sorted.begin() + end[b + 1]);
  }
  return sorted;
}

}  // namespace

std::vector<FaceBeyond> faces_beyond(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops) {
  std::vector<FaceBeyond> out;
  for (const std::vector<Index>& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Index from = loop[k], to = loop[(k + 1) % loop.size()];
      const auto corner = around.edge(to, from);
      out.push_back({from, to, corner ? Vec3(area_vector(mesh, around.face(*corner)).stableNormalized()) : Vec3(Vec3::Zero())});
    }
  return out;
}

std::vector<FaceBeyond> faces_beyond_rows(const Mesh& mesh, const Connectivity& around,
                                          const std::vector<std::vector<Index>>& loops) {
  std::vector<FaceBeyond> out = faces_beyond(mesh, around, loops);
  Index first = 0;
  for (const std::vector<Index>& loop : loops) {
    const Index n = static_cast<Index>(loop.size());
    for (Index k = 0; k < n; ++k) {
      out[first + k].from = first + k;
      out[first + k].to = first + (k + 1) % n;
    }
    first += n;
  }
  return out;
}

Index count_folded_edges(const PointsRef& vertices, const PointsRef& added, const Faces& faces,
                         std::span<const FaceBeyond> beyond) {
  const Index n = vertices.rows();
  const auto at = [&](Index v) -> Vec3 { return v < n ? vertices.row(v) : added.row(v - n); };
  std::vector<Vec3> normals;  // of the triangles; zero where one has no area
  std::vector<TriangleEdge> all;
  for (Index f = 0; f < faces.size(); ++f) {
    if (f % 256 == 0) check_interruption();
    const auto face = faces[f];
    for (std::size_t k = 2; k < face.size(); ++k) {
      const std::array<Index, 3> corner = {face[0], face[k - 1], face[k]};
      const Vec3 a = at(corner[0]);
      for (int i = 0; i < 3; ++i) {
        const auto [low, high] = std::minmax(corner[i], corner[(i + 1) % 3]);
        all.emplace_back(low, high, static_cast<Index>(normals.size()));
      }
      normals.push_back((at(corner[1]) - a).cross(at(corner[2]) - a).stableNormalized());
    }
  }
  const Index own = static_cast<Index>(normals.size());  // those beyond come after them, and count only where one of them is
  for (const FaceBeyond& face : beyond) {
    const auto [low, high] = std::minmax(face.from, face.to);
    all.emplace_back(low, high, static_cast<Index>(normals.size()));
    normals.push_back(face.normal.stableNormalized());
  }
  const std::vector<TriangleEdge> edges = by_edge(all, n, added.rows());
  const double cosine = std::cos(folded_degrees * M_PI / 180);
  Index count = 0;
  for (std::size_t k = 0, first = 0; k < edges.size(); ++k) {
    const auto& [low, high, triangle] = edges[k];
    if (std::get<0>(edges[first]) != low || std::get<1>(edges[first]) != high) first = k;
    if (k > first && std::get<2>(edges[first]) < own) count += normals[triangle].dot(normals[std::get<2>(edges[first])]) < cosine;
  }
  return count;
}

}  // namespace tripatch
