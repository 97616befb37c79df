#include "test_surfaces.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/options.h"
#include "tripatch/patch/bezier_triangle.h"
#include "tripatch/patch_from_sides.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// x, y of the equilateral triangle of unit side.
template <class B>
auto plane(const B& b) {
  return std::pair(b[1] + 0.5 * b[2], std::sqrt(0.75) * b[2]);
}

/// Integral of w over the triangle.
double weight_integral() {
  double sum = 0;
  for (double w : corner_quadrature(8).weights) sum += w;
  return sum;
}

}  // namespace

TEST_CASE("quadrature over the triangle is exact on polynomials, with the corner weight") {
  const Quadrature q = corner_quadrature(6);
  CHECK((q.b.rowwise().sum().array() - 1).abs().maxCoeff() < 1e-15);
  // integral of b0^i b1^j b2^k over a triangle: 2 area i! j! k! / (i + j + k + 2)!
  const auto monomial = [](int i, int j, int k) {
    return std::sqrt(3.0) / 2 * std::tgamma(i + 1) * std::tgamma(j + 1) * std::tgamma(k + 1) / std::tgamma(i + j + k + 3);
  };
  // (1 - b0)(1 - b1)(1 - b2) = b0 b1 + b1 b2 + b2 b0 - b0 b1 b2
  double sum = 0;
  for (Index k = 0; k < q.b.rows(); ++k) sum += q.weights[k] * q.b(k, 0) * q.b(k, 0) * q.b(k, 1);
  CHECK(sum == Approx(27.0 / 8 * (monomial(3, 2, 0) + monomial(2, 2, 1) + monomial(3, 1, 1) - monomial(3, 2, 1))).epsilon(1e-12));
}

TEST_CASE("energies are those of the equilateral metric, with the stated weights") {
  const SurfacePtr surface = formula_surface([](const auto& b) {
    using Scalar = std::decay_t<decltype(b[0])>;
    const auto [x, y] = plane(b);
    JetPoint<Scalar::order> p;
    p.x[0] = x * x + 3.0 * (x * y);                      // xx: 2, xy: 3
    p.x[1] = 0.5 * (y * y);                              // yy: 1
    p.x[2] = x * x * x - 2.0 * (x * x * y) + y * y * y;  // xxx: 6, xxy: -4, yyy: 6
    return p;
  });
  // only the cubic has third derivatives
  CHECK(energy(*surface, Fairing::third_derivative, 1) == Approx(weight_integral() * (36 + 3 * 16 + 36)).epsilon(1e-12));
  const SurfacePtr quadratic = formula_surface([surface](const auto& b) {
    using Scalar = std::decay_t<decltype(b[0])>;
    const auto [x, y] = plane(b);
    JetPoint<Scalar::order> p;
    p.x[0] = x * x + 3.0 * (x * y);
    p.x[1] = 0.5 * (y * y);
    return p;
  });
  CHECK(energy(*quadratic, Fairing::thin_plate, 1) == Approx(weight_integral() * (4 + 2 * 9 + 1)).epsilon(1e-12));
}

TEST_CASE("thin plate of a blend with disagreeing corners is finite and does not depend on the quadrature") {
  const SurfacePtr patch = side_vertex(make_boundary(skewed_sides(unrelated_surfaces(6))));
  CHECK(energy(*patch, Fairing::thin_plate, 1, 16) == Approx(energy(*patch, Fairing::thin_plate, 1, 32)).epsilon(1e-3));
}

TEST_CASE("energies are not called by other names") {
  CHECK_THROWS_WITH(named<Fairing>("membrane", "energy"), Catch::Contains("thin_plate, third_derivative"));
}

TEST_CASE("a plane has none of any energy, and fairing leaves it alone") {
  const SurfacePtr flat = std::make_shared<BezierTriangle>((Points(3, 3) << 0, 0, 0, 1, 0, 0, 0, 1, 0).finished());
  for (const Fairing of : {Fairing::thin_plate, Fairing::third_derivative, Fairing::minimum_variation, Fairing::quadric_variation,
                           Fairing::automatic})
    CHECK(energy(*flat, of, 1) == 0);
  CHECK(soft_minimum(0, 0) == 0);
  CHECK(soft_minimum(1, 0) == 0);
  const MadePatch made = patch_from_sides(sides_of(flat), {});
  CHECK(made.report.energy_before < 1e-20);
  CHECK(made.report.energy_after <= made.report.energy_before);
  CHECK(made.report.warnings.empty());
}
