#include "tripatch/spline/unfold.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace tripatch {
namespace {

/// Rounds of moving: on 120 holes of scanned and modelled meshes with one to ten folded edges three were enough where any were.
constexpr int mending_rounds = 8;
/// More folded edges than this share of all, and than `some_anyway`, are no matter of single vertices: the surface itself is wrong.
constexpr double some = 0.03;
constexpr Index some_anyway = 4;

struct Joint {
  Index low, high, triangle;
  bool operator<(const Joint& o) const { return low != o.low ? low < o.low : high < o.high; }
  bool same(const Joint& o) const { return low == o.low && high == o.high; }
};

std::vector<Joint> sorted_joints(const std::vector<std::array<Index, 3>>& triangles) {
  std::vector<Joint> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
      edges.push_back({low, high, static_cast<Index>(t)});
    }
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// The triangles of each folded edge, or the one and -1 where it is folded back over a face beyond.
std::vector<std::array<Index, 2>> folded_pairs(const Points& points, const std::vector<std::array<Index, 3>>& triangles,
                                               const std::vector<Joint>& edges, std::span<const FaceBeyond> beyond) {
  const double cosine = std::cos(folded_degrees * M_PI / 180);
  const auto normal = [&](Index t) -> Vec3 {
    const Vec3 a = points.row(triangles[t][0]), b = points.row(triangles[t][1]), c = points.row(triangles[t][2]);
    return (b - a).cross(c - a).stableNormalized();
  };
  std::vector<std::array<Index, 2>> out;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k)
    if (edges[k].same(edges[k + 1]) && normal(edges[k].triangle).dot(normal(edges[k + 1].triangle)) < cosine)
      out.push_back({edges[k].triangle, edges[k + 1].triangle});
  for (const FaceBeyond& face : beyond) {
    const Joint wanted{std::min(face.from, face.to), std::max(face.from, face.to), -1};
    const auto found = std::lower_bound(edges.begin(), edges.end(), wanted);
    if (found != edges.end() && found->same(wanted) && normal(found->triangle).dot(face.normal) < cosine)
      out.push_back({found->triangle, -1});
  }
  return out;
}

}  // namespace

Index unfold(Points& points, const std::vector<std::array<Index, 3>>& triangles, Index fixed, Index allowed,
             std::span<const FaceBeyond> beyond) {
  const std::vector<Joint> edges = sorted_joints(triangles);
  std::vector<std::array<Index, 2>> found = folded_pairs(points, triangles, edges, beyond);
  const Index before = static_cast<Index>(found.size());
  if (before <= allowed || before > std::max(some_anyway, static_cast<Index>(some * static_cast<double>(edges.size()) / 2)))
    return before;
  Points moved = points;
  for (int round = 0; round < mending_rounds; ++round) {
    std::vector<Index> who;
    for (const std::array<Index, 2>& pair : found)
      for (Index t : pair)
        for (int k = 0; t >= 0 && k < 3; ++k)
          if (triangles[t][k] >= fixed) who.push_back(triangles[t][k]);
    std::sort(who.begin(), who.end());
    who.erase(std::unique(who.begin(), who.end()), who.end());
    if (who.empty()) return before;
    Points sum = Points::Zero(static_cast<Index>(who.size()), 3);
    Eigen::VectorXd count = Eigen::VectorXd::Zero(sum.rows());
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (k > 0 && edges[k].same(edges[k - 1])) continue;
      for (const auto& [v, other] : {std::pair(edges[k].low, edges[k].high), std::pair(edges[k].high, edges[k].low)}) {
        const auto place = std::lower_bound(who.begin(), who.end(), v);
        if (place == who.end() || *place != v) continue;
        sum.row(place - who.begin()) += moved.row(other);
        count[place - who.begin()] += 1;
      }
    }
    for (std::size_t i = 0; i < who.size(); ++i)
      moved.row(who[i]) = sum.row(static_cast<Index>(i)) / count[static_cast<Index>(i)];
    found = folded_pairs(moved, triangles, edges, beyond);
    if (static_cast<Index>(found.size()) <= allowed) {
      points = moved;
      return static_cast<Index>(found.size());
    }
  }
  return before;
}

}  // namespace tripatch
