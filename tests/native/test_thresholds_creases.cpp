// How creases are followed among others and where they meet, on both sides of each threshold.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_rings.h"
#include "tripatch/hole/rim_shape.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

constexpr double one_degree = std::numbers::pi / 180;

/// A roof over a surface that bends by `curved` in all directions.
Rings over_bowl(double degrees, double curved, double length = 10) {
  return Rings(radii(0.1, 9), [=](double x, double y) {
    const double ring = (std::hypot(x, y) - 0.5) / 0.1, share = std::clamp(length / 0.1 + 0.5 - ring, 0.0, 1.0);
    Vec3 p = roof(x, y, share * degrees / 2);
    p[2] -= curved * (x * x + y * y) / 2;
    return p;
  });
}

/// Degrees that three quarters of the edges looked at stay below.
double ordinary(const Rings& rings) {
  const Mesh mesh = rings.mesh();
  const Connectivity around(mesh);
  const std::vector<Index> vertices = rings.features().vertices;
  std::vector<double> all;
  for (Index v : vertices)
    for (Connectivity::Corner c : around.at(v)) {
      const Index w = around.next(c);
      const auto across = around.edge(w, v);
      if (!across || (v > w && std::binary_search(vertices.begin(), vertices.end(), w))) continue;
      all.push_back(degrees_between(area_vector(mesh, around.face(c)), area_vector(mesh, around.face(*across))));
    }
  std::sort(all.begin(), all.end());
  return all[3 * (all.size() - 1) / 4];
}

/// Where a crease is found that is none below, between two values of what it is made from.
template <class F>
double first_found(double low, double high, const F& made) {
  REQUIRE(made(low).features().creases.empty());
  REQUIRE_FALSE(made(high).features().creases.empty());
  while (std::abs(high - low) > 1e-4 * std::abs(high)) {
    const double middle = (low + high) / 2;
    (made(middle).features().creases.empty() ? low : high) = middle;
  }
  return high;
}

/// Three ridges that go up to one point above the hole, in such directions (degrees), shifted sideways.
Rings pyramid(const std::array<double, 3>& directions, const std::array<double, 3>& slopes, double shift = 0) {
  return Rings(radii(0.1, 8), [=](double x, double y) {
    const double r = std::hypot(x, y);
    double place = std::atan2(y, x) / (2 * std::numbers::pi) * 24;  // spokes 0, 12 and 18 are the ridges
    if (place < -1e-9) place += 24;
    const std::array<double, 4> spokes = {0, 12, 18, 24};
    int k = 0;
    while (k < 2 && place > spokes[k + 1] + 1e-9) ++k;
    const double from = directions[k], to = k < 2 ? directions[k + 1] : directions[0] + 360;
    const double share = (place - spokes[k]) / (spokes[k + 1] - spokes[k]), angle = (from + share * (to - from)) * one_degree;
    // the plane through both ridges
    const auto ridge = [&](int i) {
      return Vec3(std::cos(directions[i] * one_degree), std::sin(directions[i] * one_degree), -slopes[i]);
    };
    const Vec3 normal = ridge(k).cross(ridge((k + 1) % 3)), d(std::cos(angle), std::sin(angle), 0);
    return Vec3(r * d[0] - shift * d[1], r * d[1] + shift * d[0], -r * normal.dot(d) / normal[2]);
  });
}

}  // namespace

TEST_CASE("a crease bends three times as much as three quarters of the edges around", "[thresholds]") {
  const auto made = [](double degrees) { return over_bowl(degrees, 1.2); };
  const double found = first_found(5, 100, made);
  const double usual = ordinary(made(found));
  REQUIRE(3 * usual > 26);
  double least = 180;  // as long as it has to be, half of the hole
  for (Index j = 0; j < 5; ++j) least = std::min(least, made(found).bend(j));
  CHECK(least == Approx(3 * usual).epsilon(0.02));
}

TEST_CASE("where edges turn by five degrees a crease is not followed below 25, and half of the hole long if it ends",
          "[thresholds]") {
  // sharp at the rim, then less
  const auto blunt = [](double curved) {
    return Rings(radii(0.1, 9), [=](double x, double y) {
      const double ring = (std::hypot(x, y) - 0.5) / 0.1;
      Vec3 p = roof(x, y, ring < 1.5 ? 16 : 9);
      p[2] -= curved * (x * x + y * y) / 2;
      return p;
    });
  };
  const double curved = first_found(1.5, 0.1, blunt);
  CHECK(ordinary(blunt(curved)) == Approx(5).epsilon(0.03));
  for (const double length : {0.4, 0.6}) CHECK(over_bowl(60, 0.8, length).features().creases.size() == (length < 0.5 ? 0 : 1));
}

