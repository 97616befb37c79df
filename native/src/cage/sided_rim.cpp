#include "tripatch/cage/sided_rim.h"

#include <algorithm>
#include <memory>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/beginning.h"
#include "tripatch/polygon/follow.h"

namespace tripatch {

Hole SidedRim::hole() const { return {rim, {corners[0], corners[1], corners[2]}}; }

std::vector<Index> SidedRim::side(int i) const {
  const int n = sides(), first = n == 3 ? (i + 1) % n : i % n;
  const Index size = static_cast<Index>(rim.size()), from = corners[first], to = first + 1 < n ? corners[first + 1] : size;
  std::vector<Index> along;
  for (Index k = from; k <= to; ++k) along.push_back(rim[k % size]);
  return along;
}

std::vector<Index> corners_by_valence(const Mesh& mesh, const Connectivity& left, const std::vector<Index>& rim) {
  std::vector<Index> places;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const auto faces = left.at(rim[k]);
    if (faces.size() < 2) return {};
    for (Connectivity::Corner c : faces)
      if (mesh.faces[left.face(c)].size() != 4) return {};
    if (faces.size() > 2) places.push_back(static_cast<Index>(k));
  }
  const bool few = places.size() < 3 || places.size() > static_cast<std::size_t>(most_sides);
  return few ? std::vector<Index>() : places;
}

Sides three_sides(const CageSides& sides) { return {sides[0], sides[1], sides[2]}; }

PolygonDomain cage_domain(const SidedRim& rim, const Points& vertices, const Connectivity& left) {
  const RimShape shape = measure({vertices, left.faces()}, left, rim.rim);
  std::vector<double> turns, lengths;
  for (int i = 0; i < rim.sides(); ++i) {
    turns.push_back(shape.turn[rim.corners[i]]);
    const std::vector<Index> side = rim.side(i);
    double length = 0;
    for (std::size_t k = 0; k + 1 < side.size(); ++k) length += (vertices.row(side[k]) - vertices.row(side[k + 1])).norm();
    lengths.push_back(length);
  }
  return rim.sides() == 2 ? lens_like(turns) : polygon_like(turns, lengths);
}

QuadLayout polygon_cage_layout(const SidedRim& rim, const Points& vertices, const PolygonDomain& domain, const Connectivity& left,
                               int rows) {
  const Index r = static_cast<Index>(rim.rim.size());
  PlanePoints places(r, 2);
  std::vector<int> quads(static_cast<std::size_t>(r), -1);  // at corners
  Index row = 0;
  for (int i = 0; i < rim.sides(); ++i) {
    const Index edges = static_cast<Index>(rim.side(i).size()) - 1;
    const std::ptrdiff_t faces = static_cast<std::ptrdiff_t>(left.at(rim.rim[rim.corners[i]]).size());
    quads[row] = static_cast<int>(std::max<std::ptrdiff_t>(1, 4 - faces));
    for (Index k = 0; k < edges; ++k) places.row(row++) = domain.on_side(i, static_cast<double>(k) / static_cast<double>(edges));
  }
  // from where the rim's geometry begins it, as seen in a mirror where it goes backwards: which of equal layouts is taken hangs on that
  Beginnings beginnings(vertices(rim.rim, Eigen::all), {}, rim.corners);
  beginnings.compare_along();
  const Beginning first = beginnings.left()[0];
  const auto given = [&](Index k) { return first.at(k, r); };
  PlanePoints walked(r, 2);
  std::vector<RimCorner> corners;
  for (Index k = 0; k < r; ++k) {
    walked.row(k) = places.row(given(k));
    if (quads[given(k)] >= 0) corners.push_back({k, quads[given(k)]});
  }
  const double turn = first.backwards ? -1 : 1;
  walked.col(1) *= turn;
  const PlaneLayout plane = polygon_layout(walked, corners, rows);
  QuadLayout layout;
  layout.barycentric = Points::Zero(plane.uv.rows(), 3);
  for (Index k = 0; k < plane.uv.rows(); ++k)
    layout.barycentric.row(k < r ? given(k) : k).head<2>() << plane.uv(k, 0), turn * plane.uv(k, 1);
  layout.rim = plane.rim;
  for (Index f = 0; f < plane.faces.size(); ++f) {
    std::vector<Index> face;
    for (Index v : plane.faces[f]) face.push_back(v < r ? given(v) : v);
    if (first.backwards) std::reverse(face.begin(), face.end());
    layout.faces.add(face);
  }
  layout.poles = plane.poles;
  layout.in_plane = true;
  return layout;
}

Eigen::VectorXd nearest_on(const Surface& patch, const Points& points, Points& coordinates) {
  const auto* over = dynamic_cast<const PolygonSurface*>(&patch);
  return over ? nearest_in_polygon(patch, over->domain(), points, coordinates) : nearest(patch, points, coordinates);
}

}  // namespace tripatch
