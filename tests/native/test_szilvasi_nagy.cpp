#include "test_surfaces.h"
#include "tripatch/constructions/shape_search.h"
#include "tripatch/constructions/szilvasi_nagy.h"
#include "tripatch/fairing/energy.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

std::shared_ptr<SzilvasiNagy> blend(const std::array<SurfacePtr, 3>& surfaces, int continuity,
                                    std::array<double, 3> shape = {.5, .5, .5}, bool as_printed = false) {
  SzilvasiNagyOptions options;
  options.continuity = continuity;
  options.shape = shape;
  options.as_printed = as_printed;
  return std::make_shared<SzilvasiNagy>(surfaces, options);
}

Make from_hole(int continuity) {
  return [continuity](const Sides& sides) { return blend(hole_surfaces(make_boundary(sides), continuity), continuity); };
}

std::array<SurfacePtr, 3> quadratics(unsigned seed) {
  return {bezier(random_net(2, seed, 0.3)), bezier(random_net(2, seed + 1, 0.3)), bezier(random_net(2, seed + 2, 0.3))};
}

/// Largest distance on the sides, and largest angle between tangent planes there away from the corners.
std::pair<double, double> misfit(const Surface& patch, const std::array<SurfacePtr, 3>& surfaces) {
  double distance = 0, angle = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= 40; ++k) {
      const double t = k / 40.0;
      Points b(1, 3);
      b.row(0) = Vec3::Map(on_side(i, t).data());
      distance = std::max(distance, (patch.positions(b) - surfaces[i]->positions(b)).norm());
      if (k > 0 && k < 40) angle = std::max(angle, degrees_between(patch.normals(b).row(0), surfaces[i]->normals(b).row(0)));
    }
  return {distance, angle};
}

/// Reads another surface with its corners in another order.
SurfacePtr relabelled_surface(const SurfacePtr& surface, const std::array<int, 3>& order) {
  // new b[k] stands at corner order[k]; (b0, b1) of the old one are linear in the new
  return formula_surface([surface, order](const auto& b) {
    using Scalar = std::decay_t<decltype(b[0])>;
    constexpr int N = Scalar::order;
    std::array<Scalar, 3> old;
    for (int k = 0; k < 3; ++k) old[order[k]] = b[k];
    std::array<double, 3 * jet_size(N)> series;
    const std::array<double, 3> at = {old[0].value(), old[1].value(), old[2].value()};
    surface->evaluate(at.data(), 1, N, series.data());
    JetPoint<N> p = load<N>(series.data());
    if constexpr (N > 0) {
      const Substitution<N> substitution(old[0].c[1], old[0].c[2], old[1].c[1], old[1].c[2]);
      for (int x = 0; x < 3; ++x) p.x[x] = substitution(p.x[x]);
    }
    return p;
  });
}

double relabelling(int continuity, bool as_printed) {
  const std::array<SurfacePtr, 3> surfaces = quadratics(5);
  const std::array<double, 3> shape = {0.3, 0.6, 0.45};
  const Points b = grid(12), expected = blend(surfaces, continuity, shape, as_printed)->positions(b);
  double worst = 0;
  for (const std::array<int, 3>& order :
       {std::array{1, 2, 0}, std::array{2, 0, 1}, std::array{0, 2, 1}, std::array{2, 1, 0}, std::array{1, 0, 2}}) {
    const bool odd = order[1] != (order[0] + 1) % 3;
    std::array<SurfacePtr, 3> same;
    std::array<double, 3> same_shape;
    Points same_b(b.rows(), 3);
    for (int k = 0; k < 3; ++k) {
      same[k] = relabelled_surface(surfaces[order[k]], order);
      // lambda_k mixes surfaces k and k + 2
      same_shape[k] = odd ? 1 - shape[order[(k + 2) % 3]] : shape[order[k]];
      same_b.col(k) = b.col(order[k]);
    }
    const Points found = blend(same, continuity, same_shape, as_printed)->positions(same_b);
    worst = std::max(worst, (found - expected).rowwise().norm().maxCoeff());
  }
  return worst;
}

}  // namespace

TEST_CASE("szilvasi_nagy_c0 from a hole keeps its promises") { check_promises(from_hole(0), 0); }
TEST_CASE("szilvasi_nagy_c1 from a hole keeps its promises") { check_promises(from_hole(1), 1); }

TEST_CASE("szilvasi_nagy from a hole reproduces cubics, and no more") {
  for (int continuity : {0, 1}) {
    for (int degree = 1; degree <= 3; ++degree) CHECK(reproduction_error(from_hole(continuity), degree) < 1e-12);
    CHECK(reproduction_error(from_hole(continuity), 4) > 1e-3);
  }
}

TEST_CASE("szilvasi_nagy interpolates three quadratic patches") {
  for (unsigned seed : {1u, 20u, 40u}) {
    const std::array<SurfacePtr, 3> surfaces = quadratics(seed);
    const std::array<double, 3> shape = {0.2, 0.5, 0.7};
    CHECK(misfit(*blend(surfaces, 0, shape), surfaces).first < 1e-12);
    const auto [distance, angle] = misfit(*blend(surfaces, 1, shape), surfaces);
    CHECK(distance < 1e-12);
    CHECK(angle < 1e-6);
  }
}

