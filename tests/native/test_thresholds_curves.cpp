// What decides about curves of sides and slopes across them, on both sides of each threshold.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/boundary/side_curves.h"

using namespace tripatch;

namespace {

constexpr double one_degree = std::numbers::pi / 180;

PiecewisePolynomial curve(const std::vector<Vec3>& net) {
  std::vector<double> flat;
  for (const Vec3& p : net) flat.insert(flat.end(), p.begin(), p.end());
  return PiecewisePolynomial::bezier(flat, 3);
}

/// Sides in one plane that turn by so many degrees at corner 0, with tangents of such a length there.
Sides turning(double degrees, double tangent) {
  const double a = degrees * one_degree;
  const Vec3 at = Vec3::Zero(), next(1, 1, 0), before(-1, 1, 0), in = tangent * Vec3::UnitX(),
             out = tangent * Vec3(std::cos(a), std::sin(a), 0);
  Sides sides;
  sides[1].c = curve({before, at - in / 2, at});
  sides[2].c = curve({at, at + out / 2, next});
  sides[0].c = curve({next, before});
  for (Side& side : sides) {
    const Vec3 r0 = side.c.derivative_at(0).cross(Vec3::UnitZ()).normalized(),
               r1 = side.c.derivative_at(1).cross(Vec3::UnitZ()).normalized();
    side.r = curve({r0, r1});
  }
  return sides;
}

/// A side of one edge or more along x in the plane z = 0.
SideDraft straight(double from, double to, int edges) {
  SideDraft side;
  for (int k = 0; k <= edges; ++k) {
    side.vertex.push_back(k);
    side.t.push_back(static_cast<double>(k) / edges);
    side.position.emplace_back(from + (to - from) * side.t.back(), 0, 0);
    side.normal.push_back(Vec3::UnitZ());
    side.second.push_back(Eigen::Matrix3d::Zero());
  }
  side.point = side.position;
  side.length = std::abs(to - from);
  return side;
}

}  // namespace

TEST_CASE("two tangents span the plane of a corner from two degrees between them on", "[thresholds]") {
  for (const double sine : {0.0345, 0.0355}) {
    const Vec3 along(std::sqrt(1 - sine * sine), 0.5 * sine, std::sqrt(0.75) * sine), across = Vec3::UnitX().cross(along);
    std::vector<Side> sides(3);
    const Vec3 next(1, 0.5, 0), before(-1, 0.5, 0);
    sides[0].c = curve({before, Vec3(-0.5, 0, 0), Vec3::Zero()});
    sides[1].c = curve({Vec3::Zero(), 0.5 * along, next});
    sides[2].c = curve({next, before});
    for (Side& side : sides) side.r = curve({Vec3::UnitZ(), Vec3::UnitZ()});
    const Vec3 normal = planes_from_rim(sides, {false, false, false})[1].normal(0);
    CHECK((normal.cross(across.normalized()).norm() < 1e-9) == (sine > 0.035));
  }
}

TEST_CASE("a slope across is none below 1e-10 of the patch's height, and a tangent has no direction below 1e-12",
          "[thresholds]") {
  const Vec3 tau(1, 1, 0);
  for (const double part : {0.9e-10, 1.1e-10})
    CHECK((corner_slope(part * 2 * Vec3::UnitX(), Vec3::UnitY(), tau, 2, 0).alpha > 0) == (part > 1e-10));
  for (const double part : {0.9e-12, 1.1e-12}) {  // along tau: what is across it is nothing of tau
    const CornerSlope slope = corner_slope(Vec3::UnitX(), part * 2 * Vec3(1, 1, 0) / std::sqrt(2.0), tau, 2, 0);
    CHECK((slope.alpha < 0.5) == (part > 1e-12));
  }
}

TEST_CASE("corners where the rim turns by five degrees take all of the floor, from 25 on none", "[thresholds]") {
  CHECK(floor_share(4.9) == 1);
  CHECK(floor_share(5.5) < 1);
  CHECK(floor_share(24.5) > 0);
  CHECK(floor_share(25.1) == 0);
}

TEST_CASE("a corner that turns back by 179 degrees turns either way and counts as convex", "[thresholds]") {
  for (const double degrees : {90.0, 178.9, 179.1})
    CHECK(make_boundary(turning(-degrees, 1)).turn_deg[0] == Approx(degrees < 179 ? -degrees : degrees));
}

