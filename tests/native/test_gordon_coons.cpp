#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/constructions/gordon_coons.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

SurfacePtr make(const Sides& sides) { return gordon_coons({sides[0].c, sides[1].c, sides[2].c}); }

}  // namespace

TEST_CASE("gordon_coons keeps its promises") { check_promises(make, 0); }

TEST_CASE("gordon_coons reproduces polynomials of degree 2, and no more") {
  for (int degree = 1; degree <= 2; ++degree) CHECK(reproduction_error(make, degree) < 1e-12);
  CHECK(reproduction_error(make, 3) > 1e-3);
}

// W(x, y) as Barnhill, Birkhoff and Gordon print it, for a function F on the triangle (0, 0), (1, 0), (0, 1): x = b0, y = b1.
TEST_CASE("gordon_coons is the parametric form of W(x, y)") {
  const SurfacePtr surface = wave();
  const auto f = [&](double x, double y) {
    Points b(1, 3);
    b << x, y, 1 - x - y;
    return Vec3(surface->positions(b).row(0));
  };
  const SurfacePtr patch = make(sides_of(surface));
  for (const auto& [x, y] : {std::pair(0.2, 0.3), std::pair(0.7, 0.1), std::pair(0.1, 0.85)}) {
    const double z = 1 - x - y;
    const Vec3 w = 0.5 * (z / (1 - y) * f(0, y) + x / (1 - y) * f(1 - y, y) + z / (1 - x) * f(x, 0) + y / (1 - x) * f(x, 1 - x) +
                          x / (x + y) * f(x + y, 0) + y / (x + y) * f(0, x + y) - x * f(1, 0) - y * f(0, 1) - z * f(0, 0));
    Points b(1, 3);
    b << x, y, z;
    CHECK((Vec3(patch->positions(b).row(0)) - w).norm() < 1e-12);
  }
}

TEST_CASE("gordon_coons refuses curves that do not meet, by name of the corner") {
  Sides sides = sides_of(wave());
  const std::array<double, 3> shift = {0, 0, 0.01};
  sides[1].c = sides[1].c + PiecewisePolynomial::constant(shift);
  CHECK(refusal_code([&] { make(sides); }) == "sides_apart");
}