TEST_CASE("szilvasi_nagy takes first derivatives from its surfaces") {
  const std::array<SurfacePtr, 3> surfaces = unrelated_surfaces(31);
  const auto patch = blend(surfaces, 1, {0.3, 0.8, 0.6});
  for (int i = 0; i < 3; ++i)
    for (double t : {0.1, 0.4, 0.75}) {
      std::array<double, 9> found, expected;
      patch->evaluate(on_side(i, t).data(), 1, 1, found.data());
      surfaces[i]->evaluate(on_side(i, t).data(), 1, 1, expected.data());
      for (int k = 0; k < 9; ++k) CHECK(found[k] == Approx(expected[k]).margin(1e-12));
    }
  CHECK(derivative_error(*patch) < 1e-4);
}

TEST_CASE("szilvasi_nagy as printed: Definition 1 interpolates, Definition 2 does not") {
  const std::array<SurfacePtr, 3> surfaces = quadratics(1);
  CHECK(misfit(*blend(surfaces, 0, {.5, .5, .5}, true), surfaces).first < 1e-12);
  const auto [distance, angle] = misfit(*blend(surfaces, 1, {.5, .5, .5}, true), surfaces);
  CHECK(distance > 0.5);
  CHECK(angle > 30);
}

TEST_CASE("szilvasi_nagy does not depend on the numbering; as printed it does") {
  CHECK(relabelling(0, false) < 1e-14);
  CHECK(relabelling(1, false) < 1e-13);
  CHECK(relabelling(0, true) > 0.01);
  CHECK(relabelling(1, true) > 0.01);
}

// Definition 1 and 2 written out at one point from the surfaces' positions and first derivatives, mu and its derivative by hand.
TEST_CASE("szilvasi_nagy is the formula of mathematics, term by term") {
  const std::array<SurfacePtr, 3> r = unrelated_surfaces(8);
  const std::array<double, 3> lambda = {0.35, 0.55, 0.8};
  const auto mu = [&](int i, const Vec3& b) {
    const double u = b[i], w = b[(i + 2) % 3];
    return (1 - lambda[i]) * w * w / (lambda[i] * u * u + (1 - lambda[i]) * w * w);
  };
  const auto g = [&](int i, const Vec3& b) -> Vec3 {
    Points at(1, 3);
    at.row(0) = b;
    const double m = mu((i + 2) % 3, b);
    return m * r[(i + 2) % 3]->positions(at).row(0) + (1 - m) * r[(i + 1) % 3]->positions(at).row(0);
  };
  for (const Vec3& b : {Vec3(0.2, 0.5, 0.3), Vec3(0.75, 0.2, 0.05)}) {
    const double b01 = b[0] * b[1], b12 = b[1] * b[2], b20 = b[2] * b[0], sum = b01 * b01 + b12 * b12 + b20 * b20;
    const std::array<double, 3> w = {b12 * b12 / sum, b20 * b20 / sum, b01 * b01 / sum};
    Vec3 q = Vec3::Zero(), s = Vec3::Zero(), blends = Vec3::Zero();
    for (int i = 0; i < 3; ++i) {
      const Vec3 delta = perpendicular_feet()[i], foot = b - b[i] * delta;
      const double h = 1e-3;
      const auto odd = [&](int n) -> Vec3 { return g(i, foot + n * h * delta) - g(i, foot - n * h * delta); };
      blends += g(i, b);
      q += w[i] * g(i, foot);
      s += 0.5 * b[i] * w[i] * (45 * odd(1) - 9 * odd(2) + odd(3)) / (60 * h);
    }
    Points at(1, 3);
    at.row(0) = b;
    const auto c0 = blend(r, 0, lambda), c1 = blend(r, 1, lambda);
    CHECK((Vec3(c0->positions(at).row(0)) - 0.5 * (blends - q)).norm() < 1e-13);
    CHECK((Vec3(c1->positions(at).row(0)) - (0.5 * (blends - q) - s)).norm() < 1e-9);
    CHECK((Vec3(c1->correction(at).row(0)) - q).norm() < 1e-13);
    CHECK((Vec3(c1->slope_correction(at).row(0)) - s).norm() < 1e-9);
    for (int i = 0; i < 3; ++i) CHECK(c1->mu(b.data())[i] == Approx(mu(i, b)));
  }
  // on its side the correction term is the auxiliary curve
  const auto c0 = blend(r, 0, lambda);
  for (int i = 0; i < 3; ++i) {
    Points at(1, 3);
    at.row(0) = Vec3::Map(on_side(i, 0.3).data());
    CHECK((c0->correction(at) - c0->auxiliary_curve(i, {0.3})).norm() < 1e-13);
    CHECK((Vec3(c0->auxiliary_curve(i, {0.0}).row(0)) - plain_corners[(i + 1) % 3]).norm() < 1e-13);
  }
  CHECK(c0->mu(Vec3(0, 1, 0).data())[0] == 1);
}

