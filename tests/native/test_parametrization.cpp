#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "tripatch/mesh/triangles.h"
#include "tripatch/parametrization/parametrization.h"

using namespace tripatch;

namespace {

struct Surface {
  Points points;
  Triangles triangles;
};

/// A grid of 2 n m triangles over [0, 1]^2.
Surface grid(int n, int m, const std::function<Vec3(double, double)>& f) {
  Surface s;
  s.points.resize((n + 1) * (m + 1), 3);
  const auto at = [&](int i, int j) { return Index{i} * (m + 1) + j; };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= m; ++j) s.points.row(at(i, j)) = f(static_cast<double>(i) / n, static_cast<double>(j) / m);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      s.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      s.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return s;
}

/// Rings of n vertices around a pole: f(ring / rings, angle); the pole is f(0, 0).
Surface polar(int rings, int n, const std::function<Vec3(double, double)>& f) {
  Surface s;
  s.points.resize(1 + rings * n, 3);
  s.points.row(0) = f(0, 0);
  for (int r = 1; r <= rings; ++r)
    for (int k = 0; k < n; ++k)
      s.points.row(1 + (r - 1) * n + k) = f(static_cast<double>(r) / rings, 2 * std::numbers::pi * k / n);
  for (int k = 0; k < n; ++k) {
    const int next = (k + 1) % n;
    s.triangles.push_back({0, 1 + k, 1 + next});
    for (int r = 1; r < rings; ++r) {
      const Index a = 1 + (r - 1) * n + k, b = 1 + (r - 1) * n + next;
      s.triangles.push_back({a, a + n, b + n});
      s.triangles.push_back({a, b + n, b});
    }
  }
  return s;
}

/// A tube of radius 1 closed by half a ball: `length` radii of it.
Surface finger(double length, int rings, int n) {
  return polar(rings, n, [=](double t, double a) {
    const double s = t * (std::numbers::pi / 2 + length);
    const double radius = s < std::numbers::pi / 2 ? std::sin(s) : 1,
                 z = s < std::numbers::pi / 2 ? std::cos(s) : std::numbers::pi / 2 - s;
    return Vec3(radius * std::cos(a), radius * std::sin(a), z);
  });
}

double twice_area(const PlanePoints& uv, const std::array<Index, 3>& t) {
  const Eigen::RowVector2d p = uv.row(t[1]) - uv.row(t[0]), q = uv.row(t[2]) - uv.row(t[0]);
  return p[0] * q[1] - p[1] * q[0];
}

/// What must hold of every layout; empty when it does.
std::string flaw(const Surface& s, const std::optional<Parametrization>& layout) {
  if (!layout) return "no layout";
  double plane = 0, space = 0;
  for (const auto& t : s.triangles) {
    const double twice = twice_area(layout->uv, t);
    if (!(twice > 0)) return "a triangle turned over";
    plane += twice;
    space += Vec3(s.points.row(t[1]) - s.points.row(t[0])).cross(Vec3(s.points.row(t[2]) - s.points.row(t[0]))).norm();
  }
  if (std::abs(plane - space) > 1e-9 * space) return "areas differ";
  for (std::size_t k = 1; k < layout->energies.size(); ++k)
    if (!(layout->energies[k] < layout->energies[k - 1])) return "the energy does not fall";
  return "";
}

/// Largest relative error of an edge's length.
double stretch(const Surface& s, const PlanePoints& uv) {
  double worst = 0;
  for (const auto& t : s.triangles)
    for (int k = 0; k < 3; ++k) {
      const double space = (s.points.row(t[k]) - s.points.row(t[(k + 1) % 3])).norm();
      worst = std::max(worst, std::abs((uv.row(t[k]) - uv.row(t[(k + 1) % 3])).norm() / space - 1));
    }
  return worst;
}

const PlaneLayoutOptions to_the_end = {200, 0};

Surface bumpy(int n) {
  std::mt19937 random(5);
  return grid(n, n, [&](double u, double v) {
    const double noise = static_cast<double>(random() % 1000) / 1000;
    return Vec3(u, v, 0.15 * std::sin(7 * u) * std::cos(9 * v) + 0.6 / n * noise);
  });
}

}  // namespace

