#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <numbers>
#include <random>

#include "tripatch/mesh/triangles.h"
#include "tripatch/report/crossings.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/report/one_to_one.h"

using namespace tripatch;

namespace {

std::vector<Crossing> all_crossings(const Points& points, const Triangles& triangles) {
  return find_crossings(points, Points(0, 3), faces_of(triangles), 1000000);
}

/// A triangle in the plane z = 0 and one next to it whose tip lies at a height below it, at (0.25, 0.25).
Points pierced(double below) {
  Points points(6, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, -below, 0.5, 0.25, 1, 0.25, 0.5, 1;
  return points;
}
const Triangles two = {{0, 1, 2}, {3, 4, 5}};

/// Whether the line from p to q goes through a triangle: by the signs of volumes.
bool goes_through(const Vec3& p, const Vec3& q, const std::array<Vec3, 3>& t) {
  const auto volume = [](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return (b - a).cross(c - a).dot(d - a); };
  if ((volume(t[0], t[1], t[2], p) > 0) == (volume(t[0], t[1], t[2], q) > 0)) return false;
  const bool first = volume(p, q, t[0], t[1]) > 0;
  return (volume(p, q, t[1], t[2]) > 0) == first && (volume(p, q, t[2], t[0]) > 0) == first;
}

/// Of triangles some of which share vertices: an edge through a triangle that has neither of its ends.
bool any_goes_through(const Points& points, const Triangles& triangles) {
  for (const std::array<Index, 3>& s : triangles)
    for (const std::array<Index, 3>& t : triangles)
      for (int k = 0; k < 3; ++k) {
        const Index a = s[k], b = s[(k + 1) % 3];
        if (std::count(t.begin(), t.end(), a) + std::count(t.begin(), t.end(), b) > 0) continue;
        if (goes_through(points.row(a), points.row(b), {points.row(t[0]), points.row(t[1]), points.row(t[2])})) return true;
      }
  return false;
}

bool is_surely_one_to_one(const Points& points, const Triangles& triangles) {
  const Faces faces = faces_of(triangles);
  EdgesByVertex edges = edges_of_triangles(points.rows(), 0, faces, {});
  return surely_one_to_one(points, Points(0, 3), faces, edges);
}

/// A band of quads, halved, round the z axis over an angle, in a plane but for what moves its vertices.
struct Band {
  Points points;
  Triangles triangles;

  Band(Index along, Index across, double angle, double rise) : points(along * across, 3) {
    for (Index i = 0; i < along; ++i)
      for (Index j = 0; j < across; ++j) {
        const double turn = angle * static_cast<double>(i) / static_cast<double>(along - 1);
        const double radius = 1 + 0.8 * static_cast<double>(j) / static_cast<double>(across - 1);
        points.row(across * i + j) << radius * std::cos(turn), radius * std::sin(turn), rise * turn;
        const Index a = across * i + j, b = a - across - 1;
        if (i > 0 && j > 0) triangles.insert(triangles.end(), {{b, b + 1, a}, {b, a, a - 1}});
      }
  }
};

}  // namespace

TEST_CASE("an edge that goes through a triangle crosses it there") {
  const std::vector<Crossing> found = all_crossings(pierced(1), two);
  REQUIRE(found.size() == 2);  // both edges at the tip
  for (const Crossing& each : found) {
    CHECK((each.edge[0] == 3 || each.edge[1] == 3));
    CHECK(each.triangle == two[0]);
    CHECK(std::abs(each.where[2]) < 1e-15);
    CHECK((each.where - Vec3(0.375, 0.25, 0)).norm() * (each.where - Vec3(0.25, 0.375, 0)).norm() < 1e-15);
  }
  CHECK(crosses_itself(pierced(1), two));
  CHECK(find_crossings(pierced(1), Points(0, 3), faces_of(two), 1).size() == 1);
  CHECK(find_crossings(pierced(1).topRows(3), pierced(1).bottomRows(3), faces_of(two), 9).size() == 2);  // new vertices
}

TEST_CASE("what touches a triangle does not cross it") {
  const double longest = std::sqrt(2.0);
  for (double scale : {1e-9, 1.0, 1e9}) {
    CHECK(all_crossings(scale * pierced(-0.1), two).empty());
    CHECK(all_crossings(scale * pierced(0.9e-6 * longest), two).empty());
    CHECK(all_crossings(scale * pierced(1.1e-6 * longest), two).size() == 2);
  }
  Points beside = pierced(1);
  beside.bottomRows(3).col(0).array() += 2;
  CHECK(all_crossings(beside, two).empty());
}

TEST_CASE("triangles with a common vertex cross by the edge across from it, those with a common edge do not") {
  Points points(5, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.4, 0.2, -1, 0.4, 0.2, 1;
  const std::vector<Crossing> found = all_crossings(points, {{0, 1, 2}, {0, 3, 4}});
  REQUIRE(found.size() == 1);
  CHECK((found[0].where - Vec3(0.4, 0.2, 0)).norm() < 1e-15);
  points.row(3) << 0.4, 0.2, 1e-3;  // folded over the other, but not through it
  CHECK(all_crossings(points, {{0, 1, 2}, {1, 0, 3}}).empty());
}

TEST_CASE("faces of more corners are cut into fans") {
  Points points(7, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0.2, 0.7, -1, 0.2, 0.7, 1, 3, 3, 0.5;
  Faces faces;
  faces.add(std::array<Index, 4>{0, 1, 2, 3});
  faces.add(std::array<Index, 3>{4, 5, 6});
  const std::vector<Crossing> found = find_crossings(points, Points(0, 3), faces, 9);
  REQUIRE(!found.empty());
  CHECK(found[0].triangle == std::array<Index, 3>{0, 2, 3});
}

TEST_CASE("all crossings of many triangles are found, each pair once") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(0, 1), size(-0.15, 0.15);
  const int count = 300;
  Points points(3 * count, 3);
  Triangles triangles;
  for (int t = 0; t < count; ++t) {
    const Vec3 middle(place(random), place(random), place(random));
    for (int k = 0; k < 3; ++k) points.row(3 * t + k) = middle + Vec3(size(random), size(random), size(random));
    triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  std::size_t expected = 0;
  const auto corners = [&](int t) {
    return std::array<Vec3, 3>{points.row(3 * t), points.row(3 * t + 1), points.row(3 * t + 2)};
  };
  for (int s = 0; s < count; ++s)
    for (int t = 0; t < count; ++t)
      for (int k = 0; k < 3; ++k)
        if (s != t) expected += goes_through(corners(s)[k], corners(s)[(k + 1) % 3], corners(t));
  CHECK(expected > 100);
  CHECK(all_crossings(points, triangles).size() == expected);
}

TEST_CASE("a closed surface does not cross itself, nothing nor a triangle without area does") {
  CHECK(all_crossings(Points(0, 3), {}).empty());
  Points flat = pierced(1);
  flat.row(5) = flat.row(4);
  CHECK(all_crossings(flat, two).empty());
  Points grid(400, 3);
  Triangles triangles;
  for (Index i = 0; i < 20; ++i)
    for (Index j = 0; j < 20; ++j) {
      grid.row(20 * i + j) << std::cos(0.3 * i), std::sin(0.3 * i), 0.1 * j;  // almost a whole turn
      if (i > 0 && j > 0) {
        const Index a = 20 * i + j;
        triangles.insert(triangles.end(), {{a - 21, a - 1, a}, {a - 21, a, a - 20}});
      }
    }
  CHECK(all_crossings(grid, triangles).empty());
}

TEST_CASE("what lies one to one over a plane is known to, and what is said to does not cross itself") {
  std::mt19937 random(11);
  std::normal_distribution<double> noise;
  std::uniform_real_distribution<double> any(0, 1);
  int sure = 0, crossed = 0, neither = 0;
  for (int round = 0; round < 400; ++round) {
    // over more than a turn the band comes back over or through itself, however flat it lies
    Band band(8 + round % 9, 3 + round % 4, (0.5 + 1.2 * any(random)) * 2 * std::numbers::pi,
              round % 3 == 0 ? 0 : 0.1 * noise(random));
    const double moved = round % 2 ? 0.02 : 0.3 * any(random);
    const bool turned = any(random) < 0.5;
    for (Index v = 0; v < band.points.rows(); ++v)
      band.points.row(v) += moved * Vec3(0.2 * noise(random), 0.2 * noise(random), noise(random));
    if (turned)
      for (std::array<Index, 3>& t : band.triangles) std::swap(t[1], t[2]);
    std::shuffle(band.triangles.begin(), band.triangles.end(), random);
    const Eigen::Quaterniond rotation =
        Eigen::Quaterniond(noise(random), noise(random), noise(random), noise(random)).normalized();
    band.points = (band.points * rotation.toRotationMatrix().transpose()).rowwise() + Vec3(3, -2, 5).transpose();
    const bool crosses = any_goes_through(band.points, band.triangles),
               proven = is_surely_one_to_one(band.points, band.triangles);
    CHECK_FALSE((crosses && proven));
    CHECK(crosses_itself(band.points, band.triangles) == crosses);
    sure += proven;
    crossed += crosses;
    neither += !proven && !crosses;
  }
  CHECK(sure > 60);
  CHECK(crossed > 100);
  CHECK(neither > 20);
}

TEST_CASE("a surface over a plane is known to lie over it, wherever and however large it is; less than a turn of a band, too") {
  for (double scale : {1e-9, 1.0, 1e9}) {
    const Band most(60, 4, 1.9 * std::numbers::pi, 0.5), more(60, 4, 2.1 * std::numbers::pi, 0.5);
    CHECK(is_surely_one_to_one(scale * most.points, most.triangles));
    CHECK_FALSE(is_surely_one_to_one(scale * more.points, more.triangles));
  }
}

TEST_CASE("nothing is known of what is no one sheet with one border") {
  const Band band(9, 3, std::numbers::pi, 0);
  REQUIRE(is_surely_one_to_one(band.points, band.triangles));
  Triangles two_sheets = band.triangles;
  two_sheets.erase(two_sheets.begin() + 16, two_sheets.begin() + 20);  // a row across
  CHECK_FALSE(is_surely_one_to_one(band.points, two_sheets));
  Triangles twice = band.triangles;
  twice.push_back(twice[5]);
  CHECK_FALSE(is_surely_one_to_one(band.points, twice));
  Triangles turned = band.triangles;
  std::swap(turned[5][1], turned[5][2]);
  CHECK_FALSE(is_surely_one_to_one(band.points, turned));
  Points closed(4, 3);
  closed << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  CHECK_FALSE(is_surely_one_to_one(closed, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}));
  CHECK_FALSE(is_surely_one_to_one(Points(0, 3), {}));
}
