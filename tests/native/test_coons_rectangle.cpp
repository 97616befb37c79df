#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "tripatch/constructions/coons_rectangle.h"

using namespace tripatch;

namespace {

BezierRectangle random_rectangle(int m, int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points net((m + 1) * (n + 1), 3);
  for (double& x : net.reshaped()) x = uniform(random);
  return {net, m, n};
}

Vec3 at(const RectangleSurface& surface, double u, double v) {
  Vec3 p;
  const std::array<double, 2> uv = {u, v};
  surface.evaluate(uv.data(), 1, 0, p.data());
  return p;
}

using Curve = std::function<Vec3(double)>;
/// The bilinearly blended Coons patch (section 2) of the curves v = 0, u = 1, v = 1, u = 0, each along u or v.
Vec3 coons(const std::array<Curve, 4>& c, double u, double v) {
  return (1 - u) * c[3](v) + u * c[1](v) + (1 - v) * c[0](u) + v * c[2](u) - (1 - u) * ((1 - v) * c[0](0) + v * c[2](0)) -
         u * ((1 - v) * c[0](1) + v * c[2](1));
}

/// The Coons patch of the edges of the piece [u0, u1] x [v0, v1], at (s, t) of that piece.
Vec3 coons_of_piece(const RectangleSurface& surface, double u0, double u1, double v0, double v1, double s, double t) {
  const auto u = [=](double x) { return u0 + x * (u1 - u0); };
  const auto v = [=](double x) { return v0 + x * (v1 - v0); };
  return coons({[&](double x) { return at(surface, u(x), v0); }, [&](double x) { return at(surface, u1, v(x)); },
                [&](double x) { return at(surface, u(x), v1); }, [&](double x) { return at(surface, u0, v(x)); }},
               s, t);
}

}  // namespace

TEST_CASE("the rectangular discrete Coons net is the Coons patch of its boundary curves") {
  for (auto [m, n] : {std::pair{2, 2}, {3, 5}, {8, 4}}) {
    const BezierRectangle patch = coons_rectangle(random_rectangle(m, n, m));
    for (double u : {0.0, 0.3, 0.8, 1.0})
      for (double v : {0.0, 0.4, 0.9}) CHECK((at(patch, u, v) - coons_of_piece(patch, 0, 1, 0, 1, u, v)).norm() < 1e-14);
  }
}

TEST_CASE("the permanence principle holds for rectangular Coons patches") {
  const BezierRectangle patch = coons_rectangle(random_rectangle(4, 5, 2));
  for (double s : {0.2, 0.5, 0.7})
    for (double t : {0.3, 0.6})
      CHECK((coons_of_piece(patch, 0.1, 0.6, 0.25, 0.9, s, t) - at(patch, 0.1 + 0.5 * s, 0.25 + 0.65 * t)).norm() < 1e-14);
  // and not for any surface
  const BezierRectangle other = random_rectangle(4, 5, 2);
  CHECK((coons_of_piece(other, 0.1, 0.6, 0.25, 0.9, 0.5, 0.5) - at(other, 0.35, 0.575)).norm() > 1e-3);
}

TEST_CASE("the mask with alpha -1/4 gives the discrete Coons patch, others do not") {
  for (auto [m, n] : {std::pair{2, 2}, {3, 5}, {8, 4}}) {
    const BezierRectangle boundary = random_rectangle(m, n, 9);
    CHECK((permanence_rectangle(boundary).net() - coons_rectangle(boundary).net()).norm() < 1e-12);
    if (m > 2) CHECK((permanence_rectangle(boundary, 0.1).net() - coons_rectangle(boundary).net()).norm() > 1e-2);
  }
}

TEST_CASE("the rectangular Coons patch has the least integral of |x_uv|^2 of all with its boundary") {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  const int m = 5, n = 4;
  const BezierRectangle patch = coons_rectangle(random_rectangle(m, n, 3));
  const double least = coons_energy(patch);
  for (int trial = 0; trial < 50; ++trial) {
    Points net = patch.net();
    for (int i = 1; i < m; ++i)
      for (int j = 1; j < n; ++j)
        for (int x = 0; x < 3; ++x) net(patch.row(i, j), x) += 0.01 * normal(random);
    CHECK(coons_energy({net, m, n}) > least);
  }
  // against quadrature: the midpoint rule is of order 2
  double sum = 0;
  const int steps = 400;
  for (int a = 0; a < steps; ++a)
    for (int b = 0; b < steps; ++b) {
      const std::array<double, 2> uv = {(a + 0.5) / steps, (b + 0.5) / steps};
      std::array<double, 18> jet;
      patch.evaluate(uv.data(), 1, 2, jet.data());
      sum += Vec3::Map(&jet[12]).squaredNorm() / (steps * steps);
    }
  CHECK(least == Approx(sum).epsilon(1e-4));
}
