// Rings between two closed boundaries, against surfaces that are known: fillets, tori, cylinders and cones.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "tripatch/annulus/annulus_layout.h"
#include "tripatch/annulus/annulus_patch.h"

using namespace tripatch;

namespace {

constexpr double turn = 2 * std::numbers::pi;

PiecewisePolynomial curve_of(const std::function<Vec3(double)>& f) {
  return PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = f(t[k]);
      },
      3);
}

/// A closed side through points with the derivative away from the hole; both by the angle over 2 pi, which may continue from `begin`, or back.
Side side_of(const std::function<Vec3(double)>& c, const std::function<Vec3(double)>& r, double begin = 0, bool back = false) {
  const auto at = [=](const std::function<Vec3(double)>& f) {
    return curve_of([=](double t) { return f(turn * (begin + (back ? -t : t))); });
  };
  return {at(c), at(r), {}};
}

/// Errors of points of the patch, inside.
std::array<double, 2> errors_of(const AnnulusPatch& made, const std::function<double(const Vec3&)>& distance) {
  double most = 0, squares = 0;
  PlanePoints places(40 * 9, 2);
  for (int k = 0; k < 40; ++k)
    for (int j = 0; j < 9; ++j) places.row(9 * k + j) = made.patch->place(k / 40.0, (j + 1) / 10.0);
  const Points points = made.patch->positions(as_rows(places));
  for (Index k = 0; k < points.rows(); ++k) {
    const double off = std::abs(distance(points.row(k)));
    most = std::max(most, off);
    squares += off * off / static_cast<double>(points.rows());
  }
  return {most, std::sqrt(squares)};
}

double from_torus(const Vec3& p, double large, double small) { return std::hypot(std::hypot(p[0], p[1]) - large, p[2]) - small; }

/// A circle across a torus about z, at this angle about z; r away from the gap that begins or ends there.
Side end_of_torus(double large, double small, double angle, bool begins, double begin = 0) {
  const Vec3 radial(std::cos(angle), std::sin(angle), 0), ahead(-std::sin(angle), std::cos(angle), 0);
  // the gap lies ahead of its first end; new faces run so that r x c' points outwards
  const auto c = [=](double a) -> Vec3 { return (large + small * std::cos(a)) * radial + small * std::sin(a) * Vec3(0, 0, 1); };
  const auto r = [=](double) -> Vec3 { return begins ? Vec3(-ahead) : ahead; };
  return side_of(c, r, begin, begins);
}

}  // namespace

TEST_CASE("a ring between a boss and a plate is the quarter circle of a fillet") {
  const double radius = 0.9, fillet = 0.4;
  // the plate at z = 0 with a hole of radius 1.3; the boss from z = 0.4 up; seen from above
  const Side plate = side_of([=](double a) { return Vec3((radius + fillet) * std::cos(a), (radius + fillet) * std::sin(a), 0); },
                             [](double a) { return Vec3(std::cos(a), std::sin(a), 0); });
  const Side boss = side_of([=](double a) { return Vec3(radius * std::cos(a), radius * std::sin(a), fillet); },
                            [](double) { return Vec3(0, 0, 1); }, 0.3, true);
  const AnnulusPatch made = annulus_patch(plate, boss);
  const auto [most, rms] = errors_of(
      made, [&](const Vec3& p) { return std::hypot(std::hypot(p[0], p[1]) - radius - fillet, p[2] - fillet) - fillet; });
  CHECK(most < 1e-3 * fillet);
  CHECK(rms < 5e-4 * fillet);
  CHECK(std::max(made.seam_angle_max[0], made.seam_angle_max[1]) < 1e-5);
  CHECK(made.rib_turn == Approx(90).epsilon(1e-6));
  CHECK(made.rib_length == Approx(fillet * turn / 4).epsilon(1e-2));
}

