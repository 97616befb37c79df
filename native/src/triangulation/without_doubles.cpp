#include "tripatch/triangulation/without_doubles.h"

#include <algorithm>
#include <map>

namespace tripatch {

bool without_doubles(Triangles& triangles, const std::vector<EdgeKey>& joined) {
  std::vector<EdgeKey> edges;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) edges.push_back({t[k], t[(k + 1) % 3]});
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  const auto has = [](const auto& sorted, Index a, Index b) {
    return std::binary_search(sorted.begin(), sorted.end(), std::array<Index, 2>{a, b});
  };
  std::vector<EdgeKey> doubled;
  for (const auto& pair : joined)
    if (has(edges, pair[0], pair[1]) && has(edges, pair[1], pair[0])) doubled.push_back(pair);
  if (doubled.empty()) return true;
  std::map<std::array<Index, 2>, std::size_t> triangle;  // of a directed edge
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) triangle[{triangles[t][k], triangles[t][(k + 1) % 3]}] = t;
  const auto opposite = [](const std::array<Index, 3>& t, Index a, Index b) {
    return t[0] != a && t[0] != b ? t[0] : t[1] != a && t[1] != b ? t[1] : t[2];
  };
  const auto put = [&](std::size_t t, Index a, Index b, Index c) {
    triangles[t] = {a, b, c};
    triangle[{a, b}] = triangle[{b, c}] = triangle[{c, a}] = t;
  };
  for (bool changed = true; changed && !doubled.empty();) {
    changed = false;
    for (auto pair = doubled.begin(); pair != doubled.end();) {
      const auto [a, b] = *pair;
      const std::size_t left = triangle.at({a, b}), right = triangle.at({b, a});
      const Index c = opposite(triangles[left], a, b), d = opposite(triangles[right], a, b);
      if (c == d || triangle.count({c, d}) || triangle.count({d, c}) || std::ranges::binary_search(joined, edge_key(c, d))) {
        ++pair;
        continue;
      }
      triangle.erase({a, b});
      triangle.erase({b, a});
      put(left, c, d, b);
      put(right, d, c, a);
      pair = doubled.erase(pair);
      changed = true;
    }
  }
  return doubled.empty();
}

}  // namespace tripatch
