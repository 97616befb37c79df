#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/center.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/fairing.h"

using namespace tripatch;

namespace {

const std::array<Fairing, 5> energies = {Fairing::thin_plate, Fairing::third_derivative, Fairing::minimum_variation,
                                         Fairing::quadric_variation, Fairing::automatic};

/// A surface (u, v) -> space given for jets, so that its exact derivatives are at hand.
template <class Chart>
class ChartSurface : public JetSurface<ChartSurface<Chart>> {
public:
  explicit ChartSurface(std::array<Eigen::Vector2d, 3> corners) : corners_(corners) {}
  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    Jet<N> u, v;
    for (int i = 0; i < 3; ++i) {
      u += corners_[i][0] * b[i];
      v += corners_[i][1] * b[i];
    }
    return Chart::at(u, v);
  }
  Vec3 corner(int i) const {
    const JetPoint<0> p = Chart::at(Jet<0>(corners_[i][0]), Jet<0>(corners_[i][1]));
    return Vec3(p.x[0].value(), p.x[1].value(), p.x[2].value());
  }

private:
  std::array<Eigen::Vector2d, 3> corners_;
};

struct Sphere {
  template <int N>
  static JetPoint<N> at(const Jet<N>& u, const Jet<N>& v) {
    const Jet<N> r = reciprocal(sqrt(square(u) + square(v) + 1.0));
    JetPoint<N> p;
    p.x = {u * r, v * r, r};
    return p;
  }
};
struct Ellipsoid {
  template <int N>
  static JetPoint<N> at(const Jet<N>& u, const Jet<N>& v) {
    JetPoint<N> p = Sphere::at(u, v);
    p.x[0] *= 1.5;
    p.x[2] *= 0.7;
    return p;
  }
};
struct Saddle {
  template <int N>
  static JetPoint<N> at(const Jet<N>& u, const Jet<N>& v) {
    JetPoint<N> p;
    p.x = {u, v, square(u) - square(v)};
    return p;
  }
};
struct Cubic {
  template <int N>
  static JetPoint<N> at(const Jet<N>& u, const Jet<N>& v) {
    JetPoint<N> p;
    p.x = {u, v, 0.5 * (u * u * u) + u * v - 0.3 * square(v)};
    return p;
  }
};

const std::array<Eigen::Vector2d, 3> chart = {Eigen::Vector2d(-0.6, -0.4), Eigen::Vector2d(0.8, -0.3), Eigen::Vector2d(0.1, 0.7)};

/// The great-circle sides of a triangle of the unit sphere, in arc length, with unit conormals; moved by x -> scale turn x + shift.
Sides sphere_sides(const std::array<Vec3, 3>& corner, const Eigen::Matrix3d& turn = Eigen::Matrix3d::Identity(), double scale = 1,
                   const Vec3& shift = Vec3::Zero()) {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Vec3 a = corner[(i + 1) % 3], b = corner[(i + 2) % 3], out = -a.cross(b).normalized();
    const double angle = std::acos(a.dot(b));
    sides[i].c = PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> values) {
          for (std::size_t k = 0; k < t.size(); ++k) {
            const Vec3 p = (std::sin((1 - t[k]) * angle) * a + std::sin(t[k] * angle) * b) / std::sin(angle);
            Eigen::Map<Vec3>(values.data() + 3 * k) = scale * (turn * p) + shift;
          }
        },
        3, 1e-12);
    const Vec3 r = scale * (turn * out);
    sides[i].r = PiecewisePolynomial::constant({r.data(), 3});
  }
  return sides;
}

const std::array<Vec3, 3> octant = {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};

