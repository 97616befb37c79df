// Rims in the plane that turn as requested, for tests of corners.
#pragma once

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/corners.h"

namespace tripatch::testing {

/// A rim in the plane and one ring of triangles around it.
struct PlaneRim {
  Points vertices;
  Faces faces;
  std::vector<Index> rim;

  /// turns: degrees, at the vertices; lengths: of the edge after each. Both are taken `folds` times, and the turns of one round sum to
  /// 360 / folds: so the rim is closed.
  explicit PlaneRim(const std::vector<double>& turns, int folds, const std::vector<double>& lengths = {}) {
    const Index m = static_cast<Index>(turns.size()), n = folds * m;
    REQUIRE(std::accumulate(turns.begin(), turns.end(), 0.0) * folds == Approx(360));
    vertices = Points::Zero(2 * n, 3);
    Vec3 at = Vec3::Zero();
    double angle = 0;
    for (Index k = 0; k < n; ++k) {
      rim.push_back(k);
      vertices.row(k) = at;
      angle += turns[k % m] * std::numbers::pi / 180;
      at += (lengths.empty() ? 1 : lengths[k % m]) * Vec3(std::cos(angle), std::sin(angle), 0);
    }
    REQUIRE(at.norm() < 1e-9 * static_cast<double>(n));
    const Eigen::RowVector3d middle = vertices.topRows(n).colwise().mean();
    for (Index k = 0; k < n; ++k) vertices.row(n + k) = middle + 1.3 * (vertices.row(k) - middle);
    for (Index k = 0; k < n; ++k) {
      const Index next = (k + 1) % n;
      faces.add(std::array<Index, 3>{next, k, n + next});
      faces.add(std::array<Index, 3>{k, n + k, n + next});
    }
  }
  Mesh mesh() const { return {vertices, faces}; }
  std::vector<Index> clear() const { return clear_corners(mesh(), Connectivity(mesh()), rim); }
  std::vector<Index> detected() const { return detect_corners(mesh(), Connectivity(mesh()), rim); }
  bool round() const { return is_round(mesh(), Connectivity(mesh()), rim); }
};

/// `corners` of them turn by so many degrees, the other vertices, `between` from each to the next, by what is left, alike.
inline PlaneRim bowed(int corners, double degrees, int between) {
  std::vector<double> turns(between + 1, (360.0 / corners - degrees) / between);
  turns[0] = degrees;
  return PlaneRim(turns, corners);
}

/// Sides of so many straight edges.
inline PlaneRim straight(const std::vector<double>& turns, int folds, const std::vector<int>& edges) {
  std::vector<double> all;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    all.push_back(turns[i]);
    all.insert(all.end(), edges[i] - 1, 0.0);
  }
  return PlaneRim(all, folds);
}

}  // namespace tripatch::testing