TEST_CASE("a ring across the gap of a bent pipe is a sector of its torus") {
  const double large = 2, small = 0.5;
  for (const double gap : {10.0, 40.0, 90.0, 150.0}) {
    const Side first = end_of_torus(large, small, 0, true), second = end_of_torus(large, small, gap * turn / 360, false, 0.37);
    REQUIRE(first.normal(0.1).dot(first.c(0.1) - Vec3(large, 0, 0)) > 0);
    const AnnulusPatch made = annulus_patch(first, second);
    const auto [most, rms] = errors_of(made, [&](const Vec3& p) { return from_torus(p, large, small); });
    CAPTURE(gap);
    CHECK(most < (gap > 90 ? 2e-2 : 2e-3) * small);
    CHECK(rms < 5e-3 * small);
    CHECK(std::max(made.seam_angle_max[0], made.seam_angle_max[1]) < 1e-5);
  }
}

TEST_CASE("a ring in a cylinder that is cut obliquely lies on the cylinder, and one in a cone on the cone") {
  for (const double slant : {0.0, 0.7}) {
    const auto lower = [=](double a) { return Vec3(std::cos(a), std::sin(a), slant * std::cos(a)); };
    const auto upper = [=](double a) { return Vec3(std::cos(a), std::sin(a), 1.5 - slant * std::sin(a)); };
    const Side first = side_of(
                   upper, [](double) { return Vec3(0, 0, 1); }, 0, true),
               second = side_of(lower, [](double) { return Vec3(0, 0, -1); }, 0.4);
    const AnnulusPatch made = annulus_patch(first, second);
    CAPTURE(slant);
    const auto [most, rms] = errors_of(made, [](const Vec3& p) { return std::hypot(p[0], p[1]) - 1; });
    CHECK(most < 1e-3);
  }
  const auto circle = [](double z) { return [=](double a) { return Vec3((2 - z) * std::cos(a), (2 - z) * std::sin(a), z); }; };
  const Side first = side_of(circle(0), [](double a) { return Vec3(std::cos(a), std::sin(a), -1); }),
             second = side_of(circle(1.2), [](double a) { return Vec3(-std::cos(a), -std::sin(a), 1); }, 0.8, true);
  const auto [most, rms] = errors_of(annulus_patch(first, second),
                                     [](const Vec3& p) { return (std::hypot(p[0], p[1]) - 2 + p[2]) / std::numbers::sqrt2; });
  CHECK(most < 1e-6);
}

TEST_CASE("a ring between circles of one plane that are not concentric lies in the plane and does not fold") {
  const auto circle = [](double radius, double x) {
    return [=](double a) { return Vec3(x + radius * std::cos(a), radius * std::sin(a), 0); };
  };
  const Side first = side_of(circle(2, 0), [](double a) { return Vec3(std::cos(a), std::sin(a), 0); }),
             second = side_of(circle(0.6, 0.9), [](double a) { return Vec3(-std::cos(a), -std::sin(a), 0); }, 0.2, true);
  const AnnulusPatch made = annulus_patch(first, second);
  PlanePoints places(60 * 11, 2);
  for (int k = 0; k < 60; ++k)
    for (int j = 0; j < 11; ++j) places.row(11 * k + j) = made.patch->place(k / 60.0, j / 10.0);
  const Points normals = made.patch->normals(as_rows(places));
  CHECK((normals.rowwise() - Eigen::RowVector3d(0, 0, 1)).rowwise().norm().maxCoeff() < 1e-9);
}

TEST_CASE("a ring that is to meet curvature has that of its surroundings along its boundaries") {
  const double large = 2, small = 0.5;
  Side first = end_of_torus(large, small, 0, true), second = end_of_torus(large, small, 1, false);
  CHECK_THROWS_AS(annulus_patch(first, second, {{SideContinuity::g2, SideContinuity::g2}, {1, 1}}), Refusal);
  for (Side* side : {&first, &second})
    side->q = curve_of([&](double t) -> Vec3 {
      const Vec3 p = side->c(t);
      return -Vec3(p[0], p[1], 0) / Vec3(p[0], p[1], 0).squaredNorm();  // of the circle about z
    });
  const AnnulusPatch made = annulus_patch(first, second, {{SideContinuity::g2, SideContinuity::g2}, {1, 1}});
  CHECK(made.continuity == std::array{SeamContinuity::g2, SeamContinuity::g2});
  const auto [most, rms] = errors_of(made, [&](const Vec3& p) { return from_torus(p, large, small); });
  CHECK(most < 2e-3 * small);
}