TEST_CASE("two creases go straight on up to 50 degrees, beyond that they meet a third at a point", "[thresholds]") {
  for (const double turn : {49.0, 51.0}) {
    const Features found = pyramid({0, 180 - turn, 270 - turn / 2}, {0, 0, 1}).features();
    REQUIRE(found.creases.size() == 1);
    CHECK(found.creases[0].ends.size() == (turn < 50 ? 2 : 3));
  }
}

TEST_CASE("creases meet at a point whose lines pass it within 0.15 of the diameter", "[thresholds]") {
  for (const double share : {0.145, 0.155}) {
    const auto made = [](double shift) { return pyramid({0, 120, 240}, {0.8, 0.8, 0.8}, shift); };
    double shift = 0;
    for (int k = 0; k < 30; ++k) shift = share * diameter(made(shift).mesh(), made(shift).rim);
    const Features found = made(shift).features();
    const bool met = std::any_of(found.creases.begin(), found.creases.end(), [](const Crease& c) { return c.ends.size() == 3; });
    CHECK(met == (share < 0.15));
  }
}

TEST_CASE("three creases meet at a point where their lines spread by two and a half degrees, nearly parallel ones nowhere",
          "[thresholds]") {
  // of a wedge upon a plane, so many degrees wide, which comes to its point in the middle of the hole
  const auto wedge = [](double degrees) {
    return Rings(radii(0.1, 8), [=](double x, double y) {
      const double r = std::hypot(x, y), spoke = std::atan2(y, x) / (std::numbers::pi / 12), half = degrees / 2 * one_degree;
      const double angle = std::abs(spoke) < 1
                               ? spoke * half
                               : std::copysign(half + (std::abs(spoke) - 1) / 11 * (std::numbers::pi - half), spoke);
      return Vec3(r * std::cos(angle), r * std::sin(angle),
                  std::abs(spoke) < 0.5 ? r * std::tan(half) * std::tan(std::numbers::pi / 6) : 0);
    });
  };
  for (const double degrees : {2.5, 2.55, 2.6, 2.65}) {
    const Rings rings = wedge(degrees);
    Eigen::Matrix3d across = Eigen::Matrix3d::Zero();  // the sum of the projections along its three edges
    for (const Index k : {23, 0, 1}) {
      const Vec3 along = rings.vertices.row(k).normalized();
      across += Eigen::Matrix3d::Identity() - along * along.transpose();
    }
    const Features found = rings.features();
    CAPTURE(degrees, across.determinant());
    CHECK((found.creases.size() == 1 && found.creases[0].ends.size() == 3) == (across.determinant() > 0.01));
  }
}

TEST_CASE("surroundings are looked at over forty rings for creases", "[thresholds]") {
  const Features found = Rings(radii(0.01, 60), [](double x, double y) { return roof(x, y, 30); }).features();
  REQUIRE(found.creases.size() == 1);
  CHECK(found.creases[0].ends[0].chain.size() == 42);  // the last edge leads out of them
}

namespace {

/// Whether the rim itself is taken for the crease from vertex 0 to vertex 1. The crease turns by so many degrees behind its first edge,
/// which is level, and the rim's edge by others against that.
bool goes_on(double turn, double at_rim) {
  Rings rings(radii(0.1, 8), [=](double x, double y) {
    Vec3 p = roof(x, y, 30);
    p[2] -= std::max(std::abs(x) - 0.6, 0.0) * std::tan(turn * one_degree);
    return p;
  });
  const double angle = at_rim * one_degree, lean = 30 * one_degree;  // in the plane of the face to the left
  const Eigen::RowVector3d across(0, std::cos(lean), -std::sin(lean));
  rings.vertices.row(1) =
      rings.vertices.row(0) + 0.1 * (std::sin(angle) * across - std::cos(angle) * Eigen::RowVector3d::UnitX());
  const Features found = rings.features();
  REQUIRE_FALSE(found.creases.empty());
  for (const Crease& crease : found.creases)
    for (const CreaseEnd& end : crease.ends)
      if (end.chain[0] == 1 && end.chain[1] == 0) return true;
  return false;
}

}  // namespace

TEST_CASE("the rim goes on along a crease within three degrees of its faces", "[thresholds]") {
  // 60 degrees lie between them
  const double most = std::asin(std::sin(3 * one_degree) / std::sin(60 * one_degree)) / one_degree;
  CHECK(goes_on(0, 0.98 * most));
  CHECK_FALSE(goes_on(0, 1.02 * most));
}

TEST_CASE("or half as much again as the crease's own edges leave theirs, and within 25 degrees of it", "[thresholds]") {
  const auto rim_turn = [](double turn) { return std::asin(1.5 * std::sin(turn * one_degree)) / one_degree; };
  CHECK(goes_on(8, rim_turn(7.8)));
  CHECK_FALSE(goes_on(8, rim_turn(8.6)));
  CHECK(goes_on(20, 25.5));
  CHECK_FALSE(goes_on(20, 26.2));
}
