#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tripatch/boundary/bezier_rectangle.h"
#include "tripatch/boundary/nurbs_surface.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/patch/bezier_triangle.h"

using namespace tripatch;

namespace {

Points random_points(Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points points(count, 3);
  for (double& x : points.reshaped()) x = uniform(random);
  return points;
}

std::vector<double> random_weights(Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(0.3, 3);
  std::vector<double> weights(count);
  for (double& w : weights) w = uniform(random);
  return weights;
}

/// Bezier knots of a degree.
std::vector<double> bezier_knots(int degree) {
  std::vector<double> knots(2 * degree + 2, 0.0);
  std::fill(knots.begin() + degree + 1, knots.end(), 1.0);
  return knots;
}

std::vector<double> jet(const RectangleSurface& surface, double u, double v, int order) {
  std::vector<double> out(3 * jet_size(order));
  const std::array<double, 2> uv = {u, v};
  surface.evaluate(uv.data(), 1, order, out.data());
  return out;
}

/// Point and derivatives on an edge, straight from the surface: c, c', r, q at t of the edge.
std::array<Vec3, 4> edge_data(const RectangleSurface& surface, int edge, double t) {
  const auto [u0, u1, v0, v1] = surface.domain();
  const double lu = u1 - u0, lv = v1 - v0;
  const std::array<std::array<double, 2>, 4> place = {
      {{u0 + t * lu, v0}, {u1, v0 + t * lv}, {u1 - t * lu, v1}, {u0, v1 - t * lv}}};
  const std::vector<double> j = jet(surface, place[edge][0], place[edge][1], 2);
  const Vec3 p = Vec3::Map(&j[0]), pu = Vec3::Map(&j[3]), pv = Vec3::Map(&j[6]), puu = 2 * Vec3::Map(&j[9]),
             pvv = 2 * Vec3::Map(&j[15]);
  switch (edge) {
    case 0: return {p, lu * pu, pv, pvv};
    case 1: return {p, lv * pv, -pu, puu};
    case 2: return {p, -lu * pu, -pv, pvv};
    default: return {p, -lv * pv, pu, puu};
  }
}

void check_sides_of(const RectangleSurface& surface, double tolerance) {
  for (int edge = 0; edge < 4; ++edge) {
    const Side side = surface.side(edge, false), back = surface.side(edge, true);
    for (double t : {0.0, 0.07, 0.3, 0.55, 0.81, 1.0}) {
      INFO("edge " << edge << " t " << t);
      const auto [c, dc, r, q] = edge_data(surface, edge, t);
      CHECK((side.c(t) - c).norm() < tolerance);
      CHECK((side.c.derivative_at(t) - dc).norm() < 1e3 * tolerance);
      CHECK((side.r(t) - r).norm() < 10 * tolerance);
      CHECK((side.q(t) - q).norm() < 100 * tolerance);
      CHECK((back.c(1 - t) - c).norm() < tolerance);
      CHECK((back.c.derivative_at(1 - t) + dc).norm() < 1e3 * tolerance);
      CHECK((back.r(1 - t) - r).norm() < 10 * tolerance);
      CHECK((back.q(1 - t) - q).norm() < 100 * tolerance);
      CHECK((back.normal(1 - t) + side.normal(t)).norm() < 1e-9);
    }
  }
}

}  // namespace

TEST_CASE("Bezier rectangles by de Casteljau and by B-spline basis functions agree to the fourth derivative") {
  for (auto [m, n] : {std::pair{1, 1}, {3, 3}, {2, 7}, {20, 1}, {12, 9}}) {
    const Points points = random_points((m + 1) * (n + 1), m);
    const BezierRectangle bezier(points, m, n);
    const NurbsSurface nurbs(points, m + 1, n + 1, {}, bezier_knots(m), bezier_knots(n));
    CHECK(nurbs.degree_u() == m);
    CHECK(nurbs.degree_v() == n);
    for (double u : {0.0, 0.37, 1.0})
      for (double v : {0.0, 0.61, 1.0}) {
        const std::vector<double> a = jet(bezier, u, v, 4), b = jet(nurbs, u, v, 4);
        double scale = 0, off = 0;
        for (std::size_t k = 0; k < a.size(); ++k) {
          scale = std::max(scale, std::abs(a[k]));
          off = std::max(off, std::abs(a[k] - b[k]));
        }
        CHECK(off < 1e-12 * scale);
      }
  }
}