/// The sides of a chart over a triangle, run through unevenly, with unit conormals: little of the chart's parameterization is left.
template <class Chart>
Sides chart_sides(const std::array<Eigen::Vector2d, 3>& corners) {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector2d a = corners[(i + 1) % 3], b = corners[(i + 2) % 3], out = a - corners[i];
    const auto jets = [&](double t) {  // along the side (first direction) and away from the hole (second)
      const Eigen::Vector2d p = a + t * (1.2 - 0.2 * t) * (b - a);
      return Chart::at(Jet<1>::linear(p[0], b[0] - a[0], out[0]), Jet<1>::linear(p[1], b[1] - a[1], out[1]));
    };
    const auto part = [](const JetPoint<1>& p, int k) { return Vec3(p.x[0].c[k], p.x[1].c[k], p.x[2].c[k]); };
    const auto field = [&](auto&& f) {
      return PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> values) {
            for (std::size_t k = 0; k < t.size(); ++k) Eigen::Map<Vec3>(values.data() + 3 * k) = f(jets(t[k]));
          },
          3, 1e-12);
    };
    sides[i].c = field([&](const JetPoint<1>& p) { return part(p, 0); });
    sides[i].r = field([&](const JetPoint<1>& p) {
      const Vec3 along = part(p, 1).normalized(), across = part(p, 2);
      return (across - across.dot(along) * along).normalized().eval();
    });
  }
  return sides;
}

Points grid(int n) {
  Points b((n + 1) * (n + 2) / 2, 3);
  Index k = 0;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) b.row(k++) << double(i) / n, double(j) / n, double(n - i - j) / n;
  return b;
}

double rms_to_unit_sphere(const Surface& patch) {
  const Points p = patch.positions(grid(40));
  double sum = 0;
  for (Index k = 0; k < p.rows(); ++k) sum += std::pow(p.row(k).norm() - 1, 2);
  return std::sqrt(sum / p.rows());
}

double seam_angle(const Surface& patch, const Sides& sides) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) {
    Points b(199, 3);
    for (int k = 0; k < 199; ++k) {
      const double t = (k + 1) / 200.0;
      b(k, i) = 0;
      b(k, (i + 1) % 3) = 1 - t;
      b(k, (i + 2) % 3) = t;
    }
    const Points n = patch.normals(b);
    for (int k = 0; k < 199; ++k) {
      const Vec3 mine = n.row(k), theirs = sides[i].normal((k + 1) / 200.0);
      worst = std::max(worst, std::atan2(mine.cross(theirs).norm(), mine.dot(theirs)) * 180 / std::numbers::pi);
    }
  }
  return worst;
}

FairResult faired(const Sides& sides, const FairingOptions& options = {}, const FoldCounter* folds = nullptr) {
  const Boundary boundary = make_boundary(sides);
  const FairingBase base = {sides, boundary, side_vertex(boundary)};
  return fair(base, base, options, folds);
}

/// A side that has nothing but a normal: this one at every t.
Side with_normal(const Vec3& n) {
  const Vec3 along = n.unitOrthogonal(), across = along.cross(n);
  const std::array<double, 6> net = {0, 0, 0, along[0], along[1], along[2]};
  Side side;
  side.c = PiecewisePolynomial::bezier(net, 3);
  side.r = PiecewisePolynomial::constant({across.data(), 3});
  return side;
}

}  // namespace

TEST_CASE("energies vanish on the surfaces they are made for") {
  const ChartSurface<Sphere> sphere(chart);
  CHECK(energy(sphere, Fairing::minimum_variation, 1) < 1e-20);
  CHECK(energy(sphere, Fairing::quadric_variation, 1) < 1e-20);
  const ChartSurface<Ellipsoid> ellipsoid(chart);
  CHECK(energy(ellipsoid, Fairing::minimum_variation, 1) > 0.05);
  CHECK(energy(ellipsoid, Fairing::quadric_variation, 1) < 5e-3 * energy(ellipsoid, Fairing::minimum_variation, 1));
  const ChartSurface<Saddle> saddle(chart);
  CHECK(energy(saddle, Fairing::minimum_variation, 1) > 0.05);
  CHECK(energy(saddle, Fairing::quadric_variation, 1) < 1e-3 * energy(saddle, Fairing::minimum_variation, 1));
  CHECK(energy(saddle, Fairing::third_derivative, 1) < 1e-20);
  const ChartSurface<Cubic> cubic(chart);
  CHECK(energy(cubic, Fairing::quadric_variation, 1) > 0.01 * energy(cubic, Fairing::minimum_variation, 1));
}

