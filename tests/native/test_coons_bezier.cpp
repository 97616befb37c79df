#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "test_refusals.h"
#include "tripatch/constructions/coons_bezier.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/math/linear.h"

using namespace tripatch;

namespace {

BoundaryCurves random_boundary(int degree, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  BoundaryCurves boundary;
  for (Points& curve : boundary) {
    curve.resize(degree + 1, 3);
    for (double& x : curve.reshaped()) x = uniform(random);
  }
  for (int i = 0; i < 3; ++i) boundary[i].row(degree) = boundary[(i + 1) % 3].row(0);
  return boundary;
}

Vec3 on_curve(Points curve, double t) {
  for (Index n = curve.rows() - 1; n > 0; --n)
    for (Index k = 0; k < n; ++k) curve.row(k) = (1 - t) * curve.row(k) + t * curve.row(k + 1);
  return curve.row(0);
}

using Curve = std::function<Vec3(double)>;

/// The transfinite triangular Coons patch (Arnal and Lluch, section 3), u = b0, v = b1. Curves along the sides.
Vec3 transfinite(const std::array<Curve, 3>& c, double u, double v) {
  const double w = 1 - u - v;
  const auto x_u0 = [&](double s) { return c[1](s); };        // side 1 runs from corner 2 (u = 0) to corner 0
  const auto x_0v = [&](double s) { return c[0](1 - s); };    // side 0 runs from corner 1 (v = 1) to corner 2
  const auto x_diagonal = [&](double s) { return c[2](s); };  // v = s on side 2, from corner 0 to corner 1
  return w * (x_u0(u) + x_0v(v) - x_u0(0)) + v * (x_0v(u + v) + x_diagonal(1 - u) - x_0v(1)) +
         u * (x_u0(u + v) + x_diagonal(v) - x_u0(1));
}

std::array<Curve, 3> curves_of(const BoundaryCurves& boundary) {
  std::array<Curve, 3> c;
  for (int i = 0; i < 3; ++i) c[i] = [curve = boundary[i]](double t) { return on_curve(curve, t); };
  return c;
}

Points point(double u, double v) {
  Points b(1, 3);
  b << u, v, 1 - u - v;
  return b;
}

/// The net relabelled so that old corner p[i] becomes corner i.
Points relabelled(const Points& net, int degree, const std::array<int, 3>& p) {
  Points out(net.rows(), 3);
  for (int i = 0; i <= degree; ++i)
    for (int j = 0; i + j <= degree; ++j) {
      std::array<int, 3> e = {i, j, degree - i - j}, old;
      for (int k = 0; k < 3; ++k) old[p[k]] = e[k];
      out.row(BezierTriangle::row(e[0], e[1], e[2])) = net.row(BezierTriangle::row(old[0], old[1], old[2]));
    }
  return out;
}

BoundaryCurves sides_of(const BezierTriangle& triangle) { return {triangle.side(0), triangle.side(1), triangle.side(2)}; }

const std::array<CoonsKind, 5> kinds = {CoonsKind::discrete, CoonsKind::extremal, CoonsKind::extremal_symmetric, CoonsKind::mask,
                                        CoonsKind::permanence};

Eigen::MatrixXd inside_of(const Eigen::MatrixXd& equations, int degree) {
  std::vector<Index> columns;
  for (int r = 0; r <= degree; ++r)
    for (int k = 0; k <= r; ++k)
      if (degree - r > 0 && r - k > 0 && k > 0) columns.push_back(BezierTriangle::row(degree - r, r - k, k));
  return equations(Eigen::all, columns);
}

Index mask_rank(int degree, CoonsKind kind, double alpha = coons_alpha) {
  Eigen::FullPivLU<Eigen::MatrixXd> lu(inside_of(mask_equations(degree, kind, alpha), degree));
  return lu.setThreshold(1e-11).rank();
}

}  // namespace

TEST_CASE("the discrete Coons net is the transfinite triangular Coons patch") {
  for (int n = 1; n <= 20; ++n) {
    const BoundaryCurves boundary = random_boundary(n, n);
    const BezierTriangle patch = coons_bezier(boundary, CoonsKind::discrete);
    CHECK(patch.degree() == n + 1);
    double worst = 0;
    for (double u : {0.0, 0.1, 0.35, 0.6})
      for (double v : {0.0, 0.15, 0.4}) {
        const Vec3 p = patch.positions(point(u, v)).row(0);
        worst = std::max(worst, (p - transfinite(curves_of(boundary), u, v)).norm());
      }
    CHECK(worst < 2e-14);
  }
}

