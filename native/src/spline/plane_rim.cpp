#include "tripatch/spline/plane_rim.h"

#include <algorithm>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/triangulation/plane_triangles.h"

namespace tripatch {

PlaneRim plane_rim(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops) {
  PlaneRim rim;
  std::vector<Index> vertices;
  std::vector<double> lengths;
  std::vector<std::array<Index, 2>> row;  // (vertex, row), sorted
  for (const std::vector<Index>& loop : loops) {
    if (!vertices.empty()) rim.surroundings.islands.push_back(static_cast<Index>(vertices.size()));
    vertices.insert(vertices.end(), loop.begin(), loop.end());
  }
  const Index r = static_cast<Index>(vertices.size());
  rim.points.resize(r, 3);
  rim.surroundings.normals = Points::Zero(r, 3);
  for (Index k = 0; k < r; ++k) {
    rim.points.row(k) = mesh.vertices.row(vertices[k]);
    row.push_back({vertices[k], k});
  }
  std::sort(row.begin(), row.end());
  rim.beyond = faces_beyond_rows(mesh, around, loops);
  const std::vector<char> turned = flipped(mesh, around, loops);
  Index k = 0;
  for (const std::vector<Index>& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i, ++k) {
      rim.surroundings.normals.row(k) = rim.beyond[k].normal;
      if (turned[k]) {  // a fill that continues as the others do cannot but fold there
        rim.flipped.push_back(rim.beyond[k]);
        rim.beyond[k].normal.setZero();
      }
      const Index a = loop[i], b = loop[(i + 1) % loop.size()];
      lengths.push_back((mesh.vertices.row(a) - mesh.vertices.row(b)).norm());
      for (Connectivity::Corner c : around.at(a))
        for (Index other : {around.next(c), around.previous(c)}) {
          const auto found = std::lower_bound(row.begin(), row.end(), std::array<Index, 2>{other, -1});
          if (found != row.end() && (*found)[0] == other && k < (*found)[1]) rim.surroundings.joined.push_back({k, (*found)[1]});
        }
    }
  std::sort(rim.surroundings.joined.begin(), rim.surroundings.joined.end());
  rim.surroundings.joined.erase(std::unique(rim.surroundings.joined.begin(), rim.surroundings.joined.end()),
                                rim.surroundings.joined.end());
  std::nth_element(lengths.begin(), lengths.begin() + r / 2, lengths.end());
  rim.edge = lengths[r / 2];
  rim.diameter = diameter(rim.points);
  return rim;
}

double area_of(const Points& p, const Triangles& triangles) {
  double area = 0;
  for (const std::array<Index, 3>& t : triangles) area += 0.5 * triangle_normal(p, t).norm();
  return area;
}

Triangles domain_triangles(const PlanePoints& uv, const PlaneRim& rim) {
  return all_positive(uv, rim.rough) ? rim.rough : triangulate_polygon(uv, rim.surroundings.islands);
}

PlanePolygon polygon_of(const PlaneRim& rim, const PlanePoints& uv) {
  PlanePolygon polygon;
  polygon.uv = uv;
  if (uv.allFinite()) polygon.triangles = domain_triangles(uv, rim);
  polygon.points = rim.points;
  polygon.rim = rim.points.rows();
  polygon.joined = rim.surroundings.joined;
  polygon.size = rim.of_hole;
  return polygon;
}

bool stays_near(const Points& points, const PlaneRim& rim) {
  const Index r = rim.points.rows(), step = std::max<Index>(1, r / 200);
  const double most =
      rim.diameter * rim.diameter;  // a bound for what runs away: between half and twice of it not one of 84 fills changes
  for (Index k = 0; k < points.rows(); ++k) {
    bool near = false;
    for (Index j = 0; j < r && !near; j += step) near = (points.row(k) - rim.points.row(j)).squaredNorm() <= most;
    for (const Through& met : rim.through) near = near || (Vec3(points.row(k)) - met.point).squaredNorm() <= most;
    if (!near) return false;
  }
  return true;
}

}  // namespace tripatch
