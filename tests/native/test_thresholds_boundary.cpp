// What decides in the surroundings, on both sides of its thresholds; those of meshes are in test_local_mesh and test_mesh_sides.
#include "test_refusals.h"
#include "test_surfaces.h"
#include "tripatch/boundary/normal_sides.h"
#include "tripatch/boundary/ribbon.h"
#include "tripatch/boundary/smoothed.h"
#include "tripatch/options.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/smooth_triangles.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

const std::array<Vec3, 3> corners = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0.5, std::sqrt(0.75), 0)};

/// The equilateral triangle in its plane.
Sides flat_sides() {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &a = corners[(i + 1) % 3], &b = corners[(i + 2) % 3], out = (b - a).cross(Vec3::UnitZ());
    sides[i] = {line(a, b), line(out, out), {}};
  }
  return sides;
}

}  // namespace

TEST_CASE("sides meet whose ends are a millionth of the size apart", "[thresholds]") {
  for (const double gap : {0.99e-6, 1.01e-6}) {
    Sides sides = flat_sides();
    sides[0] = moved_ends(sides[0], Vec3::Zero(), gap * Vec3::UnitZ());
    if (gap < 1e-6) {
      CHECK_NOTHROW(make_boundary(sides));
    } else {
      CHECK_THROWS_WITH(make_boundary(sides), Catch::Contains("do not meet at corner 2"));
    }
  }
}

TEST_CASE("a side is closed whose ends are a millionth of its width apart", "[thresholds]") {
  for (const double gap : {0.99e-6, 1.01e-6}) {
    const double width = std::sqrt(0.5);
    const std::array<double, 9> net = {0, 0, 0, 1, 1, 0, gap * width, 0, 0};
    const Side side = {PiecewisePolynomial::bezier(net, 3), line(Vec3::UnitZ(), Vec3::UnitZ()), {}};
    if (gap < 1e-6) {
      CHECK_NOTHROW(piece_of(side, 0.5, 1.2));
    } else {
      CHECK_THROWS_AS(piece_of(side, 0.5, 1.2), InvalidArgument);
    }
    CHECK_NOTHROW(piece_of(side, 0.5, 1));
  }
}

TEST_CASE("surroundings have planes where what is across leaves the line of the side by a billionth", "[thresholds]") {
  RibbonOptions given;
  given.cross_boundary = CrossBoundary::given;
  for (const double sine : {0.9e-9, 1.1e-9}) {
    Sides sides = flat_sides();
    const Vec3 along = corners[2] - corners[1], across = along + sine * along.cross(Vec3::UnitZ());
    sides[0].r = line(across, across);
    if (sine < 1e-9) {
      CHECK_THROWS_WITH(make_boundary(sides, given), Catch::Contains("Side 0 has no tangent planes"));
    } else {
      CHECK_NOTHROW(make_boundary(sides, given));
    }
  }
}

TEST_CASE("slopes that would lead backwards are a thousandth of what an equilateral patch has, and no other is that small",
          "[thresholds]") {
  Sides sides = flat_sides();
  const auto share = [&](const Boundary& boundary, int i, double t) {
    double alpha = 0;
    boundary.ribbons[i].alpha.taylor(t, 0, &alpha);
    return alpha * sides[i].r(t).norm() / std::sqrt(0.75);  // height of the patch
  };
  CHECK(share(make_boundary(sides), 0, 0) == Approx(1));
  sides[0].r = -1.0 * sides[0].r;
  CHECK(share(make_boundary(sides), 0, 0) == Approx(1e-3));
  CHECK(share(make_boundary(sides), 0, 1) == Approx(1e-3));
  CHECK(share(make_boundary(sides), 1, 1) > 0.1);
}

TEST_CASE("a normal that leaves the edge's line by more than a millionth makes a curve", "[thresholds]") {
  const Vec3 p = Vec3::Zero(), q = Vec3::UnitX();
  for (const double sine : {0.9e-6, 1.1e-6}) {
    const Vec3 normal(std::sqrt(1 - sine * sine), 0, sine);
    for (const bool at_start : {true, false}) {
      const std::string code = refusal_code([&] {
        if (at_start) {
          side_from_normals(p, normal, q, Vec3::UnitZ(), NormalCurve::smits);
        } else {
          side_from_normals(p, Vec3::UnitZ(), q, normal, NormalCurve::smits);
        }
      });
      CHECK((code == "normal_along_edge") == (sine < 1e-6));
    }
  }
}

TEST_CASE("sides of nine vertices and more are smoothed where their noise is small beside them, shorter ones are left alone",
          "[thresholds]") {
  const auto zigzag = [](int vertices, double noise) {
    Sides sides = flat_sides();
    std::vector<PiecewisePolynomial> pieces;
    const auto at = [&](int k) {
      const double t = static_cast<double>(k) / (vertices - 1);
      return Vec3(corners[1] + t * (corners[2] - corners[1]) + (k % 2 ? noise : 0) * Vec3::UnitZ());
    };
    for (int k = 0; k < vertices; ++k) sides[0].rim.push_back(static_cast<double>(k) / (vertices - 1));
    for (int k = 0; k + 1 < vertices; ++k) pieces.push_back(line(at(k), at(k + 1)));
    sides[0].c = PiecewisePolynomial::joined(pieces);
    const Sides smooth = smoothed(sides);
    return (smooth[0].c(1.0 / (vertices - 1)) - sides[0].c(1.0 / (vertices - 1))).norm();
  };
  CHECK(zigzag(8, 0.02) == 0);
  CHECK(zigzag(10, 0.02) > 0.005);
  CHECK(zigzag(40, 0.15) > 0.01);
  CHECK(zigzag(40, 0.5) == 0);
}

TEST_CASE("nothing is asked for a million times the size of the hole away", "[thresholds]") {
  const Sides sides = flat_sides();
  const double size = check_sides(sides);
  FillOptions options;
  options.fairing = Fairing::thin_plate;
  for (const double share : {0.999, 1.001}) {
    const auto refused_where = [&](const FillOptions& asked, const std::string& said) {
      if (share < 1) {
        CHECK_NOTHROW(patch_from_sides(sides, asked));
      } else {
        CHECK_THROWS_WITH(patch_from_sides(sides, asked), Catch::Contains(said));
      }
    };
    FillOptions bulging = options, offset = options, middle = options;
    bulging.bulge = share * 1e6;
    offset.center_offset = share * 1e6 * size;
    middle.center = Vec3(sides[0].c(0) + share * 1e6 * size * Vec3::UnitZ());
    refused_where(bulging, "bulge must be less than");
    refused_where(offset, "center_offset is more than a million times");
    refused_where(middle, "center is more than a million times");
  }
}

TEST_CASE("a triangle has an area from a million-millionth of its longest edge squared on", "[thresholds]") {
  for (const double height : {0.9e-12, 1.1e-12}) {
    const Points vertices = (Points(3, 3) << 0, 0, 0, 1, 0, 0, 0.5, height, 0).finished();
    Faces faces;
    faces.add(std::array<Index, 3>{0, 1, 2});
    std::string said;
    try {
      smooth_triangles({vertices, faces}, Points(Points::Zero(3, 3).rowwise() + Eigen::RowVector3d(0, 0, 1)), 2);
    } catch (const Refusal& refusal) {
      said = refusal.what();
    }
    CHECK((said == "Face 0 has no area") == (height < 1e-12));
  }
}