TEST_CASE("every kind interpolates its boundary curves at every degree") {
  for (CoonsKind kind : kinds)
    for (int n : {1, 2, 3, 5, 7, 9, 11, 13, 20}) {
      if (n == 20 && (kind == CoonsKind::mask || kind == CoonsKind::permanence)) continue;
      const BoundaryCurves boundary = random_boundary(n, 7 * n);
      const BezierTriangle patch = coons_bezier(boundary, kind);
      CHECK(patch.degree() == (kind == CoonsKind::discrete ? n + 1 : n));
      double worst = 0;
      for (int i = 0; i < 3; ++i)
        for (double t : {0.0, 0.2, 0.5, 0.9, 1.0}) {
          Points b = Points::Zero(1, 3);
          b(0, (i + 1) % 3) = 1 - t;
          b(0, (i + 2) % 3) = t;
          worst = std::max(worst, (patch.positions(b).row(0).transpose() - on_curve(boundary[i], t)).norm());
        }
      CHECK(worst < 1e-13);
    }
}

TEST_CASE("the functional is the integral of |x_uv|^2") {
  // Gauss-Legendre in collapsed coordinates, exact for these degrees
  const int points = 16;
  Eigen::MatrixXd jacobi = Eigen::MatrixXd::Zero(points, points);
  for (int k = 1; k < points; ++k) jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4.0 * k * k - 1);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> gauss(jacobi);
  for (int n : {2, 3, 5, 9}) {
    const BezierTriangle patch = coons_bezier(random_boundary(n, 3), CoonsKind::discrete);
    double energy = 0, all_pairs = 0;
    for (int a = 0; a < points; ++a)
      for (int b = 0; b < points; ++b) {
        const auto node = [&](int k) { return 0.5 * (1 + gauss.eigenvalues()[k]); };
        const auto weight = [&](int k) { return gauss.eigenvectors()(0, k) * gauss.eigenvectors()(0, k); };
        const double u = node(a), v = node(b) * (1 - u);
        const double w = weight(a) * weight(b) * (1 - u);
        std::array<double, 3 * jet_size(2)> jet;
        patch.evaluate(point(u, v).data(), 1, 2, jet.data());
        const Vec3 uu = 2 * Eigen::Map<Vec3>(&jet[9]), uv = Eigen::Map<Vec3>(&jet[12]), vv = 2 * Eigen::Map<Vec3>(&jet[15]);
        energy += w * uv.squaredNorm();
        // the directions that leave corner 0 are (-1, 1) and (-1, 0) in (u, v); corner 1: (0, -1) and (1, -1)
        all_pairs += w * (uv.squaredNorm() + (uu - uv).squaredNorm() + (vv - uv).squaredNorm());
      }
    const Points& net = patch.net();
    CHECK(coons_energy(patch) == Approx(energy).epsilon(1e-12));
    CHECK(coons_energy(patch, true) == Approx(all_pairs).epsilon(1e-12));
    CHECK((net.transpose() * coons_form(n + 1) * net).trace() == Approx(energy).epsilon(1e-10));
    CHECK((net.transpose() * coons_form(n + 1, true) * net).trace() == Approx(all_pairs).epsilon(1e-10));
  }
}

TEST_CASE("Proposition 4: the cubic extremal by its mask") {
  const BezierTriangle patch = coons_bezier(random_boundary(3, 4), CoonsKind::extremal);
  const auto p = [&](int i, int j, int k) -> Vec3 { return patch.net().row(BezierTriangle::row(i, j, k)); };
  const Vec3 expected = 0.5 * (p(0, 1, 2) - p(0, 2, 1) + p(1, 0, 2) + p(1, 2, 0) - p(2, 0, 1) + p(2, 1, 0));
  CHECK((p(1, 1, 1) - expected).norm() < 1e-14);
  const BezierTriangle mask = coons_bezier(random_boundary(3, 4), CoonsKind::mask);
  CHECK((mask.net() - patch.net()).norm() < 1e-14);
}

