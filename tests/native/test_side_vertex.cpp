#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/patch/side_vertex.h"
#include "tripatch/report/report.h"

using namespace tripatch;

namespace {

/// A graph surface z = f(x, y) over a triangle: sides as polynomials fitted to working precision.
Sides graph_sides(const std::array<Eigen::Vector2d, 3>& corner, const std::function<double(double, double)>& f,
                  const std::function<Eigen::Vector2d(double, double)>& gradient) {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d a = corner[(i + 1) % 3], b = corner[(i + 2) % 3];
    const Eigen::Vector2d away = 0.5 * (a + b) - corner[i];
    sides[i].c = PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k) {
            const Eigen::Vector2d p = a + t[k] * (b - a);
            out[3 * k] = p[0];
            out[3 * k + 1] = p[1];
            out[3 * k + 2] = f(p[0], p[1]);
          }
        },
        3);
    sides[i].r = PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k) {
            const Eigen::Vector2d p = a + t[k] * (b - a);
            out[3 * k] = away[0];
            out[3 * k + 1] = away[1];
            out[3 * k + 2] = gradient(p[0], p[1]).dot(away);
          }
        },
        3);
  }
  return sides;
}

const std::array<Eigen::Vector2d, 3> triangle = {Eigen::Vector2d(0.1, 0), Eigen::Vector2d(1.2, 0.3), Eigen::Vector2d(0.4, 0.9)};

}  // namespace

TEST_CASE("side-vertex reproduces cubics") {
  auto f = [](double x, double y) { return 1 + x - y + x * x * y - 2 * y * y * y + 0.5 * x * y; };
  auto g = [](double x, double y) { return Eigen::Vector2d(1 + 2 * x * y + 0.5 * y, -1 + x * x - 6 * y * y + 0.5 * x); };
  const SurfacePtr patch = side_vertex(make_boundary(graph_sides(triangle, f, g)));
  double worst = 0;
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; i + j <= 20; ++j) {
      Points b(1, 3);
      b << i / 20.0, j / 20.0, (20 - i - j) / 20.0;
      const Vec3 p = patch->positions(b).row(0);
      worst = std::max(worst, std::abs(p[2] - f(p[0], p[1])));
    }
  CHECK(worst < 1e-12);
}
