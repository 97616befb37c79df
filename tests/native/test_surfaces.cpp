#include "test_surfaces.h"

#include <numbers>

namespace tripatch::testing {

SurfacePtr bezier(const Points& net) {
  const int n = static_cast<int>(std::lround((std::sqrt(8.0 * static_cast<double>(net.rows()) + 1) - 3) / 2));
  return formula_surface([net, n](const auto& b) {
    using Scalar = std::decay_t<decltype(b[0])>;
    JetPoint<Scalar::order> p;
    for (int d = 0; d <= n; ++d)
      for (int k = 0; k <= d; ++k) {
        Scalar term(1.0);
        int count = 0;
        const std::array<int, 3> power = {n - d, d - k, k};
        for (int x = 0; x < 3; ++x)
          for (int m = 1; m <= power[x]; ++m) term *= b[x] * (static_cast<double>(++count) / m);
        p += term * JetPoint<Scalar::order>(Vec3(net.row(d * (d + 1) / 2 + k)));
      }
    return p;
  });
}

Points random_net(int n, unsigned seed, double size, const std::array<Vec3, 3>& corners) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  Points net((n + 1) * (n + 2) / 2, 3);
  for (int d = 0; d <= n; ++d)
    for (int k = 0; k <= d; ++k) {
      Vec3 p = (double(n - d) * corners[0] + double(d - k) * corners[1] + double(k) * corners[2]) / n;
      if (n - d < n && d - k < n && k < n)
        for (int x = 0; x < 3; ++x) p[x] += uniform(random);
      net.row(d * (d + 1) / 2 + k) = p;
    }
  return net;
}

PiecewisePolynomial line(const Vec3& a, const Vec3& b) {
  const std::array<double, 6> net = {a[0], a[1], a[2], b[0], b[1], b[2]};
  return PiecewisePolynomial::bezier(net, 3);
}

Side straight(const Vec3& a, const Vec3& b) {
  const Vec3 out = (b - a).cross(Vec3::UnitZ());
  return {line(a, b), line(out, out), {}};
}

std::array<double, 3> on_side(int i, double t) {
  std::array<double, 3> b;
  b[i] = 0;
  b[(i + 1) % 3] = 1 - t;
  b[(i + 2) % 3] = t;
  return b;
}

void sample(const Surface& surface, const double* b, const Vec3& v, Vec3& position, Vec3& derivative) {
  std::array<double, 9> out;
  surface.evaluate(b, 1, 1, out.data());
  position = Vec3::Map(out.data());
  derivative = v[0] * Vec3::Map(out.data() + 3) + v[1] * Vec3::Map(out.data() + 6);
}

Side side_of(const Surface& surface, int i, std::function<double(double)> stretch, std::function<double(double)> skew) {
  const auto field = [&](bool position) {
    return PiecewisePolynomial::fit(
        [&, position](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k) {
            Vec3 outward = -perpendicular_feet()[i], along = Vec3::Unit((i + 2) % 3) - Vec3::Unit((i + 1) % 3);
            if (stretch) outward *= stretch(t[k]);
            if (skew) outward += skew(t[k]) * along;
            Vec3 p, d;
            sample(surface, on_side(i, t[k]).data(), outward, p, d);
            Vec3::Map(&out[3 * k]) = position ? p : d;
          }
        },
        3);
  };
  Side side;
  side.c = field(true);
  side.r = field(false);
  return side;
}

Sides sides_of(const std::array<SurfacePtr, 3>& surfaces) {
  return {side_of(*surfaces[0], 0), side_of(*surfaces[1], 1), side_of(*surfaces[2], 2)};
}

Sides sides_of(const SurfacePtr& surface) { return sides_of({surface, surface, surface}); }

std::array<SurfacePtr, 3> unrelated_surfaces(unsigned seed, double size) {
  return {bezier(random_net(4, seed, size)), bezier(random_net(4, seed + 100, size)), bezier(random_net(4, seed + 200, size))};
}

Sides skewed_sides(const std::array<SurfacePtr, 3>& s) {
  return {side_of(
              *s[0], 0, [](double t) { return 1 + 0.5 * t; }, [](double t) { return 0.3 - 0.4 * t * t; }),
          side_of(
              *s[1], 1, [](double t) { return 0.7 + 0.2 * std::sin(3 * t); }, [](double t) { return 0.2 * t; }),
          side_of(*s[2], 2, [](double) { return 2.0; }, [](double t) { return -0.5 + 0.3 * t; })};
}

