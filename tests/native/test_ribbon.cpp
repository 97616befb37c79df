#include <numbers>

#include "test_surfaces.h"
#include "tripatch/constructions/gregory.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/constructions/quintic.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/report/report.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

double scalar(const PiecewisePolynomial& f, double t) {
  double value;
  f.taylor(t, 0, &value);
  return value;
}

/// The surroundings of one surface in affine parameterizations of their own: constant stretch and skew on each side.
Sides affine_sides(const SurfacePtr& s) {
  Sides sides;
  for (int i = 0; i < 3; ++i)
    sides[i] = side_of(*s, i, [i](double) { return 0.5 + 0.75 * i; }, [i](double) { return 0.4 - 0.5 * i; });
  return sides;
}

Boundary boundary_of(const Sides& sides, CrossBoundary kind) {
  RibbonOptions options;
  options.cross_boundary = kind;
  return make_boundary(sides, options);
}

/// A sphere cap of polar angle 30 degrees about the z axis: round rim, corners at the given longitudes. Outer normal outwards.
Sides round_rim(const std::array<double, 3>& longitude_deg, double polar_deg = 30) {
  Sides sides;
  const double polar = polar_deg * std::numbers::pi / 180;
  for (int i = 0; i < 3; ++i) {
    double from = longitude_deg[(i + 1) % 3], to = longitude_deg[(i + 2) % 3];
    if (to < from) to += 360;
    const auto field = [&](bool position) {
      return PiecewisePolynomial::fit(
          [&, position](std::span<const double> t, std::span<double> out) {
            for (std::size_t k = 0; k < t.size(); ++k) {
              const double a = (from + (to - from) * t[k]) * std::numbers::pi / 180;
              const Vec3 p(std::sin(polar) * std::cos(a), std::sin(polar) * std::sin(a), std::cos(polar));
              const Vec3 down(std::cos(polar) * std::cos(a), std::cos(polar) * std::sin(a), -std::sin(polar));
              Vec3::Map(&out[3 * k]) = position ? p : down;
            }
          },
          3);
    };
    sides[i].c = field(true);
    sides[i].r = field(false);
  }
  return sides;
}

/// Smallest |P_0 x P_1| outside 2% of the corners over its mean.
double smallest_area(const Surface& patch) {
  const Points b = grid(60);
  double least = INFINITY, sum = 0;
  Index count = 0;
  for (Index k = 0; k < b.rows(); ++k) {
    if (b.row(k).maxCoeff() > 0.98) continue;
    std::array<double, 9> out;
    patch.evaluate(&b(k, 0), 1, 1, out.data());
    const double area = Vec3::Map(out.data() + 3).cross(Vec3::Map(out.data() + 6)).norm();
    least = std::min(least, area);
    sum += area;
    ++count;
  }
  return least / (sum / static_cast<double>(count));
}

double distance_to_unit_sphere(const Surface& patch) {
  const Points p = patch.positions(grid(40));
  return std::sqrt((p.rowwise().norm().array() - 1).square().mean());
}

}  // namespace

TEST_CASE("Liu-Ma-Cheng Theorem 1: alpha and beta are constant for affinely related patches") {
  const Sides sides = affine_sides(bezier(random_net(5, 3)));
  const Boundary boundary = boundary_of(sides, CrossBoundary::consistent),
                 printed = boundary_of(sides, CrossBoundary::as_printed);
  double printed_error = 0;
  for (int i = 0; i < 3; ++i) {
    const double stretch = 0.5 + 0.75 * i, skew = 0.4 - 0.5 * i;
    for (double t : {0.0, 0.2, 0.5, 0.9, 1.0}) {
      CHECK(scalar(boundary.ribbons[i].alpha, t) == Approx(1 / stretch).epsilon(1e-10));
      CHECK(scalar(boundary.ribbons[i].beta, t) == Approx(-skew / stretch).margin(1e-10));
      printed_error = std::max(printed_error, std::abs(scalar(printed.ribbons[i].alpha, t) - 1 / stretch));
    }
  }
  CHECK(printed_error > 0.1);
}

TEST_CASE(
    "Liu-Ma-Cheng Theorem 2: the precision of the method is kept, but not by the printed equations or the slopes as given") {
  const auto error = [](CrossBoundary kind, int degree, auto method) {
    const SurfacePtr surface = bezier(random_net(degree, 8));
    return difference(*method(boundary_of(affine_sides(surface), kind)), *surface);
  };
  const auto cubic = [](const Boundary& b) { return side_vertex(b); };
  const auto fifth = [](const Boundary& b) { return quintic(b); };
  CHECK(error(CrossBoundary::consistent, 3, cubic) < 1e-12);
  CHECK(error(CrossBoundary::consistent, 5, fifth) < 1e-12);
  for (CrossBoundary other : {CrossBoundary::given, CrossBoundary::as_printed}) {
    CHECK(error(other, 3, cubic) > 0.01);
    CHECK(error(other, 5, fifth) > 0.01);
  }
}

