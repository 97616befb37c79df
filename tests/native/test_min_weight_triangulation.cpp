#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "test_triangles.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/report/crossings.h"
#include "tripatch/triangulation/closed_line.h"
#include "tripatch/triangulation/min_weight_triangulation.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

Points ring(int n, double radius, double height = 0, double wobble = 0, bool backwards = false) {
  Points x(n, 3);
  for (int k = 0; k < n; ++k) {
    const double a = (backwards ? -1 : 1) * 2 * std::numbers::pi * k / n;
    x.row(k) << radius * std::cos(a), radius * std::sin(a), height + wobble * std::sin(3 * a);
  }
  return x;
}

Points stacked(const Points& a, const Points& b) {
  Points x(a.rows() + b.rows(), 3);
  x << a, b;
  return x;
}

/// What must hold of every fill; empty when it does.
std::string flaw(const RoughFill& fill, Index r, const std::vector<Index>& islands = {}) {
  std::map<std::pair<Index, Index>, int> directed;
  for (const auto& t : fill.triangles)
    for (int k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
  std::vector<Index> start = {0};
  start.insert(start.end(), islands.begin(), islands.end());
  start.push_back(r);
  std::set<std::pair<Index, Index>> rim;
  for (std::size_t l = 0; l + 1 < start.size(); ++l)
    for (Index k = start[l]; k < start[l + 1]; ++k) rim.insert({k, k + 1 < start[l + 1] ? k + 1 : start[l]});
  for (const auto& [edge, count] : directed) {
    if (count != 1) return "an edge twice in one direction";
    if (edge.first == edge.second) return "an edge from a vertex to itself";
    const bool inner = directed.count({edge.second, edge.first});
    if (inner == (rim.count(edge) > 0)) return "the border is not the rim";
  }
  for (const auto& edge : rim)
    if (!directed.count(edge)) return "a rim edge without a triangle";
  const Index loops = static_cast<Index>(start.size()) - 1;
  if (static_cast<Index>(fill.triangles.size()) != r - 2 + 2 * (loops - 1)) return "number of triangles";
  return "";
}

double area(const Points& x, const RoughFill& fill) {
  double sum = 0;
  for (const auto& t : fill.triangles) sum += Vec3(x.row(t[1]) - x.row(t[0])).cross(Vec3(x.row(t[2]) - x.row(t[0]))).norm() / 2;
  return sum;
}

}  // namespace

TEST_CASE("a rough fill of a plane polygon covers it once, convex or not") {
  for (int n : {3, 4, 5, 17, 150, 200, 201, 1000}) {
    INFO(n);
    const Points x = ring(n, 2);
    const RoughFill fill = min_weight_triangulation(x);
    CHECK(flaw(fill, n) == "");
    CHECK_FALSE(fill.doubles_edges);
    CHECK(area(x, fill) == Approx(n * 2 * std::sin(2 * std::numbers::pi / n)).epsilon(1e-6));
  }
  Points star = ring(40, 1);
  for (int k = 0; k < 40; k += 2) star.row(k) *= 0.4;
  CHECK(area(star, min_weight_triangulation(star)) == Approx(40 * 0.5 * 0.4 * std::sin(2 * std::numbers::pi / 40)).epsilon(1e-6));
}

TEST_CASE("a straight run of rim vertices makes no triangle without area where another is possible") {
  Points square(16, 3);
  for (int k = 0; k < 4; ++k) {
    square.row(k) << k, 0, 0;
    square.row(4 + k) << 4, k, 0;
    square.row(8 + k) << 4 - k, 4, 0;
    square.row(12 + k) << 0, 4 - k, 0;
  }
  const RoughFill fill = min_weight_triangulation(square);
  CHECK(flaw(fill, 16) == "");
  for (const auto& t : fill.triangles)
    CHECK(Vec3(square.row(t[1]) - square.row(t[0])).cross(Vec3(square.row(t[2]) - square.row(t[0])))[2] > 0.5);
}

TEST_CASE("the faces around decide which way a fill bends") {
  Points x(4, 3);  // over 1-3 it bends by 23 degrees, over 0-2 by 53
  x << -1, 0, 0, 0, -0.4, 0.2, 1, 0, 0, 0, 0.4, 0.2;
  CHECK(has_edge(min_weight_triangulation(x).triangles, 1, 3));
  RimSurroundings steep;  // 34 degrees off the triangles over 0-2, 61 off the others
  steep.normals.resize(4, 3);
  for (int k = 0; k < 4; ++k) steep.normals.row(k) = Vec3(0, k < 2 ? std::sqrt(3.0) / 2 : -std::sqrt(3.0) / 2, 0.5);
  CHECK(has_edge(min_weight_triangulation(x, steep).triangles, 0, 2));
}

