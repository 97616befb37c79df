#include "tripatch/fill/rows_in_mesh.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "tripatch/creases/features.h"
#include "tripatch/math/angle.h"
#include "tripatch/mesh/edge_key.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

/// Faces of quads and at their rim, numbered as the fill's vertices.
Faces faces_at(const FillContext& context, const Fill& quads) {
  Faces faces = quads.faces;
  std::set<Index> taken;
  for (const Index v : quads.rim)
    for (const Connectivity::Corner c : context.left.at(v))
      if (taken.insert(context.left.face(c)).second) faces.add(context.mesh.faces[context.left.face(c)]);
  return faces;
}

std::vector<Index> numbered(const FillContext& context, const Fill& quads, Faces& faces) {
  std::map<Index, Index> row;
  std::vector<Index> vertices;
  const auto row_of = [&](Index v) {
    const auto [at, is_new] = row.emplace(v, static_cast<Index>(vertices.size()));
    if (is_new) vertices.push_back(v);
    return at->second;
  };
  for (const Index v : quads.rim) row_of(v);
  for (Index v = 0; v < quads.vertices.rows(); ++v) row_of(context.mesh.vertices.rows() + v);
  for (Index& v : faces.corners) v = row_of(v);
  return vertices;
}

Points positions(const FillContext& context, const Fill& quads, const std::vector<Index>& vertices) {
  const Index n = context.mesh.vertices.rows();
  Points points(static_cast<Index>(vertices.size()), 3);
  for (Index k = 0; k < points.rows(); ++k) {
    const Index v = vertices[static_cast<std::size_t>(k)];
    points.row(k) = v < n ? Vec3(context.mesh.vertices.row(v)) : Vec3(quads.vertices.row(v - n));
  }
  return points;
}

}  // namespace

RowsInMesh::RowsInMesh(const FillContext& context, const Fill& quads)
    : ground_(context),
      fill_(quads),
      rim_(static_cast<Index>(quads.rim.size())),
      own_(rim_ + quads.vertices.rows()),
      faces_(faces_at(context, quads)),
      vertices_(numbered(context, quads, faces_)),
      points_(positions(context, quads, vertices_)),
      around_(faces_, points_.rows()) {}

Points RowsInMesh::normals_of_rim() const { return vertex_normals({points_, faces_}).topRows(rim_); }
Points RowsInMesh::normals_of_new() const { return vertex_normals({points_, faces_}).middleRows(rim_, own_ - rim_); }

bool RowsInMesh::is_sharp(Index from, Index to) const {
  const auto one = around_.edge(from, to), other = around_.edge(to, from);
  if (!one || !other) return false;
  const Mesh mesh{points_, faces_};
  return angle_between(area_vector(mesh, around_.face(*one)), area_vector(mesh, around_.face(*other))) > min_crease_angle;
}

bool RowsInMesh::is_inside(Index from, Index to) const {
  return std::ranges::all_of(around_.faces_at_edge(from, to), [&](Index f) { return f < fill_.faces.size(); });
}

Index RowsInMesh::straight_on(Index from, Index to) const {
  std::vector<Index> beside;  // of the two faces at the edge
  for (const Index f : around_.faces_at_edge(from, to)) beside.insert(beside.end(), faces_[f].begin(), faces_[f].end());
  const auto at = around_.at(to);
  if (at.size() != 4) return -1;
  for (const Connectivity::Corner c : at) {
    if (faces_[around_.face(c)].size() != 4) return -1;
    if (std::ranges::find(beside, around_.next(c)) == beside.end()) return around_.next(c);
  }
  return -1;
}

std::vector<std::array<Index, 2>> RowsInMesh::creases() const {
  std::vector<std::array<Index, 2>> ends;  // from beyond to the rim
  for (Index v = 0; v < rim_; ++v)
    for (const Connectivity::Corner c : around_.at(v))
      for (const Index from : {around_.next(c), around_.previous(c)})
        if (from >= own_ && is_sharp(from, v)) ends.push_back({from, v});
  if (ends.empty()) return {};
  const Features features = find_features(ground_.mesh, ground_.left, fill_.rim);
  const auto is_crease = [&](Index a, Index b) {
    return features.walls || std::ranges::binary_search(features.barred, edge_key(vertices_[a], vertices_[b]));
  };
  std::set<EdgeKey> found;
  for (auto [from, to] : ends) {
    if (!is_crease(from, to)) continue;
    Index next = straight_on(from, to);
    while (next >= 0 && next < own_ && is_sharp(to, next)) {
      if (is_inside(to, next) && !found.insert(edge_key(to, next)).second) break;
      from = std::exchange(to, next);
      next = straight_on(from, to);
    }
  }
  std::vector<std::array<Index, 2>> edges;
  for (const auto& [a, b] : found) edges.push_back({vertices_[a], vertices_[b]});
  return edges;
}

}  // namespace tripatch