TEST_CASE("szilvasi_nagy: other surfaces with the same boundary change the inside only") {
  const std::array<SurfacePtr, 3> surfaces = quadratics(3);
  std::array<SurfacePtr, 3> other = surfaces;
  other[2] = formula_surface([inner = surfaces[2]](const auto& b) {
    using Scalar = std::decay_t<decltype(b[0])>;
    constexpr int N = Scalar::order;
    std::array<double, 3 * jet_size(N)> series;
    const std::array<double, 3> at = {b[0].value(), b[1].value(), b[2].value()};
    inner->evaluate(at.data(), 1, N, series.data());
    return load<N>(series.data()) + square(27.0 * (b[0] * b[1] * b[2])) * JetPoint<N>(Vec3(0.1, 0, 0.4));
  });
  const auto one = blend(surfaces, 1), two = blend(other, 1);
  CHECK(misfit(*two, surfaces).first < 1e-12);
  CHECK(misfit(*two, surfaces).second < 1e-6);
  CHECK(difference(*one, *two) > 0.05);
}

TEST_CASE("szilvasi_nagy: optimal lambda") {
  for (const auto& [continuity, seed] : {std::pair{0, 60u}, std::pair{1, 12u}}) {
    const std::array<SurfacePtr, 3> surfaces = quadratics(seed);
    SzilvasiNagyOptions options;
    options.continuity = continuity;
    options.optimal = true;
    options.quadrature = 6;
    const SzilvasiNagy best(surfaces, options);
    REQUIRE(best.path().size() > 1);
    CHECK(best.shape() == best.path().back().shape);
    const double least = best.path().back().energy;
    CHECK(energy(best, Fairing::thin_plate, 1, 6) == Approx(least).epsilon(1e-9));  // two evaluators of one energy
    CHECK(best.path().front().energy == Approx(energy(*blend(surfaces, continuity), Fairing::thin_plate, 1, 6)).epsilon(1e-9));
    for (std::size_t k = 2; k < best.path().size(); ++k) CHECK(best.path()[k].energy <= best.path()[k - 1].energy);

    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(0, 1);
    double found = INFINITY;
    for (int k = 0; k < 1000; ++k)
      found = std::min(found, energy(*blend(surfaces, continuity, {uniform(random), uniform(random), uniform(random)}),
                                     Fairing::thin_plate, 1, 6));
    CHECK(least <= found * (1 + 1e-6));

    for (int i = 0; i < 3; ++i) {
      const auto slope = [&](double h) {
        std::array<double, 3> up = best.shape(), down = best.shape();
        up[i] += h;
        down[i] -= h;
        return (energy(*blend(surfaces, continuity, up), Fairing::thin_plate, 1, 6) -
                energy(*blend(surfaces, continuity, down), Fairing::thin_plate, 1, 6)) /
               (2 * h);
      };
      if (best.shape()[i] < 1.001e-3) {
        CHECK(slope(1e-5) > 0);  // at its bound: outwards it would fall
      } else if (best.shape()[i] > 1 - 1.001e-3) {
        CHECK(slope(1e-5) < 0);
      } else {
        CHECK(std::abs(slope(1e-4)) < 1e-4 * least);
      }
    }
  }
}

TEST_CASE("szilvasi_nagy: doubling the quadrature changes neither the least energy nor lambda") {
  for (int continuity : {0, 1}) {
    SzilvasiNagyOptions options;
    options.continuity = continuity;
    options.optimal = true;
    const std::array<SurfacePtr, 3> surfaces = quadratics(12);
    const SzilvasiNagy once(surfaces, options);
    options.quadrature *= 2;
    const SzilvasiNagy twice(surfaces, options);
    CHECK(once.path().back().energy == Approx(twice.path().back().energy).epsilon(1e-3));
    for (int i = 0; i < 3; ++i) CHECK(std::abs(once.shape()[i] - twice.shape()[i]) < 1e-3);
  }
}

TEST_CASE("szilvasi_nagy: surfaces that agree leave lambda alone") {
  SzilvasiNagyOptions options;
  options.optimal = true;
  const SurfacePtr surface = bezier(random_net(3, 2));
  const SzilvasiNagy same({surface, surface, surface}, options);
  CHECK(same.shape() == std::array<double, 3>{0.5, 0.5, 0.5});
}

TEST_CASE("szilvasi_nagy names what is wrong with its input") {
  const std::array<SurfacePtr, 3> surfaces = quadratics(3);
  for (double bad : {0.0, 1.0, -0.2, 1.5, std::nan("")})
    CHECK_THROWS_WITH(blend(surfaces, 1, {0.5, bad, 0.5}), Catch::Contains("shape[1]"));
  std::array<SurfacePtr, 3> apart = surfaces;
  std::array<Vec3, 3> corners = plain_corners;
  corners[0][0] += 0.1;
  apart[1] = bezier(random_net(2, 1, 0.1, corners));
  CHECK_THROWS_WITH(blend(apart, 1), Catch::Contains("r1 and r2 do not meet at corner 0"));
  double out;
  CHECK_THROWS_AS(blend(surfaces, 1)->evaluate(Vec3(0.3, 0.3, 0.4).data(), 1, 5, &out), InvalidArgument);
}
