// The polynomial under the surroundings, on which samples get their parameters.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tripatch/spline/base_surface.h"

using namespace tripatch;

namespace {

PlanePoints some_places(Index n) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PlanePoints at(n, 2);
  for (Index k = 0; k < n; ++k) at.row(k) << uniform(random), uniform(random);
  return at;
}

/// A graph of degree 6 over the plane.
Vec3 sextic(double x, double y) { return {x, y, 0.2 * std::pow(x, 6) - 0.3 * std::pow(x, 3) * std::pow(y, 3) + 0.1 * x * y}; }

Points sextic_over(const PlanePoints& at) {
  Points out(at.rows(), 3);
  for (Index k = 0; k < at.rows(); ++k) out.row(k) = sextic(at(k, 0), at(k, 1));
  return out;
}

}  // namespace

TEST_CASE("a reference is a polynomial of its degree itself, and a lower degree says how much it leaves") {
  const PlanePoints at = some_places(120);
  const Points samples = sextic_over(at);
  CHECK(BaseSurface(at, samples, 6).distance_across() < 1e-13);
  const double left = BaseSurface(at, samples, 4).distance_across();
  CHECK(left > 1e-3);
  CHECK(left < 0.1);
}

TEST_CASE("a reference of a strip a thousand times as long as wide, in any direction, leaves no more than of a square") {
  const PlanePoints at = some_places(120);
  const Points samples = sextic_over(at);
  for (const double turn : {0.0, 0.3, 1.2}) {
    Eigen::Matrix2d strip;
    strip << std::cos(turn), std::sin(turn), -1e-3 * std::sin(turn), 1e-3 * std::cos(turn);
    const PlanePoints narrow = at * strip;
    const BaseSurface reference(narrow, samples, 6);
    CHECK(reference.distance_across() < 1e-12);
    CHECK(((reference.foot_points(narrow, samples) - narrow) * strip.inverse()).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("a sample above a reference has its foot where the normal through it starts") {
  const PlanePoints at = some_places(120);
  const BaseSurface reference(at, sextic_over(at), 6);
  const double h = 1e-6;
  Points above(at.rows(), 3);
  for (Index k = 0; k < at.rows(); ++k) {
    const Vec3 u = (sextic(at(k, 0) + h, at(k, 1)) - sextic(at(k, 0) - h, at(k, 1))) / (2 * h);
    const Vec3 v = (sextic(at(k, 0), at(k, 1) + h) - sextic(at(k, 0), at(k, 1) - h)) / (2 * h);
    above.row(k) = sextic(at(k, 0), at(k, 1)) + 0.02 * u.cross(v).normalized();
  }
  PlanePoints start = at;
  start.col(0).array() += 0.03;
  CHECK((reference.foot_points(start, above) - at).cwiseAbs().maxCoeff() < 1e-8);
}
