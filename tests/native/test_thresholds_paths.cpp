// Which way a fill goes, and what may be asked of it, on both sides of each threshold.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>

#include "test_refusals.h"
#include "tripatch/cage_fills/cage_fills.h"
#include "tripatch/cage_fills/tried_cages.h"
#include "tripatch/fill.h"
#include "tripatch/fill/fill_context.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/polygon/round.h"

using namespace tripatch;

namespace {

/// Rings of quads around a hole of n edges: vertex k of ring j, the rim is ring 0.
struct Rings {
  Points vertices;
  Faces faces;
  std::vector<Index> rim;
  Rings(Index n, Index rings, const std::function<Vec3(double angle, Index ring)>& at) : vertices(n * (rings + 1), 3) {
    for (Index j = 0; j <= rings; ++j)
      for (Index k = 0; k < n; ++k) {
        vertices.row(j * n + k) = at(2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n), j);
        const Index next = (k + 1) % n;
        if (j < rings) faces.add(std::array<Index, 4>{j * n + next, j * n + k, (j + 1) * n + k, (j + 1) * n + next});
        if (j == 0) rim.push_back(k);
      }
  }
  Mesh mesh() const { return {vertices, faces}; }
  Fill filled(const std::function<void(FillOptions&)>& choose = {}) const {
    FillOptions options;
    options.rim = rim;
    if (choose) choose(options);
    return fill(mesh(), options);
  }
  PolygonFill round() const {
    const Connectivity around(mesh());
    return fill_round(mesh(), around, disc_input(mesh(), around, rim, {}), {});
  }
};

Vec3 flat(double angle, Index ring) { return Vec3(std::cos(angle), std::sin(angle), 0) * (1 + 0.5 * static_cast<double>(ring)); }
Vec3 dome(double angle, Index ring) {
  const double lean = 0.5 + 0.1 * static_cast<double>(ring);
  return {std::sin(lean) * std::cos(angle), 0.8 * std::sin(lean) * std::sin(angle), 0.7 * std::cos(lean)};
}
Vec3 uneven_dome(double angle, Index ring) {
  return (1 + 0.05 * std::cos(angle) + 0.03 * std::sin(2 * angle)) * dome(angle, ring);
}

}  // namespace

TEST_CASE("a hole lies far from the origin that is a thousand times its size away", "[thresholds]") {
  // there a fill is made about its middle, and moved with it: what is lost is a rounding of its place
  Rings hole(60, 4, uneven_dome);                                      // an even one is filled from any of four places on
  hole.vertices = (0x1p30 * hole.vertices).array().round() * 0x1p-30;  // moved without rounding
  const Vec3 low = hole.vertices.topRows(60).colwise().minCoeff(), high = hole.vertices.topRows(60).colwise().maxCoeff();
  const auto filled_at = [&](const Vec3& place) {
    Rings there = hole;
    there.vertices.rowwise() += (place - 0.5 * (low + high)).transpose();
    return there.filled();
  };
  const Fill here = filled_at(Vec3::Zero());
  for (const double sizes : {980.0, 1020.0}) {
    const Vec3 away = std::round(sizes * (high - low).norm()) * Vec3::UnitX();
    const Fill there = filled_at(away);
    REQUIRE(there.vertices.rows() == here.vertices.rows());
    const double off = (there.vertices - (here.vertices.rowwise() + away.transpose())).cwiseAbs().maxCoeff();
    CAPTURE(sizes, std::log10(off));
    CHECK((off == 0) == (sizes > 1000));
  }
}

TEST_CASE("triangles have one edge a side or more, quads a hundred extra rows at most", "[thresholds]") {
  const Rings hole(6, 2, flat);
  const auto with = [&](Output output, int resolution) {
    return hole.filled([&](FillOptions& options) {
      options.output = output;
      options.resolution = resolution;
    });
  };
  CHECK_THROWS_WITH(with(Output::triangles, 0), "resolution must be 1 or more, not 0");
  CHECK_NOTHROW(with(Output::triangles, 1));
  CHECK_THROWS_WITH(with(Output::quads, 101), "resolution must be from 0 to 100, not 101");
  CHECK_NOTHROW(with(Output::quads, 100));
}

TEST_CASE("of four corners that a cage guesses those are taken that begin first, unless others turn a millionth more",
          "[thresholds]") {
  const Index n = 12;
  for (const double more : {0.97e-6, 1.03e-6}) {
    Rings hole(n, 4, flat);
    // the corners from vertex 1 on are 1, 4, 7 and 10, those from 0 on 0, 3, 6 and 9: at vertex 4 the rim turns two thirds of that more,
    // at vertex 3 one less
    const double edge = 2 * std::sin(std::numbers::pi / n), angle = std::numbers::pi / n;
    const double outward = more / (3 * std::cos(angle) / edge);
    hole.vertices.row(4) *= 1 + outward;
    const std::optional<std::vector<Index>> rim = hole.rim;
    FillOptions options;
    const Mesh mesh = hole.mesh();
    const SidedRim found = cage_rim_of(FillContext(mesh, rim, options), rim, {});
    REQUIRE(found.guessed);
    REQUIRE(found.corners.size() == 4);
    const Index first = *std::min_element(found.rim.begin(), found.rim.end());
    CHECK(first == 0);
    CHECK((found.rim[found.corners[0]] % 3 == 1) == (more > 1e-6));
  }
}

