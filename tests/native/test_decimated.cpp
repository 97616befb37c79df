// Meshes with fewer vertices: they cover what was covered, once, and what decides which vertices go.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "tripatch/mesh/border_loops.h"
#include "tripatch/mesh/decimated.h"
#include "tripatch/mesh/triangles.h"

using namespace tripatch;

namespace {

/// Rings of triangles around a round hole of n edges, in a plane or bent.
struct Annulus {
  Points vertices;
  Triangles triangles;
  explicit Annulus(Index n, Index rings, double bend = 0) : vertices(n * (rings + 1), 3) {
    for (Index j = 0; j <= rings; ++j)
      for (Index k = 0; k < n; ++k) {
        const double turn =
            2 * std::numbers::pi * (static_cast<double>(k) + 0.5 * static_cast<double>(j)) / static_cast<double>(n);
        const double r = std::pow(1 + 2 * std::numbers::pi / static_cast<double>(n), static_cast<double>(j));
        vertices.row(j * n + k) << r * std::cos(turn), r * std::sin(turn), bend * r * r;
      }
    for (Index j = 0; j < rings; ++j)
      for (Index k = 0; k < n; ++k) {
        const Index a = j * n + k, b = j * n + (k + 1) % n;
        triangles.push_back({b, a, a + n});
        triangles.push_back({b, a + n, b + n});
      }
  }
};

double area_across(const Points& p, const Triangles& triangles) {  // signed, seen from above
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += Vec3(p.row(b) - p.row(a)).cross(Vec3(p.row(c) - p.row(a)))[2] / 2;
  return sum;
}

/// The lengths of a coarser mesh's edges.
std::vector<double> lengths(const Points& all, const CoarserMesh& mesh) {
  std::vector<double> out;
  for (const std::array<Index, 3>& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) out.push_back((all.row(mesh.kept[t[k]]) - all.row(mesh.kept[t[(k + 1) % 3]])).norm());
  return out;
}

}  // namespace

TEST_CASE("a coarser mesh has the borders of the finer one, its orientation, and no edge twice in one direction") {
  const Annulus fine(120, 12, 0.2);
  for (const double length : {0.1, 0.2, 0.4}) {
    const CoarserMesh coarse = decimated(fine.vertices, fine.triangles, length);
    CHECK(coarse.kept.size() < fine.vertices.rows() / (10 * length));
    std::map<std::pair<Index, Index>, int> edges;
    for (const std::array<Index, 3>& t : coarse.triangles)
      for (int k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    for (const auto& [edge, uses] : edges) CHECK(uses == 1);
    Index open = 0;
    for (const auto& [edge, uses] : edges) open += !edges.contains({edge.second, edge.first});
    const Index joined = (static_cast<Index>(edges.size()) + open) / 2;
    CHECK(static_cast<Index>(coarse.kept.size() + coarse.triangles.size()) == joined);  // an annulus
    const Faces faces = faces_of(coarse.triangles);
    const auto loops = border_loops(Connectivity(faces, static_cast<Index>(coarse.kept.size())));
    REQUIRE(loops.size() == 2);
    for (const std::vector<Index>& loop : loops)
      for (Index v : loop) CHECK((coarse.kept[v] < 120 || coarse.kept[v] >= 12 * 120));
    CHECK(area_across(fine.vertices(coarse.kept, Eigen::all), coarse.triangles) ==
          Approx(area_across(fine.vertices, fine.triangles)).epsilon(0.1));
  }
}

TEST_CASE("edges that are as long as they shall be stay, shorter ones go") {
  const Annulus fine(60, 6);
  CoarserMesh same{std::vector<Index>(fine.vertices.rows()), fine.triangles};
  std::iota(same.kept.begin(), same.kept.end(), 0);
  const std::vector<double> all = lengths(fine.vertices, same);
  const double shortest = *std::min_element(all.begin(), all.end());
  CHECK(decimated(fine.vertices, fine.triangles, 0.999 * shortest).kept.size() == fine.vertices.rows());
  CHECK(decimated(fine.vertices, fine.triangles, 1.001 * shortest).kept.size() < fine.vertices.rows());
  const std::vector<double> left = lengths(fine.vertices, decimated(fine.vertices, fine.triangles, 2 * shortest));
  CHECK(*std::min_element(left.begin(), left.end()) >= 2 * shortest);
}
