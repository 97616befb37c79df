#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "test_curvature_jumps.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/curvature_following.h"
#include "tripatch/fairing/fairing.h"

using namespace tripatch;
using tripatch::testing::curvature_jump;

namespace {

/// The sides of z = f(u, v) over a triangle, with the derivatives of the chart across them.
template <class Height>
Sides graph_sides(const Height& height) {
  const std::array<Eigen::Vector2d, 3> corner = {Eigen::Vector2d(-0.6, -0.4), Eigen::Vector2d(0.8, -0.3),
                                                 Eigen::Vector2d(0.1, 0.7)};
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d a = corner[(i + 1) % 3], b = corner[(i + 2) % 3], out = 0.5 * (a + b) - corner[i];
    const auto jet = [&](double t) {  // along the side and away from the hole
      const Eigen::Vector2d p = a + t * (b - a);
      const Jet<2> u = Jet<2>::linear(p[0], b[0] - a[0], out[0]), v = Jet<2>::linear(p[1], b[1] - a[1], out[1]);
      JetPoint<2> point;
      point.x = {u, v, height(u, v)};
      return point;
    };
    const auto field = [&](int coefficient, double factor) {
      return PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> values) {
            for (std::size_t k = 0; k < t.size(); ++k) {
              const JetPoint<2> p = jet(t[k]);
              for (int x = 0; x < 3; ++x) values[3 * k + x] = factor * p.x[x].c[coefficient];
            }
          },
          3, 1e-13);
    };
    sides[i].c = field(jet_index(0, 0), 1);
    sides[i].r = field(jet_index(0, 1), 1);
    sides[i].q = field(jet_index(0, 2), 2);
  }
  return sides;
}

Sides wave_sides() {
  return graph_sides(
      [](const Jet<2>& u, const Jet<2>& v) { return 0.4 * (u * u * v) - 0.3 * square(v) + sqrt(0.5 + square(u) + 0.3 * v); });
}

Points along(int i, int n) {
  Points b = Points::Zero(n, 3);
  for (int k = 0; k < n; ++k) {
    const double t = (k + 0.5) / n;
    b(k, (i + 1) % 3) = 1 - t;
    b(k, (i + 2) % 3) = t;
  }
  return b;
}

double seam_deg(const Surface& patch, const Sides& sides) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    const Points b = along(i, 50), n = patch.normals(b);
    for (Index k = 0; k < b.rows(); ++k) {
      const Vec3 mine = n.row(k), theirs = sides[i].normal(b(k, (i + 2) % 3));
      worst = std::max(worst, std::atan2(mine.cross(theirs).norm(), mine.dot(theirs)) * 180 / std::numbers::pi);
    }
  }
  return worst;
}

}  // namespace

TEST_CASE("the curvature term makes every G1 patch meet the surroundings' curvature and keeps what it had") {
  const Sides sides = wave_sides();
  for (const Method& method : methods()) {
    if (method.continuity != SeamContinuity::g1 || !method.from_boundary) continue;
    INFO(method.name);
    const SurfacePtr plain = method.from_boundary(make_boundary(sides), {});
    const SurfacePtr patch = meet_curvature(plain, sides, {true, true, true});
    CHECK(curvature_jump(*plain, sides, {true, true, true}) > 1e-3);
    CHECK(curvature_jump(*patch, sides, {true, true, true}) < 1e-5);
    CHECK(seam_deg(*patch, sides) < 1e-5);
    for (int i = 0; i < 3; ++i)
      CHECK((patch->positions(along(i, 20)) - plain->positions(along(i, 20))).rowwise().norm().maxCoeff() < 1e-14);
  }
}

TEST_CASE("a side's curvature is met without touching that of the others") {
  const Sides sides = wave_sides();
  const SurfacePtr plain = find_method("side_vertex").from_boundary(make_boundary(sides), {});
  const SurfacePtr patch = meet_curvature(plain, sides, {false, true, false});
  CHECK(curvature_jump(*patch, sides, {false, true, false}) < 1e-5);
  for (int other : {0, 2}) {
    std::array<bool, 3> marked = {false, false, false};
    marked[other] = true;
    CHECK(curvature_jump(*patch, sides, marked) == Approx(curvature_jump(*plain, sides, marked)).epsilon(1e-6));
  }
}

