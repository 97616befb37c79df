#include "test_surfaces.h"
#include "tripatch/constructions/barnhill_birkhoff_gordon.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

SurfacePtr make(const Sides& sides) { return barnhill_birkhoff_gordon(make_boundary(sides)); }

}  // namespace

TEST_CASE("barnhill_birkhoff_gordon keeps its promises") { check_promises(make, 1); }

TEST_CASE("barnhill_birkhoff_gordon reproduces polynomials of degree 5, and no more") {
  for (int degree = 1; degree <= 5; ++degree) CHECK(reproduction_error(make, degree) < 1e-12);
  CHECK(reproduction_error(make, 6) > 1e-3);
}

namespace {

// Cubic Hermite loft of a whole surface along the lines parallel to side i, and the discrete sum P_j + P_i - P_j P_i, both straight
// from their definition: an evaluator that knows neither residuals nor ribbons.
using Field = std::function<Vec3(const Vec3&)>;

Field loft(const Field& f, int i) {
  return [f, i](const Vec3& b) -> Vec3 {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const double length = b[j] + b[k], s = b[k] / length, h = 0.01;
    const Vec3 from = b[i] * Vec3::Unit(i) + length * Vec3::Unit(j), to = b[i] * Vec3::Unit(i) + length * Vec3::Unit(k);
    const Vec3 along = Vec3::Unit(k) - Vec3::Unit(j);
    const auto slope = [&](const Vec3& at) -> Vec3 {  // sixth order
      const auto odd = [&](int n) -> Vec3 { return f(at + n * h * along) - f(at - n * h * along); };
      return (45 * odd(1) - 9 * odd(2) + odd(3)) / (60 * h);
    };
    return (1 - s) * (1 - s) * (1 + 2 * s) * f(from) + s * (1 - s) * (1 - s) * length * slope(from) +
           s * s * (3 - 2 * s) * f(to) - s * s * (1 - s) * length * slope(to);
  };
}

}  // namespace

TEST_CASE("barnhill_birkhoff_gordon is the mean of the six Boolean sums") {
  const SurfacePtr surface = bezier(random_net(6, 4));
  const Field f = [&](const Vec3& b) {
    Vec3 p;
    surface->evaluate(b.data(), 1, 0, p.data());
    return p;
  };
  const SurfacePtr patch = make(sides_of(surface));
  for (const Vec3& b : {Vec3(0.3, 0.5, 0.2), Vec3(0.15, 0.15, 0.7), Vec3(0.6, 0.1, 0.3)}) {
    Vec3 mean = Vec3::Zero();
    for (int i = 0; i < 3; ++i)
      for (int other = 1; other < 3; ++other) {
        const int j = (i + other) % 3;
        mean += (loft(f, j)(b) + loft(f, i)(b) - loft(loft(f, i), j)(b)) / 6;
      }
    CHECK((f(b) - mean).norm() > 1e-5);  // degree 6 is not reproduced
    Vec3 found;
    patch->evaluate(b.data(), 1, 0, found.data());
    CHECK((found - mean).norm() < 1e-9);
  }
}
