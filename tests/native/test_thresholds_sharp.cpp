// What makes a side of a hole sharp, on both sides of each threshold.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/angle.h"

using namespace tripatch;

namespace {

using Vec2 = Eigen::Vector2d;

/// A hole in the plane whose rim edges have a face each, which share nothing but the rim.
struct Walls {
  Points vertices;
  Faces faces;
  std::vector<Index> rim, places;

  /// edges: of each side; degrees(side, edge): 0 where the face continues in the plane, 90 where it goes straight down. bow: of the sides,
  /// which are parabolas so high above their chords.
  Walls(const std::vector<Vec2>& corners, const std::vector<int>& edges, const std::function<double(int, int)>& degrees,
        double bow = 0) {
    std::vector<Vec3> points;
    std::vector<double> angle;
    const int n = static_cast<int>(corners.size());
    for (int i = 0; i < n; ++i) {
      places.push_back(static_cast<Index>(points.size()));
      const Vec2 a = corners[i], way = corners[(i + 1) % n] - a, out = Vec2(way[1], -way[0]).normalized();
      for (int k = 0; k < edges[i]; ++k) {
        const double t = static_cast<double>(k) / edges[i];
        const Vec2 p = a + t * way + 4 * bow * t * (1 - t) * out;
        points.emplace_back(p[0], p[1], 0);
        angle.push_back(degrees(i, k) * std::numbers::pi / 180);
      }
    }
    const Index m = static_cast<Index>(points.size());
    vertices.resize(3 * m, 3);
    for (Index k = 0; k < m; ++k) {
      const Index next = (k + 1) % m;
      const Vec3 way = points[next] - points[k];
      const Vec3 off = std::cos(angle[k]) * way.cross(Vec3::UnitZ()) - std::sin(angle[k]) * way.norm() * Vec3::UnitZ();
      vertices.row(k) = points[k];
      vertices.row(m + 2 * k) = points[k] + off;
      vertices.row(m + 2 * k + 1) = points[next] + off;
      rim.push_back(k);
      faces.add(std::array<Index, 4>{next, k, m + 2 * k, m + 2 * k + 1});
    }
  }
  Mesh mesh() const { return {vertices, faces}; }
  std::vector<double> angles() const { return sharp_sides(mesh(), Connectivity(mesh()), rim, places); }
  Vec3 edge(Index k) const { return vertices.row((k + 1) % static_cast<Index>(rim.size())) - vertices.row(k); }
  Vec3 normal(Index k) const {
    const Index m = static_cast<Index>(rim.size());
    return Vec3(vertices.row(m + 2 * k) - vertices.row(k)).cross(edge(k)).normalized();
  }
};

const std::vector<Vec2> triangle = {{0, 0}, {1, 0.1}, {0.4, 0.9}};
const std::vector<Vec2> square = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

std::function<double(int, int)> all(double degrees) {
  return [=](int, int) { return degrees; };
}

}  // namespace

TEST_CASE("straight sides are sharp from 20 degrees on", "[thresholds]") {
  CHECK_FALSE(any_sharp(Walls(triangle, {8, 8, 8}, all(19.9)).angles()));
  for (const double angle : Walls(triangle, {8, 8, 8}, all(20.1)).angles()) CHECK(angle == Approx(20.1));
}

TEST_CASE("a side is sharp that is off by a quarter of that at both of its ends", "[thresholds]") {
  for (const double start : {4.95, 5.05}) {
    const Walls walls(triangle, {8, 8, 8}, [&](int side, int edge) {
      if (side > 0) return 0.0;
      return edge < 2 ? start : edge > 5 ? 37 : start + (37 - start) * (edge - 1) / 5.0;
    });
    CHECK((walls.angles()[0] > 0) == (start > 5));
  }
}