TEST_CASE("a rational surface is the quotient of polynomial ones, derivatives included") {
  // the same surface after knot insertion by hand is dull; a rational quadratic is a circle: radius and derivatives are known
  const double s = std::sqrt(0.5);
  Points points(6, 3);
  points << 1, 0, 0, 1, 0, 2, 1, 1, 0, 1, 1, 2, 0, 1, 0, 0, 1, 2;
  const NurbsSurface cylinder(points, 3, 2, {1, 1, s, s, 1, 1}, {0, 0, 0, 1, 1, 1}, {0, 0, 1, 1});
  for (double u : {0.0, 0.2, 0.5, 0.9, 1.0}) {
    const std::vector<double> j = jet(cylinder, u, 0.25, 3);
    const Vec3 p = Vec3::Map(&j[0]), pu = Vec3::Map(&j[3]), puu = 2 * Vec3::Map(&j[9]), puuu = 6 * Vec3::Map(&j[18]);
    CHECK(std::hypot(p[0], p[1]) == Approx(1).epsilon(1e-15));
    CHECK(p[2] == Approx(0.5).epsilon(1e-14));
    CHECK((Vec3::Map(&j[6]) - Vec3(0, 0, 2)).norm() < 1e-14);
    // derivatives of x^2 + y^2 = 1
    CHECK(std::abs(p.head<2>().dot(pu.head<2>())) < 1e-15);
    CHECK(std::abs(pu.head<2>().squaredNorm() + p.head<2>().dot(puu.head<2>())) < 1e-14);
    CHECK(std::abs(3 * pu.head<2>().dot(puu.head<2>()) + p.head<2>().dot(puuu.head<2>())) < 1e-13);
  }
}

TEST_CASE("derivatives of a NURBS surface against differences, knots of any kind") {
  const Index nu = 7, nv = 6;
  const NurbsSurface surface(random_points(nu * nv, 4), nu, nv, random_weights(nu * nv, 5),
                             {-1, 0, 0.5, 1, 1.2, 2, 2, 3, 4, 4.5, 5}, {0, 0, 0, 1, 2, 2.5, 3, 3, 3});
  CHECK(surface.degree_u() == 3);
  CHECK(surface.degree_v() == 2);
  CHECK(surface.domain() == std::array<double, 4>{1, 3, 0, 3});
  const double h = 1e-4;
  for (double u : {1.1, 1.7, 2.6})
    for (double v : {0.3, 1.6, 2.8}) {
      const auto at = [&](double a, double b) { return jet(surface, a, b, 3); };
      const std::vector<double> j = at(u, v), up = at(u + h, v), um = at(u - h, v), vp = at(u, v + h), vm = at(u, v - h);
      // the derivative of coefficient (i, j) is (i + 1) times coefficient (i + 1, j)
      for (int d = 0; d < 3; ++d)
        for (int b = 0; b <= d; ++b)
          for (int x = 0; x < 3; ++x) {
            const int i = d - b, here = 3 * jet_index(i, b) + x;
            const double scale = 1 + std::abs(j[3 * jet_index(i + 1, b) + x]) + std::abs(j[3 * jet_index(i, b + 1) + x]);
            CHECK(std::abs((up[here] - um[here]) / (2 * h) - (i + 1) * j[3 * jet_index(i + 1, b) + x]) < 2e-4 * scale);
            CHECK(std::abs((vp[here] - vm[here]) / (2 * h) - (b + 1) * j[3 * jet_index(i, b + 1) + x]) < 2e-4 * scale);
          }
    }
}

