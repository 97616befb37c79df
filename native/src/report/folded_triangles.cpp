#include "tripatch/report/folded_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <tuple>
#include <vector>

#include "tripatch/math/interruption.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// An edge of a triangle, filed under its higher vertex; in 32 bits, as a mesh counts its corners, for edges are most of the memory.
struct TriangleEdge {
  std::uint32_t low, triangle;
};

/// Edges by their higher vertex, the triangles of one in their order: each vertex of the fill's own has a place, those of the mesh, whose
/// numbers say nothing of how many there are, share the last.
class EdgesByVertex {
public:
  EdgesByVertex(Index first, Index own) : first_(first), end_(own + 3, 0) {}

  void count(Index a, Index b) { ++end_[place(std::max(a, b)) + 2]; }
  void counted() {
    for (std::size_t k = 1; k < end_.size(); ++k) end_[k] += end_[k - 1];
    edges_ = std::make_unique_for_overwrite<TriangleEdge[]>(end_.back());
  }
  void add(Index a, Index b, std::size_t triangle) {
    const auto [low, high] = std::minmax(a, b);
    const Index at = place(high);
    if (at == places() - 1) of_mesh_.push_back(high);
    edges_[end_[at + 1]++] = {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(triangle)};
  }

  /// use(first triangle at an edge, another one) for all others of each edge.
  template <class Use>
  void for_pairs(const Use& use) {
    for (Index at = 0; at + 1 < places(); ++at) {
      if (at % 256 == 0) check_interruption();
      TriangleEdge *const from = edges_.get() + end_[at], *const to = edges_.get() + end_[at + 1];
      if (to - from > many) {
        std::stable_sort(from, to, [](const TriangleEdge& p, const TriangleEdge& q) { return p.low < q.low; });
        for (const TriangleEdge *first = from, *e = from; e < to; ++e) {
          if (e->low != first->low) first = e;
          if (e > first) use(first->triangle, e->triangle);
        }
        continue;
      }
      for (const TriangleEdge* e = from; e < to; ++e)
        for (const TriangleEdge* first = from; first < e; ++first)
          if (first->low == e->low) {
            use(first->triangle, e->triangle);
            break;
          }
    }
    const TriangleEdge* const last = edges_.get() + end_[places() - 1];
    std::vector<std::tuple<Index, Index, std::uint32_t>> all;
    for (std::size_t k = 0; k < of_mesh_.size(); ++k) all.emplace_back(of_mesh_[k], last[k].low, last[k].triangle);
    std::sort(all.begin(), all.end());
    for (std::size_t k = 1, first = 0; k < all.size(); ++k) {
      const auto& [high, low, triangle] = all[k];
      if (std::get<0>(all[first]) != high || std::get<1>(all[first]) != low) first = k;
      if (k > first) use(std::get<2>(all[first]), triangle);
    }
  }

private:
  static constexpr std::ptrdiff_t many =
      24;  ///< edges at a vertex, from which on sorting them is less than comparing all of them

  Index places() const { return static_cast<Index>(end_.size()) - 2; }
  Index place(Index high) const { return high < first_ ? places() - 1 : high - first_; }

  Index first_;
  std::vector<Index> end_;  // of the place before; while edges are added one place on, which this moves to where it belongs
  std::unique_ptr<TriangleEdge[]> edges_;
  std::vector<Index> of_mesh_;  // the higher vertices of the last place
};

/// Of a triangle, by twice its vector area; zero where it has none.
Vec3 unit(const Vec3& area) {
  constexpr double least = 1e-140, most = 1e140;  // squares of which are numbers
  const double length = area.norm();
  return length > least && length < most ? Vec3(area / length) : area.stableNormalized();
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
  const auto for_triangles = [&](const auto& use) {
    for (Index f = 0; f < faces.size(); ++f) {
      if (f % 256 == 0) check_interruption();
      const auto face = faces[f];
      for (std::size_t k = 2; k < face.size(); ++k) use(std::array<Index, 3>{face[0], face[k - 1], face[k]});
    }
  };
  EdgesByVertex edges(n, added.rows());
  std::size_t own = 0;  // triangles; those beyond come after them, and count only where one of these is
  for_triangles([&](const std::array<Index, 3>& corner) {
    for (int i = 0; i < 3; ++i) edges.count(corner[i], corner[(i + 1) % 3]);
    ++own;
  });
  for (const FaceBeyond& face : beyond) edges.count(face.from, face.to);
  edges.counted();
  std::vector<Vec3> normals;
  normals.reserve(own + beyond.size());
  for_triangles([&](const std::array<Index, 3>& corner) {
    for (int i = 0; i < 3; ++i) edges.add(corner[i], corner[(i + 1) % 3], normals.size());
    const Vec3 a = at(corner[0]);
    normals.push_back(unit((at(corner[1]) - a).cross(at(corner[2]) - a)));
  });
  for (const FaceBeyond& face : beyond) {
    edges.add(face.from, face.to, normals.size());
    normals.push_back(face.normal.stableNormalized());
  }
  const double cosine = std::cos(folded_degrees * M_PI / 180);
  Index count = 0;
  edges.for_pairs([&](std::uint32_t first, std::uint32_t other) {
    if (first < own) count += normals[other].dot(normals[first]) < cosine;
  });
  return count;
}

}  // namespace tripatch