TEST_CASE("the curvatures of sides that continue one surface agree at the corners; those of fillets do not") {
  for (double mismatch : curvature_mismatch(wave_sides())) CHECK(mismatch < 1e-7);
  Sides flat = wave_sides();
  flat[1].q = PiecewisePolynomial();
  CHECK(curvature_mismatch(flat)[1] < 1e-7);
  CHECK(std::isinf(curvature_mismatch(flat)[0]));
  // quarter circles of a unit octant continued by cylinders: no curvature across the sides
  Sides fillets;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = Vec3::Unit((i + 1) % 3), b = Vec3::Unit((i + 2) % 3), out = -Vec3::Unit(i), none = Vec3::Zero();
    fillets[i].c = PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> values) {
          for (std::size_t k = 0; k < t.size(); ++k)
            Vec3::Map(&values[3 * k]) = std::cos(t[k] * std::numbers::pi / 2) * a + std::sin(t[k] * std::numbers::pi / 2) * b;
        },
        3, 1e-12);
    fillets[i].r = PiecewisePolynomial::constant({out.data(), 3});
    fillets[i].q = PiecewisePolynomial::constant({none.data(), 3});
  }
  for (double mismatch : curvature_mismatch(fillets)) CHECK(mismatch > 0.9);
  const Method& method = find_method("side_vertex");
  CHECK(curvature_agrees(fillets) == std::array<bool, 3>{false, false, false});
  CHECK(curvature_agrees(wave_sides()) == std::array<bool, 3>{true, true, true});
  const Continuity wave =
      resolve_continuity({SideContinuity::automatic, SideContinuity::g1, SideContinuity::g2}, method, wave_sides());
  CHECK(wave.automatic == std::array<bool, 3>{true, false, false});
  CHECK(wave.curvature == std::array<bool, 3>{false, false, true});
  CHECK_THROWS_AS(resolve_continuity({SideContinuity::g1, SideContinuity::g2, SideContinuity::g1}, method, flat), Refusal);
  CHECK_THROWS_AS(
      resolve_continuity({SideContinuity::g1, SideContinuity::g2, SideContinuity::g1}, find_method("gordon_coons"), wave_sides()),
      Refusal);
}

TEST_CASE("a fairing that follows the curvature comes near to it") {
  const Sides sides = wave_sides();
  // bends the truth does not have: without its curvature the sides could belong to a smoother surface
  const Boundary boundary = make_boundary(sides);
  const FairingBase base = {sides, boundary, curved_side_vertex(boundary)};
  FairingOptions options;
  const double without = curvature_jump(*fair(base, base, options).patch, sides, {true, true, true}, 50, 0.1);
  options.curvature = {true, true, true};
  const SurfacePtr patch = fair(base, base, options).patch;
  CHECK(curvature_jump(*patch, sides, {true, true, true}, 50, 0.1) < 0.1 * without);
  CHECK(seam_deg(*patch, sides) < 1e-5);
}

TEST_CASE("jumps of curvature change as their derivatives say") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> draw(-1, 1);
  const auto drawn = [&](Index rows, Index columns) {
    return Eigen::MatrixXd(Eigen::MatrixXd::NullaryExpr(rows, columns, [&](Index, Index) { return draw(random); }));
  };
  constexpr int inner = 2, slopes = 3, first = 3 * inner;
  SideBasis basis({});
  basis.slope = drawn(SideBasis::points, slopes);
  basis.second = {drawn(SideBasis::points, inner), drawn(SideBasis::points, inner)};
  FollowedSide side = {1, first, {0.7, 1.3}, 0.01, {}, {}, {}, {}, {}, {}};
  for (int k = 0; k < SideBasis::points; ++k) {
    side.form[k].n = Vec3(draw(random), draw(random), draw(random)).normalized();
    side.form[k].r = Vec3::UnitX(), side.form[k].dc = Vec3::UnitY();
    side.form[k].rr = draw(random), side.form[k].rc = draw(random), side.form[k].cc = draw(random);
    side.alpha[k] = draw(random), side.beta[k] = draw(random), side.base[k] = draw(random), side.skew[k] = draw(random);
    side.weight[k] = 1 + 0.5 * draw(random);
  }
  const CurvatureFollowing following(basis, {side}, 2, 1.7, 0.1);
  Eigen::VectorXd x = drawn(first + 2 * slopes, 1);
  RowMajor rows;
  const Eigen::VectorXd value = following.jumps(x, &rows);
  for (Index k = 0; k < x.size(); ++k) {
    const double step = 1e-3, before = x[k];  // they are quadratic: differences are exact
    x[k] = before + step;
    const Eigen::VectorXd above = following.jumps(x, nullptr);
    x[k] = before - step;
    const Eigen::VectorXd slope = (above - following.jumps(x, nullptr)) / (2 * step);
    x[k] = before;
    CHECK((rows.col(k) - slope).norm() < 1e-9 * (1 + value.norm()));
    CHECK(slope.norm() > 1e-3);
  }
}
