#include "tripatch/creases/creased_fill.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <set>

#include "tripatch/creases/crease_division.h"
#include "tripatch/creases/joined_parts.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/edge_key.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/report/crossings.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/disc.h"

namespace tripatch {
namespace {

/// A point nearer to a crease than this share of its edges is meant to lie on it.
constexpr double on_crease = share::little;

/// For each part the faces on its side of the creases: from its piece of the rim on across edges that are not sharp.
std::vector<std::vector<Index>> faces_of_parts(const Mesh& mesh, const Connectivity& around, const Features& features,
                                               const std::vector<VertexLoop>& loops) {
  if (features.walls) return features.walls->faces;
  std::set<EdgeKey> barred(features.barred.begin(), features.barred.end());
  for (const Crease& crease : features.creases)
    for (const CreaseEnd& end : crease.ends)
      for (std::size_t k = 0; k + 1 < end.chain.size(); ++k) barred.insert(edge_key(end.chain[k], end.chain[k + 1]));
  const auto near = [&](Index f) {
    const auto face = mesh.faces[f];
    return std::all_of(face.begin(), face.end(),
                       [&](Index v) { return std::binary_search(features.vertices.begin(), features.vertices.end(), v); });
  };
  std::vector<std::vector<Index>> faces(loops.size());
  std::deque<std::pair<Index, std::size_t>> open;
  Numbering taken;
  const auto claim = [&](Index a, Index b, std::size_t part) {  // the face that holds the edge so
    if (barred.count(edge_key(a, b))) return;
    const auto corner = around.edge(a, b);
    if (!corner || !near(around.face(*corner)) || !taken.add(around.face(*corner))) return;
    open.emplace_back(around.face(*corner), part);
  };
  for (std::size_t part = 0; part < loops.size(); ++part)
    for (std::size_t k = 0; k < loops[part].size(); ++k) {
      const Index a = loops[part][k], b = loops[part][(k + 1) % loops[part].size()];
      if (a < mesh.vertices.rows() && b < mesh.vertices.rows()) claim(b, a, part);
    }
  while (!open.empty()) {
    const auto [f, part] = open.front();
    open.pop_front();
    faces[part].push_back(f);
    const auto face = mesh.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) claim(face[(k + 1) % face.size()], face[k], part);
  }
  return faces;
}

/// One part as a hole of a mesh of its own: its loop's vertices come first, then those of the faces around.
struct CreasedPart {
  Points vertices;
  Faces faces;
  VertexLoop loop;  // 0, 1, 2, ...
  PlaneFillOptions options;
};

CreasedPart creased_part(const Mesh& mesh, const Connectivity& around, const Division& division, std::size_t number,
                         const std::vector<Index>& faces, const PlaneFillOptions& options) {
  const VertexLoop& loop = division.loops[number];
  const Index r = static_cast<Index>(loop.size());
  Numbering row;
  for (Index v : loop) row.add(v);
  for (Index f : faces)
    for (Index v : mesh.faces[f]) row.add(v);
  CreasedPart part;
  part.vertices.resize(static_cast<Index>(row.size()), 3);
  for (Index k = 0; k < part.vertices.rows(); ++k)
    part.vertices.row(k) = division.point(row.items()[static_cast<std::size_t>(k)]);
  for (Index f : faces) {
    VertexLoop face;
    for (Index v : mesh.faces[f]) face.push_back(row.find(v));
    part.faces.add(face);
  }
  double length = 0;
  for (Index k = 0; k < r; ++k) {
    part.loop.push_back(k);
    length += (part.vertices.row(k) - part.vertices.row((k + 1) % r)).norm();
    if (loop[k] >= division.first()) continue;
    for (Connectivity::Corner c : around.at(loop[k]))
      for (Index other : {around.next(c), around.previous(c)})
        if (const Index at = row.find(other); at >= 0 && at < r && at != k) part.options.joined.push_back(edge_key(k, at));
  }
  // What is inside one part between the points of a crease must not be inside another.
  for (const VertexLoop& curve : division.curves)
    for (std::size_t i = 0; i < curve.size(); ++i)
      for (std::size_t j = i + 2; j < curve.size(); ++j) {
        const Index a = row.find(curve[i]), b = row.find(curve[j]);
        if (a >= 0 && a < r && b >= 0 && b < r) part.options.joined.push_back(edge_key(a, b));
      }
  std::sort(part.options.joined.begin(), part.options.joined.end());
  part.options.joined.erase(std::unique(part.options.joined.begin(), part.options.joined.end()), part.options.joined.end());
  if (options.resolution)
    part.options.resolution =
        std::max(1, static_cast<int>(std::lround((1 - tie) * length / (3 * std::max(division.even, tolerance::tiny)))));
  else if (r == 3 || (faces.empty() && r > long_rim))  // else a triangle has no surface, a long rim by itself none
    part.options.resolution = static_cast<int>(r / 3);
  return part;
}

double distance_to_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 way = b - a;
  const double along = std::clamp((p - a).dot(way) / std::max(way.squaredNorm(), tolerance::tiny), 0.0, 1.0);
  return (p - a - along * way).norm();
}