TEST_CASE("a round rim has as many waves as edges, 48 at most", "[thresholds]") {
  for (const Index edges : {40, 47, 49, 60}) {
    const Rings hole(edges, 4, dome);
    const PolygonFill made = hole.round();
    const auto patch = std::dynamic_pointer_cast<const RoundSurface>(made.fill.patch);
    REQUIRE(patch);
    CHECK(patch->terms()[0].rows() == 2 * std::min<Index>(edges, 48) + 1);
  }
}

TEST_CASE("a rim's waves are taken for what they are that have four vertices each, eight of them at most", "[thresholds]") {
  // by how much of its height a rim's curve is off the wave of so many periods that its vertices lie on
  const auto off = [](Index edges, Index waves) {
    constexpr double height = 1e-5;  // so low that the vertices are as far from each other along the rim as on the circle
    const auto wave = [&](double angle) { return height * std::cos(static_cast<double>(waves) * angle); };
    const Rings hole(edges, 4, [&](double angle, Index ring) { return Vec3(flat(angle, ring) + wave(angle) * Vec3::UnitZ()); });
    const Side side = hole.round().fill.sides[0];
    double most = 0;
    for (int k = 0; k < 200; ++k) most = std::max(most, std::abs(side.c(k / 200.0)[2] - wave(2 * std::numbers::pi * k / 200)));
    return most / height;
  };
  CHECK(off(16, 4) < 1e-3);
  CHECK(off(16, 5) > 1e-2);
  CHECK(off(24, 6) < 1e-3);
  CHECK(off(23, 6) > 1e-2);
  CHECK(off(40, 8) < 1e-3);
  CHECK(off(40, 9) > 1e-2);
}

TEST_CASE("a round rim of few vertices is the circle through them", "[thresholds]") {
  // a wave to four vertices is taken for what it is; a spline alone is off by 4e-4 of the diameter
  const Rings hole(12, 4, [](double angle, Index ring) -> Vec3 {
    const double lean = 0.5 + 0.1 * static_cast<double>(ring);
    return {std::sin(lean) * std::cos(angle), std::sin(lean) * std::sin(angle), std::cos(lean)};
  });
  const Side side = hole.round().fill.sides[0];
  for (int k = 0; k < 50; ++k) CHECK(side.c(k / 50.0).head<2>().norm() == Approx(std::sin(0.5)).epsilon(1e-9));
}

TEST_CASE(
    "where faces beside a cage's hole are four times as long as its edges, or it has three, splitting one may fold the fill",
    "[thresholds]") {
  const auto may_fold = [](Index n, double times) {
    const double edge = 2 * std::sin(std::numbers::pi / static_cast<double>(n));
    // the farther corner of the face next to an edge is so many times as far as the other end of that
    const auto apart = [&](double radius) {
      return (Vec3(radius * std::cos(2 * std::numbers::pi / n), radius * std::sin(2 * std::numbers::pi / n), 0) - Vec3::UnitX())
          .norm();
    };
    double low = 1, high = 20;
    for (int k = 0; k < 60; ++k) (apart((low + high) / 2) < times * edge ? low : high) = (low + high) / 2;
    const Rings hole(n, 1, [&](double angle, Index ring) -> Vec3 {
      return Vec3(std::cos(angle), std::sin(angle), 0) * (ring == 0 ? 1 : low);
    });
    SidedRim rim;
    rim.rim = hole.rim;
    const Mesh mesh = hole.mesh();
    return may_fold_by_splitting(FillContext(mesh, hole.rim, {}), rim);
  };
  CHECK_FALSE(may_fold(9, 3.95));
  CHECK(may_fold(9, 4.05));
  CHECK_FALSE(may_fold(4, 1.5));
  CHECK(may_fold(3, 1.5));
}

TEST_CASE("a cage's report warns of poles of more than five quads", "[thresholds]") {
  for (const int valence : {4, 5, 6}) {
    // so many blocks of quads around a point, of which the first quad of each is missing
    constexpr int size = 4;
    std::vector<Vec3> points;
    std::map<std::array<int, 3>, Index> number;
    const auto at = [&](int block, int i, int j) {
      if (i == 0 && j > 0) block = (block + 1) % valence, std::swap(i, j);  // of two blocks
      const auto [found, is_new] = number.try_emplace({block, i, j}, static_cast<Index>(points.size()));
      const auto way = [&](int b) {
        return Vec3(std::cos(2 * std::numbers::pi * b / valence), std::sin(2 * std::numbers::pi * b / valence), 0);
      };
      if (is_new) points.push_back(i * way(block) + j * way(block + 1));
      return found->second;
    };
    Faces faces;
    for (int block = 0; block < valence; ++block)
      for (int i = 0; i < size; ++i)
        for (int j = 0; j < size; ++j)
          if (i > 0 || j > 0)
            faces.add(std::array<Index, 4>{at(block, i, j), at(block, i + 1, j), at(block, i + 1, j + 1), at(block, i, j + 1)});
    Points vertices(static_cast<Index>(points.size()), 3);
    for (Index k = 0; k < vertices.rows(); ++k) vertices.row(k) = points[k];
    FillOptions options;
    options.output = Output::cage;
    options.rim.emplace();
    for (int block = 0; block < valence; ++block) {
      options.rim->push_back(at(block, 1, 1));
      options.rim->push_back(at(block, 0, 1));
    }
    std::reverse(options.rim->begin(), options.rim->end());
    const Fill made = fill({vertices, faces}, options);
    REQUIRE(made.report.poles.size() == (valence == 4 ? 0 : 1));
    if (valence != 4) CHECK(made.report.poles[0][1] == valence);
    const auto& warnings = made.report.warnings;
    CHECK(has(warnings, Code::high_valence_pole) == (valence == 6));
  }
}
