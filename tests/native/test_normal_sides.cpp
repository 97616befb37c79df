#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tripatch/boundary/normal_sides.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/constructions/smits_patch.h"
#include "tripatch/messages.h"

using namespace tripatch;

namespace {

double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi; }

const std::array<Vec3, 3> points = {Vec3(0, 0, 0.1), Vec3(1.1, 0.1, 0), Vec3(0.2, 0.9, 0.3)};
const std::array<Vec3, 3> normals = {Vec3(-0.3, -0.2, 1).normalized(), Vec3(0.5, -0.1, 1).normalized(),
                                     Vec3(0.1, 0.4, 1).normalized()};

}  // namespace

TEST_CASE("Smits's curves are those of equations 4 to 9") {
  const Sides sides = sides_from_normals(points, normals, NormalCurve::smits);
  for (int i = 0; i < 3; ++i) {
    const Vec3 p0 = points[(i + 1) % 3], p1 = points[(i + 2) % 3], n0 = normals[(i + 1) % 3], n1 = normals[(i + 2) % 3];
    for (double beta : {0.0, 0.2, 0.5, 0.9, 1.0}) {
      const double h = n0.dot(p0 - p1) * (1 - beta) * (1 - beta) * beta - n1.dot(p0 - p1) * (1 - beta) * beta * beta;
      const Vec3 expected = (1 - beta) * p0 + beta * p1 + h * ((1 - beta) * n0 + beta * n1);
      CHECK((sides[i].c(beta) - expected).norm() < 1e-15);
    }
  }
}

TEST_CASE("curves over an edge are orthogonal to the normals at its ends, and the normal field to the curve") {
  for (NormalCurve curve : {NormalCurve::hermite, NormalCurve::smits}) {
    const Sides sides = sides_from_normals(points, normals, curve);
    CHECK(check_sides(sides) > 1);
    for (int i = 0; i < 3; ++i) {
      CHECK((sides[i].c(0) - points[(i + 1) % 3]).norm() < 1e-15);
      CHECK((sides[i].c(1) - points[(i + 2) % 3]).norm() < 1e-15);
      CHECK(degrees_between(sides[i].normal(0), normals[(i + 1) % 3]) < 1e-12);
      CHECK(degrees_between(sides[i].normal(1), normals[(i + 2) % 3]) < 1e-12);
      for (double t : {0.0, 0.3, 0.5, 0.8, 1.0}) {
        const Vec3 dc = sides[i].c.derivative_at(t), n = sides[i].normal(t);
        CHECK(std::abs(dc.dot(n)) < 1e-15);
        // the linear mix of the end normals, made orthogonal to the curve
        Vec3 mix = (1 - t) * normals[(i + 1) % 3] + t * normals[(i + 2) % 3];
        mix -= mix.dot(dc) / dc.squaredNorm() * dc;
        CHECK(degrees_between(mix, n) < 1e-12);
        CHECK(sides[i].r(t).dot(sides[i].c(t) - (points[0] + points[1] + points[2]) / 3) > 0);  // away from the triangle
      }
    }
  }
}

TEST_CASE("Hermite tangents are as long as the arc") {
  for (double angle : {0.01, 0.5, 1.5, 3.0}) {
    const Vec3 p(1, 0, 0), q(std::cos(angle), std::sin(angle), 0);
    const Side side = side_from_normals(2 * p, p, 2 * q, q, NormalCurve::hermite);
    CHECK(side.c.derivative_at(0).norm() == Approx(2 * angle).epsilon(1e-12));
    CHECK(side.c.derivative_at(1).norm() == Approx(2 * angle).epsilon(1e-12));
  }
}

