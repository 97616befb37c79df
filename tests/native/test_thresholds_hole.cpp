// What decides at the rim, on both sides of its thresholds; those of corners are in test_hole, of outer borders in test_outer_borders.
#include <catch2/catch.hpp>

#include "tripatch/hole/rim_checks.h"

using namespace tripatch;

TEST_CASE("a rim edge has a length from a hundred-millionth of a millionth of the rim's on", "[thresholds]") {
  for (const double part : {0.9e-14, 1.1e-14}) {
    const double length = part * (2 + std::sqrt(2.0));  // rim: a square less a corner that is nearly cut off
    const Points vertices = (Points(5, 3) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 1 - length, 1, 0, 5, 5, 1).finished();
    Faces faces;
    const std::vector<Index> rim = {0, 1, 2, 3};
    for (int k = 0; k < 4; ++k) faces.add(std::array<Index, 3>{rim[(k + 1) % 4], rim[k], 4});
    const Mesh mesh = {vertices, faces};
    if (part < 1e-14) {
      CHECK_THROWS_AS(check_positions(mesh, Connectivity(mesh), rim), Refusal);
    } else {
      CHECK_NOTHROW(check_positions(mesh, Connectivity(mesh), rim));
    }
  }
}

TEST_CASE("eight vertices are named in a sentence, of nine the first eight", "[thresholds]") {
  for (const Index turned : {4, 5}) {  // edges whose faces are turned against the others: two vertices each
    const Index n = 2 * turned;
    std::vector<Index> rim;
    Faces faces;
    for (Index k = 0; k < 4 * n; ++k) rim.push_back(k);
    for (Index k = 0; k < 4 * n; ++k) {
      const bool against = k % 8 == 0 && k / 8 < turned;
      const Index a = rim[k], b = rim[(k + 1) % (4 * n)];
      faces.add(against ? std::array<Index, 3>{a, b, 4 * n + k} : std::array<Index, 3>{b, a, 4 * n + k});
    }
    const Connectivity around(faces, 8 * n);
    try {
      check_topology(around, rim);
      FAIL("faces that disagree were taken");
    } catch (const Refusal& refusal) {
      CHECK(refusal.where().size() == static_cast<std::size_t>(2 * turned));
      CHECK((std::string(refusal.what()).find("and more") != std::string::npos) == (turned == 5));
    }
  }
}