TEST_CASE("at the extremals the gradient vanishes and every other net has more energy") {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (bool symmetric : {false, true})
    for (int n = 3; n <= 12; ++n) {
      const BezierTriangle patch =
          coons_bezier(random_boundary(n, n), symmetric ? CoonsKind::extremal_symmetric : CoonsKind::extremal);
      const Eigen::MatrixXd form = coons_form(n, symmetric);
      const Points gradient = form * patch.net();
      double inside = 0;
      const Points weight = (form.cwiseAbs() * patch.net().cwiseAbs());
      for (int i = 1; i < n; ++i)
        for (int j = 1; i + j < n; ++j) {
          const Index r = BezierTriangle::row(i, j, n - i - j);
          inside = std::max(inside, gradient.row(r).norm() / weight.row(r).norm());
        }
      CHECK(inside < 1e-13);
      const double least = coons_energy(patch, symmetric);
      for (int trial = 0; trial < 20; ++trial) {
        Points net = patch.net();
        for (int i = 1; i < n; ++i)
          for (int j = 1; i + j < n; ++j)
            for (int x = 0; x < 3; ++x) net(BezierTriangle::row(i, j, n - i - j), x) += 0.05 * normal(random);
        CHECK(coons_energy(BezierTriangle(net), symmetric) > least);
      }
    }
}

TEST_CASE("the extremal has no more energy than the Coons net of its own degree") {
  for (int n = 3; n <= 12; ++n) {
    const BezierTriangle coons = coons_bezier(random_boundary(n - 1, n), CoonsKind::discrete);
    CHECK(coons_energy(coons_bezier(sides_of(coons), CoonsKind::extremal)) <= coons_energy(coons) * (1 + 1e-12));
  }
}

TEST_CASE("the extremals warn above degree 12") {
  Messages warnings;
  coons_bezier(random_boundary(12, 1), CoonsKind::extremal, {}, &warnings);
  CHECK(warnings.empty());
  coons_bezier(random_boundary(13, 1), CoonsKind::extremal, {}, &warnings);
  REQUIRE(warnings.size() == 1);
  CHECK(warnings[0].code == Code::ill_conditioned);
}

TEST_CASE("the list of singular mask and permanence systems") {
  const std::array<int, 14> mask_deficiency = {0, 0, 0, 2, 0, 2, 0, 4, 0, 4, 0, -1, 0, -1};  // n = 3 ..; -1: singular, any
  for (int n = 3; n <= 16; ++n) {
    const int unknowns = (n - 1) * (n - 2) / 2, deficiency = mask_deficiency[n - 3];
    const Index rank = mask_rank(n, CoonsKind::mask);
    INFO("degree " << n << ", rank " << rank << " of " << unknowns);
    if (deficiency < 0) {
      CHECK(rank < unknowns);
    } else {
      CHECK(rank == unknowns - deficiency);
    }
  }
  for (int n = 3; n <= 14; ++n) {
    const int unknowns = (n - 1) * (n - 2) / 2;
    INFO("degree " << n);
    CHECK(mask_rank(n, CoonsKind::permanence) == unknowns - (n == 4 || n == 10 ? 1 : 0));
  }
}

TEST_CASE("every degree from 4 up has singular alphas") {
  // where the determinant of (identity - mask), a polynomial in alpha, changes its sign
  for (int n = 4; n <= 12; ++n) {
    const Eigen::MatrixXd a = inside_of(mask_equations(n, CoonsKind::permanence, 0.0), n);
    const Eigen::MatrixXd b = a - inside_of(mask_equations(n, CoonsKind::permanence, 1.0), n);
    const auto sign = [&](double alpha) {
      return std::copysign(1.0, Eigen::FullPivLU<Eigen::MatrixXd>(a - alpha * b).determinant());
    };
    double step = 0.01, from = 0;
    while (std::abs(from) < 10 && sign(from) == sign(from + step)) {
      from = -from;
      step = -step;
      if (step > 0) from += step;
    }
    REQUIRE(std::abs(from) < 10);
    while (std::abs(step) > 1e-15 * std::abs(from)) {
      step /= 2;
      if (sign(from) == sign(from + step)) from += step;
    }
    const double alpha = from + step;
    INFO("degree " << n << ", alpha " << alpha);
    CHECK(mask_rank(n, CoonsKind::permanence, alpha) < a.cols());
    CHECK_THROWS_AS(coons_bezier(random_boundary(n, 1), CoonsKind::permanence, alpha), Refusal);
  }
}

