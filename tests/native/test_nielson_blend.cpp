#include "test_surfaces.h"
#include "tripatch/constructions/nielson_blend.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

SurfacePtr make(const Sides& sides) { return nielson_blend(make_boundary(sides)); }

}  // namespace

TEST_CASE("nielson_blend keeps its promises") { check_promises(make, 1); }

TEST_CASE("nielson_blend reproduces polynomials of degree 2, and no more") {
  for (int degree = 1; degree <= 2; ++degree) CHECK(reproduction_error(make, degree) < 1e-12);
  CHECK(reproduction_error(make, 3) > 1e-3);
}

TEST_CASE("nielson_blend takes value and first derivatives of three surfaces") {
  const std::array<SurfacePtr, 3> surfaces = unrelated_surfaces(5);
  const SurfacePtr patch = nielson_blend(surfaces);
  for (int i = 0; i < 3; ++i)
    for (double t : {0.05, 0.3, 0.5, 0.8}) {
      std::array<double, 9> found, expected;
      patch->evaluate(on_side(i, t).data(), 1, 1, found.data());
      surfaces[i]->evaluate(on_side(i, t).data(), 1, 1, expected.data());
      for (int k = 0; k < 9; ++k) CHECK(found[k] == Approx(expected[k]).margin(1e-12));
    }
}

TEST_CASE("nielson_blend names the corner where surfaces do not meet") {
  std::array<SurfacePtr, 3> surfaces = unrelated_surfaces(5);
  std::array<Vec3, 3> corners = plain_corners;
  corners[1][2] += 0.1;
  surfaces[0] = bezier(random_net(3, 1, 0.1, corners));
  CHECK_THROWS_WITH(nielson_blend(surfaces), Catch::Contains("r2 and r0 do not meet at corner 1"));
}

TEST_CASE("nielson_blend of a surface with itself is that surface, with its derivatives at the corners too") {
  const SurfacePtr one = unrelated_surfaces(5)[0], patch = nielson_blend({one, one, one});
  for (int i = 0; i < 3; ++i)
    for (int order = 1; order <= 2; ++order) {
      const Vec3 corner = Vec3::Unit(i);
      std::vector<double> found(3 * jet_size(order)), expected(3 * jet_size(order));
      patch->evaluate(corner.data(), 1, order, found.data());
      one->evaluate(corner.data(), 1, order, expected.data());
      for (std::size_t k = 0; k < found.size(); ++k) CHECK(found[k] == Approx(expected[k]).margin(1e-3));
    }
}
