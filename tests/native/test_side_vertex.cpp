#include "test_surfaces.h"
#include "tripatch/constructions/nielson_blend.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/patch/vertex_ray.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

SurfacePtr make(const Sides& sides) { return side_vertex(make_boundary(sides)); }
SurfacePtr make_curved(const Sides& sides) { return curved_side_vertex(make_boundary(sides)); }

/// Second fundamental form as a matrix in space.
Eigen::Matrix3d form(const Surface& surface, const double* b) {
  Eigen::Matrix<double, 6, 3, Eigen::RowMajor> c;
  surface.evaluate(b, 1, 2, c.data());
  const Vec3 p0 = c.row(1), p1 = c.row(2), n = p0.cross(p1).normalized();
  Eigen::Matrix<double, 3, 2> frame;
  frame << p0, p1;
  const Eigen::Matrix<double, 2, 3> dual = (frame.transpose() * frame).inverse() * frame.transpose();
  Eigen::Matrix2d second;
  second << 2 * c.row(3).dot(n), c.row(4).dot(n), c.row(4).dot(n), 2 * c.row(5).dot(n);
  return dual.transpose() * second * dual;
}

/// Largest difference to the surface's form at the corners, over that form's norm, 1e-4 away from them in all directions.
double corner_curvature_error(const Surface& patch, const Surface& surface) {
  constexpr double rho = 1e-4;
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (double t = 0.05; t < 1; t += 0.1) {
      std::array<double, 3> at = {0, 0, 0}, near;
      at[i] = 1;
      near[i] = 1 - rho;
      near[(i + 1) % 3] = rho * (1 - t);
      near[(i + 2) % 3] = rho * t;
      const Eigen::Matrix3d truth = form(surface, at.data());
      worst = std::max(worst, (form(patch, near.data()) - truth).norm() / truth.norm());
    }
  return worst;
}

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

TEST_CASE("curved_side_vertex keeps its promises") { check_promises(make_curved, 1); }

TEST_CASE("curved_side_vertex reproduces polynomials of degree 3, and no more") {
  for (int degree = 1; degree <= 3; ++degree) CHECK(reproduction_error(make_curved, degree) < 1e-12);
  CHECK(reproduction_error(make_curved, 4) > 1e-3);
}

TEST_CASE("the curvature at a corner is that of the surroundings, from whichever side one comes: with rays of degree 5 only") {
  const SurfacePtr s = wave();
  const Sides sides = skewed_sides({s, s, s});
  CHECK(corner_curvature_error(*make_curved(sides), *s) < 0.01);
  CHECK(corner_curvature_error(*make(sides), *s) > 0.05);
}