TEST_CASE("mask and permanence nets satisfy their masks") {
  for (int n : {3, 4, 5, 7, 9}) {
    const BezierTriangle mask = coons_bezier(random_boundary(n, n), CoonsKind::mask);
    CHECK((mask_equations(n, CoonsKind::mask) * mask.net()).cwiseAbs().maxCoeff() < 1e-11 * mask.net().cwiseAbs().maxCoeff());
    for (double alpha : {-0.3, 0.0, 0.1}) {
      const BezierTriangle patch = coons_bezier(random_boundary(n, n), CoonsKind::permanence, alpha);
      CHECK((mask_equations(n, CoonsKind::permanence, alpha) * patch.net()).cwiseAbs().maxCoeff() <
            1e-11 * patch.net().cwiseAbs().maxCoeff());
    }
  }
}

TEST_CASE("a singular system gives the solution nearest to the Coons net of the polygons, or a refusal") {
  const auto check_both = [](int n, CoonsKind kind, std::optional<double> alpha) {
    INFO("degree " << n);
    CHECK_THROWS_AS(coons_bezier(random_boundary(n, 1), kind, alpha), Refusal);
    CHECK(refusal_code([&] { coons_bezier(random_boundary(n, 1), kind, alpha); }) == "coons_without_solution");

    const Eigen::MatrixXd equations = mask_equations(n, kind, alpha.value_or(coons_alpha));
    const Eigen::MatrixXd inside = inside_of(equations, n);
    const Eigen::FullPivLU<Eigen::MatrixXd> lu = Eigen::FullPivLU<Eigen::MatrixXd>(inside).setThreshold(1e-10);
    const Eigen::MatrixXd kernel = lu.kernel();
    REQUIRE(kernel.cols() > 0);
    REQUIRE(kernel.norm() > 0);
    // a solvable boundary: the rim of a net in the kernel of the whole system
    Points net(BezierTriangle::net_size(n), 3);
    net.setRandom();
    net -= least_squares(equations, equations * net);
    const BoundaryCurves boundary = sides_of(BezierTriangle(net));
    Messages warnings;
    const BezierTriangle patch = coons_bezier(boundary, kind, alpha, &warnings);
    CHECK(warnings.size() == 1);
    CHECK((equations * patch.net()).cwiseAbs().maxCoeff() < 1e-10);
    // nearest: the distance to the Coons net of the polygons is orthogonal to the kernel; that net by its formula
    Points distance((n - 1) * (n - 2) / 2, 3);
    const auto p = [&](int i, int j, int k) { return net.row(BezierTriangle::row(i, j, k)); };
    Index r = 0;
    for (int s = 0; s <= n; ++s)
      for (int k = 0; k <= s; ++k) {
        const int i = n - s, j = s - k;
        if (i == 0 || j == 0 || k == 0) continue;
        const Eigen::RowVector3d coons =
            (k * (p(i, 0, n - i) + p(0, j, n - j) - p(0, 0, n)) + j * (p(0, n - k, k) + p(i, n - i, 0) - p(0, n, 0)) +
             i * (p(n - k, 0, k) + p(n - j, j, 0) - p(n, 0, 0))) /
            n;
        distance.row(r++) = patch.net().row(BezierTriangle::row(i, j, k)) - coons;
      }
    CHECK((kernel.transpose() * distance).norm() < 1e-9 * kernel.norm());
  };
  check_both(6, CoonsKind::mask, {});
  check_both(8, CoonsKind::mask, {});
  check_both(12, CoonsKind::mask, {});
  check_both(4, CoonsKind::permanence, {});
  check_both(10, CoonsKind::permanence, -2.0 / 3.0);
  CHECK(refusal_code([&] { coons_bezier(random_boundary(4, 1), CoonsKind::permanence); }) == "coons_without_solution");
}

TEST_CASE("permanence with alpha -2/3 gives the Coons patch of degree 3") {
  const BezierTriangle coons = coons_bezier(random_boundary(2, 9), CoonsKind::discrete);
  const BezierTriangle permanence = coons_bezier(sides_of(coons), CoonsKind::permanence);
  CHECK((coons.net() - permanence.net()).norm() < 1e-14);
  CHECK((coons.net() - coons_bezier(sides_of(coons), CoonsKind::permanence, -0.5).net()).norm() > 1e-3);
}

