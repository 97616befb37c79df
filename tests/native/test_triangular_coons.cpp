#include "test_surfaces.h"
#include "tripatch/constructions/triangular_coons.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

SurfacePtr make(const Sides& sides) { return triangular_coons({sides[0].c, sides[1].c, sides[2].c}); }

}  // namespace

TEST_CASE("triangular_coons keeps its promises") { check_promises(make, 0); }

TEST_CASE("triangular_coons reproduces polynomials of degree 1, and no more") {
  for (int degree = 1; degree <= 1; ++degree) CHECK(reproduction_error(make, degree) < 1e-12);
  CHECK(reproduction_error(make, 2) > 1e-3);
}

// The printed formula of Nielson, Thomas and Wixom in Arnal and Lluch, section 3: u = b0, v = b1.
TEST_CASE("triangular_coons is the printed formula") {
  const SurfacePtr surface = wave();
  const auto x = [&](double u, double v) {
    Points b(1, 3);
    b << u, v, 1 - u - v;
    return Vec3(surface->positions(b).row(0));
  };
  const SurfacePtr patch = make(sides_of(surface));
  for (const auto& [u, v] : {std::pair(0.2, 0.3), std::pair(0.7, 0.1), std::pair(0.1, 0.85)}) {
    const Vec3 expected = (1 - u - v) * (x(u, 0) + x(0, v) - x(0, 0)) + v * (x(0, u + v) + x(u, 1 - u) - x(0, 1)) +
                          u * (x(u + v, 0) + x(1 - v, v) - x(1, 0));
    Points b(1, 3);
    b << u, v, 1 - u - v;
    CHECK((Vec3(patch->positions(b).row(0)) - expected).norm() < 1e-12);
  }
}
