// What decides about splines over a plane, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>
#include <set>

#include "tripatch/math/jet.h"
#include "tripatch/spline/hermite_correction.h"
#include "tripatch/spline/polyharmonic_spline.h"

using namespace tripatch;

namespace {

PlanePoints ring_of_samples(Index n) {
  std::mt19937 random(3);
  PlanePoints places(n, 2);
  for (Index k = 0; k < n;) {
    places.row(k) << random() / 2147483648.0 - 1, random() / 2147483648.0 - 1;
    if (places.row(k).norm() > 0.5 && places.row(k).norm() < 1) ++k;
  }
  return places;
}

/// A graph over the plane with noise of such a deviation.
template <class F>
Points graph(const PlanePoints& at, const F& height, double noise = 0) {
  std::mt19937 random(5);
  Points out(at.rows(), 3);
  for (Index k = 0; k < at.rows(); ++k) {
    const double u = (random() + 0.5) / 4294967296.0, v = (random() + 0.5) / 4294967296.0;  // Box and Muller
    out.row(k) << at(k, 0), at(k, 1),
        height(at(k, 0), at(k, 1)) + noise * std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }
  return out;
}

Points rows_over(const PlanePoints& uv) {
  Points rows = Points::Zero(uv.rows(), 3);
  rows.leftCols(2) = uv;
  return rows;
}

double wavy(double x, double y) { return std::sin(2 * x) * std::cos(2 * y); }
double cubic(double x, double y) { return 0.3 * x * x * x - 0.2 * x * y * y + 0.1 * y; }

}  // namespace

TEST_CASE("a field is half as rough as can be where its noise is 0.04 edges", "[thresholds]") {
  const PlanePoints at = ring_of_samples(80);
  for (const double noise : {0.01, 0.04, 0.1}) {
    const PolyharmonicSpline field(at, graph(at, cubic, noise), {{3}, 1});
    REQUIRE(field.noise() > 0.5 * noise);
    CHECK(field.roughness() == Approx(1 - 1 / (1 + std::pow(field.noise() / 0.04, 4))));
  }
}

TEST_CASE("orders share by their likelihoods, over a tenth of 160 samples, and none has less than a fiftieth", "[thresholds]") {
  const PlanePoints at = ring_of_samples(240);
  double below = 0, above = 1;
  for (double noise = 3.5e-3; noise < 5e-3; noise *= 1.02) {
    const Points samples = graph(at, wavy, noise);
    const PolyharmonicSpline one(at, samples, {{2.5}, 10}), other(at, samples, {{3.5}, 10}), both(at, samples, {{2.5, 3.5}, 10});
    if (both.roughness() > 1e-6) continue;
    const double odds = std::exp(-std::abs(one.likelihood() - other.likelihood()) / 16), less = odds / (1 + odds);
    CHECK(both.parts().size() == (less < 0.02 ? 1 : 2));
    if (both.parts().size() == 2) CHECK(std::min(both.parts()[0].share, both.parts()[1].share) == Approx(less).epsilon(1e-4));
    (less < 0.02 ? below : above) = less < 0.02 ? std::max(below, less) : std::min(above, less);
  }
  CHECK(below > 0.016);
  CHECK(above < 0.025);
}

TEST_CASE("noise is told in half decades of the nugget from -12 to 4; below there is none, and rounding is -14", "[thresholds]") {
  const PlanePoints at = ring_of_samples(160);
  const auto part = [&](double order, double noise) {
    return PolyharmonicSpline(at, graph(at, wavy, noise), {{order}, 1}).parts()[0];
  };
  // all noise, by a low order, and rounding, both over the mean eigenvalue of the same kernel
  CHECK(std::log10(part(3, 1e3).nugget / part(3, 0).used_nugget) == Approx(18));
  REQUIRE(part(7.5, 0).nugget == 0);
  std::set<double> nuggets;
  for (double noise = 5e-10; noise < 5e-9; noise *= 1.05) nuggets.insert(part(7.5, noise).nugget);
  nuggets.erase(0);
  CHECK(std::log10(*nuggets.begin() / part(7.5, 0).used_nugget) == Approx(2));
  double step = 10;
  for (auto k = std::next(nuggets.begin()); k != nuggets.end(); ++k) step = std::min(step, std::log10(*k / *std::prev(k)));
  CHECK(step == Approx(0.5));
}

