#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/math/jet.h"

using namespace tripatch;

namespace {

/// The Taylor coefficients of exp(2 x - y) about (x, y), by its derivatives.
Jet<4> exponential(double x, double y) {
  Jet<4> f;
  const double value = std::exp(2 * x - y);
  const std::array<double, 5> factorial = {1, 1, 2, 6, 24};
  for (int i = 0; i <= 4; ++i)
    for (int j = 0; i + j <= 4; ++j)
      f.c[jet_index(i, j)] = value * std::pow(2, i) * std::pow(-1, j) / (factorial[i] * factorial[j]);
  return f;
}

double apart(const Jet<4>& a, const Jet<4>& b) {
  double most = 0;
  for (int k = 0; k < Jet<4>::size; ++k) most = std::max(most, std::abs(a.c[k] - b.c[k]));
  return most;
}

}  // namespace

TEST_CASE("jets multiply, divide and take roots as their functions do") {
  const Jet<4> f = exponential(0.3, -0.2), g = exponential(-0.1, 0.4);
  Jet<4> sum =
      exponential(0.2, 0.2);  // exp adds: the factor in front is that of the place, each derivative that of twice the slope
  for (int d = 0, k = 0; d <= 4; ++d)
    for (int j = 0; j <= d; ++j, ++k) sum.c[k] *= std::pow(2, d);
  CHECK(apart(f * g, sum) < 1e-12);
  CHECK(apart(f * reciprocal(f), Jet<4>(1.0)) < 1e-13);
  CHECK(apart((f / g) * g, f) < 1e-13);
  CHECK(apart(sqrt(f) * sqrt(f), f) < 1e-13);
  CHECK(apart(square(f), f * f) == 0);
  CHECK(apart((f - g) + g, f) < 1e-15);
  CHECK(apart(2.0 * f - f, f) < 1e-15);
  CHECK(apart(1.0 - (1.0 - f), f) < 1e-15);
}

TEST_CASE("the product of low orders, written out, is the same as the general one") {
  Jet<1> a, b;
  Jet<4> high_a, high_b;
  for (int k = 0; k < 3; ++k) {
    a.c[k] = high_a.c[k] = 0.3 + k;
    b.c[k] = high_b.c[k] = 1.7 - 0.4 * k;
  }
  const Jet<1> low = a * b;
  const Jet<4> high = high_a * high_b;
  for (int k = 0; k < 3; ++k) CHECK(low.c[k] == high.c[k]);
}

TEST_CASE("composition with a Taylor series is the function of the jet") {
  const Jet<4> t = Jet<4>::linear(0.4, 2, -1);
  std::array<double, 5> series;  // of exp about 0.4
  double factorial = 1;
  for (int k = 0; k <= 4; ++k, factorial *= k) series[k] = std::exp(0.4) / factorial;
  CHECK(apart(compose<4>(series.data(), 1, t), std::exp(0.4) * exponential(0, 0)) < 1e-14);
}

TEST_CASE("barycentric coordinates are linear and sum to one") {
  const std::array<double, 3> b = {0.2, 0.5, 0.3};
  const Barycentric<4> jets(b.data());
  CHECK(apart(jets[0] + jets[1] + jets[2], Jet<4>(1.0)) < 1e-15);
  CHECK(jets[0].c[1] == 1);
  CHECK(jets[1].c[2] == 1);
  CHECK(jets[2].c[1] == -1);
}
