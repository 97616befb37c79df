#include "tripatch/quads/quad_layout.h"

#include <algorithm>
#include <cmath>

#include "tripatch/quads/quad_builder.h"
#include "tripatch/quads/row_widths.h"
#include "tripatch/quads/weighted_means.h"

namespace tripatch {
namespace {

/// Inside vertices at the mean of their neighbors (Tutte 1963): in a convex triangle no face is turned over.
void embed(const std::vector<NetEdge>& edges, Index rim, const std::vector<Index>& held, Points& barycentric) {
  std::vector<bool> fixed = first_rows(rim, barycentric.rows());
  for (Index v : held) fixed[v] = true;
  to_weighted_means(edges, fixed, barycentric);
  for (Index v = rim; v < barycentric.rows(); ++v)
    if (!fixed[v]) barycentric.row(v) /= barycentric.row(v).sum();
}

/// The smallest corner of the faces, as twice the signed area in barycentric coordinates.
double smallest_corner(const Faces& faces, const Points& b) {
  double smallest = 1;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    const std::size_t m = face.size();
    for (std::size_t k = 0; k < m; ++k) {
      const Vec3 p = b.row(face[k]), e = b.row(face[(k + 1) % m]).transpose() - p,
                 g = b.row(face[(k + m - 1) % m]).transpose() - p;
      smallest = std::min(smallest, e[0] * g[1] - e[1] * g[0]);
    }
  }
  return smallest;
}

}  // namespace

QuadLayout quad_layout(const std::array<std::vector<double>, 3>& parameters, int rows, const std::array<double, 2>& pole_offset) {
  QuadLayout layout;
  std::vector<Vec3> rim;
  QuadBuilder::Loop loop;
  loop.on_rim = {true, true, true};
  for (int i : {2, 0, 1}) {
    for (std::size_t k = 0; k < parameters[i].size(); ++k) {
      loop.side[i].push_back(static_cast<Index>(rim.size()));
      if (k + 1 == parameters[i].size()) break;  // the next side's first
      Vec3 b = Vec3::Zero();
      b[(i + 1) % 3] = 1 - parameters[i][k];
      b[(i + 2) % 3] = parameters[i][k];
      rim.push_back(b);
    }
  }
  loop.side[1].back() = 0;
  layout.rim = static_cast<Index>(rim.size());

  QuadBuilder builder(layout.rim);
  for (int r = 0; r < rows; ++r) loop = builder.ring(loop);
  builder.fill(loop);
  layout.faces = builder.faces;

  const Index n = builder.vertex_count();
  std::vector<NetEdge> edges;
  std::vector<int> valence(n, 0);
  const RowWidths widths(layout.faces, layout.rim);
  for (const auto& [a, b] : widths.edges()) {
    edges.push_back({a, b});
    ++valence[a];
    ++valence[b];
  }
  for (Index v = layout.rim; v < n; ++v)
    if (valence[v] != 4) layout.poles.push_back(v);
  layout.barycentric = Points::Zero(n, 3);
  for (Index v = 0; v < layout.rim; ++v) layout.barycentric.row(v) = rim[v];
  embed(edges, layout.rim, {}, layout.barycentric);

  // The poles move together, as far as no face turns over.
  Vec3 shift(-pole_offset[0] - pole_offset[1] / std::sqrt(3.0), pole_offset[0] - pole_offset[1] / std::sqrt(3.0),
             2 * pole_offset[1] / std::sqrt(3.0));
  for (int attempt = 0; attempt < 8 && shift.norm() > 0 && !layout.poles.empty(); ++attempt, shift *= 0.5) {
    Points moved = layout.barycentric;
    for (Index v : layout.poles) moved.row(v) += shift;
    embed(edges, layout.rim, layout.poles, moved);
    if (moved.minCoeff() >= 0 && smallest_corner(layout.faces, moved) > 0) {
      layout.barycentric = moved;
      break;
    }
  }
  return layout;
}

}  // namespace tripatch
