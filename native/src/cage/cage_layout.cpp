#include "tripatch/cage/cage_layout.h"

#include <Eigen/Core>
#include <algorithm>

#include "tripatch/mesh/changed_faces.h"
#include "tripatch/output/triangulate.h"
#include "tripatch/patch/bezier_triangle.h"

namespace tripatch {
namespace {

void split_crease(Index a, Index b, Index middle, Subdivision& settings) {
  for (std::size_t k = 0, count = settings.crease_edges.size(); k < count; ++k) {
    const auto [c, d] = settings.crease_edges[k];
    if (std::minmax(a, b) != std::minmax(c, d)) continue;
    settings.crease_edges[k] = {a, middle};
    settings.crease_edges.push_back({middle, b});
    settings.edge_creases.push_back(double{settings.edge_creases[k]});
  }
}

/// Each edge of the rim takes an equal share of its side, as it does of the limit rim.
std::array<std::vector<double>, 3> even_parameters(const Hole& hole) {
  std::array<std::vector<double>, 3> parameters;
  for (int i = 0; i < 3; ++i) {
    const std::size_t edges = hole.side(i).size() - 1;
    for (std::size_t k = 0; k <= edges; ++k) parameters[i].push_back(static_cast<double>(k) / static_cast<double>(edges));
  }
  return parameters;
}

/// Triangles that match the rim: the regular split where its counts are equal.
QuadLayout triangle_layout(const Hole& hole, const Points& vertices) {
  Points corners(3, 3);
  for (int k = 0; k < 3; ++k) corners.row(k) = vertices.row(hole.rim[hole.corners[k]]);
  TriangleMesh triangles = triangulate(even_parameters(hole), std::nullopt, BezierTriangle(corners));
  QuadLayout layout;
  layout.barycentric = std::move(triangles.barycentric);
  layout.rim = triangles.rim;
  std::vector<Index> valence(layout.barycentric.rows(), 0);
  for (const std::array<Index, 3>& triangle : triangles.triangles) {
    layout.faces.add(triangle);
    for (Index v : triangle) ++valence[v];
  }
  for (Index v = layout.rim; v < layout.barycentric.rows(); ++v)
    if (valence[v] != 6) layout.poles.push_back(v);
  return layout;
}

}  // namespace

SplitMesh split_odd_rims(const Mesh& mesh, const std::vector<SidedRim>& holes, const Subdivision& settings, bool wanted) {
  SplitMesh split{mesh.vertices, {}, holes, {}, settings};
  split.split.resize(holes.size());
  std::vector<Vec3> added;
  std::map<EdgeKey, Index> middles;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    SidedRim& hole = split.holes[h];
    if (!wanted || hole.rim.size() % 2 == 0) continue;
    const std::size_t place = longest_edge(mesh, hole.rim);
    const Index a = hole.rim[place], b = hole.rim[(place + 1) % hole.rim.size()];
    const Index middle = mesh.vertices.rows() + static_cast<Index>(added.size());
    split.split[h] = {middle, {a, b}};
    added.push_back(0.5 * (mesh.vertices.row(a) + mesh.vertices.row(b)));
    middles.emplace(edge_key(a, b), middle);
    split_crease(a, b, middle, split.settings);
    hole.rim.insert(hole.rim.begin() + static_cast<Index>(place) + 1, middle);
    for (Index& corner : hole.corners) corner += corner > static_cast<Index>(place);
  }
  split.faces = changed_faces(mesh.faces, {}, middles);
  const Index n = mesh.vertices.rows();
  split.vertices.conservativeResize(n + static_cast<Index>(added.size()), 3);
  for (std::size_t k = 0; k < added.size(); ++k) split.vertices.row(n + static_cast<Index>(k)) = added[k];
  return split;
}

QuadLayout cage_layout(const Hole& hole, const Points& vertices, bool loop, int rows, const std::array<double, 2>& pole_offset) {
  return loop ? triangle_layout(hole, vertices) : quad_layout(even_parameters(hole), rows, pole_offset);
}

std::vector<int> rows_to_try(const LayoutOptions& options, bool loop, bool exact) {
  if (loop) return {0};
  if (!options.rows) {
    std::vector<int> all;
    for (int rows = 0; rows <= max_extra_rows; ++rows) all.push_back(rows);
    return all;
  }
  if (exact || *options.rows == 0) return {*options.rows};
  return {0, *options.rows};
}

}  // namespace tripatch
