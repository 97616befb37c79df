// What decides about a fill over a plane, on both sides of each threshold.
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

/// The same where all around is named to be continued: then a long rim has no coarser one.
PlaneFill filled_as_it_is(const Rings& rings, PlaneFillOptions options) {
  const Connectivity all(rings.mesh());
  options.continued = &all;
  return filled(rings, options);
}

PlaneFillOptions coarse_inside() {
  PlaneFillOptions options;
  options.resolution = 4;
  return options;
}

Index samples(const PlaneFill& fill) { return fill.field->parts()[0].weights.rows(); }

/// The same numbers on every machine, -1 to 1.
double random_at(double x, double y) {
  const double k = std::sin(12.9898 * std::round(1e6 * x) + 78.233 * std::round(1e6 * y)) * 43758.5453;
  return 2 * (k - std::floor(k)) - 1;
}

}  // namespace

TEST_CASE("surroundings are followed over a quarter of the hole's diameter, and forty rings", "[thresholds]") {
  CHECK(filled(Rings(radii(0.0505, 12), flat)).rings == 5);
  CHECK(filled(Rings(radii(0.0495, 12), flat)).rings == 6);
  CHECK(filled(Rings(radii(0.0052, 60), flat), coarse_inside()).rings == 40);
}

TEST_CASE("a resolution of more than half of the rim's edges has the surface of none", "[thresholds]") {
  const auto dome = [](double x, double y) -> Vec3 { return {x, y, std::sqrt(1.3 - x * x - y * y)}; };
  const Rings rings(radii(0.05, 2), dome);
  const PlaneFill own = filled(rings);
  const PlanePoints places = own.rim_uv / 2;
  const auto off_by = [&](int resolution) {
    PlaneFillOptions options;
    options.resolution = resolution;
    const PlaneFill fill = filled(rings, options);
    return (fill.surface->positions(as_rows(places)) - own.surface->positions(as_rows(places))).norm();
  };
  const int half = static_cast<int>(rings.rim.size()) / 2;
  CHECK(off_by(half + 1) == 0);
  CHECK(off_by(half) > 0);
}

