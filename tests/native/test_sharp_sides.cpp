#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "test_surfaces.h"
#include "tripatch/boundary/side.h"
#include "tripatch/hole/corners.h"
#include "tripatch/hole/sharp_sides.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// What is left of a column below z = top(x, y) over a polygon: its walls, five rows of quads that go down, leaning outwards by
/// `lean` times their depth. The face on top is the hole; its rim begins at the first corner.
struct Column {
  Points vertices;
  Faces faces;
  std::vector<Index> rim, places;

  Column(const std::function<double(double, double)>& top, const std::vector<Eigen::Vector2d>& corners,
         const std::vector<double>& lean, int edges = 8) {
    constexpr int rows = 5;
    const int n = static_cast<int>(corners.size()), around = n * edges;
    vertices.resize((rows + 1) * (around + n), 3);
    for (int i = 0, at = 0; i < n; ++i) {  // a wall for itself: they share only the rim
      const Eigen::Vector2d a = corners[i], b = corners[(i + 1) % n],
                            out = Eigen::Vector2d(b[1] - a[1], a[0] - b[0]).normalized();
      places.push_back(i * edges);
      for (int k = 0; k <= edges; ++k, ++at)
        for (int j = 0; j <= rows; ++j) {
          const Eigen::Vector2d p = a + (b - a) * k / edges;
          const double deep = 0.1 * j;
          vertices.row(j * (around + n) + at) << p[0] + lean[i] * deep * out[0], p[1] + lean[i] * deep * out[1],
              top(p[0], p[1]) - deep;
        }
    }
    const auto vertex = [&](Index i, Index k, Index j) -> Index {
      if (j == 0 && k == edges) return (i + 1) % n * (edges + 1);
      return j * (around + n) + i * (edges + 1) + k;
    };
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < edges; ++k) {
        rim.push_back(vertex(i, k, 0));
        for (int j = 0; j < rows; ++j)
          faces.add(std::array<Index, 4>{vertex(i, k + 1, j), vertex(i, k, j), vertex(i, k, j + 1), vertex(i, k + 1, j + 1)});
      }
  }
  Mesh mesh() const { return {vertices, faces}; }
};

const std::vector<Eigen::Vector2d> triangle = {{0, 0}, {1, 0.1}, {0.4, 0.9}};
double slope(double x, double y) { return 0.3 * x - 0.2 * y; }

}  // namespace

TEST_CASE("walls below a slope are sharp, whatever their number, and a wall that continues the slope is none") {
  const double level = 1e6;  // leans out so far that it is level
  for (const std::vector<double>& lean : {std::vector<double>{0, 0, 0}, {1, 0, 1}, {level, 0, 0}, {level, level, 0}}) {
    const Column column([](double, double) { return 0.0; }, triangle, lean);
    const Connectivity around(column.mesh());
    const std::vector<double> angles = sharp_sides(column.mesh(), around, column.rim, column.places);
    for (int i = 0; i < 3; ++i) {
      const double wall = 90 - std::atan(lean[i]) * 180 / std::numbers::pi;
      CHECK(angles[i] == Approx(wall < 1 ? 0 : wall).margin(1e-9));
    }
  }
}

TEST_CASE("sides of one edge are called sharp between walls, of two where all are") {
  const auto angles = [](const std::vector<double>& lean, int edges) {
    const Column column(slope, triangle, lean, edges);
    return sharp_sides(column.mesh(), Connectivity(column.mesh()), column.rim, column.places);
  };
  CHECK_FALSE(any_sharp(angles({0, 0, 0}, 1)));
  CHECK_FALSE(any_sharp(angles({0, 0, 3}, 2)));
  const Column box([](double, double) { return 0.0; }, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {0, 0, 0, 0}, 1);
  for (double angle : sharp_sides(box.mesh(), Connectivity(box.mesh()), box.rim, box.places)) CHECK(angle == Approx(90));
  for (double angle : angles({0, 0, 0}, 2)) CHECK(angle > 60);
}

TEST_CASE("three faces that reach around a hole, as those of a coarse bevel around a corner, are no walls beside it") {
  constexpr Index edges = 8, n = 3 * edges;
  constexpr double steep = 1;
  Points vertices(2 * n, 3);
  for (Index k = 0; k < n; ++k) {
    const double a = 2 * std::numbers::pi * static_cast<double>(k) / n;
    const double middle = 2 * std::numbers::pi / 3 * (std::floor(static_cast<double>(k) / edges) + 0.5);
    const Vec3 rim(std::cos(a), std::sin(a), -steep * std::cos(a - middle));
    vertices.row(k) = rim;
    vertices.row(n + k) = 2 * rim;
  }
  Faces faces;
  std::vector<Index> rim;
  for (Index k = 0; k < n; ++k) {
    const Index next = (k + 1) % n;
    faces.add(std::array<Index, 4>{next, k, n + k, n + next});
    rim.push_back(k);
  }
  const Mesh mesh{vertices, faces};
  CHECK_FALSE(any_sharp(sharp_sides(mesh, Connectivity(mesh), rim, std::array<Index, 3>{0, edges, 2 * edges})));
}

TEST_CASE("the corners of a hole between walls are found in the plane of its rim") {
  const std::vector<Eigen::Vector2d> square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (const auto& corners : {triangle, square}) {
    const Column column(slope, corners, std::vector<double>(corners.size(), 0.0));
    CHECK(detect_corners(column.mesh(), Connectivity(column.mesh()), column.rim) == column.places);
  }
}

TEST_CASE("faces beyond sharp sides are not continued, those that smooth edges connect with the others are") {
  const Column column([](double, double) { return 0.0; }, triangle, {1e6, 0, 0});
  const Connectivity around(column.mesh());
  const std::vector<double> angles = sharp_sides(column.mesh(), around, column.rim, column.places);
  REQUIRE(any_sharp(angles));
  const std::vector<Index> beyond = not_continued(column.mesh(), around, column.rim, column.places, angles);
  REQUIRE(beyond.size() == 2 * 8 * 5);
  CHECK(beyond.front() == 8 * 5);  // the first wall's faces come first
}

TEST_CASE("a side that is not continued takes its planes from the rim and from its continued neighbors") {
  const Sides exact = sides_of(wave());
  Sides sides = exact;
  sides[1].r = PiecewisePolynomial::constant(std::array<double, 3>{0.3, -0.2, 5});  // whatever lies beyond
  const Sides told = planes_from_rim(sides, {true, false, true});
  for (int k : {0, 2}) CHECK(told[k].r(0.3) == exact[k].r(0.3));
  CHECK(told[1].q.empty());
  for (double t : {0.0, 1.0}) CHECK((told[1].normal(t) - exact[1].normal(t)).norm() < 1e-9);
  // a surface holds the tangents of both of its sides at a corner: three sides alone say the same
  const Sides alone = planes_from_rim(sides, {false, false, false});
  for (int i = 0; i < 3; ++i)
    for (double t : {0.0, 1.0}) CHECK((alone[i].normal(t) - exact[i].normal(t)).norm() < 1e-9);
}
