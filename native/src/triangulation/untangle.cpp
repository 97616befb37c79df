#include "tripatch/triangulation/untangle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/triangles.h"

namespace tripatch {
namespace {

/// Rounds of moving: on 120 holes of scanned and modelled meshes with one to ten folded edges three were enough where any were.
constexpr int mending_rounds = count::octet;
/// More folded edges than this share of all, and than `some_anyway`, are no matter of single vertices: the surface itself is wrong.
constexpr double some = 0.03;
constexpr Index some_anyway = count::several;

struct Joint {
  Index low, high, triangle;
  /// By the triangle too: else the order of an edge's two triangles, and so which edge is flipped, is the standard library's.
  bool operator<(const Joint& o) const { return std::tie(low, high, triangle) < std::tie(o.low, o.high, o.triangle); }
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
                                               const std::vector<Joint>& edges, std::span<const AdjacentFace> beyond) {
  const double cosine = std::cos(folded_degrees * std::numbers::pi / 180);
  const auto normal = [&](Index t) -> Vec3 { return triangle_normal(points, triangles[t]).stableNormalized(); };
  std::vector<std::array<Index, 2>> out;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k)
    if (edges[k].same(edges[k + 1]) && normal(edges[k].triangle).dot(normal(edges[k + 1].triangle)) < cosine)
      out.push_back({edges[k].triangle, edges[k + 1].triangle});
  for (const AdjacentFace& face : beyond) {
    const Joint wanted{std::min(face.from, face.to), std::max(face.from, face.to), -1};
    const auto found = std::lower_bound(edges.begin(), edges.end(), wanted);
    if (found != edges.end() && found->same(wanted) && normal(found->triangle).dot(face.normal) < cosine)
      out.push_back({found->triangle, -1});
  }
  return out;
}

}  // namespace

bool is_past_mending(Index folded, std::size_t triangles) {
  return folded > std::max(some_anyway, static_cast<Index>(some * static_cast<double>(3 * triangles) / 2));
}

