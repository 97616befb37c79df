#include "tripatch/report/one_to_one.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <vector>

#include "tripatch/math/parallel.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {
namespace {

/// The border of so many triangles as one loop; empty where it is none, or where edges have more than two of them or two that disagree in
/// orientation.
std::vector<Index> only_border(std::size_t triangles, EdgesByVertex& edges) {
  bool whole = true;
  std::vector<std::array<Index, 2>> border;
  edges.for_edges([&](Index high, std::span<const EdgeUse> along) {
    while (!along.empty() && along.back().what / 2 >= triangles) along = along.first(along.size() - 1);
    if (along.size() == 1)
      border.push_back(along[0].what % 2 ? std::array<Index, 2>{along[0].low, high} : std::array<Index, 2>{high, along[0].low});
    else
      whole = whole && (along.empty() || (along.size() == 2 && along[0].what % 2 != along[1].what % 2));
  });
  if (!whole || border.empty()) return {};
  std::sort(border.begin(), border.end());
  std::vector<Index> loop = {border[0][0]};
  while (loop.size() <= border.size()) {
    const auto next = std::lower_bound(border.begin(), border.end(), std::array<Index, 2>{loop.back(), 0});
    if (next == border.end() || (*next)[0] != loop.back()) return {};
    if ((*next)[1] == loop[0]) return loop.size() == border.size() ? loop : std::vector<Index>();
    loop.push_back((*next)[1]);
  }
  return {};
}

struct SeenEdge {
  Eigen::Vector2d from, to, low, high;
  std::size_t place;
};

/// Whether the edges of a closed polygon surely meet at their common ends only.
bool is_surely_simple(const std::vector<Eigen::Vector2d>& polygon, double size) {
  const std::size_t n = polygon.size();
  const double apart = tolerance::rounding * size;
  std::vector<SeenEdge> edges;
  edges.reserve(n);
  for (std::size_t k = 0; k < n; ++k) {
    const Eigen::Vector2d &p = polygon[k], &q = polygon[(k + 1) % n];
    edges.push_back({p, q, p.cwiseMin(q), p.cwiseMax(q), k});
  }
  std::sort(edges.begin(), edges.end(), [](const SeenEdge& a, const SeenEdge& b) { return a.low[0] < b.low[0]; });
  const auto on_one_side = [&](const SeenEdge& line, const SeenEdge& other) {
    const Eigen::Vector2d way = line.to - line.from, p = other.from - line.from, q = other.to - line.from;
    const double first = way[0] * p[1] - way[1] * p[0], second = way[0] * q[1] - way[1] * q[0];
    return std::min(first, second) > apart * size || std::max(first, second) < -apart * size;
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (i % 256 == 0) check_interruption();
    const SeenEdge& a = edges[i];
    for (std::size_t j = i + 1; j < n && edges[j].low[0] <= a.high[0] + apart; ++j) {
      const SeenEdge& b = edges[j];
      if (b.low[1] > a.high[1] + apart || a.low[1] > b.high[1] + apart) continue;
      const std::size_t between = (a.place + n - b.place) % n;
      if (between == 1 || between == n - 1) continue;
      if (!on_one_side(a, b) && !on_one_side(b, a)) return false;
    }
  }
  return true;
}

}  // namespace

bool surely_one_to_one(const PointsRef& vertices, const PointsRef& added, const Faces& faces, EdgesByVertex& edges) {
  return surely_one_to_one(vertices, added, faces,
                           only_border(faces.corners.size() - 2 * static_cast<std::size_t>(faces.size()), edges));
}

bool surely_one_to_one(const PointsRef& vertices, const PointsRef& added, const Faces& faces, std::span<const Index> border) {
  const Index n = vertices.rows();
  const auto at = [&](Index v) -> Vec3 { return v < n ? vertices.row(v) : added.row(v - n); };
  if (border.size() < 3) return false;
  const Vec3 origin = at(border[0]);
  std::vector<Vec3> points;
  points.reserve(border.size());
  Vec3 area = Vec3::Zero();
  double size = 0;
  for (Index v : border) {
    const Vec3 next = at(v) - origin;
    if (!points.empty()) area += points.back().cross(next);
    size = std::max(size, next.cwiseAbs().maxCoeff());
    points.push_back(next);
  }
  const Vec3 way = area.stableNormalized();
  const bool seen = holds_for_all(faces.size(), [&](Index f) {
    const auto face = faces[f];
    const Vec3 first = at(face[0]);
    Vec3 last = at(face[1]) - first;
    for (std::size_t k = 2; k < face.size(); ++k) {
      const Vec3 next = at(face[k]) - first;
      if (!(last.cross(next).dot(way) > tolerance::same * (last.squaredNorm() + next.squaredNorm()))) return false;
      last = next;
    }
    return true;
  });
  if (!seen) return false;
  const Vec3 x = way.unitOrthogonal(), y = way.cross(x);
  std::vector<Eigen::Vector2d> polygon;
  polygon.reserve(points.size());
  for (const Vec3& p : points) polygon.emplace_back(p.dot(x), p.dot(y));
  return is_surely_simple(polygon, size);
}

}  // namespace tripatch
