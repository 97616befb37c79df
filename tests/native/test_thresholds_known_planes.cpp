// How well the planes along a side are known, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_drafts.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

constexpr double one_degree = std::numbers::pi / 180;

}  // namespace

TEST_CASE("r rings tell a plane no better than ten times the rim's variance over their cube", "[thresholds]") {
  FlatDrafts flat(4);
  for (const double depth : {1.0, 2.0}) {
    SideDraft side = flat.side();
    side.depth = depth;
    const double rough = 1e-5;
    const SideFit fit = choose(flat.w, along(flat, {leaning(0, 1e-12, 0)}), side, rough);
    CHECK(fit.slope_variances[2] == Approx(10 * rough / (216 * depth * depth)));
  }
}

TEST_CASE("planes are off by 7.5 degrees times the cube of the turn, of more than four edges by less", "[thresholds]") {
  for (const int edges : {2, 4, 5, 8}) {
    FlatDrafts flat(edges);
    const double turn = 0.2;
    Vec3 p = Vec3::Zero();
    for (int k = 0; k <= edges; ++k) {
      flat.side().position[k] = p;
      flat.side().faces[k] = Vec3(std::sin((k - 0.5) * turn), 0, std::cos((k - 0.5) * turn));
      p += Vec3(std::cos(k * turn), 0, -std::sin(k * turn));
    }
    SideDraft side = flat.side();
    const double off = 7.5 * one_degree * std::pow(2 * std::sin(turn / 2), 3) * std::min(1.0, 16.0 / (edges * edges));
    CHECK(choose(flat.w, along(flat, {leaning(0, rather, 0)}), side, 0).turned == Approx(off * off));
  }
}

TEST_CASE("a plane known to a twentieth of a degree is known", "[thresholds]") {
  CHECK(is_known(leaning(0, std::pow(0.0495 * one_degree, 2), 0)));
  CHECK_FALSE(is_known(leaning(0, std::pow(0.0505 * one_degree, 2), 0)));
}

TEST_CASE("heights are measured once more over the plane that was found where it leans by 5e-4 over its guess", "[thresholds]") {
  for (const double lean : {4.9e-4, 5.1e-4}) {
    FlatDrafts flat(4);
    for (Vec3& guess : flat.side().guess) guess = Vec3(0, lean, 1).normalized();
    VarianceComponents exact;
    exact.noise = 1e-12;
    SideSearch search(flat.w, flat.drafts, 2);
    const auto nearest = nearest_of(flat.w, flat.drafts[2], search);
    const std::vector<VertexFit> fits = fit_side(flat.w, exact, flat.drafts[2], {2, false, true, false}, nearest, search);
    REQUIRE(fits.size() == 5);
    const Vec3 over = fits[0].frame.col(0).cross(fits[0].frame.col(1));  // what its heights were measured over
    CHECK(fits[0].normal[1] == Approx(0).margin(1e-9));
    CHECK(std::abs(over[1]) == Approx(lean < 5e-4 ? lean : 0).margin(1e-6));
  }
}

TEST_CASE("planes along a side are the same whether they are looked for at one go or with rests") {
  FlatDrafts flat(6);
  for (Vec3& guess : flat.side().guess) guess = Vec3(0, 0.01, 1).normalized();
  VarianceComponents exact;
  exact.noise = 1e-12;
  SideSearch search(flat.w, flat.drafts, 2), other(flat.w, flat.drafts, 2);
  const Neighborhood near = {2, false, true, false};
  const auto nearest = nearest_of(flat.w, flat.drafts[2], search);
  const std::vector<VertexFit> whole = fit_side(flat.w, exact, flat.drafts[2], near, nearest, search);
  SideFitting fitting(flat.w, exact, flat.drafts[2], near, nearest, other);
  for (const int vertices : {3, 0, 1, 100}) fitting.go_on(vertices);
  CHECK(fitting.left() == 0);
  const std::vector<VertexFit> parts = fitting.fits();
  REQUIRE(parts.size() == whole.size());
  for (std::size_t k = 0; k < whole.size(); ++k) {
    CHECK(parts[k].normal == whole[k].normal);
    CHECK(parts[k].second == whole[k].second);
    CHECK(parts[k].covariance == whole[k].covariance);
  }
}

TEST_CASE("a rim is as rough as it differs from the quintic through three vertices on either side, of four edges from the cubic",
          "[thresholds]") {
  const auto rough = [](int edges, int degree) {
    FlatDrafts flat(edges);
    SideDraft& side = flat.side();
    for (int k = 0; k <= edges; ++k) side.position[k][2] = std::pow(side.t[k], degree);
    flat.drafts[0] = flat.drafts[1] = side;
    return roughness(flat.drafts);
  };
  CHECK(rough(3, 4) == 0);  // two vertices on either side are too few
  CHECK(rough(4, 3) < 1e-24);
  CHECK(rough(4, 4) > 1e-8);
  CHECK(rough(6, 5) < 1e-24);
  CHECK(rough(6, 6) > 1e-12);
  CHECK(rough(8, 6) > 1e-12);  // no more than three on either side
}
