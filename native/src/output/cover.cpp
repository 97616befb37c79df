#include "tripatch/output/cover.h"

#include <numeric>
#include <tuple>
#include <utility>

#include "tripatch/output/doubled_edges.h"
#include "tripatch/output/triangulate.h"

namespace tripatch {

Cover cover_with_triangles(const Hole& hole, const std::array<std::vector<double>, 3>& parameters, const Surface& patch,
                           std::optional<int> resolution, const Connectivity* mesh) {
  TriangleMesh triangles = triangulate(parameters, resolution, patch);
  Cover cover;
  const Index count = triangles.barycentric.rows();
  std::vector<std::array<Index, 2>> halved;
  if (mesh) halved = halve_doubled_edges(*mesh, hole.rim, count, triangles.triangles);
  cover.barycentric = std::move(triangles.barycentric);
  cover.barycentric.conservativeResize(count + static_cast<Index>(halved.size()), 3);
  for (std::size_t k = 0; k < halved.size(); ++k)
    cover.barycentric.row(count + static_cast<Index>(k)) =
        (cover.barycentric.row(halved[k][0]) + cover.barycentric.row(halved[k][1])) / 2;
  cover.rim = triangles.rim;
  cover.rim_vertices = hole.rim;
  const Index faces = static_cast<Index>(triangles.triangles.size());
  cover.faces.offsets.resize(faces + 1);
  for (Index f = 0; f < faces; ++f) cover.faces.offsets[f + 1] = 3 * (f + 1);
  const Index* const corners = triangles.triangles.data()->data();
  cover.faces.corners.assign(corners, corners + 3 * faces);
  return cover;
}

void deliver(Cover cover, const Points& border, Index vertices, Fill& fill) {
  const bool own = border.rows() > 0;
  const Index count = cover.barycentric.rows(), first = own ? 0 : cover.rim;  // from there on all become new vertices
  std::vector<Index> index(count), split;                                     // of the mesh; edges of the rim that are split
  for (Index k = 0; k < first; ++k) {
    const bool reused = cover.rim_vertices[k] >= 0;
    index[k] = reused ? cover.rim_vertices[k] : vertices + static_cast<Index>(split.size());
    if (!reused) split.push_back(k);
  }
  const Index before = static_cast<Index>(split.size());
  std::iota(index.begin() + first, index.end(), vertices + before);
  fill.barycentric.resize(before + count - first, 3);
  fill.barycentric.topRows(before) = cover.barycentric(split, Eigen::all);
  fill.barycentric.bottomRows(count - first) = cover.barycentric.bottomRows(count - first);
  std::tie(fill.vertices, fill.normals) = fill.patch->positions_and_normals(fill.barycentric);
  if (own) {
    fill.vertices.topRows(border.rows()) = border;
    fill.border.resize(border.rows());
    std::iota(fill.border.begin(), fill.border.end(), Index{0});
  }
  fill.faces = std::move(cover.faces);
  for (Index& v : fill.faces.corners) v = index[v];
  for (const Index pole : cover.poles)
    fill.report.poles.push_back({index[pole], std::ranges::count(fill.faces.corners, index[pole])});
  fill.split_edges = cover.split_edges;
  fill.split_t = cover.split_t;
  fill.report.rows = cover.rows;
  fill.report.warnings.insert(fill.report.warnings.end(), cover.warnings.begin(), cover.warnings.end());
}

}  // namespace tripatch