TEST_CASE("where one order is likely half of the distance to another is an error", "[thresholds]") {
  // a cubic, which order 4.5 has and order 2.5 has not: no other error is left
  const PlanePoints at = ring_of_samples(110), inside = 0.4 * ring_of_samples(20);
  const Points samples = graph(at, cubic);
  const PolyharmonicSpline own(at, samples, {{4.5}, 0.1}), other(at, samples, {{2.5}, 0.1});
  Points up = Points::Zero(20, 3);
  up.col(2).setOnes();
  const Eigen::VectorXd apart = (other.positions(rows_over(inside)) - own.positions(rows_over(inside))).col(2).cwiseAbs();
  REQUIRE(apart.maxCoeff() > 1e-4);
  CHECK((own.deviation(inside, up) - 0.5 * apart).cwiseAbs().maxCoeff() < 0.02 * apart.maxCoeff());
}

TEST_CASE("second derivatives without a limit are those a ten-millionth beside a sample", "[thresholds]") {
  PlanePoints at = ring_of_samples(40);
  at.row(0) << 1, 0.999;  // within the largest coordinates about the middle
  const PolyharmonicSpline field(at, graph(at, [](double x, double y) { return std::sin(2 * x) * std::cos(3 * y); }), {{2}, 0.1});
  const double size = (at.rowwise() - at.colwise().mean()).cwiseAbs().maxCoeff();
  PlanePoints three(3, 2);
  for (Index k = 0; k < 3; ++k) three.row(k) << at(7, 0) + std::array{0.0, 0.95e-7, 1.3e-7}[k] * size, at(7, 1);
  constexpr int all = 3 * jet_size(2);
  std::vector<double> jets(3 * all);
  field.evaluate(rows_over(three).data(), 3, 2, jets.data());
  for (const int c : {3, 5}) {  // second derivatives of the height by u and by v
    const auto height = [&](int place) { return jets[place * all + 3 * c + 2]; };
    CHECK(std::abs(height(1) - height(0)) < 1e-6 * std::abs(height(0)));
    CHECK(std::abs(height(2) - height(0)) > 1e-5 * std::abs(height(0)));
  }
}

namespace {

struct BowlOver {
  PlanePoints samples = ring_of_samples(120);
  PolyharmonicSpline field{samples, graph(samples, [](double x, double y) { return 0.4 * (x * x + y * y); }), {}};
  PlanePoints rim;
  explicit BowlOver(Index n) : rim(n, 2) {
    for (Index k = 0; k < n; ++k) {
      const double a = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
      rim.row(k) << 0.6 * std::cos(a), 0.6 * std::sin(a);
    }
  }
};

}  // namespace

TEST_CASE("points inside lie over two places that are a millionth of the domain's size apart", "[thresholds]") {
  const BowlOver bowl(24);
  for (const double apart : {0.99e-6, 1.01e-6}) {
    PlanePoints places(2, 2);
    places << 0.1, 0.1, 0.1 + apart * 0.6, 0.1;
    const auto made = [&] { HermiteCorrection(bowl.field, bowl.rim, places, {{Vec3(0, 0, 1), {}}, {Vec3(0, 0, 1), {}}}); };
    if (apart < 1e-6) {
      CHECK_THROWS_AS(made(), Refusal);
    } else {
      CHECK_NOTHROW(made());
    }
  }
}

TEST_CASE("all of a rim of 200 vertices is held where points inside are met, of more every second", "[thresholds]") {
  for (const Index n : {200, 202}) {
    const BowlOver bowl(n);
    PlanePoints place(1, 2);
    place << 0.1, 0.2;
    const HermiteCorrection added(bowl.field, bowl.rim, place, {{Vec3(0.1, 0.2, 1), {}}});
    const Points left = added.positions(rows_over(bowl.rim));
    CHECK(left.row(100).norm() < 1e-12);
    CHECK((left.row(1).norm() < 1e-12) == (n == 200));
  }
}

TEST_CASE("places keep a fiftieth of the domain's size from its border", "[thresholds]") {
  const BowlOver bowl(24);
  PlanePoints corners(5, 2);
  corners << -0.5, -0.5, 0.5, -0.5, 0.5, 0.5, -0.5, 0.5, 0, 0;
  const std::vector<std::array<Index, 3>> triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const PlanePoints places = nearest_places(bowl.field, corners, triangles, {{Vec3(2, 0.1, 0.1), {}}});
  CHECK(0.5 - places(0, 0) > 0.02);
  CHECK(0.5 - places(0, 0) < 0.022);
}
