#include <algorithm>
#include <catch2/catch.hpp>

#include "test_cages.h"
#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/cage/cage_fill.h"
#include "tripatch/cage/cage_fit.h"
#include "tripatch/constructions/side_vertex.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

double tilted(double x, double y) { return 0.3 * x - 0.2 * y; }
double bowl(double x, double y) { return 0.05 * (x * x + y * y); }

CageOptions with_rim(CageRim rim) {
  CageOptions options;
  options.rim = rim;
  return options;
}

/// The cage with its middle gone, filled by the phases one after the other.
Fill filled(const CubeCorner& corner, CageRim rim, const LayoutOptions& layout = {.rows = 0}) {
  const Connectivity left(corner.mesh());
  CageFill cages(corner.mesh(), left, {corner.hole}, {}, {}, layout, with_rim(rim));
  cages.make_fair();
  Fill fill;
  fill.patch = side_vertex(make_boundary(three_sides(cages.sides(0))));
  cages.fit({fill.patch}, {false});
  cages.complete(0, fill);
  return fill;
}

}  // namespace

TEST_CASE("a plane is continued as a plane, whatever the rim", "[cage]") {
  for (int rings : {1, 2})
    for (CageRim rim : {CageRim::smooth, CageRim::exact, CageRim::move}) {
      const CubeCorner corner(rings + 3, rings, tilted);
      const Fill fill = filled(corner, rim);
      INFO("rings " << rings << ", rim " << static_cast<int>(rim));
      CHECK(fill.faces.size() == 3 * rings * rings);
      CHECK((fill.vertices.col(2) - 0.3 * fill.vertices.col(0) + 0.2 * fill.vertices.col(1)).cwiseAbs().maxCoeff() < 1e-7);
      CHECK(fill.report.seam_angle_max < 1e-5);
      CHECK(fill.report.cage_deviation_max < 1e-4);  // in the plane: at the rim the two borders differ by that
      CHECK(fill.report.triangles_folded == 0);
      CHECK(fill.report.poles == std::vector<std::array<Index, 2>>{{fill.report.poles[0][0], 3}});
    }
}

TEST_CASE("only an exact rim is creased and leaves the surroundings alone, and only a free one moves", "[cage]") {
  const CubeCorner corner(5, 2, bowl);
  const Fill smooth = filled(corner, CageRim::smooth), exact = filled(corner, CageRim::exact),
             move = filled(corner, CageRim::move);
  CHECK(smooth.report.surroundings_moved_max > 1e-6);
  CHECK(smooth.report.seam_angle_max < 1e-4);
  CHECK(smooth.creases.empty());
  CHECK(smooth.moved.empty());
  CHECK(exact.report.surroundings_moved_max < 1e-12);
  CHECK(exact.report.seam_angle_max > 1e-3);
  REQUIRE(exact.creases.size() == corner.hole.rim.size());
  for (std::size_t k = 0; k < exact.creases.size(); ++k)
    CHECK(exact.creases[k] == std::array<Index, 2>{corner.hole.rim[k], corner.hole.rim[(k + 1) % corner.hole.rim.size()]});
  CHECK(move.moved == corner.hole.rim);
  CHECK(move.moved_to.rows() == static_cast<Index>(move.moved.size()));
  CHECK(move.report.surroundings_moved_rms < smooth.report.surroundings_moved_rms);
}

TEST_CASE("the fit is the least of what it weighs: no vertex can move without loss of nearness", "[cage]") {
  const CubeCorner corner(5, 2, bowl);
  std::vector<CageHole> holes = {{corner.hole, cage_layout(corner.hole, corner.vertices, false, 0, {0, 0})}};
  const auto deviation = [&](int rounds) {
    CageOptions options = with_rim(CageRim::smooth);
    options.rounds = rounds;
    CageFit fit(corner.mesh(), holes, {}, {}, options);
    fit.make_fair();
    const CageSides sides = fit.sides(0);
    const SurfacePtr patch = side_vertex(make_boundary(three_sides(sides)));
    fit.fit({patch}, {sides}, false);
    return fit.deviation_rms(0, *patch);
  };
  const double before = deviation(0), once = deviation(1), thrice = deviation(3);
  CHECK(once < before);
  CHECK(thrice < 1.05 * once);
}

TEST_CASE("rows are added until a cage is within the tolerance, or a warning says that it is not", "[cage]") {
  const CubeCorner corner(5, 2, bowl);
  const Fill loose = filled(corner, CageRim::exact, {.tolerance = 1});
  CHECK(loose.faces.size() == 12);
  CHECK(loose.report.warnings.empty());
  const double reached = loose.report.cage_deviation_rms;
  CHECK(filled(corner, CageRim::exact, {.tolerance = 1.001 * reached}).faces.size() == 12);
  CHECK(filled(corner, CageRim::exact, {.tolerance = 0.999 * reached}).faces.size() > 12);
  const Fill strict = filled(corner, CageRim::exact, {.tolerance = 1e-12});
  REQUIRE(strict.report.warnings.size() == 1);
  CHECK(strict.report.warnings[0].code == Code::tolerance_out_of_reach);
}

TEST_CASE("holes belong together where their first two rings share faces", "[cage]") {
  // a strip of quads with two quads taken out
  const auto groups = [](int apart) {
    Points vertices(5 * 30, 3);
    Faces faces;
    for (Index j = 0; j < 5; ++j)
      for (Index i = 0; i < 30; ++i) vertices.row(30 * j + i) << static_cast<double>(i), static_cast<double>(j), 0;
    std::vector<SidedRim> holes;
    for (Index j = 0; j < 4; ++j)
      for (Index i = 0; i < 29; ++i) {
        const std::array<Index, 4> quad = {30 * j + i, 30 * j + i + 1, 30 * j + i + 31, 30 * j + i + 30};
        if (j == 2 && (i == 5 || i == 5 + apart)) {
          holes.push_back(Hole{{quad.begin(), quad.end()}, {0, 1, 2}});
        } else {
          faces.add(quad);
        }
      }
    return cage_groups(Connectivity(Mesh{vertices, faces}), holes).size();
  };
  CHECK(groups(4) == 1);  // three quads between: the second ring of each takes the middle one
  CHECK(groups(5) == 2);
}
