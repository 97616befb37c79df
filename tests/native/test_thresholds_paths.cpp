// Which way a fill goes, and what may be asked of it, on both sides of each threshold.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

#include "tripatch/fill.h"
#include "tripatch/fill/cage_fills.h"
#include "tripatch/fill/ground.h"
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
        vertices.row(j * n + k) = at(2 * M_PI * static_cast<double>(k) / static_cast<double>(n), j);
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
};

Vec3 flat(double angle, Index ring) { return Vec3(std::cos(angle), std::sin(angle), 0) * (1 + 0.5 * static_cast<double>(ring)); }
Vec3 dome(double angle, Index ring) {
  const double lean = 0.5 + 0.1 * static_cast<double>(ring);
  return {std::sin(lean) * std::cos(angle), 0.8 * std::sin(lean) * std::sin(angle), 0.7 * std::cos(lean)};
}

}  // namespace

TEST_CASE("a hole lies far from the origin that is a thousand times its size away", "[thresholds]") {
  // there a fill is made about its middle: what is lost is a rounding of its place
  const Rings near(60, 4, dome);
  const Fill about_origin = near.filled();
  Vec3 low = near.vertices.topRows(60).colwise().minCoeff(), high = near.vertices.topRows(60).colwise().maxCoeff();
  const double size = (high - low).norm();
  for (const double sizes : {980.0, 1020.0}) {
    const Vec3 away = std::round(sizes * size) * Vec3::UnitX() - 0.5 * (low + high);
    Rings there = near;
    there.vertices.rowwise() += away.transpose();
    const Fill made = there.filled();
    REQUIRE(made.vertices.rows() == about_origin.vertices.rows());
    const double off = ((made.vertices.rowwise() - away.transpose()) - about_origin.vertices).cwiseAbs().maxCoeff();
    CAPTURE(sizes, off);
    CHECK((off < 5e-13) == (sizes > 1000));
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
  CHECK_THROWS_WITH(with(Output::triangles, 0), "resolution must be from 1 to 10000");
  CHECK_NOTHROW(with(Output::triangles, 1));
  CHECK_THROWS_WITH(with(Output::quads, 101), "resolution must be from 0 to 100");
  CHECK_NOTHROW(with(Output::quads, 100));
}

TEST_CASE("of four corners that a cage guesses those are taken that begin first, unless others turn a millionth more",
          "[thresholds]") {
  const Index n = 12;
  for (const double more : {0.97e-6, 1.03e-6}) {
    Rings hole(n, 4, flat);
    // the corners from vertex 1 on are 1, 4, 7 and 10, those from 0 on 0, 3, 6 and 9: at vertex 4 the rim turns two thirds of that more,
    // at vertex 3 one less
    const double edge = 2 * std::sin(M_PI / n), angle = M_PI / n;
    const double outward = more / (3 * std::cos(angle) / edge);
    hole.vertices.row(4) *= 1 + outward;
    const std::optional<std::vector<Index>> rim = hole.rim;
    FillOptions options;
    const Mesh mesh = hole.mesh();
    const SidedRim found = cage_rim_of(Ground(mesh, rim, options), rim, {});
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
    const Mesh mesh = hole.mesh();
    const PolygonFill made = fill_round(mesh, Connectivity(mesh), hole.rim, {});
    const auto patch = std::dynamic_pointer_cast<const RoundSurface>(made.fill.patch);
    REQUIRE(patch);
    CHECK(patch->terms()[0].rows() == 2 * std::min<Index>(edges, 48) + 1);
  }
}

TEST_CASE("a round rim of few vertices is the circle through them", "[thresholds]") {
  // a wave to four vertices is taken for what it is; a spline alone is off by 4e-4 of the diameter
  const Rings hole(12, 4, [](double angle, Index ring) -> Vec3 {
    const double lean = 0.5 + 0.1 * static_cast<double>(ring);
    return {std::sin(lean) * std::cos(angle), std::sin(lean) * std::sin(angle), std::cos(lean)};
  });
  const Mesh mesh = hole.mesh();
  const Side side = fill_round(mesh, Connectivity(mesh), hole.rim, {}).fill.sides[0];
  for (int k = 0; k < 50; ++k) CHECK(side.c(k / 50.0).head<2>().norm() == Approx(std::sin(0.5)).epsilon(1e-9));
}
