#include "tripatch/isometry/isometric_fill.h"

#include <map>
#include <optional>
#include <vector>

#include "tripatch/choices.h"
#include "tripatch/isometry/least_strain.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/edge_key.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/messages.h"
#include "tripatch/output/shaped.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

/// Rings of faces that are to unroll with a fill: one says where each edge of the rim bends, two which way they run.
constexpr int unrolled_rings = count::pair;

/// Cut into a fan, by row.
void add_fan(const std::vector<Index>& face, Triangles& triangles) {
  for (std::size_t k = 2; k < face.size(); ++k) triangles.push_back({face[0], face[k - 1], face[k]});
}

/// The rows of its points are the new vertices that may move, those on split edges of the rim, then vertices of the mesh.
Sheet sheet_of(const Mesh& mesh, const Connectivity& around, const Fill& fill) {
  const Index n = mesh.vertices.rows(), all = fill.vertices.rows(), split = static_cast<Index>(fill.split_edges.size());
  Sheet sheet;
  sheet.inside = all - split;
  Numbering known(n);
  const auto row = [&](Index v) -> Index {
    if (v < n) return all + known.number(v);
    return v - n < split ? sheet.inside + v - n : v - n - split;
  };
  std::map<EdgeKey, Index> between;
  for (Index k = 0; k < split; ++k)
    between[edge_key(fill.split_edges[static_cast<std::size_t>(k)][0], fill.split_edges[static_cast<std::size_t>(k)][1])] = n + k;
  for (Index f = 0; f < fill.faces.size(); ++f) {
    std::vector<Index> face;
    for (Index v : fill.faces[f]) face.push_back(row(v));
    add_fan(face, sheet.fill);
  }
  for (Index f : rings_around(around, fill.rim, unrolled_rings).all_faces()) {
    const IndicesRef corners = mesh.faces[f];
    std::vector<Index> face;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      face.push_back(row(corners[k]));
      const auto cut = between.find(edge_key(corners[k], corners[(k + 1) % corners.size()]));
      if (cut != between.end()) face.push_back(row(cut->second));
    }
    add_fan(face, sheet.around);
  }
  sheet.points.resize(all + static_cast<Index>(known.size()), 3);
  sheet.points.topRows(sheet.inside) = fill.vertices.bottomRows(sheet.inside);
  sheet.points.middleRows(sheet.inside, split) = fill.vertices.topRows(split);
  for (Index k = all; k < sheet.points.rows(); ++k)
    sheet.points.row(k) = mesh.vertices.row(known.items()[static_cast<std::size_t>(k - all)]);
  return sheet;
}

void set_vertices(const Sheet& sheet, const Points& inside, Fill& fill) {
  Points points = sheet.points;
  points.topRows(sheet.inside) = inside;
  Triangles all = sheet.fill;
  all.insert(all.end(), sheet.around.begin(), sheet.around.end());
  const Faces faces = faces_of(all);
  const Points normals = vertex_normals({points, faces});
  fill.vertices.bottomRows(sheet.inside) = inside;
  fill.normals.resize(fill.vertices.rows(), 3);
  fill.normals.bottomRows(sheet.inside) = normals.topRows(sheet.inside);
  fill.normals.topRows(fill.vertices.rows() - sheet.inside) =
      normals.middleRows(sheet.inside, fill.vertices.rows() - sheet.inside);
  fill.patch = nullptr;
}

}  // namespace

void make_isometric(const Mesh& mesh, const Connectivity& around, std::span<const std::size_t> islands, Fill& fill) {
  const Sheet sheet = sheet_of(mesh, around, fill);
  if (sheet.inside == 0) return;
  const std::optional<LeastStrain> least = least_strain(sheet);
  if (!least) {
    fill.report.warnings.push_back({Code::surroundings_do_not_unroll});
    return;
  }
  Fill made = fill;
  set_vertices(sheet, least->inside, made);
  measure_faces(mesh, made.vertices, made.faces, faces_beyond(mesh, around, loops_of(fill.rim, islands)), made.report);
  if (!is_finite(made) || harm(made.report) > harm(fill.report)) {
    fill.report.warnings.push_back({Code::isometric_would_fold});
    return;
  }
  fill = std::move(made);
  fill.report.fairing = name_of(Fairing::isometric);
  fill.report.energy_before = least->before;
  fill.report.energy_after = least->after;
}

}  // namespace tripatch