TEST_CASE("and all of it where the tangents span a tenth of what the chords do, from 0.4 on none", "[thresholds]") {
  for (const double opening : {0.095, 0.12, 0.395, 0.405}) {
    const double sine = std::sin(4 * one_degree), chords = 2;  // of (1, 1) and (1, -1)
    const Sides sides = turning(4, std::sqrt(opening * chords / sine));
    const Boundary boundary = make_boundary(sides);
    REQUIRE(boundary.turn_deg[0] == Approx(4));
    CHECK((boundary.inward[0].norm() > 0) == (opening < 0.4));
    double length = 0, alpha = 0;
    for (const Side& side : sides) length += arc_length(side.c) / 3;
    const Vec3 c0 = sides[2].c.derivative_at(0), tau = sides[1].c.derivative_at(1) + 0.5 * c0;
    boundary.ribbons[2].alpha.taylor(0, 0, &alpha);
    const double whole = corner_slope(sides[2].r(0), c0, tau, std::sqrt(0.75) * length, 1).alpha;
    CHECK((std::abs(alpha - whole) < 1e-9 * whole) == (opening < 0.1));
  }
}

TEST_CASE("a cross derivative leads across the rim by 0.3 of itself", "[thresholds]") {
  // three sides on one line: what their ends would lead to is all along it
  const std::array<SideDraft, 3> drafts = {straight(3, -3, 1), straight(-3, 0, 1), straight(0, 3, 1)};
  const Vec3 r = side_curves(drafts, 1, 0)[2].r(0);
  CHECK(r[0] / -r[1] == Approx(1 / 0.3));
}

TEST_CASE("a rim is a graph over a plane where no normal is farther than 84 degrees from their mean", "[thresholds]") {
  // Two normals of side 2 lean. Over a graph what is read at the others does not depend on that, else it is carried along the side.
  const auto across = [](double cosine) {
    const std::array<Vec3, 3> corner = {Vec3(2, 3, 0), Vec3(0, 0, 0), Vec3(4, 0, 0)};
    std::array<SideDraft, 3> drafts = {straight(0, 1, 8), straight(0, 1, 8), straight(0, 1, 8)};
    Vec3 up = Vec3::Zero();
    drafts[2].normal[5] = Vec3(std::sin(0.3), 0, std::cos(0.3));
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k <= 8; ++k) {
        const Vec3 a = corner[(i + 2) % 3], b = corner[i];
        drafts[i].position[k] = drafts[i].point[k] = a + drafts[i].t[k] * (b - a);
        if (i != 2 || k != 4) up += drafts[i].normal[k];
      }
    const auto normal = [](double a) { return Vec3(0, std::sin(a), std::cos(a)); };
    double low = 0, high = std::numbers::pi;
    for (int k = 0; k < 60; ++k) {
      const double a = (low + high) / 2;
      (normal(a).dot((up + normal(a)).normalized()) > cosine ? low : high) = a;
    }
    drafts[2].normal[4] = normal(low);
    return Vec3(side_curves(drafts, 1, 0)[2].r(0.75));
  };
  CHECK((across(0.101) - across(0.5)).norm() < 1e-9);
  CHECK((across(0.09) - across(0.5)).norm() > 1e-6);
}

TEST_CASE("a curve through noisy vertices bends against the noise 0.9 times as much, and half of 1.9 where noise makes its bend",
          "[thresholds]") {
  const auto bend = [](double noise) {
    std::array<SideDraft, 3> drafts = {straight(3, -3, 1), straight(-3, 0, 1), straight(0, 3, 8)};
    for (int k = 0; k <= 8; ++k) drafts[2].position[k][2] = drafts[2].point[k][2] = k % 2 ? 0.01 : -0.01;
    return side_curves(drafts, 1, noise)[2].c.derivative_at(0.375, 2)[2];
  };
  const double h = 1.0 / 8, natural = -12 * 0.01 / (h * h);  // of the two Hermite pieces, flat at their ends
  CHECK(std::abs(bend(0)) < 1e-9);                           // the surface does not bend
  CHECK(bend(1e6) == Approx(1.9 * natural).epsilon(1e-6));
  CHECK(bend(std::pow(natural * h * h / 15, 2)) == Approx(0.95 * natural));
}

TEST_CASE("a side that is not continued turns over sixteen places, and the length of a curve is that of 32 chords",
          "[thresholds]") {
  std::vector<Side> sides(3);
  sides[0].c = curve({Vec3(1, 0, 0), Vec3(0, 1, 0)});
  sides[1].c = curve({Vec3(0, 1, 0), Vec3(0, 0, 1)});
  sides[2].c = curve({Vec3(0, 0, 1), Vec3(1, 0, 0)});
  for (Side& side : sides) side.r = curve({Vec3::UnitZ(), Vec3::UnitZ()});
  CHECK(planes_from_rim(sides, {false, false, false})[1].r.pieces() == 16);
  const PiecewisePolynomial quarter = PiecewisePolynomial::fit(
      [](std::span<const double> t, std::span<double> out) {
        for (std::size_t k = 0; k < t.size(); ++k)
          Vec3::Map(&out[3 * k]) = Vec3(std::cos(t[k] * std::numbers::pi / 2), std::sin(t[k] * std::numbers::pi / 2), 0);
      },
      3);
  CHECK(arc_length(quarter) == Approx(64 * std::sin(std::numbers::pi / 128)).epsilon(1e-9));
}
