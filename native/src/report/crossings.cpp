#include "tripatch/report/crossings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/report/one_to_one.h"

namespace tripatch {
namespace {

struct CrossingTriangle {
  std::array<Index, 3> corner;
  std::array<Vec3, 3> p;
  Vec3 normal;  // of unit length, zero where it has no area
  double longest = 0;
};

struct Bounds {
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);

  void take(const Bounds& other) {
    low = low.cwiseMin(other.low);
    high = high.cwiseMax(other.high);
  }
  bool meets(const Bounds& other) const {
    return (low.array() <= other.high.array()).all() && (other.low.array() <= high.array()).all();
  }
};

/// Where edge k of a triangle goes through another, if it does.
std::optional<Crossing> passed(const CrossingTriangle& of, int k, const CrossingTriangle& through, double least) {
  const Index a = of.corner[k], b = of.corner[(k + 1) % 3];
  for (Index v : through.corner)
    if (v == a || v == b) return {};
  const std::optional<Vec3> where = passage(of.p[k], of.p[(k + 1) % 3], through.p, through.normal, least);
  if (!where) return {};
  return Crossing{{a, b}, through.corner, *where};
}

/// Whether the plane of a triangle has corners of another on both sides.
bool is_on_both_sides(const CrossingTriangle& one, const CrossingTriangle& plane, double least) {
  bool over = false, under = false;
  for (const Vec3& p : one.p) {
    const double height = (p - plane.p[0]).dot(plane.normal);
    over |= height > least;
    under |= height < -least;
  }
  return over && under;
}

/// Triangles in boxes, each halved across its longest side until few are left.
class TriangleTree {
public:
  explicit TriangleTree(const std::vector<CrossingTriangle>& triangles) : triangles_(triangles), order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), Index{0});
    bounds_.reserve(triangles.size());
    for (const CrossingTriangle& t : triangles) {
      Bounds& each = bounds_.emplace_back();
      for (const Vec3& p : t.p) each.low = each.low.cwiseMin(p), each.high = each.high.cwiseMax(p);
    }
    build(0, static_cast<Index>(order_.size()));
  }

  std::vector<Crossing> crossings(std::size_t most) {
    most_ = most;
    if (!order_.empty()) within(0);
    found_.resize(std::min(most, found_.size()));
    return std::move(found_);
  }

private:
  static constexpr Index few = count::several;

  struct Node {
    Bounds bounds;
    Index first, end;
    Index second = -1;  // the node after this one, and that; none: a leaf
  };

  Index build(Index first, Index end) {
    const Index at = static_cast<Index>(nodes_.size());
    Bounds bounds;
    for (Index k = first; k < end; ++k) bounds.take(bounds_[order_[k]]);
    nodes_.push_back({bounds, first, end});
    if (end - first <= few) return at;
    check_interruption();
    Index axis = 0;
    (bounds.high - bounds.low).maxCoeff(&axis);
    const Index middle = (first + end) / 2;
    const auto place = [&](Index t) { return bounds_[t].low[axis] + bounds_[t].high[axis]; };
    std::nth_element(order_.begin() + first, order_.begin() + middle, order_.begin() + end,
                     [&](Index s, Index t) { return place(s) < place(t); });
    build(first, middle);
    const Index second = build(middle, end);
    nodes_[at].second = second;
    return at;
  }

  void within(Index at) {
    const Node& node = nodes_[at];
    if (node.second < 0) {
      for (Index i = node.first; i < node.end; ++i)
        for (Index j = i + 1; j < node.end; ++j) pair(order_[i], order_[j]);
      return;
    }
    check_interruption();
    within(at + 1);
    within(node.second);
    between(at + 1, node.second);
  }

  void between(Index one, Index other) {
    const Node &a = nodes_[one], &b = nodes_[other];
    if (found_.size() >= most_ || !a.bounds.meets(b.bounds)) return;
    if (a.second < 0 && b.second < 0) {
      for (Index i = a.first; i < a.end; ++i) {
        if (!bounds_[order_[i]].meets(b.bounds)) continue;
        for (Index j = b.first; j < b.end; ++j) pair(order_[i], order_[j]);
      }
      return;
    }
    const bool halve_first = b.second < 0 || (a.second >= 0 && a.end - a.first >= b.end - b.first);
    const Index half = halve_first ? one : other, whole = halve_first ? other : one;
    between(half + 1, whole);
    between(nodes_[half].second, whole);
  }

  void pair(Index first, Index other) {
    if (!bounds_[first].meets(bounds_[other])) return;
    const CrossingTriangle &s = triangles_[first], &t = triangles_[other];
    int common = 0;
    for (Index v : s.corner) common += std::find(t.corner.begin(), t.corner.end(), v) != t.corner.end();
    if (common > 1) return;
    const double least = tolerance::same * std::max(s.longest, t.longest);
    if (!is_on_both_sides(s, t, least) || !is_on_both_sides(t, s, least)) return;
    for (int k = 0; k < 3; ++k) {
      if (const std::optional<Crossing> found = passed(s, k, t, least)) found_.push_back(*found);
      if (const std::optional<Crossing> found = passed(t, k, s, least)) found_.push_back(*found);
    }
  }

  const std::vector<CrossingTriangle>& triangles_;
  std::vector<Index> order_;
  std::vector<Bounds> bounds_;  // of the triangles
  std::vector<Node> nodes_;
  std::vector<Crossing> found_;
  std::size_t most_ = 0;
};

}  // namespace

