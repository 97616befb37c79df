#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tripatch/fill.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/hole/rim_shape.h"

using namespace tripatch;

namespace {

struct Model {
  Points vertices;
  Faces faces;
  Mesh mesh() const { return {vertices, faces}; }
};

/// A belt of the unit sphere from one angle from its pole to another, degrees.
Model belt(double from, double to) {
  constexpr Index around = 120, rows = 40;
  Model m;
  m.vertices.resize(around * (rows + 1), 3);
  for (Index j = 0; j <= rows; ++j)
    for (Index k = 0; k < around; ++k) {
      const double a = (from + (to - from) * static_cast<double>(j) / rows) * std::numbers::pi / 180,
                   b = 2 * std::numbers::pi * static_cast<double>(k) / around;
      m.vertices.row(j * around + k) << std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a);
    }
  for (Index j = 0; j < rows; ++j)
    for (Index k = 0; k < around; ++k) {
      const Index l = (k + 1) % around;
      m.faces.add(std::vector<Index>{j * around + k, (j + 1) * around + k, (j + 1) * around + l, j * around + l});
    }
  return m;
}

std::vector<char> outer(const Model& m) {
  std::vector<char> all;
  for (const Border& border : borders_of(m.mesh())) all.push_back(border.outer);
  return all;
}

}  // namespace

TEST_CASE("a hole that was cut into a few large faces is no outer border, although they are not convex beside it") {
  constexpr Index edges = 8;  // of each quarter of the hole
  Model plate;
  plate.vertices.resize(4 * edges + 4, 3);
  for (Index k = 0; k < 4 * edges; ++k) {
    const double a = 2 * std::numbers::pi * static_cast<double>(k) / (4 * edges);
    plate.vertices.row(k) << std::cos(a), std::sin(a), 0;
  }
  for (Index i = 0; i < 4; ++i) {
    const double a = std::numbers::pi / 2 * static_cast<double>(i);
    plate.vertices.row(4 * edges + i) << 3 * std::cos(a), 3 * std::sin(a), 0;
  }
  for (Index i = 0; i < 4; ++i) {
    std::vector<Index> face = {4 * edges + i, 4 * edges + (i + 1) % 4};
    for (Index k = edges; k >= 0; --k) face.push_back((i * edges + k) % (4 * edges));
    plate.faces.add(face);
  }
  for (const Border& border : borders_of(plate.mesh())) CHECK(border.outer == (border.loop.size() == 4));
  FillOptions options;  // it is the only hole, though the plate's own border is the shorter one
  for (const char* method : {"auto", "multi_sided"}) {
    options.method = method;
    CHECK(std::cmp_equal(fill(plate.mesh(), options).rim.size(), 4 * edges));
  }
}

TEST_CASE("an outer border counts where the mesh has no other") {
  Model m = belt(10, 60);
  const Index n = m.vertices.rows();
  // the pole closes the inner border
  m.vertices.conservativeResize(n + 1, 3);
  m.vertices.row(n) << 0, 0, 1;
  for (Index k = 0; k < 120; ++k) m.faces.add(std::vector<Index>{n, k, (k + 1) % 120});
  const std::vector<Border> borders = borders_of(m.mesh());
  REQUIRE(borders.size() == 1);
  CHECK(!borders[0].outer);
  CHECK(is_outer_border(m.mesh(), borders[0].loop));
  CHECK(borders[0].diameter == Approx(2 * std::sin(std::numbers::pi / 3)).epsilon(1e-12));
}

TEST_CASE("what fills the border of a bowl that reaches 41 degrees from its middle would lie on it") {
  const auto lies_on_it = [](double angle) {
    const Model m = belt(10, angle);
    return is_outer_border(m.mesh(), borders_of(m.mesh())[1].loop, true);
  };
  CHECK(lies_on_it(40));
  CHECK_FALSE(lies_on_it(43));
}

TEST_CASE("the size of a rim is its largest distance, whichever vertex is the first") {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const Index n : {1, 2, 3, 50, 400}) {
    Points p(n, 3);
    for (double& x : p.reshaped()) x = normal(random);
    double expected = 0;
    for (Index a = 0; a < n; ++a)
      for (Index b = 0; b < a; ++b) expected = std::max(expected, (p.row(a) - p.row(b)).norm());
    CHECK(diameter(p) == expected);
    Points turned(n, 3);
    for (Index k = 0; k < n; ++k) turned.row(k) = p.row((k + n / 3) % n);
    CHECK(diameter(turned) == expected);
  }
  Points broken = Points::Zero(3, 3);
  broken(1, 1) = NAN;
  CHECK(std::isnan(diameter(broken)));
}