TEST_CASE("an obtuse triangle keeps its slopes: the floor of smooth corners is not for it") {
  const std::array<Vec3, 3> obtuse = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, 0.05, 0)};
  const SurfacePtr surface = bezier(random_net(3, 8, 0.003, obtuse));
  const Boundary boundary = boundary_of(affine_sides(surface), CrossBoundary::consistent);
  CHECK(boundary.turn_deg[2] < 15);
  CHECK(difference(*side_vertex(boundary), *surface) < 1e-12);
}

TEST_CASE("the printed slopes are those of equations (10) to (14)") {
  const Sides sides = skewed_sides(unrelated_surfaces(2));
  const Boundary boundary = boundary_of(sides, CrossBoundary::as_printed);
  for (int i = 0; i < 3; ++i) {
    const Side& side = sides[i];
    const Vec3 r = side.r(0), dc = side.c.derivative_at(0);
    const Vec3 tau = sides[(i + 2) % 3].c.derivative_at(1) + 0.5 * dc;
    Eigen::Matrix2d m;
    m << r.dot(r), r.dot(dc), r.dot(dc), dc.dot(dc);
    const Eigen::Vector2d x = m.inverse() * Eigen::Vector2d(tau.dot(r), 0);
    CHECK(scalar(boundary.ribbons[i].alpha, 0) == Approx(x[0]));
    CHECK(scalar(boundary.ribbons[i].beta, 0) == Approx(x[1]));
    for (double t : {0.1, 0.5, 0.8})  // orthogonal to the side, and in the tangent plane
      CHECK(std::abs(boundary.ribbons[i].d(t).dot(side.c.derivative_at(t))) < 1e-10);
  }
}

TEST_CASE("slopes as given are the surroundings' own per unit of the equilateral domain's side, as equation (4) has them") {
  const Sides sides = skewed_sides(unrelated_surfaces(2));
  const Boundary boundary = boundary_of(sides, CrossBoundary::given);
  const double height = std::sqrt(0.75);
  for (int i = 0; i < 3; ++i) CHECK((boundary.ribbons[i].d(0.3) - height * sides[i].r(0.3)).norm() < 1e-14);
}

TEST_CASE("every kind of slopes keeps the tangent plane, with alpha of one sign") {
  const Sides sides = skewed_sides(unrelated_surfaces(2));
  for (CrossBoundary kind : {CrossBoundary::given, CrossBoundary::consistent, CrossBoundary::as_printed})
    CHECK(seam_error(*gregory(boundary_of(sides, kind)), sides) < 1e-6);
}

TEST_CASE("a round rim with three corners") {
  for (const std::array<double, 3>& at : {std::array<double, 3>{0, 120, 240}, std::array<double, 3>{0, 60, 200}}) {
    const Sides sides = round_rim(at);
    const Boundary boundary = boundary_of(sides, CrossBoundary::consistent);
    for (int k = 0; k < 3; ++k) CHECK(std::abs(boundary.turn_deg[k]) < 1e-6);
    for (const Method& method : methods()) {
      if (method.continuity != SeamContinuity::g1 || !method.from_boundary) continue;
      const SurfacePtr patch = method.from_boundary(boundary, {});
      const bool even = at[1] == 120;
      UNSCOPED_INFO(method.name << (even ? " even" : " uneven"));
      CHECK(seam_error(*patch, sides) < 1e-6);
      CHECK(count_folds(*patch, sides) == 0);
      CHECK(smallest_area(*patch) > 1e-3);
    }
  }
  // mathematics.md, section 4: the floor at its whole keeps the cap within 1.6e-2 of its diameter
  CHECK(distance_to_unit_sphere(*side_vertex(boundary_of(round_rim({0, 120, 240}), CrossBoundary::consistent))) < 1.7e-2);
}