std::optional<Vec3> passage(const Vec3& from, const Vec3& to, const std::array<Vec3, 3>& triangle, const Vec3& normal,
                            double least) {
  const double over = (from - triangle[0]).dot(normal), under = (to - triangle[0]).dot(normal);
  if (!(std::min(std::abs(over), std::abs(under)) > least) || (over > 0) == (under > 0)) return {};
  const Vec3 at = from + over / (over - under) * (to - from);
  for (int i = 0; i < 3; ++i) {
    const Vec3 way = triangle[(i + 1) % 3] - triangle[i];
    if (!(way.cross(at - triangle[i]).dot(normal) > least * way.norm())) return {};
  }
  return at;
}

std::vector<Crossing> find_crossings(const PointsRef& vertices, const PointsRef& added, const Faces& faces, std::size_t most) {
  EdgesByVertex edges = edges_of_triangles(vertices.rows(), added.rows(), faces, {});
  return find_crossings(vertices, added, faces, edges, most);
}

std::vector<Crossing> find_crossings(const PointsRef& vertices, const PointsRef& added, const Faces& faces, EdgesByVertex& edges,
                                     std::size_t most) {
  if (surely_one_to_one(vertices, added, faces, edges)) return {};
  const Index n = vertices.rows();
  const auto at = [&](Index v) -> Vec3 { return v < n ? vertices.row(v) : added.row(v - n); };
  std::vector<CrossingTriangle> triangles;
  for (Index f = 0; f < faces.size(); ++f) {
    if (f % 256 == 0) check_interruption();
    const auto face = faces[f];
    for (std::size_t k = 2; k < face.size(); ++k) {
      CrossingTriangle t{{face[0], face[k - 1], face[k]}, {at(face[0]), at(face[k - 1]), at(face[k])}, {}, 0};
      const Vec3 u = t.p[1] - t.p[0], v = t.p[2] - t.p[0], w = t.p[2] - t.p[1];
      t.normal = u.cross(v).stableNormalized();
      t.longest = std::sqrt(std::max({u.squaredNorm(), v.squaredNorm(), w.squaredNorm()}));
      if (!t.normal.isZero()) triangles.push_back(std::move(t));
    }
  }
  return TriangleTree(triangles).crossings(most);
}

bool crosses_itself(const PointsRef& points, const Triangles& triangles) {
  return !find_crossings(points, Points(0, 3), faces_of(triangles), 1).empty();
}

}  // namespace tripatch
