// What counts as a fold between n sides, and where energies tell nothing, on both sides of each threshold.
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "test_surfaces.h"
#include "tripatch/fairing/candidates.h"
#include "tripatch/polygon/fair.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

const PolygonDomain unit_square({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}});

/// The plane of (u, v), bent by an angle (degrees) along the line u = at.
class BentPlane final : public Surface {
public:
  BentPlane(double at, double degrees) : at_(at), turn_(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Vec3::UnitY())) {}
  void evaluate(const double* b, Index n, int order, double* out) const override {
    for (Index k = 0; k < n; ++k, b += 3, out += 3 * jet_size(order)) {
      const bool beyond = b[0] > at_;
      std::fill_n(out, 3 * jet_size(order), 0.0);
      Vec3::Map(out) = beyond ? Vec3(Vec3(at_, 0, 0) + turn_ * Vec3(b[0] - at_, b[1], 0)) : Vec3(b[0], b[1], 0);
      if (order < 1) continue;
      Vec3::Map(out + 3) = beyond ? Vec3(turn_ * Vec3::UnitX()) : Vec3(Vec3::UnitX());
      Vec3::Map(out + 6) = Vec3::UnitY();
    }
  }

private:
  double at_;
  Eigen::Matrix3d turn_;
};

/// The unit_square's sides in its plane, but that of side 1 turned about it at its beginning (degrees).
SideList square_sides(double tilt = 0) {
  SideList sides;
  for (int i = 0; i < 4; ++i) {
    const Vec2 p = unit_square.corner(i), q = unit_square.corner(i + 1), out = -unit_square.inward(i);
    const std::array<double, 6> c = {p[0], p[1], 0, q[0], q[1], 0};
    const Vec3 end(out[0], out[1], 0), axis = Vec3(q[0] - p[0], q[1] - p[1], 0).normalized(),
                                       start = Eigen::AngleAxisd((i == 1 ? tilt : 0) * std::numbers::pi / 180, axis) * end;
    const std::array<double, 6> r = {start[0], start[1], start[2], end[0], end[1], end[2]};
    sides.push_back({PiecewisePolynomial::bezier(c, 3), PiecewisePolynomial::bezier(r, 3), {}});
  }
  return sides;
}

Index folds(double at, double degrees, double tilt = 0) {
  return count_polygon_folds(BentPlane(at, degrees), unit_square, square_sides(tilt));
}

}  // namespace

TEST_CASE("over a polygon neighbors fold whose normals are 60 degrees apart, and points a right angle from the rim's",
          "[thresholds]") {
  CHECK(folds(0.3, 59.9) == 0);
  CHECK(folds(0.3, 60.1) > 10);
  const Index of_neighbors = folds(0.3, 89.9);
  CHECK(folds(0.3, 90.1) > of_neighbors + 50);
}

TEST_CASE("over a polygon neighbors are not compared beside a corner whose planes are a degree apart, within 0.15 of the radius",
          "[thresholds]") {
  // a line across the plane passes some corner regions: those of corners 1 and 2, of which only 1 has two planes
  const double radius = unit_square.radius();
  for (const double from_corner : {0.05, 0.3}) {
    const double at = 1 - from_corner * radius;
    CHECK(folds(at, 70, 0.9) == folds(at, 70));
    CHECK((folds(at, 70, 1.1) < folds(at, 70)) == (from_corner < 0.15));
  }
}

TEST_CASE("energies above 5,000 tell nothing of a surface, and above 20,000 where all sides' curvature is followed",
          "[thresholds]") {
  CHECK_FALSE(beyond_energies(4999, false));
  CHECK(beyond_energies(5001, false));
  CHECK_FALSE(beyond_energies(19999, true));
  CHECK(beyond_energies(20001, true));
}

TEST_CASE("a patch oscillates between nodes whose energy on all is a quarter above that on a few, if it is rich",
          "[thresholds]") {
  CHECK_FALSE(oscillates(2.49, 2, 1));
  CHECK(oscillates(2.51, 2, 1));
  CHECK_FALSE(oscillates(0.99, 0.1, 1));
  CHECK(oscillates(1.01, 0.1, 1));
}