TEST_CASE("curvature variation has exact derivatives") {
  const ChartSurface<Cubic> surface(chart);
  Points b(1, 3);
  b << 0.2, 0.5, 0.3;
  const Derivatives d = cartesian_derivatives(surface, b)[0];
  const double flat = 0.01;
  const auto energies_of = [&](const Derivatives& x) {
    const CurvatureVariation v = curvature_variation(x, flat);
    return Eigen::Vector2d(v.area * v.variation.squaredNorm(), v.area * v.quadric.squaredNorm());
  };
  const CurvatureVariationRows rows = curvature_variation_rows(d, flat);
  CHECK(rows.value.head<4>().squaredNorm() == Approx(energies_of(d)[0]).epsilon(1e-12));
  CHECK(rows.value.tail<4>().squaredNorm() == Approx(energies_of(d)[1]).epsilon(1e-12));
  const Eigen::RowVectorXd g0 = 2 * rows.value.head<4>().transpose() * rows.derivative.topRows<4>();
  const Eigen::RowVectorXd g1 = 2 * rows.value.tail<4>().transpose() * rows.derivative.bottomRows<4>();
  const double h = 1e-5;
  for (int k = 0; k < 27; ++k) {
    Derivatives up = d, down = d;
    up.data()[k] += h;
    down.data()[k] -= h;
    const Eigen::Vector2d slope = (energies_of(up) - energies_of(down)) / (2 * h);
    CHECK(g0[k] == Approx(slope[0]).margin(1e-6 * g0.norm()));
    CHECK(g1[k] == Approx(slope[1]).margin(1e-6 * g1.norm()));
  }
}

TEST_CASE("every fairing lowers its energy and keeps the seam") {
  for (const Sides& sides : {sphere_sides(octant), chart_sides<Saddle>(chart), chart_sides<Cubic>(chart)}) {
    const Boundary boundary = make_boundary(sides);
    const FairingBase base = {sides, boundary, side_vertex(boundary)};
    for (const Fairing name : energies) {
      INFO(name_of(name));
      FairingOptions options;
      options.energy = name;
      const FairResult result = fair(base, base, options);
      CHECK(result.after < 0.9 * result.before);
      CHECK(energy(*result.patch, name, boundary.size, 14) == Approx(result.after).epsilon(0.07));
      CHECK(seam_angle(*result.patch, sides) < 1e-5);
    }
  }
}

TEST_CASE("the default comes near the truth") {
  CHECK(rms_to_unit_sphere(*faired(sphere_sides(octant)).patch) / std::sqrt(2.0) < 5e-5);
  const double a = 10 * std::numbers::pi / 180 / std::sqrt(3.0);
  std::array<Vec3, 3> small;
  for (int k = 0; k < 3; ++k)
    small[k] = Vec3(std::sin(a) * std::cos(2 * std::numbers::pi * k / 3), std::sin(a) * std::sin(2 * std::numbers::pi * k / 3),
                    std::cos(a));
  CHECK(rms_to_unit_sphere(*faired(sphere_sides(small)).patch) / (small[0] - small[1]).norm() < 1e-7);

  const Points p = faired(chart_sides<Saddle>(chart)).patch->positions(grid(40));
  double sum = 0;
  for (Index k = 0; k < p.rows(); ++k) sum += std::pow(p(k, 2) - p(k, 0) * p(k, 0) + p(k, 1) * p(k, 1), 2);
  CHECK(std::sqrt(sum / p.rows()) < 5e-5 * 1.4);
}

