#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "tripatch/math/piecewise_polynomial.h"

using namespace tripatch;

namespace {

/// A field that a cubic spline reproduces, and its derivative.
Vec3 cubic(double t) { return {t * t * t, 1 - 2 * t, 0.5 * t * t - t * t * t}; }
Vec3 cubic_slope(double t) { return {3 * t * t, -2, t - 3 * t * t}; }

const std::vector<double> knots = {0, 0.1, 0.35, 0.6, 0.7, 1};

std::vector<double> sampled(const std::vector<double>& t, const std::function<Vec3(double)>& f) {
  std::vector<double> values;
  for (double at : t) {
    const Vec3 p = f(at);
    values.insert(values.end(), p.data(), p.data() + 3);
  }
  return values;
}

double apart(const PiecewisePolynomial& f, const std::function<Vec3(double)>& g) {
  double most = 0;
  for (int k = 0; k <= 200; ++k) most = std::max(most, (f(k / 200.0) - g(k / 200.0)).norm());
  return most;
}

Vec3 wave(double t) { return {std::sin(5 * t), std::exp(-t), t}; }
PiecewisePolynomial wave_spline() { return PiecewisePolynomial::spline(knots, sampled(knots, wave), 3); }

/// A function given for batches.
auto batch(const std::function<Vec3(double)>& f) {
  return [f](std::span<const double> t, std::span<double> out) {
    for (std::size_t k = 0; k < t.size(); ++k) Eigen::Map<Vec3>(out.data() + 3 * k) = f(t[k]);
  };
}

}  // namespace

TEST_CASE("a piecewise polynomial asks for all its coefficients") {
  CHECK_THROWS_AS(PiecewisePolynomial({0, 0.5, 1}, 1, 1, {1, 2, 3}), InvalidArgument);
  CHECK_THROWS_AS(PiecewisePolynomial({0}, 0, 1, {}), InvalidArgument);
  CHECK(PiecewisePolynomial().empty());
}

TEST_CASE("pieces are polynomials about their middles; a break belongs to the piece behind it, ends are continued") {
  const PiecewisePolynomial f({0, 0.5, 1}, 1, 1, {10, 1, 20, 2});
  const auto value = [&](double t) {
    double v;
    f.taylor(t, 0, &v);
    return v;
  };
  CHECK(value(0.25) == 10);
  CHECK(value(0) == 9.75);
  CHECK(value(0.5) == 19.5);
  CHECK(value(std::nextafter(0.5, 0.0)) == Approx(10.25));
  CHECK(value(1) == 20.5);
  CHECK(value(1.25) == 21);
  CHECK(value(-0.25) == 9.5);
}

TEST_CASE("every piece is found, however uneven they are") {
  std::vector<double> breaks = {0, 1e-9, 1e-6, 1e-3, 0.5, 0.5 + 1e-9, 1}, coefficients;
  for (std::size_t p = 0; p + 1 < breaks.size(); ++p) coefficients.push_back(static_cast<double>(p));
  const PiecewisePolynomial f(breaks, 0, 1, coefficients);
  for (std::size_t p = 0; p + 1 < breaks.size(); ++p)
    for (double t : {breaks[p], 0.5 * (breaks[p] + breaks[p + 1])}) {
      double v;
      f.taylor(t, 0, &v);
      CHECK(v == static_cast<double>(p));
    }
}

