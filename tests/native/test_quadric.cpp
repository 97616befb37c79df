// Quadrics through points: known surfaces, what points cannot tell, and the stated deviation under noise.
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "tripatch/estimate/quadric.h"

using namespace tripatch;

namespace {

struct Known {
  const char* name;
  std::function<Vec3(double, double)> at;
  std::function<double(const Vec3&)> off;  ///< distance, to first order
};

const std::vector<Known>& known() {
  static const std::vector<Known> all = {
      {"sphere", [](double u, double v) { return Vec3(std::cos(v) * std::cos(u), std::cos(v) * std::sin(u), std::sin(v)); },
       [](const Vec3& x) { return x.norm() - 1; }},
      {"cylinder", [](double u, double v) { return Vec3(std::cos(u), std::sin(u), v); },
       [](const Vec3& x) { return std::hypot(x[0], x[1]) - 1; }},
      {"cone", [](double u, double v) { return Vec3((2 + v) * std::cos(u), (2 + v) * std::sin(u), v); },
       [](const Vec3& x) { return (std::hypot(x[0], x[1]) - x[2] - 2) / std::sqrt(2.0); }},
      {"saddle", [](double u, double v) { return Vec3(u, v, u * v); }, [](const Vec3& x) { return x[2] - x[0] * x[1]; }},
  };
  return all;
}

/// Turned, moved and scaled by an odd factor.
Vec3 placed(const Vec3& x) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return 37.5 * (turn * x) + Vec3(100, -20, 3);
}
Vec3 taken_back(const Vec3& y) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  return turn.transpose() * ((y - Vec3(100, -20, 3)) / 37.5);
}

/// Around a gap in the middle: the gap is where the quadric is asked for.
Points sampled(const Known& surface, double inner, double outer, int n, double noise, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal(0, 1);
  Points out(n, 3);
  for (int k = 0; k < n; ++k) {
    const double r = inner + (outer - inner) * unit(random), a = 6.283185307179586 * unit(random);
    const Vec3 off(normal(random), normal(random), normal(random));
    out.row(k) = placed(surface.at(r * std::cos(a), r * std::sin(a)) + noise * off);
  }
  return out;
}

}  // namespace

TEST_CASE("what lies on a quadric tells it to rounding, also where nothing was known") {
  for (const Known& surface : known()) {
    INFO(surface.name);
    const auto quadric = Quadric::through(sampled(surface, 0.4, 0.6, 60, 0, 1));
    REQUIRE(quadric);
    const Points there = sampled(surface, 0, 0.4, 50, 0.05, 2), moved = quadric->nearest(there);
    for (Index k = 0; k < moved.rows(); ++k) CHECK(std::abs(surface.off(taken_back(moved.row(k)))) < 1e-10);
    CHECK(quadric->deviation(moved, 0.1).maxCoeff() < 1e-6);
    const Points normals = quadric->normals(moved, there - moved);
    for (Index k = 0; k < moved.rows(); ++k) {
      const Vec3 way = there.row(k) - moved.row(k);
      CHECK(way.cross(Vec3(normals.row(k))).norm() < 0.2 * way.norm() + 1e-9);
      CHECK(way.dot(Vec3(normals.row(k))) >= 0);
    }
  }
}

TEST_CASE("the deviation is that of the truth under noise, or more") {
  for (const Known& surface : known()) {
    INFO(surface.name);
    double squares = 0, expected = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
      const auto quadric = Quadric::through(sampled(surface, 0.4, 0.6, 60, 0.002, seed));
      REQUIRE(quadric);
      const Points moved = quadric->nearest(sampled(surface, 0, 0.4, 30, 0, seed + 100));
      const Eigen::VectorXd deviation = quadric->deviation(moved, 0.1);
      for (Index k = 0; k < moved.rows(); ++k) squares += std::pow(37.5 * surface.off(taken_back(moved.row(k))), 2);
      expected += deviation.squaredNorm();
    }
    CHECK(squares < expected);
  }
}

TEST_CASE("too few points, one plane and two planes tell no quadric that a surface has") {
  CHECK(!Quadric::through(sampled(known()[0], 0.4, 0.6, 19, 0, 1)));
  CHECK(!Quadric::through(Points::Ones(40, 3)));
  const Known plane = {"plane", [](double u, double v) { return Vec3(u, v, 0); }, [](const Vec3& x) { return x[2]; }};
  const Known roof = {"roof", [](double u, double v) { return Vec3(u, v, -std::abs(u)); }, {}};
  if (const auto quadric = Quadric::through(sampled(plane, 0.4, 0.6, 60, 0, 1))) {
    const Points there = sampled(plane, 0, 0.4, 20, 0, 2);
    CHECK(quadric->deviation(there, 0.1).minCoeff() > 1e-8);  // what a plane is known to is less
  }
  const auto quadric = Quadric::through(sampled(roof, 0.4, 0.6, 60, 0, 1));
  REQUIRE(quadric);
  const Points edge = placed(Vec3(0.01, 0, 0)).transpose();
  CHECK(std::isinf(quadric->deviation(edge, 37.5 * 0.1)[0]));
}