SurfacePtr wave() {
  return formula_surface([](const auto& b) {
    using Scalar = std::decay_t<decltype(b[0])>;
    JetPoint<Scalar::order> p;
    for (int i = 0; i < 3; ++i) p += b[i] * JetPoint<Scalar::order>(Vec3(plain_corners[i][0], plain_corners[i][1], 0));
    // sin and exp by their Taylor series at the value
    const double v = 3 * p.x[0].value() + 1.5 * p.x[1].value();
    std::array<double, Scalar::order + 1> series;
    const std::array<double, 4> cycle = {std::sin(v), std::cos(v), -std::sin(v), -std::cos(v)};
    double factorial = 1;
    for (int k = 0; k <= Scalar::order; ++k) {
      series[k] = 0.2 * cycle[k % 4] / factorial;
      factorial *= k + 1;
    }
    p.x[2] = compose<Scalar::order>(series.data(), 1, 3.0 * p.x[0] + 1.5 * p.x[1]) + 0.3 * (p.x[0] * p.x[1]);
    return p;
  });
}

double size_of(const Sides& sides) { return check_sides(sides); }

double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi; }

double side_error(const Surface& patch, const Sides& sides) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= 50; ++k) {
      const double t = k / 50.0;
      Points b(1, 3);
      b.row(0) = Vec3::Map(on_side(i, t).data());
      worst = std::max(worst, (Vec3(patch.positions(b).row(0)) - sides[i].c(t)).norm());
    }
  return worst / size_of(sides);
}

double seam_error(const Surface& patch, const Sides& sides, double margin) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= 50; ++k) {
      const double t = margin + (1 - 2 * margin) * k / 50.0;
      Points b(1, 3);
      b.row(0) = Vec3::Map(on_side(i, t).data());
      worst = std::max(worst, degrees_between(patch.normals(b).row(0), sides[i].normal(t)));
    }
  return worst;
}

Points grid(int n) {
  Points b((n + 1) * (n + 2) / 2, 3);
  Index row = 0;
  for (int d = 0; d <= n; ++d)
    for (int k = 0; k <= d; ++k) b.row(row++) = Vec3(n - d, d - k, k) / n;
  return b;
}

double difference(const Surface& a, const Surface& b, int n) {
  const Points at = grid(n);
  return (a.positions(at) - b.positions(at)).rowwise().norm().maxCoeff();
}

Sides transformed(const Sides& sides, const Eigen::Matrix3d& linear, const Vec3& shift) {
  const auto apply = [](const PiecewisePolynomial& f, const Eigen::Matrix3d& m, const Vec3& s) {
    const int n = f.degree() + 1;
    std::vector<double> coefficients(f.pieces() * n * 3);
    for (Index p = 0; p < f.pieces(); ++p) {
      Eigen::Map<Eigen::Matrix<double, 3, Eigen::Dynamic>> a(&coefficients[p * n * 3], 3, n);
      f.taylor(0.5 * (f.breaks()[p] + f.breaks()[p + 1]), f.degree(), a.data());
      a = (m * a).eval();
      a.col(0) += s;
    }
    return PiecewisePolynomial(f.breaks(), f.degree(), 3, coefficients);
  };
  Sides result;
  for (int i = 0; i < 3; ++i) result[i] = {apply(sides[i].c, linear, shift), apply(sides[i].r, linear, Vec3::Zero()), {}, {}};
  return result;
}

Sides relabelled(const Sides& sides, const std::array<int, 3>& order) {
  const bool odd = order[1] != (order[0] + 1) % 3;
  Sides result;
  for (int k = 0; k < 3; ++k) {
    const Side& side = sides[order[k]];
    result[k] = odd ? Side{side.c.reversed(), side.r.reversed(), {}, {}} : side;
  }
  return result;
}

