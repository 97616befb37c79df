#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/creases/hinged_surface.h"
#include "tripatch/math/jet.h"

using namespace tripatch;

namespace {

/// P = (u, v, g(u, v)) with g = 1 + 2 u - v + u^2 / 2 - 3 u v + v^2 + u^3 + 2 u^2 v - u v^2 + v^3 / 3, all of whose derivatives are seen.
class Cubic final : public Surface {
public:
  void evaluate(const double* b, Index n, int order, double* out) const override {
    for (Index k = 0; k < n; ++k) {
      const double u = b[3 * k], v = b[3 * k + 1];
      const double g[] = {1 + 2 * u - v + u * u / 2 - 3 * u * v + v * v + u * u * u + 2 * u * u * v - u * v * v + v * v * v / 3,
                          2 + u - 3 * v + 3 * u * u + 4 * u * v - v * v,
                          -1 - 3 * u + 2 * v + 2 * u * u - 2 * u * v + v * v,
                          0.5 + 3 * u + 2 * v,
                          -3 + 4 * u - 2 * v,
                          1 - u + v,
                          1,
                          2,
                          -1,
                          1.0 / 3};
      const double x[] = {u, 1, 0}, y[] = {v, 0, 1};
      for (int at = 0; at < jet_size(order); ++at) {
        *out++ = at < 3 ? x[at] : 0;
        *out++ = at < 3 ? y[at] : 0;
        *out++ = g[at];
      }
    }
  }
};

PlaneMotion turned(double angle, double x, double y) {
  PlaneMotion motion;
  motion.turn = Eigen::Rotation2Dd(angle).toRotationMatrix();
  motion.shift << x, y;
  return motion;
}

}  // namespace

TEST_CASE("a hinged surface: derivatives in the common plane are those of the part, turned") {
  PlanePoints square(4, 2);
  square << -1, -1, 1, -1, 1, 1, -1, 1;
  const auto cubic = std::make_shared<Cubic>();
  const PlaneMotion left = turned(0.4, -1.5, 0), right = turned(-1.1, 1.5, 0.2);
  const HingedSurface hinged({{cubic, square, left}, {cubic, square, right}});
  for (const PlaneMotion& motion : {left, right}) {
    PlanePoints own(1, 2);
    own << 0.3, -0.2;
    const PlanePoints at = motion.of(own);
    double jet[3 * jet_size(3)], b[3] = {at(0, 0), at(0, 1), 0};
    hinged.evaluate(b, 1, 3, jet);
    const Eigen::RowVector2d step(0.07, -0.05);  // the surface is its own Taylor polynomial
    PlanePoints beside = at + step;
    double there[3], expected[3], moved[3] = {beside(0, 0), beside(0, 1), 0};
    hinged.evaluate(moved, 1, 0, there);
    const PlanePoints back = motion.back(beside);
    const double in_part[3] = {back(0, 0), back(0, 1), 0};
    cubic->evaluate(in_part, 1, 0, expected);
    for (int axis = 0; axis < 3; ++axis) {
      CHECK(there[axis] == Approx(expected[axis]).margin(1e-14));
      double sum = 0;
      for (int degree = 0; degree <= 3; ++degree)
        for (int j = 0; j <= degree; ++j)
          sum += jet[3 * jet_index(degree - j, j) + axis] * std::pow(step[0], degree - j) * std::pow(step[1], j);
      CHECK(sum == Approx(expected[axis]).margin(1e-13));
    }
  }
}

TEST_CASE("a hinged surface: a point is of the part in whose border it lies, else of the nearest") {
  PlanePoints square(4, 2);
  square << 0, 0, 1, 0, 1, 1, 0, 1;
  const auto cubic = std::make_shared<Cubic>();
  const HingedSurface hinged({{cubic, square, turned(0, 0, 0)}, {cubic, square, turned(0, 2, 0)}});
  for (const auto& [x, u] : {std::pair{0.5, 0.5}, {2.5, 0.5}, {1.4, 1.4}, {1.6, -0.4}, {-0.3, -0.3}, {3.2, 1.2}}) {
    double p[3], b[3] = {x, 0.5, 0};
    hinged.evaluate(b, 1, 0, p);
    CHECK(p[0] == Approx(u));
  }
}
