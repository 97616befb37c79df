// Places where the triangles of a domain lie over each other.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_cages.h"
#include "tripatch/boundary/limit_surface.h"
#include "tripatch/cage/cage_layout.h"
#include "tripatch/cage/cage_samples.h"
#include "tripatch/cage/closed_cage.h"
#include "tripatch/cage/limit_mesh.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/output/remesh.h"
#include "tripatch/quads/polygon_layout.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// A square of two triangles.
PlanePolygon square() {
  PlanePolygon square;
  square.uv.resize(4, 2);
  square.uv << 0, 0, 1, 0, 1, 1, 0, 1;
  square.points = Points::Zero(4, 3);
  square.points.leftCols<2>() = square.uv;
  square.rim = 4;
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  return square;
}

}  // namespace

TEST_CASE("a place where triangles lie over each other is no place for a vertex") {
  PlanePolygon twice = square();
  twice.uv.conservativeResize(6, 2);
  twice.uv.bottomRows(2) << 0.2, 0.1, 0.9, 0.15;
  twice.points.conservativeResize(6, 3);
  twice.triangles.push_back({4, 5, 2});
  const auto before = twice.triangles;
  CHECK_FALSE(insert_row(twice, {0.7, 0.3}, Vec3(0.7, 0.3, 0)));
  CHECK(twice.triangles == before);
  CHECK(twice.uv.rows() == 6);
}
