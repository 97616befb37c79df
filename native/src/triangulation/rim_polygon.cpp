#include "tripatch/triangulation/rim_polygon.h"

#include <algorithm>
#include <limits>

#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

struct Bridge {
  Index from, to;  // place in the polygon, row of the point
};

/// The shortest that joins the polygon to a loop not yet taken, if possible none of the mesh's edges.
Bridge shortest_bridge(const PointsRef& points, const RimPolygon& polygon, const std::vector<char>& taken,
                       const std::vector<EdgeKey>& joined) {
  Bridge best{0, -1};
  for (const bool all : {false, true}) {
    double least = std::numeric_limits<double>::infinity();
    for (Index k = 0; k < polygon.size(); ++k)
      for (Index v = 0; v < points.rows(); ++v) {
        if (taken[v]) continue;
        const double squared = (points.row(polygon.vertices[k]) - points.row(v)).squaredNorm();
        if (!clearly_less(squared, least)) continue;
        if (!all && std::binary_search(joined.begin(), joined.end(), edge_key(polygon.vertices[k], v))) continue;
        least = squared;
        best = {k, v};
      }
    if (best.to >= 0) break;
  }
  return best;
}

void check(const PointsRef& points, const RimSurroundings& rim) {
  const Index r = points.rows();
  Index start = 0;
  for (std::size_t k = 0; k <= rim.islands.size(); ++k) {
    const Index end = k < rim.islands.size() ? rim.islands[k] : r;
    if (end - start < 3 || end > r) throw InvalidArgument("every loop of a rim needs three vertices or more");
    start = end;
  }
  if (rim.normals.size() && rim.normals.rows() != r) throw InvalidArgument("normals: one for each edge of the rim");
  for (const auto& [a, b] : rim.joined)
    if (std::min(a, b) < 0 || std::max(a, b) >= r) throw InvalidArgument("joined: pairs of rows of the rim's points");
}

}  // namespace

RimPolygon one_polygon(const PointsRef& points, const RimSurroundings& rim, const std::vector<EdgeKey>& joined,
                       std::vector<EdgeKey>& bridges) {
  check(points, rim);
  const Index r = points.rows();
  std::vector<Index> start = {0};
  start.insert(start.end(), rim.islands.begin(), rim.islands.end());
  start.push_back(r);
  const auto normal = [&](Index k) { return rim.normals.size() ? Vec3(rim.normals.row(k)) : Vec3(Vec3::Zero()); };
  RimPolygon polygon;
  for (Index k = 0; k < start[1]; ++k) {
    polygon.vertices.push_back(k);
    polygon.normals.push_back(normal(k));
  }
  std::vector<char> taken(r, 0);
  std::fill_n(taken.begin(), start[1], 1);
  for (std::size_t island = 1; island + 1 < start.size(); ++island) {
    const auto [place, v] = shortest_bridge(points, polygon, taken, joined);
    const auto end = std::upper_bound(start.begin(), start.end(), v);
    const Index low = *(end - 1), count = *end - low;
    bridges.push_back(edge_key(polygon.vertices[place], v));
    RimPolygon walk;  // from the polygon's vertex over the island back to it
    walk.vertices.push_back(polygon.vertices[place]);
    walk.normals.push_back(Vec3::Zero());
    for (Index k = 0; k <= count; ++k) {
      walk.vertices.push_back(low + (v - low + k) % count);
      walk.normals.push_back(k < count ? normal(walk.vertices.back()) : Vec3(Vec3::Zero()));
    }
    polygon.vertices.insert(polygon.vertices.begin() + place, walk.vertices.begin(), walk.vertices.end());
    polygon.normals.insert(polygon.normals.begin() + place, walk.normals.begin(), walk.normals.end());
    std::fill_n(taken.begin() + low, count, 1);
  }
  std::sort(bridges.begin(), bridges.end());
  return polygon;
}

std::vector<AdjacentFace> beyond_of(const RimPolygon& polygon) {
  std::vector<AdjacentFace> beyond;
  const Index n = polygon.size();
  for (Index k = 0; k < n; ++k) beyond.push_back({polygon.vertices[k], polygon.vertices[(k + 1) % n], polygon.normals[k]});
  return beyond;
}

}  // namespace tripatch
