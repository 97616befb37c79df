// Which of a patch and a spline is the nearer one, on both sides of each threshold.
#include <catch2/catch.hpp>

#include "test_surfaces.h"
#include "tripatch/fill/automatic_fill.h"
#include "tripatch/fill/polygon_fill.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// A spline over a plane that states to be so well known, and a patch that lies so far above it.
struct Two {
  Fill patch, spline;
  Two(double apart, double said) {
    constexpr Index n = 25;
    spline.patch = formula_surface([](const auto& b) {
      using J = std::decay_t<decltype(b[0])>;
      JetPoint<J::order> p;
      p.x = {b[0], b[1], J(0.0)};
      return p;
    });
    spline.uv = PlanePoints(n, 2);
    spline.vertices = patch.vertices = Points::Zero(n, 3);
    for (Index k = 0; k < n; ++k) {
      const Index row = k / 5;
      const Vec2 at(0.2 * static_cast<double>(k % 5), 0.2 * static_cast<double>(row));
      spline.uv.row(k) = at;
      spline.vertices.row(k).head<2>() = at;
      patch.vertices.row(k) << at[0] + 0.01, at[1], apart;
    }
    spline.deviation = Eigen::VectorXd::Constant(n, said);
  }
  bool spline_taken(double diameter = 1) const { return excluded_by(patch, spline, diameter); }
  /// missed: by the spline, of the planes along the rim; known: to so much by the patch. Degrees.
  bool spline_taken_for(double missed, double known) {
    spline.report.surroundings_error = missed;
    patch.report.surroundings_error = known;
    return spline_taken();
  }
};

}  // namespace

TEST_CASE("a patch is excluded that lies four standard deviations from the spline", "[thresholds]") {
  CHECK_FALSE(Two(0.0398, 0.01).spline_taken());
  CHECK(Two(0.0402, 0.01).spline_taken());
}

TEST_CASE("a patch whose energy tells of a thousandth of the diameter is excluded by half a deviation", "[thresholds]") {
  const double diameter = 2, said = 0.01;
  for (const double apart : {0.0049, 0.0051, 0.03}) {
    Two two(apart, said);
    two.patch.report.energy_after = 0.99 * said / (1e-3 * diameter);
    CHECK_FALSE(two.spline_taken(diameter));
    two.patch.report.energy_after = 1.01 * said / (1e-3 * diameter);
    CHECK(two.spline_taken(diameter) == (apart > 0.005));
  }
}

TEST_CASE("a spline excludes no patch whose planes it misses by half a degree, where they are known twenty times better",
          "[thresholds]") {
  Two two(1, 0.01);
  const auto taken = [&](double missed, double known) { return two.spline_taken_for(missed, known); };
  CHECK(taken(0.49, 0.02));
  CHECK_FALSE(taken(0.51, 0.02));
  CHECK(taken(2, 0.101));
  CHECK_FALSE(taken(2, 0.099));
}

TEST_CASE("nor one whose planes it misses by a hundredth of a degree, where they are known a thousand times better",
          "[thresholds]") {
  Two two(1, 0.01);
  const auto taken = [&](double missed, double known) { return two.spline_taken_for(missed, known); };
  CHECK(taken(0.0099, 0));
  CHECK_FALSE(taken(0.0101, 0));
  CHECK(taken(0.1, 1.01e-4));
  CHECK_FALSE(taken(0.1, 0.99e-4));
}

TEST_CASE("a spline that misses planes by two degrees, known four times better and to one and a half, is made again with them",
          "[thresholds]") {
  Two two(0, 0.01);
  const auto kept = [&](double missed, double known) {
    two.spline.report.surroundings_error = missed;
    two.patch.report.surroundings_error = known;
    return keeps_better_planes(two.patch, two.spline);
  };
  CHECK_FALSE(kept(1.99, 0));
  CHECK(kept(2.01, 0));
  CHECK_FALSE(kept(4, 1.01));
  CHECK(kept(4, 0.99));
  CHECK_FALSE(kept(10, 1.51));
  CHECK(kept(10, 1.49));
}