TEST_CASE("an edge gives the same bits from both its triangles") {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  for (int trial = 0; trial < 50; ++trial)
    for (NormalCurve curve : {NormalCurve::hermite, NormalCurve::smits}) {
      const Vec3 p = vector(), q = vector(), n = vector(), m = n + 0.3 * vector();
      const Side there = side_from_normals(p, n, q, m, curve), back = side_from_normals(q, m, p, n, curve);
      for (double t : {0.0, 0.25, 0.5, 0.625, 1.0}) {
        CHECK(there.c(t) == back.c(1 - t));
        CHECK(there.r(t) == -back.r(1 - t));
      }
    }
}

TEST_CASE("a side-vertex patch on sides from normals has their normal field along all sides") {
  for (NormalCurve curve : {NormalCurve::hermite, NormalCurve::smits}) {
    const Sides sides = sides_from_normals(points, normals, curve);
    const SurfacePtr patch = side_vertex(make_boundary(sides));
    for (int i = 0; i < 3; ++i)
      for (int k = 1; k < 20; ++k) {
        const double t = k / 20.0;
        Points b = Points::Zero(1, 3);
        b(0, (i + 1) % 3) = 1 - t;
        b(0, (i + 2) % 3) = t;
        CHECK((patch->positions(b).row(0).transpose() - sides[i].c(t)).norm() < 1e-14);
        CHECK(degrees_between(patch->normals(b).row(0), sides[i].normal(t)) < 1e-6);
      }
  }
}

TEST_CASE("the fill of Smits's page meets his curves, not their normal field") {
  const SurfacePtr patch = smits_patch(points, normals);
  const Sides sides = sides_from_normals(points, normals, NormalCurve::smits);
  double angle = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= 10; ++k) {
      const double t = k / 10.0;
      Points b = Points::Zero(1, 3);
      b(0, (i + 1) % 3) = 1 - t;
      b(0, (i + 2) % 3) = t;
      CHECK((patch->positions(b).row(0).transpose() - sides[i].c(t)).norm() < 1e-15);
      angle = std::max(angle, degrees_between(patch->normals(b).row(0), sides[i].normal(t)));
    }
  CHECK(angle > 0.1);
  CHECK(angle < 20);
  // it does not depend on the numbering
  Points b(2, 3);
  b << 0.2, 0.3, 0.5, 0.5, 0.2, 0.3;
  const SurfacePtr turned = smits_patch({points[2], points[0], points[1]}, {normals[2], normals[0], normals[1]});
  CHECK((patch->positions(b.row(0)) - turned->positions(b.row(1))).norm() < 1e-15);
  CHECK_THROWS_AS(smits_patch(points, {normals[0], Vec3::Zero(), normals[2]}), Refusal);
}

TEST_CASE("normals that determine no curve are refused, with the corner") {
  const auto where = [](std::array<Vec3, 3> p, std::array<Vec3, 3> n) {
    try {
      sides_from_normals(p, n);
    } catch (const CodedRefusal& refusal) {
      INFO(refusal.what());
      CHECK(std::string(refusal.what()).find(std::to_string(refusal.where().at(0))) != std::string::npos);
      return refusal.where();
    }
    return std::vector<Index>();
  };
  for (Index k = 0; k < 3; ++k) {
    std::array<Vec3, 3> p = points, n = normals;
    n[k] = Vec3::Zero();
    CHECK(where(p, n) == std::vector<Index>{k});
    n[k] = Vec3(0, std::nan(""), 1);
    CHECK(where(p, n) == std::vector<Index>{k});
    n[k] = points[(k + 1) % 3] - points[k];
    CHECK(where(p, n) == std::vector<Index>{k});
    n = normals;
    p[k][1] = std::numeric_limits<double>::infinity();
    CHECK(where(p, n) == std::vector<Index>{k});
    p = points;
    p[k] = p[(k + 1) % 3];
    CHECK(where(p, n).size() == 2);
    const Vec3 chord = points[(k + 1) % 3] - points[k];
    n[k] = chord.cross(Vec3(1, 1, 1));
    n[(k + 1) % 3] = -n[k];
    CHECK(where(points, n).size() == 2);
  }
}
