// Which layout and which model a fill over a plane takes, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_rings.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/parametrization/parametrization.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/base_surface.h"
#include "tripatch/spline/disc.h"
#include "tripatch/spline/minimize_bending.h"
#include "tripatch/spline/plane_fill.h"
#include "tripatch/triangulation/min_weight_triangulation.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

double area(const Points& p, const std::vector<std::array<Index, 3>>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += Vec3(p.row(b) - p.row(a)).cross(Vec3(p.row(c) - p.row(a))).norm() / 2;
  return sum;
}

/// A hole of few vertices around, all of which are samples; and the first layout of it.
struct FirstLayout {
  PlaneFill fill;
  double edge, rough_area, area_of_fill;
  Disc disc;
  Points points;
  PlanePoints laid;  // of them
  Index rim;

  explicit FirstLayout(const Rings& rings) : rim(rings.n) {
    const Connectivity around(rings.mesh());
    fill = fill_over_plane(rings.mesh(), around, {rings.rim});
    disc = disc_around(rings.mesh(), around, {rings.rim}, 0.25 * diameter(rings.mesh(), rings.rim), 40);
    points = disc.points;
    RimSurroundings beyond;
    beyond.normals.resize(rim, 3);
    for (const AdjacentFace& face : faces_beyond_rows(rings.mesh(), around, {rings.rim}))
      beyond.normals.row(face.from) = face.normal;
    for (Index k = 0; k < rim; ++k) beyond.joined.push_back({std::min(k, (k + 1) % rim), std::max(k, (k + 1) % rim)});
    std::vector<std::array<Index, 3>> triangles = min_weight_triangulation(points.topRows(rim), beyond).triangles;
    rough_area = area(points, triangles);
    triangles.insert(triangles.end(), disc.triangles.begin(), disc.triangles.end());
    PlaneLayoutOptions options;
    options.tolerance = 1e-3;
    laid = parametrize(points, triangles, options)->uv;
    Points all(rim + fill.vertices.rows(), 3);
    all << points.topRows(rim), fill.vertices;
    area_of_fill = area(all, fill.triangles);
    edge = (points.row(0) - points.row(1)).norm();
  }
  /// What polynomials of a degree leave of the samples, over an edge.
  double left_by(int degree) const { return BaseSurface(laid, points, degree).distance_across() / edge; }
  /// Whether the rim lies where it has its feet on references of degrees, each through the feet on the one before.
  bool is_on(const std::vector<int>& degrees) const {
    PlanePoints at = laid, of_rim = laid.topRows(rim);
    for (int degree : degrees) {
      const BaseSurface reference(at, points, degree);
      of_rim = reference.foot_points(of_rim, points.topRows(rim));
      at = reference.foot_points(at, points);
    }
    return (of_rim - fill.rim_uv).norm() < 1e-7;
  }
  /// The new vertices between the field and the second model, whose difference is a field of order 2.5.
  Points averaged(double share) const {
    const Index added = fill.vertices.rows();
    Points of_field(rim + added, 3);
    PlanePoints uv(rim + added, 2);
    uv << fill.rim_uv, fill.uv;
    of_field << points.topRows(rim), fill.field->positions(as_rows(fill.uv));
    Points other = of_field;
    other.bottomRows(added) = second_model(of_field, fill.triangles, disc, {2, 3})->vertices;
    FieldOptions options;
    options.orders = {2.5};
    options.unit = edge;
    const PolyharmonicSpline difference(uv, share * (other - fill.field->positions(as_rows(uv))), options);
    return of_field.bottomRows(added) + difference.positions(as_rows(fill.uv));
  }
};

Vec3 flat(double x, double y) { return {x, y, 0}; }

double random_at(double x, double y) {
  const double k = std::sin(12.9898 * std::round(1e6 * x) + 78.233 * std::round(1e6 * y)) * 43758.5453;
  return 2 * (k - std::floor(k)) - 1;
}

}  // namespace

