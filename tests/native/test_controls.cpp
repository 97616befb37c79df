// Shape control: tension, the middle of the patch, sides met in position only.
#include <Eigen/Geometry>
#include <cmath>

#include "test_surfaces.h"
#include "tripatch/fairing/center.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fill.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

const std::array<const char*, 4> energies = {"thin_plate", "third_derivative", "minimum_variation", "auto"};

/// An uneven triangle of the unit sphere.
SurfacePtr sphere() {
  return formula_surface([](const auto& b) {
    constexpr int order = std::decay_t<decltype(b[0])>::order;
    JetPoint<order> p;
    for (int i = 0; i < 3; ++i) p += b[i] * JetPoint<order>(Vec3(plain_corners[i] + Vec3(-0.5, -0.4, 0.7)));
    return reciprocal(sqrt(square(p.x[0]) + square(p.x[1]) + square(p.x[2]))) * p;
  });
}

MadePatch made(const Sides& sides, const std::string& fairing, const std::function<void(FillOptions&)>& set = {}) {
  FillOptions options;
  options.fairing = fairing == "none" ? std::nullopt : std::optional(named<Fairing>(fairing, "fairing"));
  if (set) set(options);
  return patch_from_sides(sides, options);
}

/// The integral of w |DP|^2, which tension makes small.
double membrane(const Surface& patch) {
  const Quadrature nodes = corner_quadrature(8);
  const std::vector<Derivatives> d = cartesian_derivatives(patch, nodes.b);
  double sum = 0;
  for (std::size_t k = 0; k < d.size(); ++k) sum += nodes.weights[k] * d[k].topRows(2).squaredNorm();
  return sum;
}

double off_sphere(const Surface& patch) { return (patch.positions(grid(20)).rowwise().norm().array() - 1).abs().maxCoeff(); }

Vec3 middle(const Surface& patch) { return center_of(patch).first; }

}  // namespace

TEST_CASE("tension pulls tight, the more the tighter, and keeps the tangent planes") {
  for (const Sides& sides : {sides_of(wave()), skewed_sides({sphere(), sphere(), sphere()})})
    for (const char* energy : energies) {
      INFO(energy);
      double last = membrane(*made(sides, energy).patch);
      for (double tension : {0.1, 1.0, 10.0}) {
        const MadePatch tight = made(sides, energy, [&](FillOptions& o) { o.tension = tension; });
        CHECK(membrane(*tight.patch) < last);
        CHECK(tight.report.energy_after < tight.report.energy_before);
        CHECK(side_error(*tight.patch, sides) < 1e-12);
        CHECK(seam_error(*tight.patch, sides) < 1e-5);
        last = membrane(*tight.patch);
      }
    }
}

TEST_CASE("tension and the middle move, turn and scale with the hole") {
  const Sides sides = sides_of(wave());
  const Vec3 center = middle(*made(sides, "none").patch) + 0.1 * Vec3(0.3, -0.2, 1);
  for (const char* energy : {"third_derivative", "auto"}) {
    INFO(energy);
    CHECK(motion_error([&](const Sides& s) { return made(s, energy, [](FillOptions& o) { o.tension = 2; }).patch; }, sides) <
          1e-6);
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
    const Points plain = made(sides, energy, [&](FillOptions& o) { o.center = center; }).patch->positions(grid(12));
    for (double scale : {1e-6, 1e6}) {
      const Vec3 shift = scale * Vec3(0.3, -2, 1);
      const Sides moved = transformed(sides, scale * turn, shift);
      const SurfacePtr patch = made(moved, energy, [&](FillOptions& o) { o.center = scale * turn * center + shift; }).patch;
      const Points expected = (scale * (plain * turn.transpose())).rowwise() + shift.transpose();
      CHECK((patch->positions(grid(12)) - expected).rowwise().norm().maxCoeff() < 1e-6 * scale);
    }
  }
}

TEST_CASE("the middle is where it is asked for, with the seam as good as before") {
  for (const Sides& sides : {sides_of(wave()), skewed_sides(unrelated_surfaces(11))})
    for (const char* energy : {"none", "thin_plate", "third_derivative", "minimum_variation", "auto"})
      for (const Method& method : methods()) {
        const std::string name = method.name;  // the Bezier methods take no such sides
        if (!method.from_boundary || name.starts_with("coons_")) continue;
        if (name != "side_vertex" && energy != std::string("third_derivative")) continue;
        INFO(energy << " " << method.name);
        const auto of = [&](FillOptions& o) { o.method = method.name; };
        const SurfacePtr plain = made(sides, energy, of).patch;
        const Vec3 center = middle(*plain) + Vec3(0.02, -0.03, 0.05);
        const SurfacePtr patch = made(sides, energy, [&](FillOptions& o) {
                                   of(o);
                                   o.center = center;
                                 }).patch;
        CHECK((middle(*patch) - center).norm() < 1e-12 * size_of(sides));
        CHECK(side_error(*patch, sides) < 1e-12);
        if (method.continuity == SeamContinuity::g1) CHECK(seam_error(*patch, sides) < 1e-5);
      }
}