TEST_CASE("the area decides where angles cannot: a quadrilateral takes the smaller of two bends") {
  Points x(4, 3);
  x << 0, 0, 0, 1, 0, 0.01, 1, 1, 0, 0, 1, 0.01;
  const RoughFill fill = min_weight_triangulation(x);
  Points turned(4, 3);
  for (int k = 0; k < 4; ++k) turned.row(k) = x.row((k + 1) % 4);
  CHECK(area(x, fill) <= area(turned, min_weight_triangulation(turned)) + 1e-9);
}

TEST_CASE("edges that the mesh has already are not made again") {
  const Points x = ring(4, 1);
  RimSurroundings rim;
  rim.joined = {{2, 0}, {0, 1}};  // a rim edge among them says nothing
  RoughFill fill = min_weight_triangulation(x, rim);
  CHECK(has_edge(fill.triangles, 1, 3));
  CHECK_FALSE(fill.doubles_edges);
  rim.joined = {{0, 2}, {3, 1}};
  fill = min_weight_triangulation(x, rim);
  CHECK(flaw(fill, 4) == "");
  CHECK(fill.doubles_edges);
  for (int n : {30, 500}) {  // of the ears all but one in seven are taken; where it is done by parts, one in three
    rim.joined.clear();
    for (Index k = 0; k < n; ++k)
      if (n == 30 ? k % 7 != 0 : k % 3 == 0) rim.joined.push_back({k, (k + 2) % n});
    const Points y = ring(n, 1);
    fill = min_weight_triangulation(y, rim);
    CHECK(flaw(fill, n) == "");
    CHECK_FALSE(fill.doubles_edges);
  }
}

TEST_CASE("islands and strips") {
  SECTION("an island in a plane") {
    const Points x = stacked(ring(20, 2), ring(7, 0.5, 0, 0, true));
    RimSurroundings rim;
    rim.islands = {20};
    const RoughFill fill = min_weight_triangulation(x, rim);
    CHECK(flaw(fill, 27, {20}) == "");
    CHECK_FALSE(fill.doubles_edges);
    const double expected = 20 * 2 * std::sin(2 * std::numbers::pi / 20) - 7 * 0.125 * std::sin(2 * std::numbers::pi / 7);
    CHECK(area(x, fill) == Approx(expected).epsilon(1e-6));
  }
  SECTION("three islands") {
    Points small = ring(5, 0.2, 0, 0, true);
    Points x = ring(40, 2);
    for (double at : {-1.0, 0.0, 1.0}) {
      Points moved = small;
      moved.col(0).array() += at;
      x = stacked(x, moved);
    }
    RimSurroundings rim;
    rim.islands = {40, 45, 50};
    const RoughFill fill = min_weight_triangulation(x, rim);
    CHECK(flaw(fill, 55, {40, 45, 50}) == "");
    CHECK_FALSE(fill.doubles_edges);
    CHECK(area(x, fill) ==
          Approx(40 * 2 * std::sin(2 * std::numbers::pi / 40) - 3 * 5 * 0.02 * std::sin(2 * std::numbers::pi / 5)).epsilon(1e-6));
  }
  for (int n : {12, 400}) {  // a cylinder between two rims
    const Points x = stacked(ring(n, 1), ring(n, 1, 0.5, 0, true));
    RimSurroundings rim;
    rim.islands = {n};
    const RoughFill fill = min_weight_triangulation(x, rim);
    CHECK(flaw(fill, 2 * n, {n}) == "");
    CHECK_FALSE(fill.doubles_edges);
    CHECK(area(x, fill) == Approx(0.5 * n * 2 * std::sin(std::numbers::pi / n)).epsilon(n > 200 ? 0.2 : 0.02));
  }
}

TEST_CASE("a rough fill is the same turned and scaled, and whatever degenerates") {
  const Points x = ring(60, 1, 0, 0.3);
  Points moved = x * (Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix().transpose() * 1e5);
  moved.rowwise() += Eigen::RowVector3d(3e5, 0, -1e5);
  CHECK(flaw(min_weight_triangulation(moved), 60) == "");
  CHECK(area(moved, min_weight_triangulation(moved)) == Approx(1e10 * area(x, min_weight_triangulation(x))).epsilon(1e-2));
  CHECK(flaw(min_weight_triangulation(Points::Zero(9, 3)), 9) == "");
  Points line = Points::Zero(30, 3);
  for (int k = 0; k < 30; ++k) line(k, 0) = k;
  CHECK(flaw(min_weight_triangulation(line), 30) == "");
  CHECK_THROWS_AS(min_weight_triangulation(ring(2, 1)), InvalidArgument);
  RimSurroundings rim;
  rim.islands = {10};
  CHECK_THROWS_AS(min_weight_triangulation(ring(12, 1), rim), InvalidArgument);
}