TEST_CASE("edges of rectangles become sides with exact slopes") {
  check_sides_of(BezierRectangle(random_points(20, 1), 4, 3), 1e-13);
  check_sides_of(BezierRectangle(random_points(6, 2), 1, 2), 1e-13);
  check_sides_of(BezierRectangle(random_points(13 * 3, 8), 12, 2), 1e-12);
  const std::vector<double> knots_u = {-1, 0, 0.5, 1, 1.2, 2, 2, 3, 4, 4.5, 5}, knots_v = {0, 0, 0, 1, 2, 2.5, 3, 3, 3};
  check_sides_of(NurbsSurface(random_points(42, 4), 7, 6, {}, knots_u, knots_v), 1e-13);
  check_sides_of(NurbsSurface(random_points(42, 4), 7, 6, std::vector<double>(42, 2.5), knots_u, knots_v), 1e-13);
  check_sides_of(NurbsSurface(random_points(42, 4), 7, 6, random_weights(42, 5), knots_u, knots_v), 1e-11);
}

TEST_CASE("sides of a Bezier triangle: position, slope and second derivative into the triangle") {
  const BezierTriangle triangle(random_points(BezierTriangle::net_size(4), 6));
  for (int i = 0; i < 3; ++i)
    for (double t : {0.0, 0.2, 0.7, 1.0}) {
      std::array<double, 3> b{};
      b[(i + 1) % 3] = 1 - t;
      b[(i + 2) % 3] = t;
      std::array<double, 18> j;
      triangle.evaluate(b.data(), 1, 2, j.data());
      const auto first = [&](double x, double y) -> Vec3 { return x * Vec3::Map(&j[3]) + y * Vec3::Map(&j[6]); };
      const auto second = [&](double x, double y) -> Vec3 {
        return 2 * (x * x * Vec3::Map(&j[9]) + x * y * Vec3::Map(&j[12]) + y * y * Vec3::Map(&j[15]));
      };
      std::array<double, 3> delta = {-0.5, -0.5, -0.5};
      delta[i] = 1;
      std::array<double, 3> along{};
      along[(i + 1) % 3] = -1;
      along[(i + 2) % 3] = 1;
      const Side side = side_of(triangle, i, false), back = side_of(triangle, i, true);
      CHECK((side.c(t) - Vec3::Map(&j[0])).norm() < 1e-14);
      CHECK((side.c.derivative_at(t) - first(along[0], along[1])).norm() < 1e-13);
      CHECK((side.r(t) - first(delta[0], delta[1])).norm() < 1e-13);
      CHECK((side.q(t) - second(delta[0], delta[1])).norm() < 1e-12);
      CHECK((back.r(1 - t) - side.r(t)).norm() < 1e-14);
      CHECK((back.normal(1 - t) - first(1, 0).cross(first(0, 1)).normalized()).norm() < 1e-12);
    }
  CHECK_THROWS_AS(side_of(triangle, 3, false), InvalidArgument);
}

TEST_CASE("a hole between three Bezier rectangles is filled with their tangent planes") {
  // three bicubic pieces of one saddle around a triangle, each with its edge u along the hole's side
  const std::array<Eigen::Vector2d, 3> corner = {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0.1), Eigen::Vector2d(0.3, 0.8)};
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d a = corner[(i + 1) % 3], b = corner[(i + 2) % 3], out = 0.5 * (a + b) - corner[i];
    // z = x y + x, of degree 2 on any lines: its blossom gives the net of a biquadratic
    Points net(9, 3);
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) {
        const auto place = [&](double s, double d) -> Eigen::Vector2d { return a + s * (b - a) + d * out; };
        const double s0 = j == 2, s1 = j >= 1, d0 = k == 2, d1 = k >= 1;
        const Eigen::Vector2d p = place(0.5 * j, 0.5 * k);
        double z = p[0];
        for (auto [s, t, d, e] : {std::array{s0, s1, d0, d1}, {s0, s1, d1, d0}, {s1, s0, d0, d1}, {s1, s0, d1, d0}})
          z += place(s, d)[0] * place(t, e)[1] / 4;
        net.row(j * 3 + k) << p[0], p[1], z;
      }
    sides[i] = BezierRectangle(net, 2, 2).side(0, false);
    for (double t : {0.1, 0.6}) {
      const Vec3 p = sides[i].c(t);
      REQUIRE(p[2] == Approx(p[0] * p[1] + p[0]).margin(1e-14));
    }
  }
  const SurfacePtr patch = side_vertex(make_boundary(sides));
  for (int i = 0; i < 3; ++i)
    for (int k = 1; k < 20; ++k) {
      Points b = Points::Zero(1, 3);
      b(0, (i + 1) % 3) = 1 - k / 20.0;
      b(0, (i + 2) % 3) = k / 20.0;
      const Vec3 n = patch->normals(b).row(0), m = sides[i].normal(k / 20.0);
      CHECK(std::atan2(n.cross(m).norm(), n.dot(m)) * 180 / std::numbers::pi < 1e-6);
    }
  Points middle(1, 3);
  middle << 0.3, 0.3, 0.4;
  const Vec3 p = patch->positions(middle).row(0);
  CHECK(p[2] == Approx(p[0] * p[1] + p[0]).margin(1e-14));  // precision 3
}

