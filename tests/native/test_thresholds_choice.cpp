// Which of two fills of a hole is taken, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>

#include "test_surfaces.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/fill.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/hole/hole.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// A spline over a plane that states to be so well known, and a patch that lies so far above it.
struct Two {
  Fill patch, spline;
  Two(double apart, double said) {
    constexpr Index n = 25;
    spline.patch = formula_surface([](const auto& b) {
      using J = std::decay_t<decltype(b[0])>;
      JetPoint<J::order> p;
      p.x = {b[0], b[1], J(0.0)};
      return p;
    });
    spline.uv = PlanePoints(n, 2);
    spline.vertices = patch.vertices = Points::Zero(n, 3);
    for (Index k = 0; k < n; ++k) {
      const Vec2 at(0.2 * static_cast<double>(k % 5), 0.2 * static_cast<double>(k / 5));
      spline.uv.row(k) = at;
      spline.vertices.row(k).head<2>() = at;
      patch.vertices.row(k) << at[0] + 0.01, at[1], apart;
    }
    spline.deviation = Eigen::VectorXd::Constant(n, said);
  }
  bool spline_taken(double diameter = 1) const { return excluded_by(patch, spline, diameter); }
};

/// A flat hole with so many corners and edges a side, each side with five rows of squares beyond it that share nothing with the others'
/// but the rim. degrees(t): how far they lean downwards along a side.
struct Skirts {
  Points vertices;
  Faces faces;
  std::vector<Index> rim, corners;

  Skirts(int sides, int edges, const std::function<double(double)>& degrees) {
    constexpr int rows = 5;
    const Index around = sides * edges, columns = sides * (edges + 1);
    const double edge = 2 * std::sin(M_PI / sides) / edges;
    vertices.resize(around + columns * rows, 3);
    const auto corner = [&](int i) { return Vec3(std::cos(2 * M_PI * i / sides), std::sin(2 * M_PI * i / sides), 0); };
    for (int i = 0; i < sides; ++i) {
      corners.push_back(static_cast<Index>(i) * edges);
      const Vec3 way = corner(i + 1) - corner(i), out = way.cross(Vec3::UnitZ()).normalized();
      for (int k = 0; k <= edges; ++k) {
        const double t = static_cast<double>(k) / edges, a = degrees(t) * M_PI / 180;
        const Vec3 p = corner(i) + t * way, down = std::cos(a) * out - std::sin(a) * Vec3::UnitZ();
        if (k < edges) vertices.row(static_cast<Index>(i) * edges + k) = p;
        for (int j = 1; j <= rows; ++j) vertices.row(vertex(i, k, j, edges, sides)) = p + edge * j * down;
      }
      for (int k = 0; k < edges; ++k) {
        rim.push_back(vertex(i, k, 0, edges, sides));
        for (int j = 0; j < rows; ++j)
          faces.add(std::array<Index, 4>{vertex(i, k + 1, j, edges, sides), vertex(i, k, j, edges, sides),
                                         vertex(i, k, j + 1, edges, sides), vertex(i, k + 1, j + 1, edges, sides)});
      }
    }
  }
  static Index vertex(Index i, Index k, Index j, Index edges, Index sides) {
    if (j == 0) return (i * edges + k) % (sides * edges);
    return sides * edges + ((j - 1) * sides + i) * (edges + 1) + k;
  }
  Mesh mesh() const { return {vertices, faces}; }
  /// Whether it is filled by a surface for the reason that the planes of its sides differ.
  bool planes_differ() const {
    FillOptions options;
    options.rim = rim;
    return fill(mesh(), options).report.method_reason.find("differ at the corners") != std::string::npos;
  }
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

TEST_CASE("between sides whose planes are ten degrees apart at the corners there is no one surface", "[thresholds]") {
  const auto made = [](double degrees) { return Skirts(4, 8, [=](double) { return degrees; }); };
  const auto apart = [&](double degrees) {
    const Skirts hole = made(degrees);
    return fill_with_polygon(hole.mesh(), Connectivity(hole.mesh()), hole.rim, hole.corners, {}).planes_apart_deg;
  };
  const auto [below, above] = flip(4, 12, [&](double degrees) { return made(degrees).planes_differ(); });
  CHECK(apart(below) <= 10);
  CHECK(apart(above) > 10);
  CHECK(apart(above) < 10.1);
}

TEST_CASE("three sides whose planes are 45 degrees apart make no surface, where the rim has nine edges", "[thresholds]") {
  // each leans from its beginning to its end ever more: no side is sharp at both of its corners
  const auto made = [](double degrees, int edges = 4) { return Skirts(3, edges, [=](double t) { return degrees * t; }); };
  const auto apart = [&](double degrees) {
    const Skirts hole = made(degrees);
    const Mesh mesh = hole.mesh();
    const Connectivity around(mesh);
    const Sides sides = mesh_sides(mesh, around, make_hole(mesh, around, hole.rim, std::nullopt)).sides;
    double most = 0;
    for (int k = 0; k < 3; ++k)
      most = std::max(most, degrees_between(sides[(k + 1) % 3].normal(1), sides[(k + 2) % 3].normal(0)));
    return most;
  };
  const auto [below, above] = flip(20, 75, [&](double degrees) { return made(degrees).planes_differ(); });
  CHECK(apart(below) <= 45);
  CHECK(apart(above) > 45);
  CHECK(apart(above) < 45.2);
  CHECK(made(75, 3).planes_differ());
  CHECK_FALSE(made(75, 2).planes_differ());
}

TEST_CASE("a patch is excluded that lies four standard deviations from the spline", "[thresholds]") {
  CHECK_FALSE(Two(0.0398, 0.01).spline_taken());
  CHECK(Two(0.0402, 0.01).spline_taken());
}

TEST_CASE("a patch whose energy tells of a thousandth of the diameter is excluded by half a deviation", "[thresholds]") {
  const double diameter = 2, said = 0.01;
  for (const double apart : {0.0049, 0.0051, 0.03}) {
    Two two(apart, said);
    two.patch.report.energy_after = 0.99 * said / (1e-3 * diameter);
    CHECK_FALSE(two.spline_taken(diameter));
    two.patch.report.energy_after = 1.01 * said / (1e-3 * diameter);
    CHECK(two.spline_taken(diameter) == (apart > 0.005));
  }
}

TEST_CASE("a spline excludes no patch whose planes it misses by half a degree, where they are known twenty times better",
          "[thresholds]") {
  Two two(1, 0.01);
  const auto taken = [&](double missed, double known) {
    two.spline.report.surroundings_error = missed;
    two.patch.report.surroundings_error = known;
    return two.spline_taken();
  };
  CHECK(taken(0.49, 0));
  CHECK_FALSE(taken(0.51, 0));
  CHECK(taken(2, 0.101));
  CHECK_FALSE(taken(2, 0.099));
}