TEST_CASE("the rough fill of a mirrored rim is as large, whichever apexes are compared first") {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 400; ++round) {
    const Index n = 4 + round % 40;
    Points x(n, 3);
    RimSurroundings rim, mirrored;
    rim.normals.resize(n, 3);
    for (Index k = 0; k < n; ++k) {
      const double a = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n), r = 1 + 0.1 * normal(random);
      x.row(k) << r * std::cos(a), r * std::sin(a), 0.1 * normal(random);
      rim.normals.row(k) = Vec3(0.5 * normal(random), 0.5 * normal(random), 1).normalized();
    }
    const Eigen::Array3d across(-1, 1, 1);  // which turns what goes round, and so the rim is taken backwards
    Points y(n, 3);
    mirrored.normals.resize(n, 3);
    for (Index k = 0; k < n; ++k) {
      y.row(k) = x.row(n - 1 - k).array() * across.transpose();
      mirrored.normals.row(k) = rim.normals.row((2 * n - 2 - k) % n).array() * across.transpose();
    }
    INFO(n);
    CHECK(area(y, min_weight_triangulation(y, mirrored)) ==
          Approx(area(x, min_weight_triangulation(x, rim))).epsilon(4 * tie));  // which of such is taken may differ
  }
}

TEST_CASE("rounding does not choose among rough fills where vertices of a rim lie on a line") {
  // a part of a box's face: faces lie beyond five of its edges, those along the line are a crease's, and one more is sharp
  Points x(8, 3);
  x << -1, 1, 3, 0, 1, 3, 0, 1, 2, 0, 1, 1, -1, 1, 2, -2, 1, 2, -2, 1, 3, -1.52, 1, 3;
  x /= 3;
  RimSurroundings rim;
  rim.normals = Points::Zero(8, 3);
  rim.normals.middleRows(1, 5).col(1).setOnes();
  const RoughFill fill = min_weight_triangulation(x, rim);
  for (int k = 0; k < 200; ++k) {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.1 * k, Vec3(std::cos(k), std::sin(k), 1).normalized()).toRotationMatrix();
    RimSurroundings turned = rim;
    turned.normals = rim.normals * turn.transpose();
    CHECK(min_weight_triangulation(x * turn.transpose(), turned).triangles == fill.triangles);
  }
  for (const auto& t : fill.triangles)
    CHECK(Vec3(x.row(t[1]) - x.row(t[0])).cross(Vec3(x.row(t[2]) - x.row(t[0]))).norm() > 1e-3);
}