TEST_CASE("bad nets, weights and knots are named") {
  const Points points = random_points(12, 1);
  const std::vector<double> u = {0, 0, 0, 0, 1, 1, 1, 1}, v = {0, 0, 0, 1, 1, 1};
  const auto message = [](auto make) {
    try {
      make();
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const auto nurbs = [&](std::vector<double> w, std::vector<double> ku, std::vector<double> kv) {
    return message([&] { NurbsSurface(points, 4, 3, w, ku, kv); });
  };
  CHECK(nurbs({}, u, v).empty());
  std::vector<double> weights(12, 1.0);
  weights[7] = 0;
  CHECK_THAT(nurbs(weights, u, v), Catch::StartsWith("weights[2, 1] must be greater than 0, not 0"));
  weights[7] = std::nan("");
  CHECK_THAT(nurbs(weights, u, v), Catch::StartsWith("weights[2, 1] is not finite"));
  weights.pop_back();
  CHECK_THAT(nurbs(weights, u, v), Catch::Contains("not 11"));
  CHECK(nurbs({}, {0, 0, 0, 0, 1, 1, 0.5, 1}, v) == "knots_u decreases at 6");
  CHECK(nurbs({}, u, {0, 0, 0, 1, 1, INFINITY}) == "knots_v[5] is not finite");
  CHECK_THAT(nurbs({}, {0, 0, 1, 1, 1}, v), Catch::Equals("len(knots_u) must be from 6 to 8, not 5"));
  CHECK_THAT(nurbs({}, u, {0, 0, 0, 0, 0, 0}), Catch::Equals("knots_v repeats knot 2 too often for degree 2"));
  CHECK_THAT(nurbs({}, {0, 0, 0.5, 0.5, 1, 1}, v), Catch::Equals("knots_u repeats knot 2 too often for degree 1"));
  Points bad = points;
  bad(5, 1) = std::nan("");
  CHECK(message([&] { NurbsSurface(bad, 4, 3, {}, u, v); }) == "points[1, 2] is not finite");
  CHECK(message([&] { BezierRectangle(bad, 3, 2); }) == "net[1, 2] is not finite");
  CHECK_THAT(message([&] { BezierRectangle(points, 3, 3); }), Catch::Contains("16 points, not 12"));
  CHECK_THAT(message([&] { BezierRectangle(points, 11, 0); }), Catch::Contains("from 1 to 20, not 0"));
  CHECK_THROWS_AS(BezierRectangle(points, 3, 2).side(4, false), InvalidArgument);
  Points pole = points;
  for (int j = 0; j < 3; ++j) pole.row(j) = points.row(0);
  CHECK_THROWS_WITH(BezierRectangle(pole, 3, 2).side(3, false), "Edge 3 of the surface is a single point");
  CHECK_NOTHROW(BezierRectangle(pole, 3, 2).side(1, false));
}
