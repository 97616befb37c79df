// What decides on places, edges and faces around a cage, on both sides of each threshold.
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

/// Its triangles with a vertex put in.
std::vector<std::array<Index, 3>> with_row(const Eigen::RowVector2d& at) {
  PlanePolygon polygon = square();
  insert_row(polygon, at, Vec3(at[0], at[1], 0));
  return polygon.triangles;
}

}  // namespace

TEST_CASE("a place is on an edge or a vertex that is a millionth of the domain away", "[thresholds]") {
  CHECK(with_row({0.5, 0.97e-6}).size() == 2);  // no vertex in an edge of the border
  CHECK(with_row({0.5, 1.03e-6}).size() == 4);
  const auto has = [](const std::vector<std::array<Index, 3>>& all, const std::array<Index, 3>& t) {
    return std::find(all.begin(), all.end(), t) != all.end();
  };
  const double beside = 0.97e-6 * std::sqrt(2.0), away = 1.03e-6 * std::sqrt(2.0);
  CHECK(with_row({0.5, 0.5 - beside}).size() == 4);
  CHECK(has(with_row({0.5, 0.5 - away}), {0, 2, 3}));
  CHECK_FALSE(has(with_row({0.5, 0.5 - beside}), {0, 2, 3}));  // both triangles are halved
  for (const double away_from_middle : {0.97e-6, 1.03e-6}) {
    PlanePolygon fan = square();
    CHECK(insert_row(fan, {0.5, 0.5}, Vec3(0.5, 0.5, 0)));
    REQUIRE(fan.triangles.size() == 4);
    const double step = away_from_middle * std::sqrt(0.5);
    CHECK(insert_row(fan, {0.5 + step, 0.5 + step}, Vec3(0.5, 0.5, 0)));
    CHECK(fan.triangles.size() == (away_from_middle < 1e-6 ? 4 : 6));  // the vertex that is there
  }
  PlanePolygon fan = square();
  insert_row(fan, {0.5, 0.5}, Vec3(0.5, 0.5, 0));
  CHECK_FALSE(insert_row(fan, {0.5 + 1.2e-6, 0.5},
                         Vec3(0.5, 0.5, 0)));  // on all edges of the middle, which would be left without triangles
}

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

TEST_CASE("a rim is split at the first of the edges that are longest but for rounding", "[thresholds]") {
  Points square(4, 3);
  for (const double longer : {1.94e-8, 2.06e-8}) {
    square << 0, 0, 0, 1, 0, 0, 1, 1 + longer, 0, 0, 1, 0;
    CHECK(longest_edge(square) == (longer < 2e-8 ? 0 : 1));
  }
}

namespace {

/// Rings around a hole of one vertex with the first ring's faces so many times as long across the rim as its edges, sampled.
HoleSamples sampled(double times) {
  CubeCorner corner(4, 1, [](double, double) { return 0.0; });
  std::vector<char> on_rim(corner.vertices.rows(), 0);
  for (Index v : corner.hole.rim) on_rim[v] = 1;
  for (Index v = 0; v < corner.vertices.rows(); ++v) {  // everything beyond the rim moves away from it, in its own direction
    if (on_rim[v] || corner.vertices.row(v).norm() < 1e-9) continue;
    double nearest = INFINITY;
    Vec3 foot;
    for (Index r : corner.hole.rim)
      if (const double d = (corner.vertices.row(v) - corner.vertices.row(r)).norm(); d < nearest) {
        nearest = d;
        foot = corner.vertices.row(r);
      }
    corner.vertices.row(v) = foot + times * (Vec3(corner.vertices.row(v)) - foot);
  }
  const Mesh given = corner.mesh();
  CageHole hole = {corner.hole, cage_layout(corner.hole, corner.vertices, false, 0, {0, 0})};
  const ClosedCage closed = close_holes(given, {hole}, {});
  const Connectivity whole(closed.mesh());
  const auto rings = rings_around(closed, whole, hole.hole);
  Subdivision settings;
  settings.quality = stencil_quality;
  const LimitSurface was(given, settings), limit(closed.mesh(), settings);
  std::vector<Index> free;
  for (Index v = closed.first_vertex.front(); v < closed.first_vertex.back(); ++v) free.push_back(v);
  const CageSystem system(closed.vertices, free);
  return sample_hole({given, closed, was, limit, system, false}, hole, closed.first_face[0], rings, false, 1);
}

}  // namespace

TEST_CASE("faces around a cage are strips from two and a half times the fill's own on, and for certain at twice that",
          "[thresholds]") {
  const auto least = [](double times) {
    double least = 1;
    for (const SampledFace& face : sampled(times).outside) least = std::min(least, face.along);
    return least;
  };
  CHECK(least(2.49) == 1);
  CHECK(least(2.51) < 1);
  CHECK(least(4.99) > 0);
  CHECK(least(5.01) == 0);
}

