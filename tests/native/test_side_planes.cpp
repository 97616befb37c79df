// Planes along a side.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_drafts.h"

using namespace tripatch;
using namespace tripatch::testing;

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