TEST_CASE("the fairest patch with a middle has less of the energy than the patch that is only lifted there") {
  const Sides sides = sides_of(wave());
  const Vec3 center = middle(*made(sides, "none").patch) + Vec3(0, 0, 0.1);
  const auto lift = [&](FillOptions& o) { o.center = center; };
  for (const char* energy : energies) {
    INFO(energy);
    const MadePatch fair = made(sides, energy, lift);
    CHECK(fair.report.energy_after < 0.9 * fair.report.energy_before);
    CHECK(fair.report.folds == 0);
  }
  // a quadratic energy grows with the square of the distance from where the middle would be by itself
  const SurfacePtr free = made(sides, "third_derivative").patch;
  const double size = size_of(sides), least = energy(*free, Fairing::third_derivative, size);
  const auto above = [&](double offset) {
    const SurfacePtr patch = made(sides, "third_derivative", [&](FillOptions& o) { o.center_offset = offset; }).patch;
    return energy(*patch, Fairing::third_derivative, size) - least;
  };
  CHECK(above(0.01) == Approx(above(-0.01)).epsilon(1e-3));
  CHECK(above(0.02) == Approx(4 * above(0.01)).epsilon(1e-3));
}

TEST_CASE("an offset moves the middle along its normal") {
  const Sides sides = sides_of(wave());
  for (const char* energy : {"none", "auto"})
    for (double offset : {-0.05, 0.1}) {
      const auto [p, n] = center_of(*made(sides, energy).patch);
      const SurfacePtr patch = made(sides, energy, [&](FillOptions& o) { o.center_offset = offset; }).patch;
      CHECK((middle(*patch) - (p + offset * n)).norm() < 1e-12);
    }
}

TEST_CASE("a middle far away folds the patch and is told, not more") {
  const Sides sides = sides_of(sphere());
  for (const char* energy : {"none", "third_derivative", "auto"}) {
    const MadePatch far = made(sides, energy, [](FillOptions& o) { o.center = Vec3(0, 0, -30); });
    CHECK((middle(*far.patch) - Vec3(0, 0, -30)).norm() < 1e-11);
    CHECK(far.report.folds > 0);
    CHECK(far.patch->positions(grid(9)).allFinite());
  }
}

TEST_CASE("a free side takes the slope that the energy wants") {
  const Sides sides = skewed_sides({sphere(), sphere(), sphere()});
  using enum SideContinuity;
  for (const BySide<SideContinuity>& asked : {BySide<SideContinuity>{free, g1, g1}, {g1, free, free}}) {
    const auto of = [&](FillOptions& o) { o.continuity = asked; };
    const MadePatch opened = made(sides, "minimum_variation", of);
    CHECK(off_sphere(*opened.patch) < 1e-3);
    CHECK(side_error(*opened.patch, sides) < 1e-12);
    for (int i = 0; i < 3; ++i) CHECK(name_of(opened.report.continuity[i]) == std::string(name_of(asked[i])));
    const MadePatch fixed = made(sides, "minimum_variation", [&](FillOptions& o) {
      std::vector<SideContinuity> other;
      for (SideContinuity c : asked) other.push_back(c == free ? g0 : c);
      o.continuity = BySide<SideContinuity>(other);
    });
    CHECK(off_sphere(*fixed.patch) > 10 * off_sphere(*opened.patch));
    for (const char* energy : {"thin_plate", "third_derivative"})
      CHECK(made(sides, energy, of).report.energy_after < made(sides, energy).report.energy_after);
    CHECK(motion_error([&](const Sides& s) { return made(s, "third_derivative", of).patch; }, sides) < 1e-6);
  }
}

TEST_CASE("sides met in position only are made fair with the freedom that is left, and the others keep their planes") {
  const Sides sides = sides_of(wave());
  for (const SideContinuity open : {SideContinuity::g0, SideContinuity::free}) {
    const MadePatch fair =
        made(sides, "auto", [&](FillOptions& o) { o.continuity = {open, SideContinuity::g1, SideContinuity::g1}; });
    CHECK(fair.report.fairing == "auto");
    CHECK(fair.report.energy_after < 0.9 * fair.report.energy_before);
    for (double t : {0.1, 0.5, 0.9})
      for (int i : {1, 2}) {
        const std::array<double, 3> b = on_side(i, t);
        const Vec3 n = fair.patch->normals(Points(Eigen::Map<const Points>(b.data(), 1, 3))).row(0);
        CHECK(degrees_between(n, sides[i].normal(t)) < 1e-5);
      }
  }
  // a method that meets the sides in position only is left alone, until it is asked for more
  const auto method = [](FillOptions& o) { o.method = "gordon_coons"; };
  CHECK(made(sides, "auto", method).report.fairing.empty());
  const MadePatch free = made(sides, "auto", [](FillOptions& o) {
    o.method = "gordon_coons";
    o.continuity = each_side(SideContinuity::free);
  });
  CHECK(free.report.fairing == "auto");
  CHECK(side_error(*free.patch, sides) < 1e-12);
  CHECK(free.report.energy_after < free.report.energy_before);
}

TEST_CASE("controls that mean nothing are refused") {
  const Sides sides = sides_of(wave());
  const auto with = [&](const char* fairing, const std::function<void(FillOptions&)>& set) { return made(sides, fairing, set); };
  CHECK_THROWS_AS(with("auto", [](FillOptions& o) { o.tension = -1; }), InvalidArgument);
  CHECK_THROWS_AS(with("none", [](FillOptions& o) { o.tension = 1; }), InvalidArgument);
  CHECK_THROWS_AS(with("auto", [](FillOptions& o) { o.center_offset = NAN; }), InvalidArgument);
  CHECK_THROWS_AS(with("auto", [](FillOptions& o) { o.continuity = named<SideContinuity>("free", "continuity"); }),
                  InvalidArgument);
  const auto both = [](FillOptions& o) {
    o.center = Vec3(0, 0, 1);
    o.center_offset = 1;
  };
  CHECK_THROWS_AS(with("auto", both), InvalidArgument);
}
