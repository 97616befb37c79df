// What decides about sides on limit surfaces, on both sides of each threshold.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_refusals.h"
#include "tripatch/boundary/limit_sides.h"

using namespace tripatch;

namespace {

/// A closed cage of squares with a hole of 2 x 2 of them in its middle; the sides' corners are those of the square but one.
struct SquareCage {
  static constexpr int n = 10;
  Points vertices;
  Faces faces;
  std::vector<Index> gone;
  std::vector<Index> along = {at(4, 4), at(5, 4), at(6, 4)};
  SquareCage() : vertices((n + 1) * (n + 1), 3) {
    for (int i = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) vertices.row(at(i, j)) << i, j, 0;
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        if (i >= 4 && i < 6 && j >= 4 && j < 6) gone.push_back(faces.size());
        faces.add(std::array<Index, 4>{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
      }
  }
  static Index at(int i, int j) { return i * (n + 1) + j; }
  Mesh mesh() const { return {vertices, faces}; }
};

}  // namespace

TEST_CASE("a side on a limit surface has a tangent at its ends from a millionth of its length on", "[thresholds]") {
  for (const double part : {0.95e-6, 1.05e-6}) {
    SquareCage cage;
    // columns before and behind the first vertex so near to it that the derivative there, twice their way, is that part of the length
    double length = 2;
    for (int round = 0; round < 3; ++round) {
      for (int j = 0; j <= SquareCage::n; ++j)
        for (const int side : {-1, 1}) cage.vertices(SquareCage::at(4 + side, j), 0) = 4 + side * part * length / 2;
      const LimitSurface surface(cage.mesh(), {}, cage.along);
      const Connectivity around(cage.mesh(), cage.gone);
      if (round < 2) {
        const std::vector<Index> rest = {cage.along[1], cage.along[2]};
        const Side side = side_on(surface, around, rest, 1e-13);
        length = (side.c(1) - Vec3(4, 4, 0)).norm();
        continue;
      }
      if (part < 1e-6) {
        CHECK(refusal_code([&] { side_on(surface, around, cage.along, 1e-13); }) == "corner_lacks_planes");
      } else {
        CHECK_NOTHROW(side_on(surface, around, cage.along, 1e-13));
      }
    }
  }
}

TEST_CASE("a limit rim has a kink where its pieces turn by a tenth of a degree", "[thresholds]") {
  for (const double degrees : {0.098, 0.102}) {
    SquareCage cage;
    Subdivision settings;
    for (int i = 0; i < SquareCage::n; ++i) {  // creased along the side, and sharp in its middle
      settings.crease_edges.push_back({SquareCage::at(i, 4), SquareCage::at(i + 1, 4)});
      settings.edge_creases.push_back(1);
    }
    settings.crease_vertices = {SquareCage::at(5, 4)};
    settings.vertex_creases = {1};
    cage.vertices(SquareCage::at(5, 4), 2) = std::tan(degrees * std::numbers::pi / 360);
    const Connectivity whole(cage.mesh()), around(cage.mesh(), cage.gone);
    const std::vector<Index> rim = {SquareCage::at(4, 4), SquareCage::at(5, 4), SquareCage::at(6, 4), SquareCage::at(6, 5),
                                    SquareCage::at(6, 6), SquareCage::at(5, 6), SquareCage::at(4, 6), SquareCage::at(4, 5)};
    const Hole hole = make_hole(cage.mesh(), around, rim, std::array<Index, 3>{rim[0], rim[2], rim[5]});
    const LimitSides sides = limit_sides(cage.mesh(), whole, around, hole, settings);
    const bool told = std::any_of(sides.warnings.begin(), sides.warnings.end(), [](const Message& warning) {
      return warning.code == Code::limit_rim_kink && warning.where == std::vector<Index>{SquareCage::at(5, 4)};
    });
    CHECK(told == (degrees > 0.1));
  }
}

TEST_CASE("two derivatives span a plane from a millionth between them on", "[thresholds]") {
  for (const double sine : {0.99e-6, 1.01e-6}) {
    LimitJet jet;
    jet.pu = Vec3(3, 0, 0);
    jet.pv = -0.2 * Vec3(std::sqrt(1 - sine * sine), 0, sine);
    CHECK(spans_plane(jet) == (sine > 1e-6));
  }
}