TEST_CASE("a round rim of 120 edges gets a ring of quads to twenty edges, and in them a grid", "[thresholds]") {
  for (const Index n : {104, 120, 138}) {  // beyond a hundred edges that is the only layout that is tried
    PlanePoints rim(n, 2);
    for (Index k = 0; k < n; ++k)
      rim.row(k) << std::cos(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n)),
          std::sin(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
    const Index inside = polygon_layout(rim, {}).faces.size() - n / 20 * n;
    CHECK(inside > 0);
    CHECK(inside <= n * n / 16);
    CHECK(inside > n * n / 16 - n);
  }
}

TEST_CASE("a crumpled surface gets eight times as many triangles as its sizes and its rim say", "[thresholds]") {
  class Rough final : public Surface {
  public:
    void evaluate(const double* b, Index n, int, double* out) const override {  // positions only
      for (Index k = 0; k < n; ++k, b += 3, out += 3)
        out[0] = b[0], out[1] = b[1], out[2] = 20 * std::sin(4000 * b[0]) * std::cos(4000 * b[1]);
    }
  };
  constexpr Index n = 40;
  PlanePolygon disc;
  disc.uv = Eigen::Matrix<double, n + 1, 2>::Zero();
  for (Index k = 0; k < n; ++k) {
    disc.uv.row(k) << std::cos(2 * std::numbers::pi * static_cast<double>(k) / n),
        std::sin(2 * std::numbers::pi * static_cast<double>(k) / n);
    disc.triangles.push_back({k, (k + 1) % n, n});
  }
  disc.points = Points::Zero(n + 1, 3);
  disc.points.leftCols<2>() = disc.uv;
  disc.rim = n;
  const double made = static_cast<double>(remesh(disc, {}, Rough()).triangles.size());
  CHECK(made == Approx(8 * (triangles_wanted(disc, {}) + n)).epsilon(0.01));
}

namespace {

struct Polygon {
  PlanePoints rim;
  std::vector<RimCorner> corners;
  PlaneLayout layout() const { return polygon_layout(rim, corners); }
};

/// A polygon of n edges, as long as each other as they can be. quads: that are wanted at its corners.
Polygon polygon(const std::vector<Vec2>& corner, Index n, const std::vector<int>& quads) {
  const std::size_t sides = corner.size();
  Polygon made{PlanePoints(n, 2), {}};
  double around = 0;
  for (std::size_t i = 0; i < sides; ++i) around += (corner[(i + 1) % sides] - corner[i]).norm();
  Index row = 0;
  for (std::size_t i = 0; i < sides; ++i) {
    const Vec2 way = corner[(i + 1) % sides] - corner[i];
    const Index edges = i + 1 == sides ? n - row : std::lround(static_cast<double>(n) * way.norm() / around);
    made.corners.push_back({row, quads[i]});
    for (Index j = 0; j < edges; ++j) made.rim.row(row++) = corner[i] + way * static_cast<double>(j) / static_cast<double>(edges);
  }
  return made;
}

}  // namespace

TEST_CASE("of rims of up to a hundred edges two layouts are tried", "[thresholds]") {
  // the second is the better one here: it has one pole, the first has two
  const std::vector<Vec2> corner = {{1.07, 0.25}, {0.02, 0.81}, {-1.09, 0.55}, {-0.93, -0.17}, {-0.16, -0.60}, {0.95, -0.57}};
  for (const Index n : {98, 100, 102, 104})
    CHECK(polygon(corner, n, {0, 0, 0, 0, 0, 0}).layout().poles.size() == (n > 100 ? 2 : 1));
}

TEST_CASE("a quad too many or too few at a corner costs a fifth, a corner more or less than four a tenth", "[thresholds]") {
  // the best corners are among those that are tried: not where one of the costs is a third less or half as much more
  const auto least = [](const Polygon& given) {
    const PlaneLayout layout = given.layout();
    return quad_quality(as_rows(layout.uv), layout.faces).least;
  };
  CHECK(least(polygon({{1, -0.3}, {0.6, 0.9}, {-0.8, 0.7}, {-1.1, -0.3}, {-0.6, -0.7}, {0.7, -0.7}}, 24, {2, 2, 1, 1, 1, 1})) >
        0.82);
  CHECK(least(polygon({{0.8, 0.2}, {0.7, 0.9}, {-0.3, 0.8}, {-0.8, 0.4}, {-0.8, -0.5}, {-0.1, -0.9}, {0.4, -0.9}}, 16,
                      {1, 1, 1, 1, 2, 2, 2})) > 0.83);
  CHECK(least(polygon({{1, -0.2}, {0.4, 0.9}, {-0.1, 1.1}, {-1, 0.6}, {-0.9, -0.6}, {-0.2, -0.9}, {0.6, -0.9}}, 26,
                      {2, 2, 1, 1, 1, 1, 1})) > 0.82);
}