TEST_CASE("what both models of a rough hole are apart by is known of finer triangles too", "[thresholds]") {
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

TEST_CASE("nothing is laid out where half of the rim's edges are 2e-10 of its size or less", "[thresholds]") {
  const auto is_tiny = [](double out) {  // edges of about 0.13 in a rim with one vertex far out
    Rings rings(radii(0.1, 3), flat);
    rings.vertices(0, 0) += out;
    const std::optional<Message> why = filled(rings).plainer;
    return why && why->code == Code::tiny_edges_plain_triangles;
  };
  const double edge = Rings(radii(0.1, 3), flat).vertices.row(2).head<2>().norm() * 2 * std::sin(std::numbers::pi / 24);
  CHECK(!is_tiny(edge / 2.1e-10));
  CHECK(is_tiny(edge / 1.9e-10));
}

TEST_CASE("a field has a hundred samples more than the rim has vertices, 160 at least and 600 at most", "[thresholds]") {
  CHECK(samples(filled(Rings(radii(0.1, 5), flat))) == 96);  // all there are: three rings, no long edges
  CHECK(samples(filled(Rings(radii(0.02, 20), flat))) == 160);
  CHECK(samples(filled(Rings(radii(0.02, 20), flat, 90), coarse_inside())) == 190);
  CHECK(samples(filled_as_it_is(Rings(radii(0.1, 4), flat, 520), coarse_inside())) == 600);
}

TEST_CASE("a strongly curved surface without noise has 450 samples more than the rim has vertices", "[thresholds]") {
  const auto on_ball = [](double widest) {  // rims at half of that angle, in radians
    return Rings(
        radii(0.02, 20),
        [=](double x, double y) {
          const double r = std::hypot(x, y), angle = widest * r;
          return Vec3(std::sin(angle) * x / r, std::sin(angle) * y / r, std::cos(angle));
        },
        90);
  };
  CHECK(samples(filled(on_ball(0.4), coarse_inside())) == 190);
  CHECK(samples(filled(on_ball(1.6), coarse_inside())) == 540);
}

TEST_CASE("where noise is 0.003 to 0.03 edges the surroundings are followed twice as far", "[thresholds]") {
  double least = 1, most = 0, below = 0, above = 1;  // noise, over an edge, where they are and where they are not
  for (int k = 0; k < 14; ++k) {
    const double size = (k < 7 ? 6.2e-4 : 6.6e-3) * std::pow(1.03, k % 7);
    const Rings rings(radii(0.05, 14), [=](double x, double y) { return Vec3(x, y, size * random_at(x, y)); });
    const PlaneFill fill = filled(rings);
    const double noise = fill.field->noise() / (rings.vertices.row(0) - rings.vertices.row(1)).norm();
    if (fill.rings == 10) {
      least = std::min(least, noise);
      most = std::max(most, noise);
    } else {
      (noise < 0.01 ? below : above) = noise < 0.01 ? std::max(below, noise) : std::min(above, noise);
    }
  }
  // what is looked at twice as far has nearly the same noise
  CHECK((below < 0.003 && below > 0.0028 && least < 0.0032));
  CHECK((above > 0.03 && above < 0.032 && most > 0.028));
}

namespace {

/// Whether the places of a rim are its points seen from above.
bool seen_from_above(const Rings& rings) {
  const PlaneFill fill = filled_as_it_is(rings, coarse_inside());
  double off = 0;
  for (Index k = 0; k < rings.n; k += 7) {
    const double here = (rings.vertices.row(k) - rings.vertices.row(3)).head<2>().norm();
    off = std::max(off, std::abs((fill.rim_uv.row(k) - fill.rim_uv.row(3)).norm() - here));
  }
  return off < 1e-9;
}

}  // namespace

TEST_CASE("rims of more than 400 edges are seen from above where nothing leans by more than 60 degrees", "[thresholds]") {
  const auto cone = [](double degrees) {
    const double slope = std::tan(degrees * std::numbers::pi / 180);
    return [=](double x, double y) { return Vec3(x, y, -slope * std::hypot(x, y)); };
  };
  CHECK_FALSE(seen_from_above(Rings(radii(0.2, 2), cone(30), 400)));
  CHECK(seen_from_above(Rings(radii(0.2, 2), cone(30), 402)));
  CHECK(seen_from_above(Rings(radii(0.2, 2), cone(59.5), 402)));
  CHECK_FALSE(seen_from_above(Rings(radii(0.2, 2), cone(60.5), 402)));
}

TEST_CASE(
    "the second model is 0.45 of a fill where it is rough, 0.8 where far rough, a quarter where orders are low or details faint",
    "[thresholds]") {
  CHECK(share_of_details(1, 2) == Approx(std::pow(1 - 1.0 / 16, 2)));
  CHECK(share_of_details(3, 2) == 0);
  CHECK_FALSE(mostly_details(0.199));
  CHECK(mostly_details(0.201));
  const auto share = [](double noise, double roughness, double details, double order, bool strongly_curved = false) {
    return share_of_second({noise, roughness, details, order, strongly_curved});
  };
  CHECK(share(0, 1, 0.5, 5) == Approx(0.225));
  CHECK(share(0, 0, 0, 2) == Approx(0.25).epsilon(1e-5));
  CHECK(share(0, 0, 0, 3.5) == Approx(0.125));
  CHECK(share(0, 0, 0, 5) < 1e-4);
  CHECK(share(0, 0, 0, 3.5 * 1.1) == Approx(0.25 / (1 + std::pow(1.1, 24))));
  CHECK(share(0.15, 1, 0, 5) == Approx(0.4));
  CHECK(share(0.3, 1, 0, 5) == Approx(0.8 * 16 / 17));
  CHECK(share(0.15, 1, 1, 5) == Approx((0.45 + 0.8) / 2));
  CHECK(share(10, 1, 1, 5) == Approx(0.8));
  CHECK(share(0.005, 0, 1, 6) == Approx(0.125).epsilon(2e-3));
  CHECK(share(0.012, 0, 1, 6) == Approx(0.25 * 12 / 17 / 2).epsilon(2e-3));
  CHECK(share(0.02, 0, 1, 6) < 0.01);
  CHECK(share(0.005, 0, 0, 6) < 1e-5);
  CHECK(share(0.005, 0, 1, 6, true) < 1e-5);
}

TEST_CASE("a crease does not run where a point inside lies within a twentieth of its edge", "[thresholds]") {
  const Rings rings(radii(0.1, 8), [](double x, double y) { return roof(x, y, 30); });
  const auto across = [&](const Rings& r, const PlaneFillOptions& options) {
    return fill_across_creases(r.mesh(), Connectivity(r.mesh()), r.rim, r.features(), options);
  };
  const PlaneFill plain = *across(rings, {});
  double edge = 0;  // over the middle
  for (const auto& [a, b] : plain.creases) {
    const auto at = [&](Index v) -> Vec3 {
      return v < rings.n ? Vec3(rings.vertices.row(v)) : Vec3(plain.vertices.row(v - rings.n));
    };
    if (at(a)[0] * at(b)[0] <= 1e-9) edge = std::max(edge, (at(a) - at(b)).norm());
  }
  REQUIRE(edge > 0.05);
  for (const double share : {0.049, 0.051}) {
    PlaneFillOptions options;
    options.through = {{roof(0.01, share * edge, 30), {}}};
    CHECK(across(rings, options).has_value() == (share > 0.05));
  }
}

namespace {

Vec3 bent_roof(double x, double y) { return roof(x, y, 30) - Vec3(0, 0, 0.02 * y * y); }

/// As the ends of creases say, not the walls between them.
std::optional<PlaneFill> across_ends(const Rings& rings) {
  Features features = rings.features();
  features.walls.reset();
  return fill_across_creases(rings.mesh(), Connectivity(rings.mesh()), rings.rim, features, {});
}

}  // namespace

TEST_CASE("a crease does not run past a vertex of the rim by less than a ten-thousandth of its edge", "[thresholds]") {
  Rings rings(radii(0.1, 8), [](double x, double y) { return bent_roof(x, y); });
  const double edge = 1 / static_cast<double>(across_ends(rings)->creases.size());
  for (const double share : {0.98e-4, 1.02e-4}) {
    for (Index k = 2; k <= 10; ++k) {  // on one side the rim comes down to the crease, next to one of its points
      const double x = 0.5 * std::cos(static_cast<double>(k) * std::numbers::pi / 12);
      rings.vertices.row(k) = bent_roof(x + 0.01, share * edge + std::abs(x) / 2);
    }
    REQUIRE(rings.features().creases.size() == 1);
    CHECK(across_ends(rings).has_value() == (share > 1e-4));
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

TEST_CASE("the curve of a crease is that of 24 of its vertices on either side", "[thresholds]") {
  const auto along = [](Index moved) {  // places of its new points, where a vertex of the crease is somewhat farther on
    Rings rings(radii(0.02, 36), [](double x, double y) { return bent_roof(x, y); });
    rings.vertices(moved * rings.n, 1) += 0.004;
    REQUIRE(rings.features().creases.at(0).ends[0].chain.size() > 30);
    const PlaneFill fill = *across_ends(rings);
    double sum = 0;
    for (const auto& [a, b] : fill.creases)
      for (Index v : {a, b})
        if (v >= rings.n) sum += std::abs(fill.vertices(v - rings.n, 1));
    return sum;
  };
  CHECK(along(23) > 1e-9);
  CHECK(along(24) < 1e-12);
}

TEST_CASE("rims of more than 400 edges are filled on coarser ones", "[thresholds]") {
  CHECK(samples(filled(Rings(radii(0.02, 12), flat, 400), coarse_inside())) == 500);
  CHECK(samples(filled(Rings(radii(0.05, 1), flat, 402), coarse_inside())) < 402);
}

TEST_CASE("a long rim is filled on one of up to 200 edges", "[thresholds]") {
  const auto coarse = [](Index edges) { return samples(filled(Rings(radii(0.05, 1), flat, edges), coarse_inside())); };
  CHECK(coarse(792) == 198 + 198);
  CHECK(coarse(808) == 101 + 202);  // what is beyond has longer edges
}

TEST_CASE("a long rim is filled on a coarser one where its surroundings are 0.75 edges of that wide", "[thresholds]") {
  const auto is_coarse = [](double wide) {  // a cap of a ball, its rim jagged
    const double angle = std::numbers::pi / 4, edge = 2 * std::numbers::pi * std::sin(angle) / 200;
    const auto ball = [&](double x, double y) {
      const double r = std::hypot(x, y), from_pole = angle + wide * edge * (r - 0.5) + 0.004 * random_at(x / r, y / r);
      return Vec3(std::sin(from_pole) * x / r, std::sin(from_pole) * y / r, std::cos(from_pole));
    };
    return samples(filled(Rings({0.5, 1, 1.5}, ball, 420), coarse_inside())) != 420 + 100;
  };
  CHECK_FALSE(is_coarse(0.72));
  CHECK(is_coarse(0.78));
}

TEST_CASE("a long rim without noise is filled through six hundred samples, one with noise fitted around three hundred",
          "[thresholds]") {
  const auto noisy = [](double noise) {
    return [noise](double x, double y) -> Vec3 { return {x, y, noise * std::numbers::pi / 200 * random_at(x, y)}; };
  };
  CHECK(samples(filled(Rings(radii(0.02, 12), noisy(0), 500), coarse_inside())) == 600);
  CHECK(samples(filled(Rings(radii(0.02, 12), noisy(5e-4), 500), coarse_inside())) == 600);
  CHECK(samples(filled(Rings(radii(0.02, 12), noisy(5e-3), 500), coarse_inside())) == 300);
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

TEST_CASE("a long rim whose surroundings are named is laid out with a third of it in 20 edges", "[thresholds]") {
  const double angle = 58 * std::numbers::pi / 180, edge = 2 * std::numbers::pi * std::sin(angle) / 402;
  const auto ball = [&](double x, double y) {
    const double r = std::hypot(x, y), from_pole = angle + 2 * (r - 0.5) + 0.01 * random_at(x / r, y / r);
    return Vec3(std::sin(from_pole) * x / r, std::sin(from_pole) * y / r, std::cos(from_pole));
  };
  const Rings rings(radii(edge / 2, 12), ball, 402);
  PlaneFillOptions coarse;
  coarse.resolution = 20;
  const PlaneFill fill = filled_as_it_is(rings, {}), of_20 = filled_as_it_is(rings, coarse);
  REQUIRE(fill.vertices.rows() > 10000);
  REQUIRE(of_20.vertices.rows() < 1000);
  CHECK((fill.rim_uv - of_20.rim_uv).norm() < 1e-9 * fill.rim_uv.norm());
  CHECK((fill.vertices.rowwise().norm().array() - 1).abs().maxCoeff() < 5e-3);
}

TEST_CASE("of an error three quarters are handed on at most", "[thresholds]") {
  const auto fed_back = [](double height, double degrees) {  // of an ellipsoid
    const double angle = degrees * std::numbers::pi / 180, edge = 2 * std::numbers::pi * std::sin(angle) / 40;
    const auto lift = [&](double x, double y) {
      const double r = std::hypot(x, y), from_pole = angle + 2 * (r - 0.5);
      return Vec3(std::sin(from_pole) * x / r, std::sin(from_pole) * y / r, height * std::cos(from_pole));
    };
    return filled(Rings(radii(edge / 2, 6), lift, 40)).fed_back;
  };
  CHECK(fed_back(3, 90) == 0.75);
  CHECK(fed_back(4, 120) == Approx(0.64).margin(0.03));
}

TEST_CASE("a fill stays within a diameter of its rim", "[thresholds]") {
  double farthest =
      0;  // over the diameter, of balls that are open at less and less, where a fill continues into their other side
  for (double degrees = 103; degrees < 107; degrees += 0.5) {
    const double angle = degrees * std::numbers::pi / 180, edge = 2 * std::numbers::pi * std::sin(angle) / 40;
    const auto ball = [&](double x, double y) {
      const double r = std::hypot(x, y), from_pole = angle + 2 * (r - 0.5);
      return Vec3(std::sin(from_pole) * x / r, std::sin(from_pole) * y / r, std::cos(from_pole));
    };
    const Rings rings(radii(edge / 2, 6), ball, 40);
    const PlaneFill fill = filled(rings);
    for (Index k = 0; k < fill.vertices.rows(); ++k) {
      const double from_rim = (rings.vertices.topRows(40).rowwise() - fill.vertices.row(k)).rowwise().norm().minCoeff();
      farthest = std::max(farthest, from_rim / diameter(rings.mesh(), rings.rim));
    }
  }
  CHECK(farthest < 1);
  CHECK(farthest > 0.95);
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

TEST_CASE("a fill of more than 30,000 triangles is laid out with a third of its rim in 20 edges", "[thresholds]") {
  for (const auto& [degrees, is_few] : {std::pair(70.0, true), {30.0, false}}) {
    const double angle = degrees * std::numbers::pi / 180, edge = 2 * std::numbers::pi * std::sin(angle) / 360;
    const auto cap = [&](double x, double y) {
      const double r = std::hypot(x, y), from_pole = angle + 2 * (r - 0.5);
      return Vec3(std::sin(from_pole) * x / r, std::sin(from_pole) * y / r, std::cos(from_pole));
    };
    const Rings rings(radii(edge / 2, 6), cap, 360);
    PlaneFillOptions coarse;
    coarse.resolution = 20;
    const PlaneFill fill = filled(rings), of_20 = filled(rings, coarse);
    CHECK(!fill.plainer);
    CHECK((fill.triangles.size() > 30'000) == is_few);
    CHECK((fill.rim_uv == of_20.rim_uv) == is_few);
  }
}

TEST_CASE(
    "of more than a million vertices times those of the rim few triangles bend least, and the fill is on a surface through "
    "theirs",
    "[thresholds]") {
  for (const auto& [n, middle, lobe] : {std::tuple(Index{240}, 2.1, 0.6), {Index{200}, 2.2, 0.5}}) {
    const double edge = 2 * std::numbers::pi * std::sin(1.2) / static_cast<double>(n);
    const auto lobes = [&, middle = middle, lobe = lobe](double x, double y) {  // of a rough ball: the field folds
      const double r = std::hypot(x, y), from_pole = middle + lobe * std::sin(3 * std::atan2(y, x)) + 2 * (r - 0.5);
      const double size = 1 + 0.2 * edge * random_at(x, y);
      return Vec3(size * Vec3(std::sin(from_pole) * x / r, std::sin(from_pole) * y / r, std::cos(from_pole)));
    };
    const PlaneFill fill = filled(Rings(radii(edge / 2, 6), lobes, n));
    CAPTURE(fill.vertices.rows());
    REQUIRE(fill.plainer);
    CHECK(fill.plainer->code == Code::least_bending);
    CHECK((fill.vertices.rows() * n > 1'000'000) == (n == 240));
    CHECK((dynamic_cast<const PolyharmonicSpline*>(fill.surface.get()) != nullptr) == (n == 240));
    CHECK(fill.folds == 0);
  }
}