double relabelling_error(const Make& make, const Sides& sides) {
  const std::array<std::array<int, 3>, 6> orders = {{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  const SurfacePtr patch = make(sides);
  const Points b = grid(12), expected = patch->positions(b);
  double worst = 0;
  for (const std::array<int, 3>& order : orders) {
    Points relabelled_b(b.rows(), 3);
    for (int k = 0; k < 3; ++k) relabelled_b.col(k) = b.col(order[k]);
    const Points found = make(relabelled(sides, order))->positions(relabelled_b);
    worst = std::max(worst, (found - expected).rowwise().norm().maxCoeff());
  }
  return worst / size_of(sides);
}

double motion_error(const Make& make, const Sides& sides) {
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  const Points b = grid(12), expected = make(sides)->positions(b);
  double worst = 0;
  for (double scale : {1e-6, 1.0, 1e6}) {
    const Vec3 shift = scale * Vec3(0.3, -2, 1);
    const Points found = make(transformed(sides, scale * rotation, shift))->positions(b);
    const Points moved = (scale * (expected * rotation.transpose())).rowwise() + shift.transpose();
    worst = std::max(worst, (found - moved).rowwise().norm().maxCoeff() / (scale * size_of(sides)));
  }
  return worst;
}

double corner_slope(const Surface& patch, const Sides& sides, int order) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (double rho : {0.0, 1e-40, 1e-20, 1e-9, 1e-6, 1e-3})
      for (double t : {0.0, 0.1, 0.5, 0.9, 1.0}) {
        std::array<double, 3> b;
        b[i] = 1 - rho;
        b[(i + 1) % 3] = rho * (1 - t);
        b[(i + 2) % 3] = rho * t;
        Eigen::VectorXd out(3 * jet_size(order));
        patch.evaluate(b.data(), 1, order, out.data());
        REQUIRE(out.allFinite());
        const Vec3 corner = sides[(i + 2) % 3].c(0);
        const double away = (Vec3(out.head<3>()) - corner).norm();
        worst = std::max({worst,
                          rho > 1e-12    ? (away - 1e-14) / rho
                          : away > 1e-12 ? INFINITY
                                         : 0.0,
                          out.segment<6>(3).cwiseAbs().maxCoeff()});
      }
  return worst / size_of(sides);
}

double corner_angle(const Surface& patch, const Sides& sides, double rho) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (double t : {0.1, 0.3, 0.5, 0.7, 0.9}) {
      Points b(1, 3);
      b(0, i) = 1 - rho;
      b(0, (i + 1) % 3) = rho * (1 - t);
      b(0, (i + 2) % 3) = rho * t;
      worst = std::max(worst, degrees_between(patch.normals(b).row(0), sides[(i + 2) % 3].normal(0)));
    }
  return worst;
}

double derivative_error(const Surface& patch, int highest) {
  const double h = 1e-4;
  double worst = 0;
  for (const Vec3& at : {Vec3(0.3, 0.45, 0.25), Vec3(0.8, 0.15, 0.05), Vec3(0.05, 0.2, 0.75)})
    for (int order = 1; order <= highest; ++order) {
      const int low = jet_size(order - 1);
      Eigen::VectorXd exact(3 * jet_size(order));
      patch.evaluate(at.data(), 1, order, exact.data());
      for (int direction = 0; direction < 2; ++direction) {
        const Vec3 step = h * (Vec3::Unit(direction) - Vec3::Unit(2));
        Eigen::VectorXd plus(3 * low), minus(3 * low);
        const Vec3 up = at + step, down = at - step;
        patch.evaluate(up.data(), 1, order - 1, plus.data());
        patch.evaluate(down.data(), 1, order - 1, minus.data());
        const Eigen::VectorXd difference = (plus - minus) / (2 * h);
        // coefficient (i, j) of degree order - 1 differentiates to (i + 1, j) times i + 1, or (i, j + 1) times j + 1
        for (int j = 0; j < order; ++j) {
          const int i = order - 1 - j, from = jet_index(i, j);
          const int to = direction == 0 ? jet_index(i + 1, j) : jet_index(i, j + 1), factor = direction == 0 ? i + 1 : j + 1;
          const Vec3 expected = factor * exact.segment<3>(3 * to), found = difference.segment<3>(3 * from);
          worst = std::max(worst, (expected - found).norm() / (1 + expected.norm()));
        }
      }
    }
  return worst;
}

void check_promises(const Make& make, int continuity, bool symmetric) {
  const Sides related = sides_of(bezier(random_net(4, 7))), incompatible = sides_of(unrelated_surfaces(3)),
              skewed = skewed_sides(unrelated_surfaces(11)), analytic = sides_of(wave());
  const Sides same_surface_skewed = skewed_sides({wave(), wave(), wave()});
  for (const Sides* sides : {&related, &incompatible, &skewed, &analytic, &same_surface_skewed}) {
    const SurfacePtr patch = make(*sides);
    CHECK(side_error(*patch, *sides) < 1e-12);
    if (continuity > 0) CHECK(seam_error(*patch, *sides) < 1e-6);
    CHECK(corner_slope(*patch, *sides) < 5);
    CHECK(derivative_error(*patch) < 1e-4);
    if (symmetric) CHECK(relabelling_error(make, *sides) < 1e-11);
    CHECK(motion_error(make, *sides) < 1e-11);
  }
  if (continuity > 0)
    for (const Sides* sides : {&related, &analytic, &same_surface_skewed}) CHECK(corner_angle(*make(*sides), *sides) < 0.01);
}

double reproduction_error(const Make& make, int degree) {
  double worst = 0;
  for (unsigned seed : {1u, 2u, 3u}) {
    const SurfacePtr surface = bezier(random_net(degree, seed));
    worst = std::max(worst, difference(*make(sides_of(surface)), *surface));
  }
  return worst;
}

}  // namespace tripatch::testing