TEST_CASE("surroundings are not followed whose layout has an energy of 100", "[thresholds]") {
  int followed = 0;  // two rings of them: fills over other layouts may fold
  for (const double steep : {113.2, 113.6, 113.8, 114.0, 115.7, 116.1, 116.5, 117.0, 118.0}) {  // four waves around the hole
    const Rings rings(radii(0.1, 3),
                      [&](double x, double y) { return Vec3(x, y, steep * std::hypot(x, y) * std::cos(4 * std::atan2(y, x))); });
    const Connectivity around(rings.mesh());
    const Disc disc = disc_around(rings.mesh(), around, {rings.rim}, 0, 2);
    RimSurroundings beyond;
    beyond.normals.resize(rings.n, 3);
    for (const AdjacentFace& face : faces_beyond_rows(rings.mesh(), around, {rings.rim}))
      beyond.normals.row(face.from) = face.normal;
    std::vector<std::array<Index, 3>> triangles = min_weight_triangulation(disc.points.topRows(rings.n), beyond).triangles;
    triangles.insert(triangles.end(), disc.triangles.begin(), disc.triangles.end());
    PlaneLayoutOptions options;
    options.tolerance = 1e-3;
    const double energy = parametrize(disc.points, triangles, options)->energies.back();
    CAPTURE(steep, energy);
    REQUIRE(std::abs(energy - 100) < 2.5);
    const bool follows = fill_over_plane(rings.mesh(), around, {rings.rim}).rings == 2;
    followed += follows;
    CHECK((energy < 100 || !follows));
  }
  CHECK(followed > 0);
}

TEST_CASE("a fill is laid out again whose area is 1.05 times that of the rim's triangles", "[thresholds]") {
  double below = 1, above = 2;
  for (double height = 0.114; height < 0.12; height *= 1.01) {  // of the top above the rim, on a ball
    const double radius = (0.25 + height * height) / (2 * height);
    const FirstLayout one(Rings(radii(0.05, 5), [=](double x, double y) {
      const double angle = std::hypot(x, y) / radius, r = std::max(std::hypot(x, y), 1e-9);
      return Vec3(radius * std::sin(angle) * x / r, radius * std::sin(angle) * y / r, radius * std::cos(angle));
    }));
    const double share = one.area_of_fill / one.rough_area;
    CHECK(one.is_on({4}) == (share < 1.05));
    (one.is_on({4}) ? below : above) = one.is_on({4}) ? std::max(below, share) : std::min(above, share);
  }
  CHECK(below > 1.045);
  CHECK(above < 1.055);
}

TEST_CASE("a reference is of degree 4, of 6 where that leaves a twentieth of an edge", "[thresholds]") {
  double below = 0, above = 1;
  for (double size = 0.012; size < 0.0135; size *= 1.02) {
    const FirstLayout one(Rings(radii(0.05, 5), [=](double x, double y) { return Vec3(x, y, size * random_at(x, y)); }));
    const double left = one.left_by(6);
    CHECK(one.is_on(left > 0.05 ? std::vector<int>{6, 6, 6, 5} : std::vector<int>{4}));
    (left < 0.05 ? below : above) = left < 0.05 ? std::max(below, left) : std::min(above, left);
  }
  CHECK(below > 0.048);
  CHECK(above < 0.052);
}

TEST_CASE("further references follow where there are three rings", "[thresholds]") {
  const auto rough = [](double x, double y) { return Vec3(x, y, 0.03 * random_at(x, y)); };
  const FirstLayout two(Rings(radii(0.12, 2), rough)), three(Rings(radii(0.12, 3), rough));
  REQUIRE(two.disc.rings == 2);
  REQUIRE(three.disc.rings == 3);
  CHECK(two.is_on({6}));
  CHECK(three.is_on({6, 6, 6, 5}));
}

TEST_CASE("the second model is taken from a tenth of it on", "[thresholds]") {
  double below = 0, above = 1;
  for (double size = 0.0098; size < 0.0115; size *= 1.02) {
    const FirstLayout one(Rings(radii(0.05, 5), [=](double x, double y) { return Vec3(x, y, size * random_at(x, y)); }));
    const PolyharmonicSpline& field = *one.fill.field;
    const double left = one.left_by(one.left_by(6) > 0.05 ? 6 : 4) * one.edge;
    const double share = share_of_second(
        {field.noise() / one.edge, field.roughness(), share_of_details(field.noise(), left), field.mean_order(), false});
    const bool taken = one.fill.surface.get() != one.fill.field.get();
    CHECK(taken == (share >= 0.1));
    if (taken) CHECK((one.averaged(share) - one.fill.vertices).norm() < 1e-9 * one.fill.vertices.norm());
    (taken ? above : below) = taken ? std::min(above, share) : std::max(below, share);
  }
  CHECK(below > 0.09);
  CHECK(above < 0.11);
}

