// Planes along a long side between those that are fitted.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_drafts.h"
#include "tripatch/estimate/fits_between.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// What a side sees of an arc: normals that turn by `bend` a radian, spaced unevenly.
struct Arc {
  SideDraft side;
  std::vector<VertexFit> fits;

  explicit Arc(int edges, double over = 1) {
    for (int k = 0; k <= edges; ++k) {
      const double x = static_cast<double>(k) / edges, t = x + 0.05 * std::sin(2 * std::numbers::pi * x), angle = over * t;
      side.vertex.push_back(k);
      side.t.push_back(t);
      side.tangent.push_back({std::cos(angle), 0, -std::sin(angle)});
      VertexFit fit = leaning(0, certain, 0);
      fit.normal = {std::sin(angle), 0, std::cos(angle)};
      fit.second = 0.1 * side.tangent.back() * side.tangent.back().transpose();
      fits.push_back(fit);
    }
  }
  bool is_between(int k) const { return tripatch::is_between(k, side.edges()); }
};

/// The largest error of what is reported between fits; -1: something is not given.
double largest_error(const Arc& arc) {
  FitsBetween between(arc.side, arc.fits);
  double error = 0;
  for (int k = 0; k <= arc.side.edges(); ++k) {
    if (!arc.is_between(k)) continue;
    const std::optional<VertexFit> told = between.at(k);
    if (!told) return -1;
    error = std::max({error, (told->normal - arc.fits[k].normal).norm(), (told->second - arc.fits[k].second).norm()});
  }
  return error;
}

}  // namespace

TEST_CASE("no vertex is farther than another fit's reach from a fit, and sides look alike from both ends") {
  for (int edges = 1; edges < 200; ++edges) {
    int left_out = 0, most = 0;
    for (int k = 0; k <= edges; ++k) {
      const bool is = is_between(k, edges);
      REQUIRE(is == is_between(edges - k, edges));
      left_out = is ? left_out + 1 : 0;
      most = std::max(most, left_out);
      if (k < 3) REQUIRE_FALSE(is);
    }
    REQUIRE(most == (edges < 24 ? 0 : edges < 64 ? 1 : 3));
  }
}

TEST_CASE("what lies between fits is told by those around it, to the sixth order of their distance") {
  CHECK(largest_error(Arc(100)) < 1e-9);
  CHECK(std::log2(largest_error(Arc(200)) / largest_error(Arc(400))) == Approx(6).margin(0.2));
}

TEST_CASE("fits between others lie in their planes and are known as those beside them") {
  Arc arc(100);
  for (std::size_t k = 0; k < arc.fits.size(); ++k) {
    arc.fits[k].covariance *= 1 + static_cast<double>(k) / 100;
    arc.fits[k].bend_variance = 1e-6 * static_cast<double>(k);
  }
  const VertexFit told = FitsBetween(arc.side, arc.fits).at(30).value();  // between 28 and 32
  CHECK(told.normal.norm() == Approx(1));
  CHECK((told.second * told.normal).norm() < 1e-15);
  CHECK((told.second - told.second.transpose()).norm() < 1e-15);
  CHECK((told.covariance - 0.5 * (arc.fits[28].covariance + arc.fits[32].covariance)).norm() < 1e-15);
  CHECK(told.slope_variances == Approx(told.covariance.trace()));
  CHECK(told.bend_variance == Approx(30e-6));
  CHECK((told.frame.transpose() * told.normal).norm() < 1e-6);
}

TEST_CASE("where fits are not told by those around them, vertices between have fits of their own") {
  constexpr double told = 0.05 * std::numbers::pi / 180 / 50;
  Arc arc(100);
  const std::vector<VertexFit> smooth = arc.fits;
  const auto are_told = [&](const std::array<int, 3>& vertices) {
    FitsBetween between(arc.side, arc.fits);
    return std::all_of(vertices.begin(), vertices.end(), [&](int k) { return between.at(k).has_value(); });
  };
  const auto any_told = [&](const std::array<int, 3>& vertices) {
    FitsBetween between(arc.side, arc.fits);
    return std::any_of(vertices.begin(), vertices.end(), [&](int k) { return between.at(k).has_value(); });
  };
  const std::array<int, 3> before = {29, 30, 31}, far_off = {61, 62, 63};  // one of the fits that tell them is that at 32
  for (const double times : {0.9, 1.1}) {
    arc.fits = smooth;
    arc.fits[32].normal += times * told * arc.side.tangent[32];
    CHECK(are_told(before) == times < 1);
    CHECK(any_told(before) == times < 1);
    CHECK(are_told(far_off));
    arc.fits = smooth;
    arc.fits[32].second += times * told * Vec3::UnitY() * Vec3::UnitY().transpose();
    CHECK(are_told(before) == times < 1);
  }
  arc.fits = smooth;
  for (std::size_t k = 30; k < arc.fits.size(); ++k) {  // the side turns by a degree between two fits
    const double angle = std::atan2(smooth[k].normal[0], smooth[k].normal[2]) + std::numbers::pi / 180;
    arc.fits[k].normal = {std::sin(angle), 0, std::cos(angle)};
    const Vec3 along(std::cos(angle), 0, -std::sin(angle));
    arc.fits[k].second = 0.1 * along * along.transpose();
  }
  CHECK_FALSE(any_told({29, 30, 31}));
  CHECK_FALSE(any_told({25, 26, 27}));
  CHECK(are_told(far_off));
}

TEST_CASE("a dent between fits is not overlooked") {
  constexpr int edges = 72;
  for (const double depth : {0.0, 1e-6, 1e-4, 1e-2}) {
    FlatDrafts flat(edges);
    REQUIRE(is_between(30, edges));
    flat.vertices(flat.at(30, -1), 2) = depth;
    flat.w = local_mesh({flat.vertices, flat.faces}, Connectivity(flat.faces, flat.vertices.rows()), flat.hole);
    for (Vec3& p : flat.w.position) p += flat.w.origin;
    VarianceComponents exact;
    exact.noise = 1e-12;
    SideSearch search(flat.w, flat.drafts, 2), other(flat.w, flat.drafts, 2);
    const Neighborhood near = {2, false, true, false};
    const auto nearest = nearest_of(flat.w, flat.side(), search);
    const std::vector<VertexFit> all = fit_side(flat.w, exact, flat.side(), near, nearest, search);
    const std::vector<std::vector<Share>> nobody_asks;
    SideFitting fitting(flat.w, exact, flat.side(), near, nobody_asks, other);
    fitting.go_on(fitting.left());
    const std::vector<VertexFit> some = fitting.fits();
    if (some.empty()) continue;  // a plane is not well known, and all are looked at in other ways
    REQUIRE(some.size() == all.size());
    double most = 0;
    for (std::size_t k = 0; k < all.size(); ++k) most = std::max(most, (some[k].normal - all[k].normal).norm());
    CHECK(most < 2e-5);  // a thousandth of a degree
  }
}