TEST_CASE("a developable strip comes out flat") {
  // a triangulated piece of a cylinder or cone is developable itself when its edges run along the rulings
  const Surface cylinder = grid(30, 8, [](double u, double v) { return Vec3(std::cos(4 * u), std::sin(4 * u), 2 * v); });
  const Surface cone =
      grid(30, 8, [](double u, double v) { return Vec3((1 + v) * std::cos(4 * u), (1 + v) * std::sin(4 * u), 0.7 * (1 + v)); });
  const Surface plane = grid(5, 9, [](double u, double v) { return Vec3(u + 0.3 * v * v, 2 * v, u); });
  for (const Surface* s : {&cylinder, &cone, &plane}) {
    const auto layout = parametrize(s->points, s->triangles, to_the_end);
    REQUIRE(flaw(*s, layout) == "");
    CHECK(stretch(*s, layout->uv) < 1e-6);
    CHECK(layout->energies.back() == Approx(4).epsilon(1e-10));
    CHECK(layout->energies.size() < 40);
  }
}

TEST_CASE("no triangle is turned over and the energy falls on hard surfaces") {
  const auto half = [](double t, double a) {
    return Vec3(std::sin(std::numbers::pi / 2 * t) * std::cos(a), std::sin(std::numbers::pi / 2 * t) * std::sin(a),
                std::cos(std::numbers::pi / 2 * t));
  };
  const auto most = [](double t, double a) {  // nine tenths of a ball's meridian
    return Vec3(std::sin(0.9 * std::numbers::pi * t) * std::cos(a), std::sin(0.9 * std::numbers::pi * t) * std::sin(a),
                std::cos(0.9 * std::numbers::pi * t));
  };
  const Surface ball = polar(12, 40, half);
  const auto layout = parametrize(ball.points, ball.triangles, to_the_end);
  REQUIRE(flaw(ball, layout) == "");
  CHECK(layout->energies.back() < 4.4);
  for (const Surface& s : {polar(20, 30, most), finger(3, 20, 16), finger(10, 60, 12), finger(20, 100, 12), bumpy(20)}) {
    const auto laid = parametrize(s.points, s.triangles);
    CHECK(flaw(s, laid) == "");
    REQUIRE(laid);
    CHECK(laid->energies.size() > 2);
    const auto longer = parametrize(s.points, s.triangles, to_the_end);
    CHECK(flaw(s, longer) == "");
    CHECK(longer->energies.back() <= laid->energies.back());
    CHECK(laid->energies.back() < 1.02 * longer->energies.back());  // a tolerance of 1e-4 a step stops near the end
  }
}

TEST_CASE("the way from a start that is far off has so many steps as its vertices allow, and the usual ones anyway") {
  const Surface s = grid(12, 12, [](double u, double v) { return Vec3(u, v, 0.1 * std::sin(5 * u)); });
  PlanePoints thin = s.points.leftCols(2);
  thin.col(1) *= 1e-6;
  const auto steps = [&](int vertex_steps) {
    const PlaneLayoutOptions options = {4, 0, vertex_steps};
    return parametrize(s.points, s.triangles, options, &thin)->energies.size() - 1;
  };
  const int n = static_cast<int>(s.points.rows());
  CHECK(steps(5 * n) == 5);
  CHECK(steps(6 * n) == 6);
  CHECK(steps(n) == 4);
  CHECK(steps(1000 * n) > 6);
}

TEST_CASE("a layout is the same turned and scaled") {
  const Surface s = bumpy(12);
  const auto layout = parametrize(s.points, s.triangles, to_the_end);
  REQUIRE(flaw(s, layout) == "");
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (double scale : {1e-6, 1.0, 1e6}) {
    Points moved = scale * s.points * turn.transpose();
    moved.rowwise() += scale * Eigen::RowVector3d(3, -1, 2);
    const auto other = parametrize(moved, s.triangles, to_the_end);
    REQUIRE(other);
    CHECK((other->uv / scale - layout->uv).cwiseAbs().maxCoeff() < 1e-5);
  }
  const auto again = parametrize(s.points, s.triangles, to_the_end);
  CHECK(again->uv == layout->uv);
}

TEST_CASE("a layout goes on from one that was given, if nothing is turned over in that") {
  const Surface s = bumpy(12);
  const auto layout = parametrize(s.points, s.triangles);
  Points raised = s.points;
  raised.col(2) *= 1.02;
  const Surface nearby = {raised, s.triangles};
  const auto cold = parametrize(raised, s.triangles), warm = parametrize(raised, s.triangles, {}, &layout->uv);
  CHECK(flaw(nearby, warm) == "");
  CHECK(warm->energies.front() < cold->energies.front());
  CHECK(warm->energies.size() < cold->energies.size());
  CHECK(warm->energies.back() == Approx(cold->energies.back()).epsilon(1e-3));
  PlanePoints bad = layout->uv;
  bad.row(80).swap(bad.row(20));
  const auto mended = parametrize(raised, s.triangles, {}, &bad);
  CHECK(flaw(nearby, mended) == "");
  CHECK(mended->uv == cold->uv);
}

