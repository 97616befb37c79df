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

namespace {

/// Over a grid from -1 to 1 the graph of a function, as the polynomial that it is.
template <class F>
BaseSurface over_square(const F& place, int degree) {
  PlanePoints at(121, 2);
  Points samples(121, 3);
  for (Index k = 0; k < 121; ++k) {
    const Index row = k / 11, column = k % 11;
    at.row(k) << static_cast<double>(row) / 5 - 1, static_cast<double>(column) / 5 - 1;
    samples.row(k) = place(at(k, 0), at(k, 1));
  }
  return {at, samples, degree};
}

/// Where a foot that starts at x on the u axis comes to.
double foot_from(const BaseSurface& reference, double x, const Vec3& sample) {
  PlanePoints start(1, 2);
  start << x, 0;
  return reference.foot_points(start, Points(sample.transpose()))(0, 0);
}

}  // namespace

TEST_CASE("feet between two leave the middle in eight doubling steps, slower within a fifth of where the surface bends as much",
          "[thresholds]") {
  const BaseSurface valley = over_square([](double x, double y) { return Vec3(x, y, x * x / 2); }, 2);
  for (const double above : {0.15, 0.19, 0.21, 0.5}) {  // the center of the circle that the valley is in the middle
    const double grows = above < 0.2 ? 1 + above / 0.2 : 2;
    CHECK(foot_from(valley, 1e-7, {0, 0, 1 + above}) == Approx(1e-7 * std::pow(grows, 8)).epsilon(1e-3));
  }
}

TEST_CASE("a sample that is thirty radii of curvature off on the inner side stays where it is", "[thresholds]") {
  const BaseSurface valley = over_square([](double x, double y) { return Vec3(x, y, x * x / 2); }, 2);
  CHECK(foot_from(valley, 1e-7, {0, 0, 29.9}) == Approx(1e-7 * 256).epsilon(1e-3));
  CHECK(foot_from(valley, 1e-7, {0, 0, 30.1}) == 1e-7);
  CHECK(std::abs(foot_from(valley, 1e-7, {0, 0, -30.1})) < 1e-12);
}

TEST_CASE("a foot goes by a tenth of the plane's extent at each of eight steps", "[thresholds]") {
  const BaseSurface plane = over_square([](double x, double y) { return Vec3(x, y, 0); }, 1);
  CHECK(foot_from(plane, -0.39, {0.4, 0, 0}) == Approx(0.4).epsilon(1e-12));
  CHECK(foot_from(plane, -0.41, {0.4, 0, 0}) == Approx(0.39).epsilon(1e-12));
}

TEST_CASE("a sample stays where it is where two tangents are one line to a millionth", "[thresholds]") {
  for (const double narrow : {0.99e-6, 1.01e-6}) {
    const BaseSurface strip = over_square([&](double x, double y) { return Vec3(x, narrow * y, 0); }, 1);
    CHECK(foot_from(strip, 0, {0.05, 0, 0}) == Approx(narrow < 1e-6 ? 0 : 0.05).margin(1e-6));
  }
}