TEST_CASE("Taylor coefficients are derivatives over factorials, in three dimensions and in others") {
  const std::array<double, 8> net = {0, 1, 0, 2, 1, 0, 3, -1};  // a cubic in two dimensions
  const PiecewisePolynomial flat = PiecewisePolynomial::bezier(net, 2);
  const std::array<double, 12> space_net = {0, 1, 0, 0, 2, 0, 1, 0, 0, 3, -1, 0};
  const PiecewisePolynomial space = PiecewisePolynomial::bezier(space_net, 3);
  std::array<double, 12> in_flat;
  std::array<double, 18> in_space;
  for (double t : {0.0, 0.3, 1.0}) {
    flat.taylor(t, 5, in_flat.data());
    space.taylor(t, 5, in_space.data());
    for (int k = 0; k <= 5; ++k)
      for (int x = 0; x < 2; ++x) CHECK(in_flat[2 * k + x] == Approx(in_space[3 * k + x]).margin(1e-14));
    const Vec3 first = space.derivative()(t), third = space.derivative_at(t, 3);
    for (int order : {1, 2, 3}) {  // the short ways of low orders
      std::array<double, 12> low;
      space.taylor(t, order, low.data());
      CHECK((Vec3::Map(&low[3]) - first).norm() < 1e-13);
    }
    CHECK((Vec3::Map(&in_space[9]) - third / 6).norm() < 1e-13);
    CHECK(Vec3::Map(&in_space[12]).norm() == 0);
  }
  CHECK_THROWS_AS(space.derivative_at(0.5, 9), InvalidArgument);
}

TEST_CASE("Bezier curves are those of de Casteljau, at any degree") {
  for (int degree : {0, 1, 6, 7, 12, 13, 20}) {
    INFO(degree);
    std::vector<double> net;
    for (int k = 0; k <= degree; ++k) net.insert(net.end(), {std::cos(1.3 * k), std::sin(0.7 * k), 0.1 * k});
    const PiecewisePolynomial f = PiecewisePolynomial::bezier(net, 3);
    for (double t : {0.0, 0.2, 0.5, 0.99, 1.0}) {
      std::vector<double> w = net;
      for (int level = degree; level > 0; --level)
        for (int i = 0; i < 3 * level; ++i) w[i] = (1 - t) * w[i] + t * w[i + 3];
      CHECK((f(t) - Vec3::Map(w.data())).norm() < 1e-12);
    }
  }
  CHECK_THROWS_AS(PiecewisePolynomial::bezier(std::vector<double>{1, 2, 3, 4}, 3), InvalidArgument);
}

TEST_CASE("Hermite pieces take values and derivatives") {
  const PiecewisePolynomial f = PiecewisePolynomial::hermite(knots, sampled(knots, wave), sampled(knots, cubic), 3);
  for (double t : knots) {
    CHECK((f(t) - wave(t)).norm() < 1e-14);
    CHECK((f.derivative_at(t) - cubic(t)).norm() < 1e-13);
  }
  CHECK_THROWS_AS(PiecewisePolynomial::hermite(knots, sampled({0, 1}, wave), sampled(knots, cubic), 3), InvalidArgument);
}

TEST_CASE("splines reproduce cubics, not-a-knot and with given ends") {
  const std::vector<double> values = sampled(knots, cubic);
  CHECK(apart(PiecewisePolynomial::spline(knots, values, 3), cubic) < 1e-14);
  const Vec3 start = cubic_slope(0), end = cubic_slope(1);
  const std::span<const double> from(start.data(), 3), to(end.data(), 3);
  CHECK(apart(PiecewisePolynomial::spline(knots, values, 3, from, to), cubic) < 1e-14);
  CHECK(apart(PiecewisePolynomial::spline(knots, values, 3, from), cubic) < 1e-14);
  CHECK(apart(PiecewisePolynomial::spline(knots, values, 3, {}, to), cubic) < 1e-14);
  CHECK(apart(PiecewisePolynomial::spline(std::vector<double>{0, 1}, sampled({0, 1}, cubic), 3, from, to), cubic) < 1e-14);
}

TEST_CASE("splines are twice continuously differentiable and keep the ends given") {
  const Vec3 start(1, 2, 3), end(-1, 0, 2);
  const PiecewisePolynomial f = PiecewisePolynomial::spline(knots, sampled(knots, wave), 3, {start.data(), 3}, {end.data(), 3});
  CHECK((f.derivative_at(0) - start).norm() < 1e-13);
  CHECK((f.derivative_at(1) - end).norm() < 1e-13);
  for (const PiecewisePolynomial& g : {f, wave_spline()})
    for (std::size_t k = 1; k + 1 < knots.size(); ++k)
      for (int order : {0, 1, 2}) {
        const double before = std::nextafter(knots[k], 0.0);
        CHECK((g.derivative_at(before, order) - g.derivative_at(knots[k], order)).norm() < 1e-10);
      }
  // not-a-knot: the first and the last inner knot are none
  for (std::size_t k : {std::size_t{1}, knots.size() - 2})
    CHECK((wave_spline().derivative_at(std::nextafter(knots[k], 0.0), 3) - wave_spline().derivative_at(knots[k], 3)).norm() <
          1e-9);
}

