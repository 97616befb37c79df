#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "tripatch/patch/bezier_triangle.h"

using namespace tripatch;

namespace {

Points random_net(int degree, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points net(BezierTriangle::net_size(degree), 3);
  for (double& x : net.reshaped()) x = uniform(random);
  return net;
}

/// The second evaluator: the Bernstein sum, term by term.
Vec3 bernstein_sum(const BezierTriangle& triangle, const Vec3& b) {
  const int n = triangle.degree();
  Vec3 p = Vec3::Zero();
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const int k = n - i - j;
      const double weight = std::tgamma(n + 1.0) / (std::tgamma(i + 1.0) * std::tgamma(j + 1.0) * std::tgamma(k + 1.0));
      p += weight * std::pow(b[0], i) * std::pow(b[1], j) * std::pow(b[2], k) * triangle.net().row(BezierTriangle::row(i, j, k));
    }
  return p;
}

const std::array<Vec3, 4> places = {Vec3(0.2, 0.3, 0.5), Vec3(0.9, 0.04, 0.06), Vec3(0, 0.25, 0.75), Vec3(0, 1, 0)};

}  // namespace

TEST_CASE("de Casteljau and the Bernstein sum give the same point and derivatives") {
  for (int degree = 0; degree <= 20; ++degree) {
    const BezierTriangle triangle(random_net(degree, 100 + degree));
    REQUIRE(triangle.degree() == degree);
    for (const Vec3& b : places) {
      std::array<double, 3 * jet_size(4)> jet;
      triangle.evaluate(b.data(), 1, 4, jet.data());
      BezierTriangle row = triangle;  // differentiated i times in direction 0
      for (int i = 0; i <= 4; ++i, row = row.derivative({1, 0, -1})) {
        BezierTriangle mixed = row;
        for (int j = 0; i + j <= 4; ++j, mixed = mixed.derivative({0, 1, -1})) {
          const double factorials = std::tgamma(i + 1.0) * std::tgamma(j + 1.0);
          const Vec3 ours = factorials * Eigen::Map<const Vec3>(&jet[3 * jet_index(i, j)]);
          const double scale = std::pow(std::max(degree, 1), i + j);
          CHECK((ours - bernstein_sum(mixed, b)).norm() < 1e-12 * scale);
        }
      }
    }
  }
}

TEST_CASE("evaluation of a lower order is the head of that of a higher order") {
  const BezierTriangle triangle(random_net(7, 5));
  std::array<double, 3 * jet_size(4)> all;
  for (int order = 0; order <= 4; ++order) {
    std::vector<double> jet(3 * jet_size(order));
    triangle.evaluate(places[0].data(), 1, order, jet.data());
    triangle.evaluate(places[0].data(), 1, 4, all.data());
    for (std::size_t k = 0; k < jet.size(); ++k) CHECK(jet[k] == Approx(all[k]).epsilon(1e-13));
  }
  CHECK_THROWS_AS(triangle.evaluate(places[0].data(), 1, 5, all.data()), InvalidArgument);
}

TEST_CASE("degree elevation keeps the surface") {
  for (int degree : {0, 1, 3, 8, 20}) {
    const BezierTriangle triangle(random_net(degree, degree)), elevated = triangle.elevated();
    CHECK(elevated.degree() == degree + 1);
    for (const Vec3& b : places) {
      const Points at = b.transpose();
      CHECK((triangle.positions(at) - elevated.positions(at)).norm() < 1e-14 * (degree + 1));
    }
    for (int i = 0; i < 3; ++i) CHECK((elevated.side(i) - elevated_curve(triangle.side(i))).norm() < 1e-14 * (degree + 1));
  }
}

TEST_CASE("sides run from corner i + 1 to corner i + 2 and are the boundary curves") {
  const BezierTriangle triangle(random_net(5, 1));
  for (int i = 0; i < 3; ++i) {
    const Points side = triangle.side(i);
    CHECK(side.row(0) == triangle.net().row(side_row(5, i, 0)));
    Points corner = Points::Zero(1, 3);
    corner(0, (i + 1) % 3) = 1;
    CHECK((triangle.positions(corner) - side.row(0)).norm() < 1e-15);
    const double t = 0.3;
    Points curve = side, at = Points::Zero(1, 3);
    for (Index n = 5; n > 0; --n)
      for (Index k = 0; k < n; ++k) curve.row(k) = (1 - t) * curve.row(k) + t * curve.row(k + 1);
    at(0, (i + 1) % 3) = 1 - t;
    at(0, (i + 2) % 3) = t;
    CHECK((triangle.positions(at) - curve.row(0)).norm() < 1e-14);
  }
}

TEST_CASE("nets of a wrong size and points that are not finite are named") {
  CHECK_THROWS_WITH(BezierTriangle(Points(Points::Zero(7, 3))), Catch::Contains("not 7"));
  CHECK_THROWS_WITH(BezierTriangle(Points(Points::Zero(0, 3))), Catch::Contains("not 0"));
  CHECK_THROWS_AS(BezierTriangle(Points(Points::Zero(BezierTriangle::net_size(41), 3))), InvalidArgument);
  Points net = random_net(3, 1);
  net(6, 1) = std::nan("");
  CHECK_THROWS_WITH(BezierTriangle(net), "net[6] is not finite");
}
