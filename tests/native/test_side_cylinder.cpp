// Planes of sides whose faces have their vertices on a cylinder, and on both sides of what decides whether they have.
#include <catch2/catch.hpp>
#include <cmath>

#include "test_drafts.h"
#include "tripatch/estimate/side_cylinder.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

constexpr double radius = 5;

/// Next to side 2 the sheet is bent about the y axis, outwards up; the side is moved along it by so much times the square of the place, and
/// faces lie the more askew the farther along they are.
struct Bent {
  explicit Bent(int edges, double slant, double depth = 10, double askew = 0) : flat(edges) {
    for (Vec3& p : flat.w.position) {
      const double angle = (p[0] + askew * p[0] * p[1]) / radius, along = p[1] + (p[1] > -0.5 ? slant * p[0] * p[0] : 0);
      p = Vec3(radius * std::sin(angle), along, radius * std::cos(angle) - radius);
    }
    flat.side().depth = depth;
    fit.slope_variances.assign(flat.side().vertex.size(), 1.0);
    flat.side().normal = flat.side().faces;
    flat.side().second.assign(flat.side().vertex.size(), Eigen::Matrix3d::Zero());
    for (std::size_t k = 0; k < flat.side().vertex.size(); ++k) flat.side().position[k] = flat.w.position[flat.side().vertex[k]];
    fit.bend_variance = 1;
  }
  bool taken() {
    for (std::size_t f = 0; f < flat.w.area.size(); ++f) {
      const std::span<const int> face = flat.w.part[static_cast<int>(f)];
      const auto at = [&](int c) { return flat.w.position[face[c]]; };
      flat.w.area[f] = (at(2) - at(0)).cross(at(3) - at(1));
    }
    take_cylinder(flat.w, fit, flat.side());
    return fit.slope_variances[1] < 1;
  }
  FlatDrafts flat;
  SideFit fit;
};

}  // namespace

TEST_CASE("planes and curvature of a side that runs aslant on a cylinder are the cylinder's") {
  Bent bent(6, 0.1);
  REQUIRE(bent.taken());
  const SideDraft& side = bent.flat.side();
  for (int k = 0; k <= 6; ++k) {
    const Vec3 normal(std::sin(k / radius), 0, std::cos(k / radius)), around(std::cos(k / radius), 0, -std::sin(k / radius));
    CHECK((side.normal[k] - normal).norm() < 1e-9);
    CHECK(std::abs(around.dot(side.second[k] * around) + 1 / radius) < 1e-9);
    CHECK(side.second[k].col(1).norm() < 1e-9);
  }
  CHECK(bent.fit.turned == 0);
  CHECK(std::sqrt(bent.fit.slope_variances[3]) < 1e-4);
}

TEST_CASE("a side that is known is left as it is") {
  Bent bent(6, 0.1);
  bent.fit.slope_variances.assign(7, std::pow(0.9 * well_known, 2));
  bent.taken();
  CHECK(bent.flat.side().normal[3] == Vec3::UnitZ());
}

namespace {

/// Rows of squares around an axis, as long as they are wide, with their profile on a circle from so many edges outside the side
/// on. The profile is tangent to the straight line before it, or, from half an edge on, to a row whose two circles are as large.
Bent behind(double straight, double profile) {
  Bent bent(6, 0, 1);
  const double step = 2 * std::asin(0.5 / profile);
  for (Vec3& p : bent.flat.w.position) {
    const double angle = std::atan2(p[0], p[2] + radius), outside = std::max(-p[1] - straight, 0.0) * step;
    const double up = profile * (std::cos(outside) - 1),
                 along = p[1] < -straight ? -straight - profile * std::sin(outside) : p[1];
    p = Vec3((radius + up) * std::sin(angle), along, (radius + up) * std::cos(angle) - radius);
  }
  bent.fit.slope_variances.assign(7, std::pow(0.9 * well_known, 2));
  return bent;
}

double off_cylinder(Bent bent) {
  bent.taken();
  double most = 0;
  for (int k = 0; k <= 6; ++k)
    most = std::max(most, (bent.flat.side().normal[k] - Vec3(std::sin(k / radius), 0, std::cos(k / radius))).norm());
  return most;
}

}  // namespace

TEST_CASE(
    "a strip as deep as its edges are long is a cylinder where what lies behind it begins to bend there, whatever fits say") {
  CHECK(off_cylinder(behind(1, 10)) < 1e-12);
  CHECK(off_cylinder(behind(1, -10)) < 1e-12);
}

TEST_CASE("a row between two equal circles of a surface that bends on is no cylinder") {
  CHECK(off_cylinder(behind(0.5, 10)) > 0.01);
  CHECK(off_cylinder(behind(7, 10)) > 0.01);  // nor where nothing says whether it bends
}

TEST_CASE("planes beside a cylinder are exact whose faces lie askew on it, to where Gauss-Newton ends") {
  Bent bent(6, 0.1, 10, 0.3);
  REQUIRE(bent.taken());
  for (int k = 0; k <= 6; ++k)
    CHECK((bent.flat.side().normal[k] - Vec3(std::sin(k / radius), 0, std::cos(k / radius))).norm() < 1e-14);
}
