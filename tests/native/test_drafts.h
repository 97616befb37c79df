// A side of a hole in a flat sheet while its planes are estimated, for tests of what decides there.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "tripatch/estimate/side_planes.h"

namespace tripatch::testing {

/// A sheet of unit squares in the plane with a hole of `edges` x `edges` squares in its middle, `rings` squares from the border. Side 2 is
/// the first edge of the square, from (0, 0) to (edges, 0), the hole above it; side 1 are the last two.
struct FlatDrafts {
  Points vertices;
  Faces faces;
  Hole hole;
  LocalMesh w;
  std::array<SideDraft, 3> drafts;

  explicit FlatDrafts(int edges, int rings = 7) : rings_(rings), width_(edges + 2 * rings + 1) {
    vertices.resize(width_ * width_, 3);
    for (int i = -rings; i <= edges + rings; ++i)
      for (int j = -rings; j <= edges + rings; ++j) vertices.row(at(i, j)) << i, j, 0;
    for (int i = -rings; i < edges + rings; ++i)
      for (int j = -rings; j < edges + rings; ++j)
        if (!(i >= 0 && i < edges && j >= 0 && j < edges))
          faces.add(std::array<Index, 4>{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    for (int k = 0; k < edges; ++k) hole.rim.push_back(at(k, 0));
    for (int k = 0; k < edges; ++k) hole.rim.push_back(at(edges, k));
    for (int k = 0; k < edges; ++k) hole.rim.push_back(at(edges - k, edges));
    for (int k = 0; k < edges; ++k) hole.rim.push_back(at(0, edges - k));
    hole.corners = {0, edges, 2 * edges};
    w = local_mesh({vertices, faces}, Connectivity(faces, vertices.rows()), hole);
    for (Vec3& p : w.position) p += w.origin;  // edges have length 1 in both
    w.origin = Vec3::Zero();
    for (int i = 0; i < 3; ++i) drafts[i] = draft(hole.corners[(i + 1) % 3], hole.corners[(i + 2) % 3]);
  }

  Index at(int i, int j) const { return static_cast<Index>(i + rings_) * width_ + j + rings_; }
  /// In the local mesh.
  int local(int i, int j) const { return w.part.vertex.find(at(i, j)); }
  SideDraft& side() { return drafts[2]; }

private:
  SideDraft draft(Index from, Index to) const {
    const int n = static_cast<int>(w.rim.size()), edges = static_cast<int>((to - from + n) % n);
    SideDraft side;
    for (int k = 0; k <= edges; ++k) {
      const int v = w.rim[(from + k) % n];
      side.vertex.push_back(v);
      side.position.push_back(w.position[v]);
      side.t.push_back(static_cast<double>(k) / edges);
      side.faces.push_back(Vec3::UnitZ());
      if (k < edges) side.face.push_back(w.beside[(from + k) % n]);
    }
    for (int k = 0; k <= edges; ++k)
      side.tangent.push_back((side.position[std::min(k + 1, edges)] - side.position[std::max(k - 1, 0)]).normalized());
    side.guess = side.faces;
    side.length = edges;
    return side;
  }
  int rings_;
  Index width_;
};

/// A plane that leans outwards over the side, known so well, which predicts what is near with such a density.
inline VertexFit leaning(double sine, double variance, double density) {
  VertexFit fit;
  fit.normal = Vec3(0, -sine, std::sqrt(1 - sine * sine));
  fit.second.setZero();
  fit.frame << Vec3::UnitX(), Vec3::UnitY();
  fit.covariance = 0.5 * variance * Eigen::Matrix2d::Identity();
  fit.slope_variances = variance;
  fit.bend_variance = 0;
  fit.density = {density};
  return fit;
}

using Fits = std::vector<std::vector<VertexFit>>;

/// The same at all vertices of a side, for each neighborhood.
inline Fits along(const FlatDrafts& flat, const std::vector<VertexFit>& each) {
  Fits fits;
  for (const VertexFit& fit : each) fits.emplace_back(flat.drafts[2].vertex.size(), fit);
  return fits;
}

constexpr double certain = 1e-6, rather = 1e-4;  // variances

}  // namespace tripatch::testing