TEST_CASE("triangles without area do not break a layout") {
  Surface s = grid(10, 10, [](double u, double v) { return Vec3(u, v, 0.1 * std::sin(5 * u)); });
  s.points.row(60) = s.points.row(61);                           // an edge without length
  s.points.row(25) = (s.points.row(13) + s.points.row(37)) / 2;  // three vertices in line
  CHECK(flaw(s, parametrize(s.points, s.triangles)) == "");
  const Points line = s.points.col(0) * Eigen::RowVector3d(1, 0, 0);
  const auto flat = parametrize(line, s.triangles);
  REQUIRE(flat);
  for (const auto& t : s.triangles) CHECK(twice_area(flat->uv, t) > 0);
  const auto nowhere = parametrize(Points::Zero(s.points.rows(), 3), s.triangles);
  REQUIRE(nowhere);
  CHECK(nowhere->uv.allFinite());
}

TEST_CASE("inner holes are closed for the layout, also where they touch the border") {
  const Surface whole = grid(10, 10, [](double u, double v) { return Vec3(u, v, 0.2 * u * v); });
  Surface pierced = {whole.points, {}};
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    const std::size_t i = t / 20, j = t / 2 % 10;
    if (!(i >= 4 && i < 6 && j >= 3 && j < 6)) pierced.triangles.push_back(whole.triangles[t]);
  }
  const auto around = parametrize(pierced.points, pierced.triangles);
  REQUIRE(flaw(pierced, around) == "");
  CHECK(around->holes_filled == 1);
  // a triangle hole whose corner is a border vertex
  Surface s = grid(4, 4, [](double u, double v) { return Vec3(u, v, 0); });
  Triangles kept;
  for (std::size_t t = 0; t < s.triangles.size(); ++t) {
    const auto& f = s.triangles[t];
    const bool touches = f == std::array<Index, 3>{2, 7, 8};  // its corner 2 is on the border, its edges are not
    if (!touches) kept.push_back(f);
  }
  REQUIRE(kept.size() + 1 == s.triangles.size());
  s.triangles = kept;
  const auto layout = parametrize(s.points, s.triangles);
  REQUIRE(flaw(s, layout) == "");
  CHECK(layout->holes_filled == 1);
}

