// When two sides have one plane at their corner, and when one begins behind it: on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_drafts.h"
#include "tripatch/estimate/corner_planes.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

constexpr double one_degree = std::numbers::pi / 180;

Vec3 turned(double degrees) { return {std::sin(degrees * one_degree), 0, std::cos(degrees * one_degree)}; }

}  // namespace

TEST_CASE("two sides have one plane at their corner up to 60 degrees between theirs, and from 5 on up to 5 deviations",
          "[thresholds]") {
  const auto joined = [](double degrees, double deviations) {
    FlatDrafts flat(2);
    std::array<SideFit, 3> fits;
    const double apart = 2 * std::sin(degrees * one_degree / 2), variance = std::pow(apart / deviations, 2) / 2;
    for (int i = 0; i < 3; ++i) {
      flat.drafts[i].normal = flat.drafts[i].faces;
      for (VertexFit& end : fits[i].ends) {
        end.normal = Vec3::UnitZ();
        end.frame << Vec3::UnitX(), Vec3::UnitY();
        end.covariance = variance * Eigen::Matrix2d::Identity();
      }
    }
    fits[2].ends[1].normal = turned(degrees / 2);
    fits[0].ends[0].normal = turned(-degrees / 2);
    for (const int i : {0, 2})
      fits[i].ends[i == 0 ? 0 : 1].frame << fits[i].ends[i == 0 ? 0 : 1].normal.cross(Vec3::UnitY()), Vec3::UnitY();
    flat.drafts[2].normal.back() = fits[2].ends[1].normal;
    flat.drafts[0].normal.front() = fits[0].ends[0].normal;
    settle_corners(fits, {false, false, false}, flat.drafts);
    return (flat.drafts[2].normal.back() - flat.drafts[0].normal.front()).norm() == 0;
  };
  CHECK(joined(59.5, 1));
  CHECK_FALSE(joined(60.5, 1));
  CHECK(joined(4.95, 100));
  CHECK_FALSE(joined(5.05, 100));
  CHECK(joined(20, 4.9));
  CHECK_FALSE(joined(20, 5.2));
}

namespace {

/// Side 2 turns towards the plane of the face at its end by `lean` and before that by `turn` (degrees), and so does side 0 that begins
/// there. What take_flat_corners makes of that; area: of that face.
struct FlatCorner {
  FlatDrafts flat{3};
  std::array<SideFit, 3> fits;
  FlatCorner(double lean, double turn, double area = 1) {
    for (const auto& [i, last, before] : {std::array{2, 2, 1}, {0, 0, 1}}) {
      flat.w.area[flat.drafts[i].face[last]] = turned(lean);
      flat.w.area[flat.drafts[i].face[before]] = turned(lean + turn);
    }
    for (int f : flat.w.part.faces_at(flat.local(3, 0)))
      if (f != flat.drafts[2].face.back() && f != flat.drafts[0].face.front()) flat.w.area[f] = 2 * area * Vec3::UnitZ();
    for (int i = 0; i < 3; ++i) {
      flat.drafts[i].normal.assign(flat.drafts[i].vertex.size(), Vec3::UnitX());
      fits[i].slope_variances.assign(flat.drafts[i].vertex.size(), 1.0);
    }
    take_flat_corners(flat.w, fits, {false, true, false}, flat.drafts);
  }
};

}  // namespace

TEST_CASE("a plane begins behind a corner where its face is 0.3 edges wide and it leans by a quarter to three quarters of a turn",
          "[thresholds]") {
  CHECK_FALSE(FlatCorner(10, 20, 0.0891).fits[2].flat[1]);
  CHECK(FlatCorner(10, 20, 0.0909).fits[2].flat[1]);
  CHECK_FALSE(FlatCorner(4.95, 20).fits[2].flat[1]);
  CHECK(FlatCorner(5.05, 20).fits[2].flat[1]);
  CHECK(FlatCorner(14.95, 20).fits[2].flat[1]);
  CHECK_FALSE(FlatCorner(15.05, 20).fits[2].flat[1]);
  // it is off by 0.4 of what it leans otherwise than by half
  const FlatCorner corner(13, 20);
  CHECK(corner.fits[2].slope_variances.back() == Approx(std::pow(0.4 * 3 * one_degree, 2)));
  CHECK(corner.fits[0].slope_variances.front() == Approx(std::pow(0.4 * 3 * one_degree, 2)));
  CHECK(corner.flat.drafts[2].normal.back() == Vec3::UnitZ());
}

TEST_CASE("a side between two planes turns evenly where its turns differ by a twentieth", "[thresholds]") {
  for (const double less : {0.049, 0.051}) {
    FlatDrafts flat(3);
    std::array<SideFit, 3> fits;
    const double turn = 20;
    for (int e = 0; e < 3; ++e) flat.w.area[flat.drafts[2].face[e]] = turned(e == 2 ? (2 - less) * turn : e * turn);
    for (int i = 0; i < 3; ++i) {
      flat.drafts[i].normal.assign(flat.drafts[i].vertex.size(), Vec3::UnitX());
      fits[i].slope_variances.assign(flat.drafts[i].vertex.size(), 1.0);
    }
    fits[2].flat = {true, true};
    fits[2].slope_variances.front() = fits[2].slope_variances.back() = 1e-9;
    take_flat_corners(flat.w, fits, {true, true, true}, flat.drafts);
    CHECK((flat.drafts[2].normal[1] == Vec3::UnitX()) == (less > 0.05));
    CHECK(fits[2].slope_variances[1] == Approx(std::pow(0.4 * less * turn * one_degree, 2)));
  }
}
