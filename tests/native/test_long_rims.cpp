// Fills over a plane within long and noisy rims.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <tuple>

#include "test_refusals.h"
#include "test_rings.h"
#include "tripatch/creases/creased_fill.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/spline/minimize_bending.h"
#include "tripatch/spline/plane_fill.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

Vec3 flat(double x, double y) { return {x, y, 0}; }

PlaneFill filled(const Rings& rings, const PlaneFillOptions& options = {}) {
  return fill_over_plane(rings.mesh(), Connectivity(rings.mesh()), {rings.rim}, options);
}

/// The same numbers on every machine, -1 to 1.
double random_at(double x, double y) {
  const double k = std::sin(12.9898 * std::round(1e6 * x) + 78.233 * std::round(1e6 * y)) * 43758.5453;
  return 2 * (k - std::floor(k)) - 1;
}

}  // namespace

TEST_CASE("what both models of a rough hole are apart by is known of finer triangles too") {
  const auto rough = [](double x, double y) -> Vec3 { return {x, y, 0.03 * random_at(x, y)}; };
  const Rings rings(radii(0.13, 3), rough);
  PlaneFillOptions options;
  options.resolution = 40;
  const PlaneFill own = filled(rings), fine = filled(rings, options);
  REQUIRE(fine.vertices.rows() > 10 * own.vertices.rows());
  CHECK(fine.surface->positions(as_rows(own.rim_uv)) == own.surface->positions(as_rows(own.rim_uv)));
  for (Index k = 0; k < own.vertices.rows(); ++k) {
    Index nearest = 0;
    (fine.uv.rowwise() - own.uv.row(k)).rowwise().norm().minCoeff(&nearest);
    CHECK(fine.deviation[nearest] == Approx(own.deviation[k]).epsilon(0.25));
  }
}

TEST_CASE("where nothing can be laid out the rim's own triangles are delivered") {
  // the other side of a flat sheet, folded flat onto it
  Points vertices(5, 3);
  vertices << 0, 0, 0, 4, 0, 0, 4, 4, 0, 2, 3, 0, 0, 4, 0;
  Faces faces;
  for (const std::array<Index, 3>& face : {std::array<Index, 3>{0, 1, 3}, {1, 2, 3}, {0, 3, 4}}) faces.add(face);
  const Mesh mesh{vertices, faces};
  const PlaneFill fill = fill_over_plane(mesh, Connectivity(mesh), {{0, 4, 3, 2, 1}});
  CHECK_FALSE(fill.surface);
  CHECK(fill.triangles.size() == 3);
  CHECK(fill.vertices.rows() == 0);
  CHECK(fill.folds == fill.rim_folds);
  CHECK(fill.plainer->code == Code::plain_triangles);
}

TEST_CASE("a long jagged rim with noise in many rings is as near as its noise allows") {
  // the same wave, and the noise, an edge's share, of 8,000 and more vertices: of thinned samples 1.5e-3
  const auto wave = [](double x, double y) { return 0.25 * std::sin(1.7 * x + 0.3) * std::cos(1.3 * y); };
  const Rings rings(
      radii(0.004, 16),
      [&](double x, double y) {
        const double edge = std::numbers::pi / 700, grown = 1 + 0.3 * edge * random_at(x, y), u = x * grown, v = y * grown;
        return Vec3(u, v, wave(u, v) + 0.02 * edge * random_at(y, x));
      },
      700);
  const PlaneFill fill = filled(rings);
  REQUIRE(fill.vertices.rows() > 1000);
  double squares = 0;
  for (const auto& v : fill.vertices.rowwise()) squares += std::pow(v[2] - wave(v[0], v[1]), 2);
  CHECK(std::sqrt(squares / static_cast<double>(fill.vertices.rows())) < 5e-4);
}

TEST_CASE("caps of a ball are filled over long jagged rims as well as over short ones") {
  for (const double degrees : {45.0, 62.0})
    for (const Index edges : {300, 500, 1000, 2000}) {
      const double widest = degrees * std::numbers::pi / 180,
                   edge = 2 * std::numbers::pi * std::sin(widest) / static_cast<double>(edges);
      const Rings rings(
          radii(edge / 2, 20),
          [&](double x, double y) {
            const double r = std::hypot(x, y), angle = widest + 2 * (r - 0.5) + 0.014 * random_at(x / r, y / r);
            return Vec3(std::sin(angle) * x / r, std::sin(angle) * y / r, std::cos(angle));
          },
          edges);
      const PlaneFill fill = filled(rings);
      CAPTURE(degrees, edges);
      CHECK(fill.folds == 0);
      REQUIRE(fill.vertices.rows() > 1000);
      CHECK((fill.vertices.rowwise().norm().array() - 1).abs().maxCoeff() < (degrees < 60 ? 1e-3 : 5e-3));
      CHECK(fill.deviation.maxCoeff() < 0.05);
    }
}

TEST_CASE("the slope beside a long even rim is seen where few rings are around it: a cap of a ball is not filled flat") {
  for (const Index edges : {800, 1500}) {
    const double widest = 40 * std::numbers::pi / 180,
                 edge = 2 * std::numbers::pi * std::sin(widest) / static_cast<double>(edges);
    const Rings rings(
        radii(edge, 4),
        [&](double x, double y) {
          const double r = std::hypot(x, y), angle = widest + r - 0.5;
          return Vec3(std::sin(angle) * x / r, std::sin(angle) * y / r, std::cos(angle));
        },
        edges);
    const PlaneFill fill = filled(rings);
    CAPTURE(edges);
    REQUIRE(fill.vertices.rows() > 1000);
    CHECK((fill.vertices.rowwise().norm().array() - 1).abs().maxCoeff() < 0.04);
  }
}

TEST_CASE("faces that are folded beside the rim do not keep a fill from going on as those around them do") {
  for (const Index edges : {40, 120, 500}) {
    const double widest = 40 * std::numbers::pi / 180,
                 edge = 2 * std::numbers::pi * std::sin(widest) / static_cast<double>(edges);
    Rings rings(
        radii(edge, 12),
        [&](double x, double y) {
          const double r = std::hypot(x, y), angle = widest + r - 0.5 + edge / 8 * random_at(x / r, y / r);
          return Vec3(std::sin(angle) * x / r, std::sin(angle) * y / r, std::cos(angle));
        },
        edges);
    for (const Index v : {Index{3}, edges / 2}) {  // a vertex over the next one, in the ball
      const Vec3 along = rings.vertices.row(v + 1) - rings.vertices.row(v),
                 out = rings.vertices.row(v + edges) - rings.vertices.row(v);
      rings.vertices.row(v) = (Vec3(rings.vertices.row(v)) + 0.4 * along + 1.5 * out).normalized();
    }
    const PlaneFill fill = filled(rings);
    CAPTURE(edges);
    CHECK(!fill.plainer);
    CHECK(fill.rim_folds >= 2);
    CHECK(fill.folds <= fill.rim_folds);
    REQUIRE(fill.vertices.rows() > 50);
    CHECK((fill.vertices.rowwise().norm().array() - 1).abs().maxCoeff() < 5e-3);
  }
}
