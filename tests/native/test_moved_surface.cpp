#include <catch2/catch.hpp>

#include "tripatch/math/jet.h"
#include "tripatch/patch/moved_surface.h"

using namespace tripatch;

namespace {

constexpr int degree = 4;

/// A polynomial of degree 4 over the plane: its Taylor coefficients at one place give it at every other.
class Quartic final : public Surface {
public:
  void evaluate(const double* b, Index n, int order, double* out) const override {
    for (Index k = 0; k < n; ++k) {
      const Jet<degree> u = Jet<degree>::linear(b[3 * k], 1, 0), v = Jet<degree>::linear(b[3 * k + 1], 0, 1);
      JetPoint<degree> p;
      p.x = {1.0 + u - 2.0 * v + u * v * v * v + 0.5 * (v * v), v * v * v - u * u * v + 3.0 * u, u * u * v * v - v + 2.0};
      for (int at = 0; at < jet_size(order); ++at)
        for (int x = 0; x < 3; ++x) *out++ = p.x[x].c[at];
    }
  }
};

Vec3 place(const Surface& surface, double u, double v) {
  const std::array<double, 3> at = {u, v, 0};
  Vec3 p;
  surface.evaluate(at.data(), 1, 0, p.data());
  return p;
}

/// What the Taylor coefficients at one place say of others.
double expansion_error(const Surface& surface) {
  const std::array<double, 3> from = {0.3, -0.4, 0};
  std::array<double, 3 * jet_size(degree)> jets;
  surface.evaluate(from.data(), 1, degree, jets.data());
  double error = 0;
  for (double du : {0.0, 0.5, -1.0})
    for (double dv : {0.0, 0.7, -2.0}) {
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i <= degree; ++i)
        for (int j = 0; i + j <= degree; ++j) sum += std::pow(du, i) * std::pow(dv, j) * Vec3::Map(&jets[3 * jet_index(i, j)]);
      error = std::max(error, (sum - place(surface, from[0] + du, from[1] + dv)).norm());
    }
  return error;
}

}  // namespace

TEST_CASE("a mirrored surface is the mirror image of what lies at the mirrored place, with all derivatives") {
  const SurfacePtr given = std::make_shared<Quartic>(), image = mirrored(given);
  for (double v : {0.0, 0.8}) {
    const Vec3 p = place(*given, 0.6, -v);
    CHECK((place(*image, 0.6, v) - Vec3(-p[0], p[1], p[2])).norm() < 1e-14);
  }
  CHECK(expansion_error(*given) < 1e-12);
  CHECK(expansion_error(*image) < 1e-12);
}

TEST_CASE("a moved surface has the derivatives that it had") {
  const SurfacePtr given = std::make_shared<Quartic>(), there = moved(given, Vec3(3, -1, 2));
  CHECK((place(*there, 0.6, 0.8) - place(*given, 0.6, 0.8) - Vec3(3, -1, 2)).norm() < 1e-14);
  CHECK(expansion_error(*there) < 1e-12);
}
