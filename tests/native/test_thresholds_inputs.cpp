// What is taken and what is refused, on both sides of each bound.
#include <cmath>
#include <numbers>

#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/boundary/bezier_rectangle.h"
#include "tripatch/constructions/coons_bezier.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/patch/bezier_triangle.h"
#include "tripatch/polygon/round.h"
#include "tripatch/smooth_triangles.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// A circle of radius 1 in the plane whose end lies so far above its beginning and meets it at an angle (degrees).
Side circle(double gap, double degrees) {
  const double outward = 2 * std::numbers::pi * std::tan(degrees * std::numbers::pi / 360);
  const auto field = [](const auto& f) {
    return PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k)
            Vec3::Map(&out[3 * k]) =
                f(t[k], Vec3(std::cos(2 * std::numbers::pi * t[k]), std::sin(2 * std::numbers::pi * t[k]), 0));
        },
        3);
  };
  return {field([&](double t, const Vec3& p) -> Vec3 { return (1 + outward * t * (1 - t)) * p + gap * t * Vec3::UnitZ(); }),
          field([](double, const Vec3& p) -> Vec3 { return p; }),
          {}};
}

/// Curves of one degree along the sides of a triangle; the first ends so far from where the next one begins.
BoundaryCurves curves(int degree, double gap) {
  BoundaryCurves out;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = plain_corners[(i + 1) % 3], b = plain_corners[(i + 2) % 3];
    out[i].resize(degree + 1, 3);
    for (int k = 0; k <= degree; ++k) out[i].row(k) = a + (b - a) * k / degree;
  }
  out[0](degree, 2) += gap;
  return out;
}

}  // namespace

TEST_CASE("a round rim ends where it begins, to a millionth of its size and ten degrees", "[thresholds]") {
  PolygonPatchOptions plain;
  plain.fairing.reset();
  CHECK_NOTHROW(round_patch(circle(2 * 0.99e-6, 0), plain, 8));
  CHECK(refusal_code([&] { round_patch(circle(2 * 1.01e-6, 0), plain, 8); }) == "single_side_open");
  CHECK_NOTHROW(round_patch(circle(0, 9.9), plain, 8));
  CHECK(refusal_code([&] { round_patch(circle(0, 10.1), plain, 8); }) == "single_side_has_corner");
}

TEST_CASE("curvatures agree that differ by half of the larger one at the corners", "[thresholds]") {
  // three quarter circles of a sphere of which one says that its surroundings bend less across
  const auto octant = [](double bend) {
    Sides sides;
    for (int i = 0; i < 3; ++i) {
      const Vec3 a = Vec3::Unit((i + 1) % 3), b = Vec3::Unit((i + 2) % 3), out = -Vec3::Unit(i);
      sides[i].c = PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> values) {
            for (std::size_t k = 0; k < t.size(); ++k)
              Vec3::Map(&values[3 * k]) = std::cos(t[k] * std::numbers::pi / 2) * a + std::sin(t[k] * std::numbers::pi / 2) * b;
          },
          3, 1e-12);
      sides[i].r = PiecewisePolynomial::constant({out.data(), 3});
      sides[i].q = -(i == 1 ? bend : 1) * sides[i].c;
    }
    return sides;
  };
  REQUIRE(curvature_mismatch(octant(1))[0] < 1e-9);
  for (const double wanted : {0.495, 0.505}) {
    const double bend = 1 - wanted * std::sqrt(2.0);  // of two forms, the identity of norm sqrt 2 and one that lacks a part
    REQUIRE(curvature_mismatch(octant(bend))[0] == Approx(wanted).epsilon(1e-6));
    CHECK(curvature_agrees(octant(bend))[1] == (wanted < 0.5));
  }
}

TEST_CASE("normals cancel whose sum is a billionth", "[thresholds]") {
  // two faces back to back with an edge in common; normals are given but for a little
  const Points vertices = (Points(4, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, -1, 0).finished();
  Faces faces;
  faces.add(std::array<Index, 3>{0, 1, 2});
  faces.add(std::array<Index, 3>{0, 3, 1});
  for (const double left : {0.97e-9, 1.03e-9}) {
    Points normals = Points::Zero(6, 3);
    normals.row(0) << left / (std::numbers::pi / 2), 0, 1;  // both corners at vertex 0 are right angles
    normals.row(3) << 0, 0, -1;
    CHECK((vertex_normals({vertices, faces}, normals).row(0).norm() > 0) == (left > 1e-9));
  }
}

TEST_CASE("degrees and resolutions have their bounds", "[thresholds]") {
  CHECK_NOTHROW(BezierTriangle(Points::Random(861, 3)));  // degree 40
  CHECK_THROWS_AS(BezierTriangle(Points::Random(903, 3)), InvalidArgument);
  CHECK_NOTHROW(BezierRectangle(Points::Random(21 * 2, 3), 20, 1));
  CHECK_THROWS_AS(BezierRectangle(Points::Random(22 * 2, 3), 21, 1), InvalidArgument);
  CHECK_NOTHROW(coons_bezier(curves(20, 0), CoonsKind::discrete));
  CHECK_THROWS_AS(coons_bezier(curves(21, 0), CoonsKind::discrete), InvalidArgument);
  const Points vertices = (Points(3, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0).finished();
  Faces faces;
  faces.add(std::array<Index, 3>{0, 1, 2});
  CHECK_NOTHROW(smooth_triangles({vertices, faces}, {}, 256));
  CHECK_THROWS_AS(smooth_triangles({vertices, faces}, {}, 257), InvalidArgument);
}

TEST_CASE("boundary curves meet to a billionth of the size, and an edge is as long as a million-millionth of it",
          "[thresholds]") {
  double size = 0;
  for (const Vec3& p : plain_corners) size = std::max(size, (p - plain_corners[1]).cwiseAbs().maxCoeff());
  CHECK_NOTHROW(coons_bezier(curves(3, 0.99e-9 * size), CoonsKind::discrete));
  CHECK_THROWS_WITH(coons_bezier(curves(3, 1.01e-9 * size), CoonsKind::discrete), Catch::Contains("boundary[0] and boundary[1]"));
  for (const double length : {0.98e-12, 1.02e-12}) {
    const std::array<double, 6> net = {0, 0, 0, length, 0, 0};
    const Vec3 across = Vec3::UnitY();
    const Side side = {PiecewisePolynomial::bezier(net, 3), PiecewisePolynomial::constant({across.data(), 3}), {}};
    if (length < 1e-12) {
      CHECK_THROWS_AS(checked_edge(side, 0, false), Refusal);
    } else {
      CHECK_NOTHROW(checked_edge(side, 0, false));
    }
  }
}

TEST_CASE("surfaces that are joined meet at their corners to a millionth of their size", "[thresholds]") {
  const auto triangle = [](double up) {
    return std::make_shared<BezierTriangle>((Points(3, 3) << 0, 0, up, 2, 0, up, 0, 1, up).finished());
  };
  const double size = std::sqrt(5.0);
  CHECK_NOTHROW(common_corners({triangle(0), triangle(0.97e-6 * size), triangle(0)}));
  CHECK_THROWS_AS(common_corners({triangle(0), triangle(1.03e-6 * size), triangle(0)}), InvalidArgument);
}