Index untangle(Points& points, const std::vector<std::array<Index, 3>>& triangles, Index fixed, Index allowed,
               std::span<const AdjacentFace> beyond) {
  const std::vector<Joint> edges = sorted_joints(triangles);
  std::vector<std::array<Index, 2>> found = folded_pairs(points, triangles, edges, beyond);
  const Index before = static_cast<Index>(found.size());
  if (before <= allowed || is_past_mending(before, triangles.size())) return before;
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

namespace {

/// A flip leaves no triangle flatter than this: height over longest edge. One without area would hide its folds.
constexpr double min_flipped_height = share::trace;

/// Two triangles on both sides of an edge, and what lies across their other edges.
class Flip {
public:
  Flip(const Points& points, const std::vector<std::array<Index, 3>>& triangles, const std::vector<Joint>& edges,
       std::span<const AdjacentFace> beyond)
      : points_(points), triangles_(triangles), edges_(edges), beyond_(beyond) {}

  /// The triangles after the flip of the edge from corner k of t, and how many edges fewer are folded then; 0: none, or impossible.
  int gain(Index t, int k, std::array<std::array<Index, 3>, 2>& flipped, Index& other) const {
    const Index a = triangles_[t][k], b = triangles_[t][(k + 1) % 3], c = triangles_[t][(k + 2) % 3];
    other = across(a, b, t);
    if (other < 0) return 0;
    Index d = -1;
    for (Index v : triangles_[other])
      if (v != a && v != b) d = v;
    if (d < 0 || d == c || first_of(c, d) != edges_.end()) return 0;
    flipped = {{{a, d, c}, {d, b, c}}};
    Vec3 n[2], before[2] = {normal(triangles_[t]), normal(triangles_[other])};
    for (int i = 0; i < 2; ++i) {
      double longest = 0;
      for (int j = 0; j < 3; ++j)
        longest = std::max(longest, (points_.row(flipped[i][j]) - points_.row(flipped[i][(j + 1) % 3])).squaredNorm());
      n[i] = normal(flipped[i]);
      if (!(n[i].norm() > min_flipped_height * longest)) return 0;
    }
    int folds = -folded(n[0], n[1]) + folded(before[0], before[1]);
    for (const auto& [u, v, was, now] :
         {std::tuple(a, d, 1, 0), std::tuple(c, a, 0, 0), std::tuple(d, b, 1, 1), std::tuple(b, c, 0, 1)}) {
      const Vec3 outside = normal_across(u, v, was == 0 ? t : other);
      folds += folded(outside, before[was]) - folded(outside, n[now]);
    }
    return folds;
  }

  /// Whether one of two triangles, or one across their edges, is marked.
  bool any_around(const std::array<Index, 2>& two, const std::vector<char>& marked) const {
    for (Index t : two) {
      if (marked[t]) return true;
      for (int k = 0; k < 3; ++k)
        if (const Index other = across(triangles_[t][k], triangles_[t][(k + 1) % 3], t); other >= 0 && marked[other]) return true;
    }
    return false;
  }

private:
  static int folded(const Vec3& a, const Vec3& b) {
    static const double cosine = std::cos(folded_degrees * std::numbers::pi / 180);
    return a.dot(b) < cosine * a.norm() * b.norm();
  }
  Vec3 normal(const std::array<Index, 3>& t) const { return triangle_normal(points_, t); }
  std::vector<Joint>::const_iterator first_of(Index u, Index v) const {
    const Joint wanted{std::min(u, v), std::max(u, v), -1};
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), wanted);
    return found != edges_.end() && found->same(wanted) ? found : edges_.end();
  }
  Index across(Index u, Index v, Index t) const {
    for (auto at = first_of(u, v); at != edges_.end() && at->same({std::min(u, v), std::max(u, v), -1}); ++at)
      if (at->triangle != t) return at->triangle;
    return -1;
  }
  Vec3 normal_across(Index u, Index v, Index t) const {
    if (const Index other = across(u, v, t); other >= 0) return normal(triangles_[other]);
    for (const AdjacentFace& face : beyond_)
      if (std::minmax(face.from, face.to) == std::minmax(u, v)) return face.normal;
    return Vec3::Zero();
  }

  const Points& points_;
  const std::vector<std::array<Index, 3>>& triangles_;
  const std::vector<Joint>& edges_;
  std::span<const AdjacentFace> beyond_;
};

}  // namespace

Index flip_folded(const Points& points, std::vector<std::array<Index, 3>>& triangles,
                  std::span<const std::array<Index, 2>> joined, Index allowed, std::span<const AdjacentFace> beyond) {
  std::vector<std::array<Index, 3>> turned = triangles;
  const auto is_joined = [&](Index a, Index b) {
    return std::any_of(joined.begin(), joined.end(),
                       [&](const auto& pair) { return std::minmax(pair[0], pair[1]) == std::minmax(a, b); });
  };
  Index left = 0;
  for (int round = 0; round <= mending_rounds; ++round) {
    const std::vector<Joint> edges = sorted_joints(turned);
    const std::vector<std::array<Index, 2>> found = folded_pairs(points, turned, edges, beyond);
    left = static_cast<Index>(found.size());
    if (round == 0 && is_past_mending(left, turned.size())) return left;
    if (left <= allowed) break;
    const Flip flip(points, turned, edges, beyond);
    std::vector<char> touched(turned.size(), 0);  // of this round: the edges are those before it
    bool any = false;
    for (const std::array<Index, 2>& pair : found) {
      std::array<std::array<Index, 3>, 2> flipped{}, best_flipped{};
      std::array<Index, 2> best = {-1, -1};
      int most = 0;
      for (Index t : pair)
        for (int k = 0; t >= 0 && k < 3; ++k) {
          Index other = -1;
          const int gain = flip.gain(t, k, flipped, other);
          if (gain <= most || is_joined(flipped[0][1], flipped[0][2])) continue;
          most = gain;
          best_flipped = flipped;
          best = {t, other};
        }
      if (most == 0 || flip.any_around(best, touched)) continue;
      for (int i = 0; i < 2; ++i) {
        touched[best[i]] = 1;
        turned[best[i]] = best_flipped[i];
      }
      any = true;
    }
    if (!any) break;
  }
  triangles = std::move(turned);
  return left;
}

}  // namespace tripatch