TEST_CASE("cube-like corners: three faces that meet at right angles") {
  Sides sides;
  for (int i = 0; i < 3; ++i) {  // the corner cut off a cube: side i lies in the face x_i = 0
    const Vec3 a = Vec3::Unit((i + 1) % 3), b = Vec3::Unit((i + 2) % 3), r = a + b;
    const std::array<double, 6> curve = {a[0], a[1], a[2], b[0], b[1], b[2]};
    sides[i].c = PiecewisePolynomial::bezier(curve, 3);
    sides[i].r = PiecewisePolynomial::constant({r.data(), 3});
  }
  const Boundary boundary = boundary_of(sides, CrossBoundary::consistent);
  for (int k = 0; k < 3; ++k) CHECK(boundary.corner_mismatch_deg[k] == Approx(90));
  for (const Method& method : methods()) {
    if (method.continuity != SeamContinuity::g1 || !method.from_boundary) continue;
    UNSCOPED_INFO(method.name);
    const SurfacePtr patch = method.from_boundary(boundary, {});
    CHECK(seam_error(*patch, sides) < 1e-6);
    CHECK(smallest_area(*patch) > 1e-3);
  }
}

TEST_CASE("sides of very unequal length, and a corner that turns back") {
  const std::array<Vec3, 3> sliver = {Vec3(0, 0, 0), Vec3(1, 0, 0.1), Vec3(1.02, 0.05, 0.1)};
  const Sides unequal = sides_of(bezier(random_net(4, 3, 0.01, sliver)));
  for (int i = 0; i < 3; ++i) CHECK(scalar(make_boundary(unequal).ribbons[i].alpha, 0.5) > 0);
  CHECK(seam_error(*side_vertex(make_boundary(unequal)), unequal) < 1e-6);

  // the side from corner 0 leaves it against the side that comes in: alpha would be negative there
  Sides back = sides_of(bezier(random_net(2, 1)));
  const Vec3 a = back[2].c(0), b = back[2].c(1), away = back[1].c.derivative_at(1);
  std::vector<double> net;
  for (const Vec3& p : {a, Vec3(a + 0.3 * away - 0.4 * (back[0].c(0.5) - a)), Vec3((a + 2 * b) / 3), b})
    net.insert(net.end(), p.data(), p.data() + 3);
  back[2].c = PiecewisePolynomial::bezier(net, 3);
  const Boundary boundary = make_boundary(back);
  for (int i = 0; i < 3; ++i)
    for (double t : {0.0, 0.5, 1.0}) CHECK(scalar(boundary.ribbons[i].alpha, t) > 0);
  CHECK(seam_error(*side_vertex(boundary), back) < 1e-6);
}

TEST_CASE("bulge scales the slopes inside a side and keeps the corners and the tangent plane") {
  const Sides sides = skewed_sides(unrelated_surfaces(2));
  RibbonOptions options;
  options.bulge = {1, 2, 0.5};
  const Boundary plain = make_boundary(sides), bulged = make_boundary(sides, options);
  for (int i = 0; i < 3; ++i) {
    CHECK(scalar(bulged.ribbons[i].alpha, 0.5) == Approx(options.bulge[i] * scalar(plain.ribbons[i].alpha, 0.5)));
    for (double t : {0.0, 1.0}) CHECK((bulged.ribbons[i].d(t) - plain.ribbons[i].d(t)).norm() < 1e-13);
  }
  CHECK(seam_error(*side_vertex(bulged), sides) < 1e-6);
}

TEST_CASE("three sides are as large whichever way they are walked") {
  const std::array<Vec3, 3> corner = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)};
  std::array<PiecewisePolynomial, 3> curves, back;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = corner[i], b = corner[(i + 1) % 3], out = a + 4 * (a - b) + Vec3(0, 0, 1);  // beyond its first end
    const std::array<double, 9> net = {a[0], a[1], a[2], out[0], out[1], out[2], b[0], b[1], b[2]},
                                other = {b[0], b[1], b[2], out[0], out[1], out[2], a[0], a[1], a[2]};
    curves[i] = PiecewisePolynomial::bezier(net, 3);
    back[(3 - i) % 3] = PiecewisePolynomial::bezier(other, 3);
  }
  CHECK(check_curves(curves) == Approx(check_curves(back)));
}

TEST_CASE("a ribbon of numbers that overflow is refused") {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const double a = 2 * std::numbers::pi * i / 3, b = 2 * std::numbers::pi * (i + 1) / 3;
    const std::array<double, 6> along = {std::cos(a), std::sin(a), 0, std::cos(b), std::sin(b), 0};
    const std::array<double, 6> across = {std::cos(a), std::sin(a), 0, std::cos(b), std::sin(b), 0};
    sides[i].c = PiecewisePolynomial::bezier(along, 3);
    sides[i].r = PiecewisePolynomial::bezier(across, 3);
  }
  CHECK(make_boundary(sides).ribbons[1].d.is_finite());
  const std::array<double, 6> beyond = {std::cos(0.1), INFINITY, 0, 1, 0, 0};
  sides[1].r = PiecewisePolynomial::bezier(beyond, 3);
  CHECK_THROWS_AS(make_boundary(sides), Refusal);
}
