// Patches between corners that are given.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/fill.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/hole/hole.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// A flat hole with so many corners and edges a side, each side with five rows of squares beyond it that share nothing with the others'
/// but the rim. degrees(t): how far they lean downwards along a side.
struct Skirts {
  Points vertices;
  Faces faces;
  std::vector<Index> rim, corners;

  Skirts(const std::vector<int>& edges, const std::function<double(double)>& degrees) {
    constexpr Index rows = 5;
    const int sides = static_cast<int>(edges.size());
    const Index around = std::accumulate(edges.begin(), edges.end(), Index{0});
    vertices.resize(around + rows * (around + sides), 3);
    const auto corner = [&](int i) {
      return Vec3(std::cos(2 * std::numbers::pi * i / sides), std::sin(2 * std::numbers::pi * i / sides), 0);
    };
    for (int i = 0, first = 0, next = static_cast<int>(around); i < sides; ++i) {
      corners.push_back(first);
      const Vec3 way = corner(i + 1) - corner(i), out = way.cross(Vec3::UnitZ()).normalized();
      const Index n = edges[i];
      const auto vertex = [&](Index k, Index j) { return j == 0 ? (first + k) % around : next + k * rows + j - 1; };
      for (Index k = 0; k <= n; ++k) {
        const double t = static_cast<double>(k) / static_cast<double>(n), a = degrees(t) * std::numbers::pi / 180;
        const Vec3 p = corner(i) + t * way, down = std::cos(a) * out - std::sin(a) * Vec3::UnitZ();
        if (k < n) rim.push_back(vertex(k, 0));
        if (k < n) vertices.row(vertex(k, 0)) = p;
        for (Index j = 1; j <= rows; ++j)
          vertices.row(vertex(k, j)) = p + (static_cast<double>(j) / static_cast<double>(n)) * way.norm() * down;
      }
      for (Index k = 0; k < n; ++k)
        for (Index j = 0; j < rows; ++j)
          faces.add(std::array<Index, 4>{vertex(k + 1, j), vertex(k, j), vertex(k, j + 1), vertex(k + 1, j + 1)});
      first += edges[i];
      next += static_cast<int>(rows * (n + 1));
    }
  }
  Mesh mesh() const { return {vertices, faces}; }
};

}  // namespace

TEST_CASE("a patch that folds between given corners has no faces made where a surface takes its place") {
  const Skirts hole({8, 8, 8, 8}, [](double t) { return 20 * t; });
  const Mesh mesh = hole.mesh();
  const Connectivity around(mesh);
  const std::vector<Index> beside = {4, 8, 16, 24};  // the first in the middle of a side, which has a corner in it now
  const PolygonInput read = polygon_input(mesh, around, hole.rim, beside, {});
  const PolygonFill whole = fill_with_polygon(mesh, around, read, {}), alone = fill_with_polygon(mesh, around, read, {}, false);
  REQUIRE(whole.fill.report.folds > 0);
  CHECK(whole.fill.faces.size() > 0);
  CHECK(alone.fill.faces.size() == 0);
  CHECK(alone.fill.report.folds == whole.fill.report.folds);
  CHECK(alone.fill.rim_normals == whole.fill.rim_normals);
  FillOptions options;
  options.rim = hole.rim;
  options.corners = std::vector<Index>();
  for (Index place : beside) options.corners->push_back(hole.rim[place]);
  const Fill filled = fill(mesh, options);
  CHECK(filled.report.method == "polyharmonic_spline");
  CHECK(filled.faces.size() > 0);
  const PolygonFill unfolded =
      fill_with_polygon(mesh, around, polygon_input(mesh, around, hole.rim, hole.corners, {}), {}, false);
  CHECK((unfolded.fill.report.folds == 0 && unfolded.fill.faces.size() > 0));
}