TEST_CASE("bent sides are sharp from half of the bends of their ends on above 20 degrees", "[thresholds]") {
  // where its faces begin to be sharp, the first side is off by as much as its ends may be
  double smooth = 5, sharp = 80;
  const auto made = [](double degrees) { return Walls(triangle, {8, 8, 8}, all(degrees), 0.15); };
  while (sharp - smooth > 1e-3) {
    const double middle = (smooth + sharp) / 2;
    (made(middle).angles()[0] > 0 ? sharp : smooth) = middle;
  }
  const Walls walls = made(sharp);
  const auto end = [&](Index edge, Index next) {  // direction and plane at the end of a side, and its bend
    const double share = walls.edge(edge).norm() / (walls.edge(edge).norm() + walls.edge(next).norm());
    const auto carried = [&](const Vec3& a, const Vec3& b) -> Vec3 { return a + share * (a - b); };
    const Vec3 a = walls.edge(edge).normalized(), b = walls.edge(next).normalized();
    return std::tuple(carried(a, b), carried(walls.normal(edge), walls.normal(next)),
                      degrees_between(a, b) + degrees_between(walls.normal(edge), walls.normal(next)));
  };
  double off = 0, bends = 0;
  for (const auto& [in, before, out, after] : {std::array<Index, 4>{23, 22, 0, 1}, {8, 9, 7, 6}}) {
    const auto [tangent, other, one] = end(in, before);
    const auto [own, normal, two] = end(out, after);
    off += std::min(degrees_between(normal, Vec3::UnitZ()), degrees_between(normal, -Vec3::UnitZ()));
    bends += one + two;
  }
  CHECK(bends > 20);
  CHECK((off - 40) / bends == Approx(0.5).epsilon(0.01));
}

TEST_CASE("between sides of one edge a side is sharp from 55 degrees on, as these may bend by 70", "[thresholds]") {
  for (const double degrees : {54.8, 55.2}) {
    const Walls walls(triangle, {8, 1, 1}, [&](int side, int) { return side == 0 ? degrees : 0; });
    CHECK((walls.angles()[0] > 0) == (degrees > 55));
  }
}

TEST_CASE("sides of one edge are walls from 70 degrees on, and 55 between them", "[thresholds]") {
  CHECK_FALSE(any_sharp(Walls(square, {1, 1, 1, 1}, all(69.8)).angles()));
  for (const double angle : Walls(square, {1, 1, 1, 1}, all(70.2)).angles()) CHECK(angle == Approx(70.2));
  for (const double turn : {54.8, 55.2}) {
    const Vec2 leg(std::cos(turn * std::numbers::pi / 180), std::sin(turn * std::numbers::pi / 180));
    const std::vector<Vec2> trapezoid = {{0, 0}, {1, 0}, Vec2(1, 0) + leg, Vec2(-leg[0], leg[1])};
    CHECK((Walls(trapezoid, {1, 1, 1, 1}, all(90)).angles()[0] > 0) == (turn > 55));
  }
}

TEST_CASE("two sides tell the plane of their corner where the sine between them is a fifth", "[thresholds]") {
  for (const double sine : {0.198, 0.202}) {
    const Vec2 leg(std::sqrt(1 - sine * sine), sine);
    const std::vector<Vec2> corners = {{-0.5, 0}, {0.5, 0}, Vec2(0.5, 0) + leg, {0, 2}, Vec2(-0.5 - leg[0], leg[1])};
    CHECK((Walls(corners, {8, 8, 8, 8, 8}, all(90)).angles()[0] > 0) == (sine > 0.2));
  }
}

TEST_CASE("a surface goes on across edges of up to 25 degrees", "[thresholds]") {
  for (const double degrees : {24.9, 25.1}) {
    // around vertex 1 lie a face next to the sharp side from 0 to 1, one in between and one next to the next side
    Points vertices = (Points(6, 3) << 0, 0, 0, 1, 0, 0, 0.4, 0.9, 0, 0.6, -0.7, 0, 1.6, 0.5, 0, -0.5, 0.8, 0).finished();
    const Vec3 corner = vertices.row(1), axis = (Vec3(vertices.row(4)) - corner).normalized();
    vertices.row(2) = corner + Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis) * (Vec3(vertices.row(2)) - corner);
    Faces faces;
    for (const auto& face : {std::array<Index, 3>{1, 0, 3}, {1, 3, 4}, {2, 1, 4}, {0, 2, 5}}) faces.add(face);
    const Mesh mesh = {vertices, faces};
    const std::vector<Index> places = {0, 1, 2};
    const std::vector<Index> beyond = not_continued(mesh, Connectivity(mesh), {0, 1, 2}, places, {90, 0, 0});
    CHECK(beyond == (degrees < 25 ? std::vector<Index>{0} : std::vector<Index>{0, 1}));
  }
}
