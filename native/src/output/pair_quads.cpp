#include "tripatch/output/pair_quads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tripatch/math/angle.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/edge_key.h"

namespace tripatch {
namespace {

struct TrianglePair {
  int a, b;                      // triangles, a < b
  double error;                  // 0: a plane rectangle; at most 2
  std::array<Index, 4> corners;  // from an end of their common edge on: fans from there are the two triangles
};

using Edges = std::vector<std::array<Index, 2>>;  // sorted, each from its lower end

bool contains(const Edges& edges, Index a, Index b) { return std::binary_search(edges.begin(), edges.end(), edge_key(a, b)); }

/// Infinite beyond the thresholds. The quad is (c, a, d, b), its diagonal a-b. stay: edges whose ends do not move.
double error_of(const PointsRef& points, const std::array<Index, 4>& quad, const PairQuadsOptions& options, const Edges& stay) {
  std::array<Vec3, 4> x;
  for (int k = 0; k < 4; ++k) x[k] = points.row(quad[k]);
  const Vec3 first = (x[1] - x[0]).cross(x[3] - x[0]), second = (x[3] - x[2]).cross(x[1] - x[2]);
  if (!(first.squaredNorm() > 0) || !(second.squaredNorm() > 0)) return std::numeric_limits<double>::infinity();
  const double fold = degrees_between(first, second);
  double corner = 0;  // as a share of the largest
  for (int k = 0; k < 4; ++k) {
    const Index before = quad[(k + 3) % 4], here = quad[k], next = quad[(k + 1) % 4];
    const bool stays = contains(stay, before, here) && contains(stay, here, next);
    const double off = std::abs(degrees_between(x[(k + 1) % 4] - x[k], x[(k + 3) % 4] - x[k]) - 90);
    corner = std::max(
        corner, off / std::max(stays ? options.largest_corner : options.largest_free_corner.value_or(options.largest_corner),
                               tolerance::solved));
  }
  if (!(fold <= options.largest_fold) || !(corner <= 1)) return std::numeric_limits<double>::infinity();
  return fold / std::max(options.largest_fold, tolerance::solved) + corner;
}

/// All pairs within the thresholds, the best first.
std::vector<TrianglePair> candidates(const PointsRef& points, const std::vector<std::array<Index, 3>>& triangles,
                                     const PairQuadsOptions& options, const std::vector<std::array<Index, 2>>& kept) {
  struct Edge {
    Index low, high;
    int triangle, corner;
  };
  Edges stay;  // those kept, and the border
  for (const auto& [a, b] : kept) stay.push_back(edge_key(a, b));
  std::vector<Edge> edges;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    for (int k = 0; k < 3; ++k) {
      const Index a = triangles[t][(k + 1) % 3], b = triangles[t][(k + 2) % 3];
      if (std::min({a, b, triangles[t][k]}) < 0 || std::max({a, b, triangles[t][k]}) >= points.rows())
        throw InvalidArgument("triangles of rows that the points do not have");
      edges.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  const auto key = [](const Edge& e) { return std::array<Index, 4>{e.low, e.high, e.triangle, e.corner}; };
  std::sort(edges.begin(), edges.end(), [&](const Edge& p, const Edge& q) { return key(p) < key(q); });
  const auto end_of = [&](std::size_t k) {  // of the edges that are the same
    std::size_t end = k + 1;
    while (end < edges.size() && edges[end].low == edges[k].low && edges[end].high == edges[k].high) ++end;
    return end;
  };
  for (std::size_t k = 0; k < edges.size(); k = end_of(k))
    if (end_of(k) == k + 1) stay.push_back({edges[k].low, edges[k].high});
  std::sort(stay.begin(), stay.end());
  std::vector<TrianglePair> pairs;
  for (std::size_t k = 0; k < edges.size();) {
    const std::size_t end = end_of(k);
    if (end - k == 2 && !contains(stay, edges[k].low, edges[k].high)) {
      const auto &t = triangles[edges[k].triangle], &u = triangles[edges[k + 1].triangle];
      const int i = edges[k].corner, j = edges[k + 1].corner;
      const std::array<Index, 4> quad = {t[i], t[(i + 1) % 3], u[j], t[(i + 2) % 3]};
      const double error =
          t[(i + 1) % 3] == u[(j + 2) % 3] ? error_of(points, quad, options, stay) : std::numeric_limits<double>::infinity();
      const std::array<Index, 4> corners = {quad[1], quad[2], quad[3], quad[0]};
      if (std::isfinite(error)) pairs.push_back({edges[k].triangle, edges[k + 1].triangle, error, corners});
    }
    k = end;
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const TrianglePair& p, const TrianglePair& q) { return coarse(p.error) < coarse(q.error); });
  return pairs;
}

/// For each triangle the pair it is in, or -1.
std::vector<int> choose(const std::vector<TrianglePair>& pairs, std::size_t triangles) {
  std::vector<int> chosen(triangles, -1);
  std::vector<std::vector<int>> of(triangles);  // pairs of each triangle, the best first
  for (int k = 0; k < static_cast<int>(pairs.size()); ++k) {
    of[pairs[k].a].push_back(k);
    of[pairs[k].b].push_back(k);
    if (chosen[pairs[k].a] < 0 && chosen[pairs[k].b] < 0) chosen[pairs[k].a] = chosen[pairs[k].b] = k;
  }
  const auto partner = [&](int pair, int t) { return pairs[pair].a == t ? pairs[pair].b : pairs[pair].a; };
  // From a triangle left over to another one, by pairs that are not chosen and pairs that are in turn: these change places (Edmonds 1965,
  // "Paths, trees, and flowers", without the flowers). came_by: of each triangle that is reached by a pair not chosen, that pair.
  std::vector<int> came_by(triangles, -1), queue, reached;
  const auto give_partner = [&](int start) {
    for (const int t : reached) came_by[t] = -1;
    reached.clear();
    queue.assign(1, start);
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const int t = queue[next];
      for (const int pair : of[t]) {
        int u = partner(pair, t);
        if (came_by[u] >= 0 || u == start || chosen[u] == pair) continue;
        came_by[u] = pair;
        reached.push_back(u);
        if (chosen[u] >= 0) {
          const int w = partner(chosen[u], u);
          if (came_by[w] < 0) queue.push_back(w);
          continue;
        }
        while (true) {  // back to the start
          const int taken = came_by[u], before = partner(taken, u), given_up = chosen[before];
          chosen[u] = chosen[before] = taken;
          if (before == start) return;
          u = partner(given_up, before);
        }
      }
    }
  };
  for (int t = 0; t < static_cast<int>(triangles); ++t)
    if (chosen[t] < 0) give_partner(t);
  return chosen;
}

}  // namespace

Faces pair_quads(const PointsRef& points, const std::vector<std::array<Index, 3>>& triangles, const PairQuadsOptions& options,
                 const std::vector<std::array<Index, 2>>& kept) {
  const std::vector<TrianglePair> pairs = candidates(points, triangles, options, kept);
  const std::vector<int> chosen = choose(pairs, triangles.size());
  Faces faces;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    if (chosen[t] < 0)
      faces.add(triangles[t]);
    else if (pairs[chosen[t]].a == t)
      faces.add(pairs[chosen[t]].corners);
  }
  return faces;
}

}  // namespace tripatch
