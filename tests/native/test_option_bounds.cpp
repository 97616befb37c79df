// Degrees and resolutions that are refused.
#include <cmath>
#include <numbers>

#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/boundary/bezier_rectangle.h"
#include "tripatch/constructions/coons_bezier.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/patch/bezier_triangle.h"
#include "tripatch/polygon/round.h"
#include "tripatch/smooth_triangles.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// Curves of one degree along the sides of a triangle; the first ends so far from where the next one begins.
BoundaryCurves curves(int degree, double gap) {
  BoundaryCurves out;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = plain_corners[(i + 1) % 3], b = plain_corners[(i + 2) % 3];
    out[i].resize(degree + 1, 3);
    for (int k = 0; k <= degree; ++k) out[i].row(k) = a + (b - a) * k / degree;
  }
  out[0](degree, 2) += gap;
  return out;
}

}  // namespace

TEST_CASE("degrees and resolutions have their bounds") {
  CHECK_NOTHROW(BezierTriangle(Points::Random(861, 3)));  // degree 40
  CHECK_THROWS_AS(BezierTriangle(Points::Random(903, 3)), InvalidArgument);
  CHECK_NOTHROW(BezierRectangle(Points::Random(21 * 2, 3), 20, 1));
  CHECK_THROWS_AS(BezierRectangle(Points::Random(22 * 2, 3), 21, 1), InvalidArgument);
  CHECK_NOTHROW(coons_bezier(curves(20, 0), CoonsKind::discrete));
  CHECK_THROWS_AS(coons_bezier(curves(21, 0), CoonsKind::discrete), InvalidArgument);
  const Points vertices = (Points(3, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0).finished();
  Faces faces;
  faces.add(std::array<Index, 3>{0, 1, 2});
  CHECK_NOTHROW(smooth_triangles({vertices, faces}, {}, 256));
  CHECK_THROWS_AS(smooth_triangles({vertices, faces}, {}, 257), InvalidArgument);
}