TEST_CASE("what is no disc is not laid out") {
  const Surface tube = grid(
      12, 3, [](double u, double v) { return Vec3(std::cos(2 * std::numbers::pi * u), std::sin(2 * std::numbers::pi * u), v); });
  Triangles closed = tube.triangles;  // its ends glued: two borders, one of which is filled
  for (auto& t : closed)
    for (Index& v : t) v %= 48;
  const auto laid = parametrize(tube.points, closed);
  REQUIRE(laid);
  CHECK(laid->holes_filled == 1);
  CHECK(laid->uv.bottomRows(4).array().isNaN().all());
  const Triangles tetrahedron = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  CHECK_FALSE(parametrize(tube.points, tetrahedron));                        // no border
  CHECK_FALSE(parametrize(tube.points, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));  // an edge of three triangles
  CHECK_FALSE(parametrize(tube.points, {{0, 1, 2}, {0, 1, 3}}));             // that disagree
  CHECK_FALSE(parametrize(tube.points, {{0, 1, 5}, {1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {4, 0, 6}, {0, 5, 6}, {6, 5, 4}, {4, 5, 7}}));
  CHECK_FALSE(parametrize(tube.points, {}));
  Surface torus = grid(6, 6, [](double u, double v) {
    const double a = 2 * std::numbers::pi * u, b = 2 * std::numbers::pi * v;
    return Vec3((2 + std::cos(b)) * std::cos(a), (2 + std::cos(b)) * std::sin(a), std::sin(b));
  });
  for (auto& t : torus.triangles)
    for (Index& v : t) v = (v / 7 % 6) * 7 + v % 7 % 6;
  torus.triangles.pop_back();
  CHECK_FALSE(parametrize(torus.points, torus.triangles));  // a handle
  // only what is connected across edges with the first triangle
  const auto part = parametrize(tube.points, {{0, 1, 5}, {5, 6, 7}});
  REQUIRE(part);
  CHECK(part->uv.row(5).allFinite());
  CHECK_FALSE(part->uv.row(6).allFinite());
  CHECK_THROWS_AS(parametrize(tube.points, {{0, 1, 5000}}), InvalidArgument);
}

TEST_CASE("a layout starts near its end: the embedding on a circle is made anew until that gains no more than a hundredth") {
  for (const auto& [length, most] : {std::pair(3.0, 7.2), {6.0, 13.5}}) {
    const Surface s = finger(length, 40, 12);
    const auto layout = parametrize(s.points, s.triangles, to_the_end);
    CHECK(layout->energies.front() < most);  // 34 and 395 of the first embedding, 8 and 20 of two more
  }
}

TEST_CASE("triangles that close an inner hole are as good as free to deform") {
  // a tube: what closes one of its ends would have it wide there
  const int n = 24, rings = 6;
  const Surface tube = polar(rings, n, [=](double t, double a) { return Vec3(std::cos(a), std::sin(a), -2 * t); });
  Triangles open;
  for (const std::array<Index, 3>& t : tube.triangles)
    if (t[0] != 0) open.push_back(t);
  const auto layout = parametrize(tube.points, open, to_the_end);
  REQUIRE(layout);
  REQUIRE(layout->holes_filled == 1);
  const PlanePoints closed = layout->uv.bottomRows(n);
  const double radius = (closed.rowwise() - Eigen::RowVector2d(closed.colwise().mean())).rowwise().norm().mean();
  CHECK(radius == Approx(0.5376).epsilon(0.011));  // where they are free altogether; 0.578 where they weigh a tenth
}

TEST_CASE("where the way is long a layout comes to its end, and is turned as its start is") {
  const Surface s = grid(8, 12, [](double u, double v) {
    return Vec3(std::cos(3 * v) * (1 + 0.4 * u), 1000 * (u + 0.1 * std::sin(3 * v)),
                0.3 * std::sin(3 * v) * (1 + 0.3 * std::sin(5 * u)));
  });
  PlaneLayoutOptions options;
  options.tolerance = 1e-3;
  const auto layout = parametrize(s.points, s.triangles, options), end = parametrize(s.points, s.triangles, to_the_end);
  REQUIRE(layout);
  REQUIRE(layout->energies.front() > 200);
  CHECK(layout->energies.back() < end->energies.back() * (1 + 1e-7));
  CHECK((layout->uv - end->uv).cwiseAbs().maxCoeff() < 1e-3 * end->uv.cwiseAbs().maxCoeff());

  const Surface plane = grid(6, 8, [](double u, double v) { return Vec3(u, v, 0); });
  PlanePoints sheared = plane.points.leftCols<2>();
  sheared.col(0) += 30 * sheared.col(1);
  const auto turned = parametrize(plane.points, plane.triangles, options, &sheared);
  REQUIRE(turned->energies.front() > 200);
  CHECK(turned->energies.back() == Approx(4).epsilon(1e-6));
  const auto about = [](const PlanePoints& uv) { return PlanePoints(uv.rowwise() - Eigen::RowVector2d(uv.colwise().mean())); };
  const PlanePoints now = about(turned->uv), then = about(sheared);
  const double across = then.col(0).dot(now.col(1)) - then.col(1).dot(now.col(0)), along = then.cwiseProduct(now).sum();
  CHECK(std::abs(across) < 1e-12 * along);
}

TEST_CASE("what rounding makes of a mesh a thousand times as long as wide its layout does not enlarge beyond 1e-9") {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1);
  Surface s = grid(6, 8, [](double u, double v) {
    return Vec3(1000 * (u + 0.1 * std::sin(3 * v)), std::cos(3 * v), std::sin(3 * v) * (1 + 0.3 * std::sin(5 * u)));
  });
  PlaneLayoutOptions options;
  options.tolerance = 1e-3;
  const auto layout = parametrize(s.points, s.triangles, options);
  REQUIRE(layout);
  REQUIRE(layout->energies.size() > 5);
  const double size = layout->uv.cwiseAbs().maxCoeff();
  for (int round = 0; round < 5; ++round) {
    Points moved = s.points;
    for (double& x : moved.reshaped()) x *= 1 + 1e-16 * noise(random);
    const auto other = parametrize(moved, s.triangles, options);
    REQUIRE(other);
    CHECK((other->uv - layout->uv).cwiseAbs().maxCoeff() < 1e-9 * size);
  }
}
