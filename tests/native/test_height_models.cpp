// Heights over a plane from few samples: the quadric of least squares, and the spline of order 5/2.
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

#include "tripatch/math/height_models.h"

using namespace tripatch;

namespace {

/// On a grid that is moved a little.
template <class Height>
std::vector<Vec3> sampled(std::size_t count, const Height& height) {
  std::mt19937 random(3);
  std::uniform_real_distribution<> off(-0.3, 0.3);
  std::vector<Vec3> samples;
  for (std::size_t k = 0; k < count; ++k) {
    const double x = static_cast<double>(k % 7) - 3 + off(random), y = static_cast<double>(k / 7) - 3 + off(random);
    samples.emplace_back(x, y, height(x, y));
  }
  return samples;
}

double quadric(double x, double y) { return 1 - 0.3 * x + 0.2 * y + 0.1 * x * x - 0.2 * x * y + 0.05 * y * y; }
double wave(double x, double y) { return std::sin(0.7 * x) * std::cos(0.5 * y); }

template <class Model>
double missed_by_others(const std::vector<Vec3>& samples, std::size_t k) {
  std::vector<Vec3> others = samples;
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
  return Model(others, 1).at(samples[k].head<2>())[0] - samples[k][2];
}

}  // namespace

TEMPLATE_TEST_CASE("models of heights reproduce a quadric and its slopes", "[height_models]", HeightQuadric, HeightSpline) {
  const std::vector<Vec3> samples = sampled(30, quadric);
  const TestType model(samples, 5);
  const Vec3 at = model.at({0.3, -0.4});
  CHECK(at[0] == Approx(quadric(0.3, -0.4)));
  CHECK(at[1] == Approx(-0.3 + 0.2 * 0.3 + 0.2 * 0.4));
  CHECK(at[2] == Approx(0.2 - 0.2 * 0.3 - 0.1 * 0.4));
  CHECK(model.error() < 1e-9);
}

TEMPLATE_TEST_CASE("the error is that of the rim's samples by what all others tell", "[height_models]", HeightQuadric,
                   HeightSpline) {
  const std::size_t count = GENERATE(as<std::size_t>{}, 14, 30, max_height_samples), rim = 6;
  const std::vector<Vec3> samples = sampled(count, wave);
  double sum = 0;
  for (std::size_t k = 0; k < rim; ++k) sum += std::pow(missed_by_others<TestType>(samples, k), 2);
  CHECK(TestType(samples, rim).error() == Approx(std::sqrt(sum / rim)));
}

TEST_CASE("the spline of heights goes through its samples", "[height_models]") {
  const std::vector<Vec3> samples = sampled(40, wave);
  const HeightSpline spline(samples, 8);
  for (const Vec3& p : samples) CHECK(spline.at(p.head<2>())[0] == Approx(p[2]).margin(1e-10));
}

TEST_CASE("samples on a line do not determine a spline", "[height_models]") {
  std::vector<Vec3> samples;
  for (int k = 0; k < 20; ++k) samples.emplace_back(k, 0, 0.1 * k * k);
  CHECK_FALSE(std::isfinite(HeightSpline(samples, 4).error()));
}