TEST_CASE("the permanence principle fails for triangular Coons patches") {
  const BezierTriangle coons = coons_bezier(random_boundary(4, 2), CoonsKind::discrete);
  // a smaller triangle of the domain: its Coons patch is not the piece of the larger one, except where the surface is flat enough
  const Eigen::Vector2d a(0.1, 0.2), b(0.6, 0.3), c(0.2, 0.7);  // (u, v) of corners 0, 1, 2
  const auto at = [&](const BezierTriangle& s, const Eigen::Vector2d& p) -> Vec3 {
    return s.positions(point(p[0], p[1])).row(0);
  };
  const auto failure = [&](const BezierTriangle& s) {
    const std::array<Curve, 3> sides = {[&](double t) { return at(s, b + t * (c - b)); },
                                        [&](double t) { return at(s, c + t * (a - c)); },
                                        [&](double t) { return at(s, a + t * (b - a)); }};
    const double third = 1.0 / 3.0;
    return (transfinite(sides, third, third) - at(s, third * (a + b + c))).norm();
  };
  CHECK(failure(coons) > 1e-3);
  // the measure itself is sound: quadratics are reproduced, on any triangle
  CHECK(failure(coons_bezier(random_boundary(1, 2), CoonsKind::discrete)) < 1e-14);
}

TEST_CASE("Coons nets and the symmetric kinds do not depend on the numbering, the printed ones do") {
  const std::array<std::array<int, 3>, 6> orders = {{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
  const BezierTriangle given =
      coons_bezier(random_boundary(5, 6), CoonsKind::discrete);  // of degree 6; a boundary of degree 5 below
  const BoundaryCurves boundary = random_boundary(5, 6);
  for (CoonsKind kind : kinds) {
    const BezierTriangle patch = coons_bezier(boundary, kind, {});
    double worst = 0;
    for (const auto& order : orders) {
      const BoundaryCurves moved =
          sides_of(BezierTriangle(relabelled(coons_bezier(boundary, CoonsKind::extremal_symmetric).net(), 5, order)));
      const BezierTriangle again = coons_bezier(moved, kind, {});
      worst = std::max(worst, (again.net() - relabelled(patch.net(), patch.degree(), order)).norm());
    }
    if (kind == CoonsKind::extremal || kind == CoonsKind::mask) {
      CHECK(worst > 1e-2);
    } else {
      CHECK(worst < 1e-12);
    }
  }
  // u and v may still be exchanged in the printed ones
  const BezierTriangle extremal = coons_bezier(boundary, CoonsKind::extremal);
  const BezierTriangle swapped =
      coons_bezier(sides_of(BezierTriangle(relabelled(extremal.net(), 5, {1, 0, 2}))), CoonsKind::extremal);
  CHECK((swapped.net() - relabelled(extremal.net(), 5, {1, 0, 2})).norm() < 1e-12);
}

TEST_CASE("every kind follows rigid motions and scales") {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -1).normalized()).toRotationMatrix();
  for (double scale : {1e-6, 1.0, 1e6})
    for (CoonsKind kind : kinds) {
      const BoundaryCurves boundary = random_boundary(5, 8);
      BoundaryCurves moved = boundary;
      const Eigen::RowVector3d shift = scale * Eigen::RowVector3d(1, -2, 0.5);
      for (Points& curve : moved) curve = ((scale * curve * turn.transpose()).rowwise() + shift).eval();
      const Points expected = (scale * coons_bezier(boundary, kind).net() * turn.transpose()).rowwise() + shift;
      CHECK((coons_bezier(moved, kind).net() - expected).norm() < 1e-12 * scale);
    }
}

