#include "tripatch/output/quad_cover.h"

#include "tripatch/math/tolerant_compare.h"
#include "tripatch/messages.h"
#include "tripatch/quads/quad_layout.h"

namespace tripatch {
namespace {

/// The largest distance of the quads' middles from the patch: how far the flat-sided fill is from the smooth one.
double deviation(const Cover& cover, const Surface& patch) {
  const Points vertices = patch.positions(cover.barycentric);
  Points middle(cover.faces.size(), 3), b(cover.faces.size(), 3);
  for (Index f = 0; f < cover.faces.size(); ++f) {
    Vec3 p = Vec3::Zero(), q = Vec3::Zero();
    for (Index v : cover.faces[f]) {
      p += vertices.row(v);
      q += cover.barycentric.row(v);
    }
    middle.row(f) = p / static_cast<double>(cover.faces[f].size());
    b.row(f) = q / q.sum();
  }
  return (patch.positions(b) - middle).rowwise().norm().maxCoeff();
}

}  // namespace

std::size_t longest_edge(const PointsRef& rim) {
  const Index n = rim.rows();
  const auto length = [&](Index k) { return (rim.row(k) - rim.row((k + 1) % n)).norm(); };
  Index place = 0;
  for (Index k = 1; k < n; ++k)
    if (clearly_more(length(k), length(place))) place = k;  // so that the same edge is split wherever the mesh is
  return static_cast<std::size_t>(place);
}

Cover cover_with_quads(const Mesh& mesh, const Hole& hole, std::array<std::vector<double>, 3> parameters, const Surface& patch,
                       const LayoutOptions& options, bool own_rim) {
  Cover cover;
  cover.rim_vertices = hole.rim;
  std::size_t around = 0;
  for (const std::vector<double>& t : parameters) around += t.size() - 1;
  if (around % 2 == 1 && options.split_odd && !own_rim) {
    const std::size_t place = longest_edge(mesh, hole.rim);
    std::size_t edge = place;
    for (int i : {2, 0, 1}) {
      std::vector<double>& t = parameters[i];
      if (edge < t.size() - 1) {
        t.insert(t.begin() + static_cast<Index>(edge) + 1, 0.5 * (t[edge] + t[edge + 1]));
        break;
      }
      edge -= t.size() - 1;
    }
    cover.rim_vertices.insert(cover.rim_vertices.begin() + static_cast<Index>(place) + 1, -1);
    cover.split_edges.push_back({hole.rim[place], hole.rim[(place + 1) % hole.rim.size()]});
    cover.split_t.push_back(0.5);
  }
  Cover plain;
  std::optional<double> tolerance = options.tolerance;
  const int first = options.rows.value_or(0), last = options.rows.value_or(max_extra_rows);
  for (int rows = first; rows <= last; ++rows) {
    QuadLayout layout = quad_layout(parameters, rows, options.pole_offset);
    cover.barycentric = std::move(layout.barycentric);
    cover.rim = layout.rim;
    cover.faces = std::move(layout.faces);
    cover.poles = std::move(layout.poles);
    cover.rows = rows;
    if (options.rows) return cover;
    if (!tolerance) tolerance = default_tolerance * diameter(patch.positions(cover.barycentric.topRows(cover.rim)));
    if (deviation(cover, patch) <= *tolerance) return cover;
    if (rows == 0) plain = cover;
  }
  if (!options.tolerance) return plain;  // what the rim is too coarse for no rows reach
  cover.warnings.push_back({Code::tolerance_out_of_reach});
  return cover;
}

}  // namespace tripatch