TEST_CASE("twice the quadrature changes neither the energy nor the minimizer") {
  const Sides sides = sphere_sides(octant);
  const Points b = grid(20);
  for (const Fairing name : energies) {
    INFO(name_of(name));
    FairingOptions options;
    options.energy = name;
    const FairResult once = faired(sides, options);
    options.nodes *= 2;
    const FairResult twice = faired(sides, options);
    // as shapes: the geometric energies do not see how the surface is run through
    const Points apart = once.patch->positions(b) - twice.patch->positions(b), normals = once.patch->normals(b);
    CHECK(apart.cwiseProduct(normals).rowwise().sum().cwiseAbs().maxCoeff() < 1e-3 * std::sqrt(2.0));
    CHECK(energy(*once.patch, name, std::sqrt(2.0), 14) == Approx(energy(*once.patch, name, std::sqrt(2.0), 28)).epsilon(1e-3));
  }
}

TEST_CASE("fairing moves, turns and scales with the hole") {
  const Points b = grid(15);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  const Vec3 shift(3, -1, 2);
  for (const Fairing name : energies) {
    FairingOptions options;
    options.energy = name;
    const FairResult plain = faired(sphere_sides(octant), options);
    for (double scale : {1e-6, 1.0, 1e6}) {
      INFO(name_of(name) << " scale " << scale);
      const FairResult moved = faired(sphere_sides(octant, turn, scale, scale * shift), options);
      const Points p = plain.patch->positions(b), q = moved.patch->positions(b);
      double worst = 0;
      for (Index k = 0; k < b.rows(); ++k)
        worst = std::max(worst, (q.row(k).transpose() / scale - turn * p.row(k).transpose() - shift).norm());
      CHECK(worst < 1e-5);
    }
  }
}

TEST_CASE("a fairing that folds is not used") {
  const Sides sides = sphere_sides(octant);
  const Boundary boundary = make_boundary(sides);
  const FairingBase base = {sides, boundary, with_center(side_vertex(boundary), 1.2 * Vec3::Ones().normalized())};
  // The fair patch is nearly the sphere, this one is raised. Normals of the rim between what the planes of the two say near the center:
  Sides seen;
  for (int i = 0; i < 3; ++i) seen[i] = with_normal(Vec3::Ones() - 3.005 * Vec3::Unit(i));
  const FoldCounter folds(seen);
  REQUIRE(folds(*base.patch) == 0);
  REQUIRE(folds(*fair(base, base).patch) > 0);
  const FairResult result = fair(base, base, {}, &folds);
  CHECK(result.patch == base.patch);
  CHECK(result.after == result.before);
  CHECK(!result.warnings.empty());
}

TEST_CASE("folds that are not the patch's own are left alone") {
  // as where they are counted on the patch with what its sides' kinks add: here at one point of side 0, whose normal no patch changes
  const double angle = 13.0 / 64 * std::numbers::pi / 2;
  const Vec3 n(0, std::cos(angle), std::sin(angle)), dip = Vec3::UnitX().cross(n) - 1e-4 * n;
  Sides seen = {with_normal(Vec3(0, 1, 1)), with_normal(Vec3::Ones()), with_normal(Vec3::Ones())};
  const Vec3 r = Vec3::UnitX().cross(Vec3(0, 1, 1)), at_dip = Vec3::UnitX().cross(dip);
  const auto line = [](const Vec3& a, const Vec3& b) {
    const std::array<double, 6> net = {a[0], a[1], a[2], b[0], b[1], b[2]};
    return PiecewisePolynomial::bezier(net, 3);
  };
  seen[0].c = line(Vec3::Zero(), Vec3::UnitX());
  seen[0].r = PiecewisePolynomial::joined({line(r, r), line(r, at_dip), line(at_dip, r), line(r, r)},
                                          {51.0 / 256, 1.0 / 256, 1.0 / 256, 203.0 / 256});
  const FoldCounter folds(seen);
  const FairResult result = faired(sphere_sides(octant), {}, &folds);
  CHECK(result.folds == 1);
  CHECK(result.after < result.before);
}