TEST_CASE("a rim of 10,000 vertices is filled roughly") {
  std::mt19937 random(3);
  Points x = ring(10'000, 100, 0, 20);
  for (int k = 0; k < x.rows(); ++k) x.row(k) *= 1 + 1e-4 * static_cast<double>(random() % 1000) / 1000;
  const RoughFill fill = min_weight_triangulation(x);
  CHECK(flaw(fill, 10'000) == "");
  CHECK(area(x, fill) < 1.2 * std::numbers::pi * 1e4);
}

namespace {

/// The rim of the squares of a plane grid within a circle, whose faces beyond lean by that angle.
struct Staircase {
  Points points;
  RimSurroundings around;
  double area = 0;

  explicit Staircase(double radius, double leaning = 0) {
    const auto filled = [&](int x, int y) { return std::hypot(x + 0.5, y + 0.5) < radius; };
    std::vector<Vec3> all;
    std::array<int, 2> at = {0, 0}, way = {1, 0};
    while (filled(at[0], at[1] - 1)) --at[1];
    const std::array<int, 2> first = at;
    do {  // the squares on the left
      all.emplace_back(at[0], at[1], 0);
      at = {at[0] + way[0], at[1] + way[1]};
      const auto square = [&](int left) {
        const std::array<int, 2> a = way, b = {-left * way[1], left * way[0]};
        return filled(at[0] + (a[0] + b[0] - 1) / 2, at[1] + (a[1] + b[1] - 1) / 2);
      };
      if (square(-1))
        way = {way[1], -way[0]};
      else if (!square(1))
        way = {-way[1], way[0]};
    } while (at != first);
    const Index r = static_cast<Index>(all.size());
    points.resize(r, 3);
    around.normals.resize(r, 3);
    for (Index k = 0; k < r; ++k) {
      const Vec3 edge = all[(k + 1) % r] - all[k];
      points.row(k) = all[k];
      around.normals.row(k) = Vec3(std::cos(leaning) * Vec3::UnitZ() + std::sin(leaning) * edge.cross(Vec3::UnitZ()));
      area += 0.5 * all[k].cross(all[(k + 1) % r]).z();
    }
  }
};

int flipped(const Staircase& rim) {
  int count = 0;
  for (const auto& t : min_weight_triangulation(rim.points, rim.around).triangles) {
    const Vec3 a = rim.points.row(t[0]), b = rim.points.row(t[1]), c = rim.points.row(t[2]);
    count += (b - a).cross(c - a).z() < 0;
  }
  return count;
}

}  // namespace

TEST_CASE("the rim of squares that were cut out of a grid is covered once, however long") {
  for (double radius : {12.0, 31.0, 80.0, 200.0}) {
    const Staircase rim(radius);
    const RoughFill fill = min_weight_triangulation(rim.points, rim.around);
    CHECK(flaw(fill, rim.points.rows()) == "");
    CHECK(flipped(rim) == 0);
    CHECK(area(rim.points, fill) == Approx(rim.area).epsilon(1e-12));
  }
}

TEST_CASE("triangles of a jagged rim do not go through each other") {
  // of these rims the triangles with the least worst angle do in 5%
  std::mt19937 random(3);
  std::uniform_real_distribution<double> turn(0, 2 * std::numbers::pi), radius(0.3, 1);
  std::normal_distribution<double> height(0, 0.6);
  for (int round = 0; round < 200; ++round) {
    const int n = 6 + round % 10;
    std::vector<double> turns;
    for (int k = 0; k < n; ++k) turns.push_back(turn(random));
    std::sort(turns.begin(), turns.end());
    Points points(n, 3);
    for (int k = 0; k < n; ++k) {
      const double r = radius(random);
      points.row(k) << r * std::cos(turns[k]), r * std::sin(turns[k]), height(random);
    }
    const RoughFill fill = min_weight_triangulation(points);
    CHECK(flaw(fill, n).empty());
    CHECK_FALSE(crosses_itself(points, fill.triangles));
  }
}

namespace {

/// A triangle in the plane z = 0, and below it at (x, 0.25) one end of a line's edge that stands upright.
Points pierced(double x, double below) {
  Points points(6, 3);
  points << 0, 0, 0, 1, 0, 0, 0, 1, 0, x, 0.25, -below, x, 0.25, 1, 2, 2, 1;
  return points;
}

bool goes_through(const Points& points) { return ClosedLine(points, {0, 1, 2, 3, 4, 5}).goes_through({0, 1, 2}); }

}  // namespace

TEST_CASE("an edge of a closed line goes through a triangle within it, beyond what touches") {
  const double longest = std::sqrt(2.0);
  for (double scale : {1e-9, 1.0, 1e9}) {
    CHECK(goes_through(scale * pierced(0.25, 0.5)));
    CHECK(goes_through(scale * pierced(0.25, 1.1e-6 * longest)));
    CHECK_FALSE(goes_through(scale * pierced(0.25, 0.9e-6 * longest)));
    CHECK_FALSE(goes_through(scale * pierced(0.25, -0.5)));  // ends above it
    CHECK_FALSE(goes_through(scale * pierced(0.8, 0.5)));    // passes it
    CHECK(goes_through(scale * pierced(1.1e-6 * longest, 0.5)));
    CHECK_FALSE(goes_through(scale * pierced(0.9e-6 * longest, 0.5)));
  }
  const ClosedLine line(pierced(0.25, 0.5), {3, 0, 1, 2, 5, 4});
  CHECK(line.goes_through({0, 1, 2}));        // by the last edge, from 4 to 3
  CHECK(line.goes_through({2, 1, 0}));        // seen from behind
  CHECK_FALSE(line.goes_through({0, 1, 3}));  // which has an end of it
  CHECK_FALSE(line.goes_through({0, 0, 1}));  // no triangle
}

TEST_CASE("triangles of rims that come close to themselves do not go through each other, nor the rim through them") {
  // of these rims the triangles with the least worst angle nearly all do, and most others do too
  std::mt19937 random(5);
  std::uniform_real_distribution<double> turn(0, 2 * std::numbers::pi), radius(0.3, 1);
  std::normal_distribution<double> height(0, 0.6);
  for (int round = 0; round < 40; ++round) {
    const int n = 40 + 4 * (round % 20);
    std::vector<double> turns;
    for (int k = 0; k < n; ++k) turns.push_back(turn(random));
    std::sort(turns.begin(), turns.end());
    Points points(n, 3);
    std::vector<Index> vertices;
    for (int k = 0; k < n; ++k) {
      const double r = radius(random);
      points.row(k) << r * std::cos(turns[k]), r * std::sin(turns[k]), height(random);
      vertices.push_back(k);
    }
    const RoughFill fill = min_weight_triangulation(points);
    CHECK(flaw(fill, n).empty());
    CHECK_FALSE(crosses_itself(points, fill.triangles));
    const ClosedLine line(points, vertices);
    CHECK(std::none_of(fill.triangles.begin(), fill.triangles.end(), [&](const auto& t) { return line.goes_through(t); }));
  }
}
