#include "tripatch/output/doubled_edges.h"

#include <algorithm>
#include <compare>

namespace tripatch {
namespace {

/// A triangle at an edge between two rim vertices, the lower one first.
struct AtEdge {
  Index a, b;
  std::size_t triangle;
  auto operator<=>(const AtEdge&) const = default;
};

/// By edges, and of each in the order of its triangles.
std::vector<AtEdge> triangles_at_edges(const std::vector<std::array<Index, 3>>& triangles, Index rim) {
  std::vector<AtEdge> all;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const std::array<Index, 3>& v = triangles[t];
    if ((v[0] < rim) + (v[1] < rim) + (v[2] < rim) < 2) continue;
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(v[k], v[(k + 1) % 3]);
      if (b < rim) all.push_back({a, b, t});
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Puts vertex m into edge a b of a triangle; its half at b is added.
void halve(std::vector<std::array<Index, 3>>& triangles, std::size_t t, Index a, Index b, Index m) {
  std::array<Index, 3> other = triangles[t];
  std::replace(triangles[t].begin(), triangles[t].end(), b, m);
  std::replace(other.begin(), other.end(), a, m);
  triangles.push_back(other);
}

}  // namespace

std::vector<std::array<Index, 2>> halve_doubled_edges(const Connectivity& mesh, std::span<const Index> rim, Index count,
                                                      std::vector<std::array<Index, 3>>& triangles) {
  std::vector<std::array<Index, 2>> halved;
  for (bool more = true; more;) {  // an edge whose triangle has changed waits for the next pass
    more = false;
    std::vector<char> changed(triangles.size(), 0);
    const std::vector<AtEdge> all = triangles_at_edges(triangles, static_cast<Index>(rim.size()));
    for (std::size_t k = 0, next = 0; k < all.size(); k = next) {
      const auto [a, b, first] = all[k];
      while (next < all.size() && all[next].a == a && all[next].b == b) ++next;
      if (next - k != 2 || mesh.faces_at_edge(rim[a], rim[b]).empty()) continue;
      more = true;
      const std::size_t second = all[k + 1].triangle;
      if (changed[first] || changed[second]) continue;
      const Index middle = count + static_cast<Index>(halved.size());
      halved.push_back({a, b});
      for (std::size_t t : {first, second}) {
        changed[t] = 1;
        halve(triangles, t, a, b, middle);
      }
    }
  }
  return halved;
}

std::vector<std::array<Index, 2>> joined_rows(const Connectivity& around, const std::vector<Index>& rim) {
  std::vector<std::array<Index, 2>> row, joined;  // (vertex, row), sorted
  for (std::size_t k = 0; k < rim.size(); ++k) row.push_back({rim[k], static_cast<Index>(k)});
  std::sort(row.begin(), row.end());
  for (Index k = 0; k < static_cast<Index>(rim.size()); ++k)
    for (Connectivity::Corner c : around.at(rim[k]))
      for (Index other : {around.next(c), around.previous(c)}) {
        const auto found = std::lower_bound(row.begin(), row.end(), std::array<Index, 2>{other, -1});
        if (found != row.end() && (*found)[0] == other && k < (*found)[1]) joined.push_back({k, (*found)[1]});
      }
  std::sort(joined.begin(), joined.end());
  joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
  return joined;
}

bool doubles_edges(const Connectivity& around, const std::vector<Index>& rim, const Faces& faces) {
  const Index r = static_cast<Index>(rim.size());
  const std::vector<std::array<Index, 2>> joined = joined_rows(around, rim);
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0, m = faces[f].size(); k < m; ++k) {
      const auto [a, b] = std::minmax(faces[f][k], faces[f][(k + 1) % m]);
      if (b >= r || b - a == 1 || b - a == r - 1) continue;
      if (std::binary_search(joined.begin(), joined.end(), std::array{a, b})) return true;
    }
  return false;
}

bool doubles_edges_of_mesh(const Connectivity& around, const std::vector<Index>& rim, Faces faces) {
  for (Index& v : faces.corners) v = std::find(rim.begin(), rim.end(), v) - rim.begin();
  return doubles_edges(around, rim, faces);
}

}  // namespace tripatch