TEST_CASE("through few values goes the polynomial of least degree") {
  const auto line = [](double t) -> Vec3 { return {1 + t, -t, 2 * t}; };
  const auto parabola = [](double t) -> Vec3 { return {t * t, 1 - t, t * t - t}; };
  const Vec3 start(0, -1, -1), end(2, -1, 1);
  const std::vector<double> two = {0, 1}, three = {0, 0.3, 1};
  CHECK(apart(PiecewisePolynomial::spline(two, sampled(two, line), 3), line) < 1e-14);
  CHECK(apart(PiecewisePolynomial::spline(three, sampled(three, parabola), 3), parabola) < 1e-14);
  CHECK(apart(PiecewisePolynomial::spline(two, sampled(two, parabola), 3, {start.data(), 3}), parabola) < 1e-14);
  CHECK(apart(PiecewisePolynomial::spline(two, sampled(two, parabola), 3, {}, {end.data(), 3}), parabola) < 1e-14);
  CHECK_THROWS_AS(PiecewisePolynomial::spline(std::vector<double>{0}, sampled({0}, line), 3), InvalidArgument);
}

TEST_CASE("a fit comes within its tolerance, with more pieces where the function asks for them") {
  const PiecewisePolynomial smooth = PiecewisePolynomial::fit(batch(wave), 3);
  CHECK(apart(smooth, wave) < 1e-12);
  CHECK(smooth.pieces() <= 8);
  const auto sharp = [](double t) -> Vec3 { return {std::abs(t - 0.5), 1 / (1 + 200 * t * t), 0}; };
  const PiecewisePolynomial f = PiecewisePolynomial::fit(batch(sharp), 3, 1e-9);
  CHECK(apart(f, sharp) < 1e-8);
  CHECK(f.pieces() > smooth.pieces());
  // pieces are halved no further than asked
  const auto torn = [](double t) -> Vec3 { return {t < 1.0 / 3 ? 0.0 : 1.0, 0, 0}; };
  const PiecewisePolynomial g = PiecewisePolynomial::fit(batch(torn), 3, 1e-13, 9, 4);
  for (std::size_t p = 0; p + 1 < g.breaks().size(); ++p) CHECK(g.breaks()[p + 1] - g.breaks()[p] >= 1.0 / 16);
  const auto broken = [](double) -> Vec3 { return {std::numeric_limits<double>::quiet_NaN(), 0, 0}; };
  CHECK_THROWS_AS(PiecewisePolynomial::fit(batch(broken), 3), Refusal);
}

TEST_CASE("fields end to end take their shares") {
  const PiecewisePolynomial a = wave_spline(), b = PiecewisePolynomial::fit(batch(cubic), 3);
  const PiecewisePolynomial even = PiecewisePolynomial::joined({a, b}), uneven = PiecewisePolynomial::joined({a, b}, {0.2, 0.8});
  for (double t : {0.0, 0.3, 0.9}) {
    CHECK((even(0.5 * t) - a(t)).norm() < 1e-13);
    CHECK((even(0.5 + 0.5 * t) - b(t)).norm() < 1e-13);
    CHECK((uneven(0.2 * t) - a(t)).norm() < 1e-13);
    CHECK((uneven(0.2 + 0.8 * t) - b(t)).norm() < 1e-13);
    CHECK((uneven.derivative_at(0.2 + 0.8 * t) - b.derivative_at(t) / 0.8).norm() < 1e-12);
  }
  CHECK_THROWS_AS(PiecewisePolynomial::joined({}), InvalidArgument);
}