TEST_CASE("boundaries whose faces face opposite ways are refused") {
  const auto circle = [](double z) { return [=](double a) { return Vec3(std::cos(a), std::sin(a), z); }; };
  const Side first = side_of(circle(0), [](double) { return Vec3(0, 0, -1); }),
             second = side_of(circle(1), [](double) { return Vec3(0, 0, 1); });
  CHECK_THROWS_AS(annulus_patch(first, second), Refusal);
}

TEST_CASE("derivatives of a ring are those of its positions") {
  const AnnulusPatch made = annulus_patch(end_of_torus(2, 0.5, 0, true), end_of_torus(2, 0.5, 1, false));
  const Vec2 at = made.patch->place(0.93, 0.4);
  std::array<double, 45> jet{};
  const std::array<double, 3> b = {at[0], at[1], 0};
  made.patch->evaluate(b.data(), 1, 2, jet.data());
  const double h = 1e-4;
  const auto point = [&](double x, double y) -> Vec3 {
    Points places = Points::Zero(1, 3);
    places.row(0) << at[0] + x, at[1] + y, 0;
    return made.patch->positions(places).row(0);
  };
  CHECK((Vec3::Map(&jet[3]) - (point(h, 0) - point(-h, 0)) / (2 * h)).norm() < 1e-6);
  CHECK((Vec3::Map(&jet[6]) - (point(0, h) - point(0, -h)) / (2 * h)).norm() < 1e-6);
  CHECK((2 * Vec3::Map(&jet[9]) - (point(h, 0) - 2 * point(0, 0) + point(-h, 0)) / (h * h)).norm() < 1e-4);
  CHECK((2 * Vec3::Map(&jet[15]) - (point(0, h) - 2 * point(0, 0) + point(0, -h)) / (h * h)).norm() < 1e-4);
}

TEST_CASE("faces between boundaries of m and n edges have at most |m - n| irregular vertices") {
  for (const auto& [m, n] : std::vector<std::array<int, 2>>{{12, 12}, {13, 12}, {12, 17}, {32, 24}, {24, 32}, {40, 9}, {6, 30}})
    for (const int rings : {1, 2, 3, 6})
      for (const bool quads : {false, true}) {
        std::vector<double> first, second;
        for (int k = 0; k < m; ++k) first.push_back(std::fmod(0.31 + static_cast<double>(k) / m, 1));
        for (int k = 0; k < n; ++k) second.push_back(std::fmod(1.77 - static_cast<double>(k) / n, 1));
        const AnnulusLayout layout = annulus_layout(first, second, rings, quads);
        CAPTURE(m, n, rings, quads);
        std::map<std::array<Index, 2>, int> edges;
        std::map<Index, int> corners;
        Index triangles = 0;
        for (Index f = 0; f < layout.faces.size(); ++f) {
          const std::span<const Index> face = layout.faces[f];
          triangles += face.size() == 3 ? 1 : 0;
          for (std::size_t k = 0; k < face.size(); ++k) {
            ++edges[{face[k], face[(k + 1) % face.size()]}];
            ++corners[face[k]];
          }
        }
        for (const auto& [edge, count] : edges) REQUIRE(count == 1);
        Index open = 0;
        for (const auto& [edge, count] : edges) open += edges.count({edge[1], edge[0]}) == 0 ? 1 : 0;
        CHECK(open == m + n);
        for (Index k = 0; k < m; ++k) CHECK(edges.count({k, (k + 1) % m}) == 1);
        for (Index k = 0; k < n; ++k) CHECK(edges.count({m + k, m + (k + 1) % n}) == 1);
        Index odd = 0;  // corners of faces: 4 inside, 2 on the boundaries
        for (const auto& [v, count] : corners) odd += count != (v < m + n ? 2 : 4) ? 1 : 0;
        CHECK(odd <= std::abs(m - n));
        CHECK(triangles <= std::abs(m - n));
        if (quads && rings > 2 && std::abs(m - n) < 9) CHECK(triangles == std::abs(m - n) % 2);
      }
}
