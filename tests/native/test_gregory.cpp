#include "test_surfaces.h"
#include "tripatch/constructions/gregory.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

SurfacePtr make(const Sides& sides) { return gregory(make_boundary(sides)); }

}  // namespace

TEST_CASE("gregory keeps its promises") { check_promises(make, 1); }

TEST_CASE("gregory reproduces polynomials of degree 3, and no more") {
  for (int degree = 1; degree <= 3; ++degree) CHECK(reproduction_error(make, degree) < 1e-12);
  CHECK(reproduction_error(make, 4) > 1e-3);
}

// Straight from Gregory 1974: p_i = (T_j + T_k - T_j T_k) F about vertex i with T the linear Taylor operators across the two sides,
// for a function whose twists agree; weights b_i^2 (3 - 2 b_i + 6 b_j b_k).
TEST_CASE("gregory is the convex combination of Taylor sums where twists agree") {
  const SurfacePtr surface = wave();
  const SurfacePtr patch = make(sides_of(surface));
  const auto value = [&](const Vec3& b) {
    Vec3 p;
    surface->evaluate(b.data(), 1, 0, p.data());
    return p;
  };
  const auto derivative = [&](const Vec3& b, const Vec3& v) {
    Vec3 p, d;
    sample(*surface, b.data(), v, p, d);
    return d;
  };
  for (const Vec3& b : {Vec3(0.3, 0.5, 0.2), Vec3(0.15, 0.15, 0.7), Vec3(0.6, 0.1, 0.3)}) {
    Vec3 expected = Vec3::Zero();
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const double x = b[j], y = b[k], h = 1e-4;
      const Vec3 ex = Vec3::Unit(j) - Vec3::Unit(i), ey = Vec3::Unit(k) - Vec3::Unit(i), at = Vec3::Unit(i);
      const Vec3 twist = (derivative(at + h * ex, ey) - derivative(at - h * ex, ey)) / (2 * h);
      const Vec3 p = value(at + x * ex) + y * derivative(at + x * ex, ey) + value(at + y * ey) + x * derivative(at + y * ey, ex) -
                     value(at) - x * derivative(at, ex) - y * derivative(at, ey) - x * y * twist;
      expected += b[i] * b[i] * (3 - 2 * b[i] + 6 * b[j] * b[k]) * p;
    }
    Vec3 found;
    patch->evaluate(b.data(), 1, 0, found.data());
    CHECK((found - expected).norm() < 1e-8);
  }
}
