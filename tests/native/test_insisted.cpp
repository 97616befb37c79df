// What a method that is requested may not deliver.
#include <array>
#include <catch2/catch.hpp>
#include <string>

#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/fill/insisted.h"
#include "tripatch/report/folded_triangles.h"

using namespace tripatch;

namespace {

/// A square hole with four faces around it, and a fill with its middle at some place.
struct SquareHole {
  Points vertices;
  Faces faces;
  Fill fill;

  SquareHole() : vertices(8, 3) {
    vertices << 1, 1, 0, -1, 1, 0, -1, -1, 0, 1, -1, 0, 2, 2, 0, -2, 2, 0, -2, -2, 0, 2, -2, 0;
    for (Index k = 0; k < 4; ++k) faces.add(std::array<Index, 4>{(k + 1) % 4, k, 4 + k, 4 + (k + 1) % 4});
    for (Index k = 0; k < 4; ++k) fill.faces.add(std::array<Index, 3>{k, (k + 1) % 4, 8});
    fill.rim = {0, 1, 2, 3};
    fill.vertices.resize(1, 3);
    fill.vertices << 0, 0, 0;
  }
  Index folds() const {
    const Mesh mesh{vertices, faces};
    return count_folded_edges(vertices, fill.vertices, fill.faces, faces_beyond(mesh, Connectivity(mesh), {fill.rim}));
  }
  /// The code, and where; empty: it is not refused.
  std::pair<std::string, std::vector<Index>> refused(const FillOptions& options) const {
    const Mesh mesh{vertices, faces};
    try {
      refuse_if_insisted(FillContext(mesh, fill.rim, options), fill, options);
    } catch (const CodedRefusal& refusal) {
      return {code_of(refusal.message()), refusal.where()};
    }
    return {};
  }
};

FillOptions by(const char* method) {
  FillOptions options;
  options.method = method;
  return options;
}

}  // namespace

TEST_CASE("a patch that is insisted on is refused where it folds more than its rim does, and says where") {
  SquareHole hole;
  hole.fill.vertices << 3, 1.5, 0;  // beyond vertex 0: the faces next to it lie over each other
  const Index folds = hole.folds();
  REQUIRE(folds > 1);
  hole.fill.report.triangles_folded = folds;
  const auto [said, where] = hole.refused(by(patch_method));
  CHECK(said == "method_folds");
  REQUIRE(!where.empty());
  CHECK((where[0] == 0 || where[0] == 3));
  CHECK(hole.refused(by(automatic_method)).first.empty());
  CHECK(hole.refused(by(spline_method)).first == "method_folds");
  hole.fill.report.rim_folded = folds;
  CHECK(hole.refused(by(patch_method)).first.empty());
  hole.fill.report.rim_folded = folds - 1;
  CHECK(hole.refused(by(patch_method)).first == "method_folds_more_than_rim");
}

TEST_CASE(
    "a patch that is insisted on is refused where it crosses itself; a surface of all surroundings does so where its rim does") {
  SquareHole hole;
  hole.fill.report.crosses_itself = true;
  CHECK(hole.refused(by(polygon_method)).first == "method_crosses");
  CHECK(hole.refused(by(spline_method)).first.empty());
  CHECK(hole.refused(by(automatic_method)).first.empty());
}

TEST_CASE("a patch that somebody shapes is made though it folds") {
  SquareHole hole;
  hole.fill.vertices << 3, 1.5, 0;
  hole.fill.report.triangles_folded = 2;
  for (const int which : {0, 1, 2}) {
    FillOptions options = by(patch_method);
    if (which == 0) options.bulge = 3;
    if (which == 1) options.fairing.reset();
    if (which == 2) options.center_offset = 0.1;
    CHECK(hole.refused(options).first.empty());
  }
}

TEST_CASE("what is beyond a side that is met in position only may lean over a patch that is insisted on") {
  SquareHole hole;
  hole.vertices.bottomRows(4).leftCols(2) *= 0.2;  // walls under the fill
  hole.vertices.bottomRows(4).col(2).setConstant(-0.1);
  hole.fill.report.triangles_folded = 4;
  CHECK(!hole.refused(by(patch_method)).first.empty());
  hole.fill.report.continuity = std::vector(3, SeamContinuity::free);
  CHECK(hole.refused(by(patch_method)).first.empty());
  hole.fill.vertices << 3, 1.5, 0;
  CHECK(!hole.refused(by(patch_method)).first.empty());
}