namespace {

double median_edge(const Mesh& mesh, const std::vector<Index>& rim) {
  std::vector<double> lengths;
  for (std::size_t k = 0; k < rim.size(); ++k)
    lengths.push_back((mesh.vertices.row(rim[k]) - mesh.vertices.row(rim[(k + 1) % rim.size()])).norm());
  std::sort(lengths.begin(), lengths.end());
  return lengths[rim.size() / 2];
}

/// A hole in the end of a fillet: from the plane around it the surface bends down, by so many degrees over so many rows, to a rim of n
/// edges. rough: of the heights, over an edge.
struct Fillet {
  PlaneFill fill;
  double noise;  // over an edge, as the field has it
  double minimize_bending,
      own;  // how far from the field, over the diameter, the triangles that bend least are, and the fill's own

  Fillet(Index n, double degrees, int rows, double rough) {
    const double edge = std::numbers::pi / static_cast<double>(n);
    std::vector<double> radius{0.5}, height{0};
    for (int j = 0; j < rows + 4; ++j) {
      const double angle = std::max(0.0, 1 - (j + 0.5) / rows) * degrees * std::numbers::pi / 180;
      radius.push_back(radius.back() + edge * std::cos(angle));
      height.push_back(height.back() - edge * std::sin(angle));
    }
    Rings rings(radius, flat, n);
    for (Index k = 0; k < rings.vertices.rows(); ++k)
      rings.vertices(k, 2) =
          height[k / n] + rough * edge * random_at(rings.vertices(k, 0), rings.vertices(k, 1) + 0.1 * height[k / n]);
    const Mesh mesh = rings.mesh();
    const Connectivity around(mesh);
    fill = fill_over_plane(mesh, around, {rings.rim});
    noise = fill.field->noise() / median_edge(mesh, rings.rim);
    const double size = diameter(mesh, rings.rim);
    const Disc disc = disc_around(mesh, around, {rings.rim}, 0.25 * size, 40);
    const Points on_field = fill.field->positions(as_rows(fill.uv));
    Points points(n + on_field.rows(), 3);
    points << rings.vertices.topRows(n), on_field;
    const auto far = [&](const Points& some) { return (some - on_field).rowwise().norm().maxCoeff() / size; };
    minimize_bending = far(second_model(points, fill.triangles, disc, {2})->vertices);
    own = far(fill.vertices);
  }
  bool is_held_back() const { return own > 0.99 * minimize_bending; }
};

}  // namespace

TEST_CASE("a fill that runs on like the end of a fillet is held back from a fifth of the hole's diameter on", "[thresholds]") {
  double below = 0, above = 1;
  for (double degrees = 68; degrees < 75; degrees += 0.5) {
    const Fillet one(24, degrees, 4, 0);
    CHECK(one.is_held_back() == (one.minimize_bending > 0.2));
    (one.is_held_back() ? above : below) =
        one.is_held_back() ? std::min(above, one.minimize_bending) : std::max(below, one.minimize_bending);
  }
  CHECK(below > 0.19);
  CHECK(above < 0.21);
}

TEST_CASE("a fill through noise of 0.15 edges and more is not held back", "[thresholds]") {
  double below = 0, above = 1;
  for (double rough = 0.22; rough < 0.28; rough += 0.005) {
    const Fillet one(24, 120, 2, rough);
    CHECK(one.minimize_bending > 0.22);
    CHECK(one.is_held_back() == (one.noise < 0.15));
    (one.is_held_back() ? below : above) = one.is_held_back() ? std::max(below, one.noise) : std::min(above, one.noise);
  }
  CHECK(below > 0.145);
  CHECK(above < 0.155);
}
