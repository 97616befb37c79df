// What is read of a hole before its fills are made, on both sides of each threshold.
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

/// Where a hole begins to be filled otherwise, between two values of what it is made from.
std::array<double, 2> flip(double low, double high, const std::function<bool(double)>& other) {
  REQUIRE_FALSE(other(low));
  REQUIRE(other(high));
  while (high - low > 0.02) {
    const double middle = (low + high) / 2;
    (other(middle) ? high : low) = middle;
  }
  return {low, high};
}

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

/// Degrees between the planes of three sides at their corners, the most.
double planes_apart(const Skirts& hole) {
  const Mesh mesh = hole.mesh();
  const Connectivity around(mesh);
  const Sides sides = mesh_sides(mesh, around, make_hole(mesh, around, hole.rim, std::nullopt)).sides;
  double most = 0;
  for (int k = 0; k < 3; ++k) most = std::max(most, degrees_between(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)));
  return most;
}

TEST_CASE("two sides that are known without noise keep planes of their own from five degrees on", "[thresholds]") {
  const auto made = [](double degrees) { return Skirts({8, 8, 8}, [=](double) { return degrees; }); };
  const auto [below, above] = flip(1, 5, [&](double degrees) { return planes_apart(made(degrees)) > 1; });
  const auto between = [](double degrees) {  // planes that lean out by the same angle, in directions 120 degrees apart
    const double sine = std::sin(degrees * std::numbers::pi / 180);
    return std::acos(1 - 1.5 * sine * sine) * 180 / std::numbers::pi;
  };
  CHECK(between(below) == Approx(5).epsilon(0.02));
  CHECK(between(above) == Approx(5).epsilon(0.02));
}

TEST_CASE("a round rim has six edges", "[thresholds]") {
  for (const int edges : {5, 6}) {
    const Skirts hole(std::vector<int>(edges, 1), [](double) { return 0.0; });
    const auto filled = [&] { disc_input(hole.mesh(), Connectivity(hole.mesh()), hole.rim, {}); };
    if (edges < 6) {
      CHECK(refusal_code([&] { filled(); }) == "round_rim_too_short");
    } else {
      CHECK_NOTHROW(filled());
    }
  }
}

TEST_CASE("the open end of an uneven prism of up to six walls has a corner at every one of them", "[thresholds]") {
  for (const Index walls : {5, 6, 7}) {  // of even ones corners are found as such
    Points vertices(2 * walls, 3);
    Faces faces;
    FillOptions options;
    options.rim.emplace();
    for (Index k = 0; k < walls; ++k) {
      const double place = static_cast<double>(k),
                   angle = 2 * std::numbers::pi * (place + 0.35 * std::sin(3 * place + 3)) / static_cast<double>(walls);
      const Vec3 corner =
          (1 + 0.4 * std::cos(5 * place + 6)) * Vec3(std::cos(angle), std::sin(angle), 0.001 * std::cos(place));  // not flat
      vertices.row(k) = corner;
      vertices.row(walls + k) = corner - Vec3::UnitZ();
      const Index next = (k + 1) % walls;
      faces.add(std::array<Index, 4>{next, k, walls + k, walls + next});
      options.rim->push_back(k);
    }
    CAPTURE(walls);
    CHECK(fill({vertices, faces}, options).report.corners.size() == static_cast<std::size_t>(walls <= 6 ? walls : 0));
  }
}
