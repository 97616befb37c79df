#include "tripatch/cage/sided_rim.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdlib>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/canonical_start.h"
#include "tripatch/polygon/follow.h"
#include "tripatch/quads/spread.h"

namespace tripatch {
namespace {

/// A rim as it is seen along its vector area.
PlanePoints seen(const Points& rim) {
  Vec3 area = Vec3::Zero();
  const Vec3 middle = rim.colwise().mean();
  const auto at = [&](Index k) -> Vec3 { return rim.row(k % rim.rows()).transpose() - middle; };
  for (Index k = 0; k < rim.rows(); ++k) area += at(k).cross(at(k + 1));
  const Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(area, Vec3::UnitZ());
  PlanePoints places(rim.rows(), 2);
  for (Index k = 0; k < rim.rows(); ++k) places.row(k) = (turn * at(k)).head<2>();
  return places;
}

/// From where the rim's geometry begins it, as seen in a mirror where it goes backwards: which of equal layouts is taken hangs on that.
CanonicalStart beginning_of(const Points& rim, const std::vector<Index>& places) {
  CanonicalStarts beginnings(rim, {}, places);
  beginnings.compare_along();
  return beginnings.left()[0];
}

/// A layout of a rim that was walked so.
QuadLayout as_given(const PlaneLayout& walked, const CanonicalStart& first) {
  const Index r = walked.rim;
  const auto given = [&](Index k) { return k < r ? first.at(k, r) : k; };
  QuadLayout layout;
  layout.barycentric = Points::Zero(walked.uv.rows(), 3);
  for (Index k = 0; k < walked.uv.rows(); ++k)
    layout.barycentric.row(given(k)).head<2>() << walked.uv(k, 0), (first.backwards ? -1 : 1) * walked.uv(k, 1);
  layout.rim = r;
  for (Index f = 0; f < walked.faces.size(); ++f) {
    std::vector<Index> face;
    for (Index v : walked.faces[f]) face.push_back(given(v));
    if (first.backwards) std::reverse(face.begin(), face.end());
    layout.faces.add(face);
  }
  layout.poles = walked.poles;
  layout.in_plane = true;
  return layout;
}

/// A rim from where its geometry begins it, and in which direction: what its vertices want is rounded along it.
struct Walk {
  CanonicalStart first;
  std::vector<Index> rim;
};

Walk walk_of(const std::vector<Index>& rim, const Points& vertices) {
  Walk walk = {beginning_of(vertices(rim, Eigen::all), {}), {}};
  const Index r = static_cast<Index>(rim.size());
  for (Index k = 0; k < r; ++k) walk.rim.push_back(rim[walk.first.at(k, r)]);
  return walk;
}

}  // namespace

std::optional<QuadLayout> grown_layout(const std::vector<Index>& rim, const Points& vertices, const Connectivity& left,
                                       WantedQuads which) {
  const Walk walk = walk_of(rim, vertices);
  const std::optional<PlaneLayout> grown =
      grown_quads(seen(vertices(walk.rim, Eigen::all)), wanted_quads(vertices, left, walk.rim, which));
  if (!grown) return {};
  QuadLayout layout = as_given(*grown, walk.first);
  layout.grown = true;
  return layout;
}

bool grows_on(const SidedRim& rim, const Points& vertices, const Connectivity& left) {
  const auto is_quad = [&](Connectivity::Corner c) { return left.faces()[left.face(c)].size() == 4; };
  const auto in_quads = [&](Index v) { return std::ranges::all_of(left.at(v), is_quad); };
  if (!rim.guessed && !std::ranges::all_of(rim.rim, in_quads)) return false;
  const Walk walk = walk_of(rim.rim, vertices);
  const std::vector<int> wanted = wanted_quads(vertices, left, walk.rim);
  const auto off = [&](const auto& quads) {
    int sum = 0;
    const Index r = static_cast<Index>(wanted.size());
    for (Index k = 0; k < r; ++k) sum += std::abs(wanted[static_cast<std::size_t>(k)] - quads(walk.first.at(k, r)));
    return sum;
  };
  const int between_corners = off([&](Index k) { return std::ranges::count(rim.corners, k) > 0 ? 1 : 2; });
  if (between_corners == 0) return false;
  const std::optional<QuadLayout> grown = grown_layout(rim.rim, vertices, left);
  if (!grown) return false;
  const int grown_off = off([&](Index k) { return static_cast<int>(std::ranges::count(grown->faces.corners, k)); });
  return grown_off + static_cast<int>(grown->poles.size()) < between_corners;
}

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
  const bool few = places.size() < 3 || places.size() > static_cast<std::size_t>(max_sides);
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
  std::optional<QuadLayout> grown;
  if (rows == 0 && rim.by_angle) grown = grown_layout(rim.rim, vertices, left, WantedQuads::by_angle);
  if (rows == 0 && rim.guessed && !rim.by_angle && grows_on(rim, vertices, left)) grown = grown_layout(rim.rim, vertices, left);
  if (grown) {
    grown->barycentric.topRows(r) = as_rows(places);
    spread_inside(grown->faces, r, grown->barycentric);
    return std::move(*grown);
  }
  // from where the rim's geometry begins it, as seen in a mirror where it goes backwards: which of equal layouts is taken hangs on that
  const CanonicalStart first = beginning_of(vertices(rim.rim, Eigen::all), rim.corners);
  PlanePoints walked(r, 2);
  std::vector<RimCorner> corners;
  for (Index k = 0; k < r; ++k) {
    walked.row(k) = places.row(first.at(k, r));
    if (quads[first.at(k, r)] >= 0) corners.push_back({k, quads[first.at(k, r)]});
  }
  if (first.backwards) walked.col(1) *= -1;
  return as_given(polygon_layout(walked, corners, rows), first);
}

Eigen::VectorXd nearest_on(const Surface& patch, const Points& points, Points& coordinates) {
  const auto* over = dynamic_cast<const PolygonSurface*>(&patch);
  return over ? nearest_in_polygon(patch, over->domain(), points, coordinates) : nearest(patch, points, coordinates);
}

}  // namespace tripatch