TEST_CASE("parts, turned fields and refined ones are the field itself") {
  const PiecewisePolynomial f = wave_spline();
  const auto itself = [&](double t) { return f(t); };
  CHECK(apart(f.part(0.05, 0.65), [&](double t) { return f(0.05 + 0.6 * t); }) < 1e-13);
  CHECK(apart(f.part(0, 1), itself) < 1e-13);
  CHECK(apart(f.reversed(), [&](double t) { return f(1 - t); }) < 1e-13);
  CHECK(apart(f.reversed().reversed(), itself) < 1e-13);
  const PiecewisePolynomial fine = f.refined({0.2, 0.35, 0.9}, 5);
  CHECK(apart(fine, itself) < 1e-13);
  CHECK(fine.degree() == 5);
  CHECK(fine.pieces() == f.pieces() + 2);  // 0.35 is a break already
  CHECK((f.reversed().derivative_at(0.3) + f.derivative_at(0.7)).norm() < 1e-12);
}

TEST_CASE("sums, multiples and products are those of the values") {
  const PiecewisePolynomial f = wave_spline(), g = PiecewisePolynomial::fit(batch(cubic), 3);
  const std::array<double, 3> arch = {0, 2, 0};
  const PiecewisePolynomial s =
      PiecewisePolynomial::joined({PiecewisePolynomial::bezier(arch, 1), PiecewisePolynomial::bezier(arch, 1)});
  const auto scalar = [&](double t) {
    double v;
    s.taylor(t, 0, &v);
    return v;
  };
  CHECK(apart(f + g, [&](double t) { return Vec3(f(t) + g(t)); }) < 1e-13);
  CHECK(apart(f - g, [&](double t) { return Vec3(f(t) - g(t)); }) < 1e-13);
  CHECK(apart(-3.0 * f, [&](double t) { return Vec3(-3 * f(t)); }) < 1e-13);
  CHECK(apart(s * f, [&](double t) { return Vec3(scalar(t) * f(t)); }) < 1e-13);
  CHECK((s * f).degree() == s.degree() + f.degree());
}

TEST_CASE("breaks that are one but for rounding are one in sums and products, whoever has them") {
  const auto with_breaks = [](std::vector<double> breaks) {
    std::vector<double> values;
    for (double t : breaks) values.insert(values.end(), {t, 2 * t, 3 * t});
    return PiecewisePolynomial::spline(breaks, values, 3);
  };
  const PiecewisePolynomial even = with_breaks({0, 0.25, 0.5, 0.75, 1}), off = with_breaks({0, 0.25, 0.5 + 1e-13, 0.75, 1});
  const PiecewisePolynomial twice = {{0, 0.25, 0.5, 0.5 + 1e-13, 0.75, 1}, 0, 3, std::vector<double>(15, 1.0)};
  const PiecewisePolynomial scalar = {{0, 0.5, 0.5 + 1e-13, 1}, 0, 1, {2.0, 2.0, 2.0}};
  const auto values = [](double t) { return Vec3(t, 2 * t, 3 * t); };
  CHECK(apart(even + off, [&](double t) { return Vec3(2 * values(t)); }) < 1e-12);
  CHECK(apart(off + even, [&](double t) { return Vec3(2 * values(t)); }) < 1e-12);
  CHECK(apart(even + twice, [&](double t) { return Vec3(values(t) + Vec3::Ones()); }) < 1e-12);
  CHECK(apart(twice + even, [&](double t) { return Vec3(values(t) + Vec3::Ones()); }) < 1e-12);
  CHECK(apart(scalar * even, [&](double t) { return Vec3(2 * values(t)); }) < 1e-12);
  CHECK((even + twice).pieces() == 4);
  CHECK((scalar * twice).pieces() == 4);
}

TEST_CASE("copies and fields of the same pieces share what they hold, and none of them changes another") {
  const PiecewisePolynomial f = wave_spline();
  PiecewisePolynomial copy = f;
  CHECK(copy.coefficients().data() == f.coefficients().data());
  CHECK(f.derivative().breaks().data() == f.breaks().data());
  CHECK((f + f.derivative()).breaks().data() == f.breaks().data());
  CHECK((2.0 * f).breaks().data() == f.breaks().data());
  copy = 2.0 * copy;
  CHECK(apart(copy, [&](double t) { return Vec3(2 * f(t)); }) == 0);
  CHECK(copy.coefficients().data() != f.coefficients().data());
}