/// Whether a crease runs along the rim, or over one of its vertices.
bool grazes_rim(const Division& division, const VertexLoop& rim) {
  const std::size_t r = rim.size();
  for (const VertexLoop& curve : division.curves)
    for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
      const Vec3 a = division.point(curve[k]), b = division.point(curve[k + 1]);
      const double near = tolerance::close * (b - a).norm();
      for (std::size_t j = 0; j < r; ++j) {
        const bool ends_there = rim[j] == curve.front() || rim[j] == curve.back();
        if (!ends_there && distance_to_edge(division.point(rim[j]), a, b) < near) return true;
        const bool is_inner = k > 0 && rim[j] != curve[k] && rim[(j + 1) % r] != curve[k];
        if (is_inner && distance_to_edge(a, division.point(rim[j]), division.point(rim[(j + 1) % r])) < near) return true;
      }
    }
  return false;
}

/// Fills of parts again, each through the points that are nearest to it. False where one lies on a crease, which is not known to run
/// there, or a part finds no surface.
bool meet_inside(const std::vector<Through>& through, const Division& division, std::vector<CreasedPart>& parts,
                 std::vector<PlaneFill>& fills) {
  for (const Through& met : through) {
    for (const VertexLoop& curve : division.curves)
      for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
        const Vec3 a = division.point(curve[k]), b = division.point(curve[k + 1]);
        if (distance_to_edge(met.point, a, b) < on_crease * (b - a).norm()) return false;
      }
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const Index r = static_cast<Index>(parts[part].loop.size());
      const auto corner = [&](Index v) -> Vec3 {
        return v < r ? Vec3(parts[part].vertices.row(v)) : Vec3(fills[part].vertices.row(v - r));
      };
      for (const std::array<Index, 3>& t : fills[part].triangles) {
        const double far = ((corner(t[0]) + corner(t[1]) + corner(t[2])) / 3 - met.point).norm();
        if (far < least) least = far, best = part;
      }
    }
    parts[best].options.through.push_back(met);
  }
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if (parts[part].options.through.empty()) continue;
    const Mesh own{parts[part].vertices, parts[part].faces};
    fills[part] = fill_over_plane(own, Connectivity(own), {parts[part].loop}, parts[part].options);
    if (!fills[part].surface || fills[part].doubles_edges) return false;
  }
  return true;
}

}  // namespace

std::optional<PlaneFill> fill_across_creases(const Mesh& mesh, const Connectivity& around, const VertexLoop& rim,
                                             const Features& features, const PlaneFillOptions& options) {
  if (!features.found()) return {};
  const Division division = divided(mesh, rim, features, options);
  if (grazes_rim(division, rim)) return {};
  const std::vector<std::vector<Index>> faces = faces_of_parts(mesh, around, features, division.loops);
  const double size = diameter(mesh, rim);
  std::vector<PlaneFill> fills;
  std::vector<CreasedPart> parts;
  for (std::size_t k = 0; k < division.loops.size(); ++k) {
    CreasedPart part = creased_part(mesh, around, division, k, faces[k], options);
    part.options.size = size;
    const Mesh own{part.vertices, part.faces};
    fills.push_back(fill_over_plane(own, Connectivity(own), {part.loop}, part.options));
    if (!fills.back().surface || fills.back().doubles_edges) return {};
    if (features.walls) fills.back().plainer.reset();  // a wall of which nothing is left is as flat as its rim
    parts.push_back(part);
  }
  if (!meet_inside(options.through, division, parts, fills)) return {};
  PlaneFill fill = joined_parts(rim, division, fills);
  Points points(static_cast<Index>(rim.size()) + fill.vertices.rows(), 3);
  for (std::size_t k = 0; k < rim.size(); ++k) points.row(static_cast<Index>(k)) = mesh.vertices.row(rim[k]);
  points.bottomRows(fill.vertices.rows()) = fill.vertices;
  fill.folds = count_folded_edges(points, fill.triangles, faces_beyond_rows(mesh, around, {rim}));
  fill.rim_folds = folds_of_rim(mesh, around, {rim});
  // walls and creases that meet so sharply leave no other way either
  if (std::ranges::all_of(fills, [](const PlaneFill& part) { return part.folds == 0; }))
    fill.rim_folds = std::max(fill.rim_folds, fill.folds);
  if (fill.folds > fill.rim_folds || crosses_itself(points, fill.triangles)) return {};
  return fill;
}

}  // namespace tripatch
