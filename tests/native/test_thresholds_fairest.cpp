// Which patch is the fairest one, and what is done about its folds, on both sides of each threshold.
#include "test_surfaces.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/candidates.h"
#include "tripatch/fairing/center.h"
#include "tripatch/fairing/fairing.h"
#include "tripatch/fairing/fairing_problem.h"
#include "tripatch/fairing/fold_removal.h"
#include "tripatch/math/triangular_grid.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// The sides of the wave, so many times as high.
FairingBase wave_so_high(double height) {
  const auto flattened = [&](const PiecewisePolynomial& field) {
    return PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = field(t[k]).cwiseProduct(Vec3(1, 1, height));
        },
        3);
  };
  FairingBase base;
  base.sides = sides_of(wave());
  for (Side& side : base.sides) side = {flattened(side.c), flattened(side.r), {}};
  base.boundary = make_boundary(base.sides);
  base.patch = side_vertex(base.boundary);
  return base;
}

/// A side that has nothing but a normal: this one at every t.
Side with_one_normal(const Vec3& n) {
  const Vec3 along = n.unitOrthogonal(), across = along.cross(n);
  const std::array<double, 6> net = {0, 0, 0, along[0], along[1], along[2]};
  return {PiecewisePolynomial::bezier(net, 3), PiecewisePolynomial::constant({across.data(), 3}), {}};
}

}  // namespace

TEST_CASE("a surface whose energy is above 1 is rich: its last steps have more unknowns", "[thresholds]") {
  FairingOptions never;
  never.rich = 1e9;
  Index unknowns = 0;
  for (const auto& [height, rich] : {std::pair(0.095, false), std::pair(0.115, true)}) {
    const FairingBase base = wave_so_high(height);
    const auto few = geometric_candidates<FairingProblem>(base, never);
    const double energy = few.best_first[0].energy;
    CAPTURE(height, energy);
    REQUIRE((rich ? energy > 1 && energy < 1.3 : energy > 0.77 && energy < 1));
    unknowns = few.problem->count();
    CHECK((geometric_candidates<FairingProblem>(base, {}).problem->count() > unknowns) == rich);
  }
}

TEST_CASE("a patch that folds at more than a hundred points is given up", "[thresholds]") {
  const FairingBase base = wave_so_high(1);
  const SurfacePtr fairest = fair(base, base).patch;
  for (const auto& [lean, few] : {std::pair(0.82, true), std::pair(0.88, false)}) {
    Sides seen;  // between such normals the patch seems to fold wherever it goes
    for (int i = 0; i < 3; ++i) seen[i] = with_one_normal(Vec3::Ones() - lean * Vec3::Unit(i));
    const FoldCounter folds(seen);
    const Index found = folds(*fairest);
    CAPTURE(lean, found);
    REQUIRE((few ? found > 77 && found <= 100 : found > 100 && found < 130));
    CHECK(fair(base, base, {}, &folds).gave_up == !few);
  }
}

TEST_CASE("folds are taken out that do not take the patch farther than a quarter of its size", "[thresholds]") {
  const FairingBase base = wave_so_high(1);
  const double size = base.boundary.size;
  const Vec3 middle = base.patch->positions(Points::Constant(1, 3, 1.0 / 3)).row(0).transpose();
  const FoldCounter folds(base.sides);
  const auto removal = [&](double away) {
    return fold_removal(with_center(base.patch, middle + away * size * Vec3::UnitX()), base.sides, size, folds);
  };
  const SurfacePtr far = removal(0.69);
  REQUIRE(far);
  const double moved = far->positions(grid(40)).rowwise().norm().maxCoeff() / size;
  CHECK(moved > 0.2);
  CHECK(moved < 0.25);
  CHECK_FALSE(removal(0.74));
}
