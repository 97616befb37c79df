#include "test_surfaces.h"
#include "tripatch/patch/nielson_blend.h"
#include "tripatch/patch/side_vertex.h"
#include "tripatch/patch/vertex_ray.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

SurfacePtr make(const Sides& sides) { return side_vertex(make_boundary(sides)); }

}  // namespace

TEST_CASE("side_vertex keeps its promises") { check_promises(make, 1); }

TEST_CASE("side_vertex reproduces polynomials of degree 3, and no more") {
  for (int degree = 1; degree <= 3; ++degree) CHECK(reproduction_error(make, degree) < 1e-12);
  CHECK(reproduction_error(make, 4) > 1e-3);
}

TEST_CASE("side_vertex is the Nielson blend of its three surfaces of rays") {
  const Boundary boundary = make_boundary(skewed_sides(unrelated_surfaces(2)));
  std::array<SurfacePtr, 3> rays;
  for (int i = 0; i < 3; ++i) rays[i] = std::make_shared<VertexRay>(boundary, i, RayDegree::cubic);
  CHECK(difference(*nielson_blend(rays), *side_vertex(boundary)) < 1e-14);
}