TEST_CASE("bad boundaries are refused in words") {
  const auto message = [](const BoundaryCurves& boundary, CoonsKind kind = CoonsKind::discrete,
                          std::optional<double> alpha = {}) {
    try {
      coons_bezier(boundary, kind, alpha);
    } catch (const InvalidArgument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  BoundaryCurves boundary = random_boundary(4, 1);
  boundary[1].conservativeResize(4, 3);
  CHECK(message(boundary) == "boundary[1] must have shape (5, 3), not (4, 3)");
  boundary = random_boundary(4, 1);
  boundary[2](4, 0) += 1e-3;
  CHECK_THAT(message(boundary), Catch::Contains("boundary[2] and boundary[0] do not meet at corner 1"));
  boundary = random_boundary(4, 1);
  boundary[2](3, 2) = std::numeric_limits<double>::infinity();
  CHECK(message(boundary) == "boundary[2][3] is not finite");
  boundary[0].resize(0, 3);
  CHECK(message(boundary) == "len(boundary[0]) must be 1 or more, not 0");
  CHECK_THAT(message(random_boundary(21, 1)), Catch::Contains("from 0 to 20, not 21"));
  CHECK_THAT(message(random_boundary(4, 1), CoonsKind::mask, 0.1), Catch::Contains("alpha"));
  CHECK_THAT(message(random_boundary(4, 1), CoonsKind::permanence, std::nan("")), Catch::Contains("alpha"));
  BoundaryCurves spot = {Points(Points::Ones(1, 3)), Points(Points::Ones(1, 3)), Points(Points::Ones(1, 3))};
  for (CoonsKind kind : kinds) CHECK(coons_bezier(spot, kind).net().isOnes(1e-15));
}

namespace {

Sides sides_between(const std::array<Curve, 3>& curves) {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const auto sampled = [&](std::span<const double> t, std::span<double> out) {
      for (std::size_t k = 0; k < t.size(); ++k) Vec3::Map(&out[3 * k]) = curves[i](t[k]);
    };
    sides[i].c = PiecewisePolynomial::fit(sampled, 3);
    sides[i].r = PiecewisePolynomial::constant(std::array<double, 3>{0, 0, 1});
  }
  return sides;
}

}  // namespace

TEST_CASE("a side that is a polynomial is taken as the Bezier curve that it is") {
  for (int n : {1, 3, 6, 9}) {  // as pieces of degree 9
    const BoundaryCurves given = random_boundary(n, 3 * n);
    const BoundaryCurves found = bezier_sides(make_boundary(sides_between(curves_of(given))));
    REQUIRE(found[0].rows() == n + 1);
    for (int i = 0; i < 3; ++i) CHECK((found[i] - given[i]).norm() < 1e-10);
  }
  for (int n : {11, 12}) {
    const BoundaryCurves given = random_boundary(n, n);
    Sides sides = sides_between(curves_of(given));
    for (int i = 0; i < 3; ++i) sides[i].c = PiecewisePolynomial::bezier({given[i].data(), std::size_t(given[i].size())}, 3);
    const BoundaryCurves found = bezier_sides(make_boundary(sides));
    REQUIRE(found[0].rows() == n + 1);
    for (int i = 0; i < 3; ++i)
      for (double t : {0.1, 0.5, 0.8}) CHECK((on_curve(found[i], t) - on_curve(given[i], t)).norm() < 1e-12);
  }
}

TEST_CASE("other sides become the curve through their rim vertices") {
  const auto wave = [](double t) { return 0.1 * std::sin(3 * std::numbers::pi * t); };  // no polynomial of degree 12
  const std::array<Curve, 3> arcs = {
      [&](double t) { return Vec3(wave(t), std::cos(std::numbers::pi / 2 * t), std::sin(std::numbers::pi / 2 * t)); },
      [&](double t) { return Vec3(std::sin(std::numbers::pi / 2 * t), wave(t), std::cos(std::numbers::pi / 2 * t)); },
      [&](double t) { return Vec3(std::cos(std::numbers::pi / 2 * t), std::sin(std::numbers::pi / 2 * t), wave(t)); }};
  Sides sides = sides_between(arcs);
  const std::array<int, 3> vertices = {13, 6, 2};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < vertices[i]; ++k) sides[i].rim.push_back(k / (vertices[i] - 1.0));
  for (CoonsKind kind : {CoonsKind::discrete, CoonsKind::extremal, CoonsKind::mask}) {
    const SurfacePtr patch = coons_fill(make_boundary(sides), kind);
    for (int i = 0; i < 3; ++i)
      for (double t : sides[i].rim) {
        Points b = Points::Zero(1, 3);
        b(0, (i + 1) % 3) = 1 - t;
        b(0, (i + 2) % 3) = t;
        CHECK((patch->positions(b).row(0).transpose() - arcs[i](t)).norm() < 1e-12);
      }
  }
  sides[1].rim.clear();
  CHECK(refusal_code([&] { coons_fill(make_boundary(sides), CoonsKind::discrete); }) == "side_is_no_bezier_curve");
  for (int k = 0; k < 14; ++k) sides[1].rim.push_back(k / 13.0);
  CHECK(refusal_code([&] { coons_fill(make_boundary(sides), CoonsKind::discrete); }) == "side_has_many_vertices");
}

TEST_CASE("the Bezier methods are registered for holes, with G0") {
  for (const char* name : {"coons_bezier", "coons_extremal", "coons_mask"}) {
    const Method& method = find_method(name);
    CHECK(method.fills_holes);
    CHECK(method.continuity == SeamContinuity::g0);
    const SurfacePtr patch = method.from_boundary(make_boundary(sides_between(curves_of(random_boundary(4, 5)))), {});
    CHECK(patch->positions(point(1, 0)).allFinite());
  }
}
