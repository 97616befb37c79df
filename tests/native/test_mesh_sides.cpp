// Tangent planes estimated from a plain mesh, against surfaces whose normals are known everywhere.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/math/angle.h"

using namespace tripatch;
using Vec2 = Eigen::Vector2d;

namespace {

struct TestSurface {
  std::function<Vec3(Vec2)> point;
  std::function<Vec3(Vec3)> normal;  // outer unit normal at the nearest point of the surface
  std::array<Vec2, 3> corner;        // counter-clockwise, seen from outside
};

TestSurface sphere() {
  // the octant, in the gnomonic chart about its middle
  const Vec3 z = Vec3::Ones().normalized(), x = Vec3(1, -1, 0).normalized(), y = z.cross(x);
  TestSurface s;
  s.point = [=](Vec2 u) { return (z + u[0] * x + u[1] * y).normalized(); };
  s.normal = [](Vec3 p) { return p.normalized(); };
  for (int k = 0; k < 3; ++k) s.corner[k] = Vec2(Vec3::Unit(k).dot(x), Vec3::Unit(k).dot(y)) / Vec3::Unit(k).dot(z);
  return s;
}

TestSurface torus() {
  const double big = 2, small = 0.8;
  return {[=](Vec2 u) {
            const double d = big + small * std::cos(u[1]);
            return Vec3(d * std::cos(u[0]), d * std::sin(u[0]), small * std::sin(u[1]));
          },
          [=](Vec3 p) {
            const Vec3 middle = big * Vec3(p[0], p[1], 0).normalized();
            return (p - middle).normalized();
          },
          {Vec2(-0.5, -0.6), Vec2(0.9, 0.1), Vec2(-0.1, 1.9)}};
}

TestSurface saddle() {
  TestSurface s{[](Vec2 u) { return Vec3(u[0], u[1], u[0] * u[0] - u[1] * u[1]); },
                [](Vec3 p) { return Vec3(-2 * p[0], 2 * p[1], 1).normalized(); },
                {}};
  for (int k = 0; k < 3; ++k)
    s.corner[k] = 0.8 * Vec2(std::cos(0.4 + 2 * std::numbers::pi * k / 3), std::sin(0.4 + 2 * std::numbers::pi * k / 3));
  return s;
}

TestSurface plane() {
  const Vec3 x(1, 2, 0.5), y(-0.3, 0.4, 1.7), n = x.cross(y).normalized();
  return {[=](Vec2 u) { return Vec3(Vec3(3, -2, 5) + u[0] * x + u[1] * y); },
          [=](Vec3) { return n; },
          {Vec2(0, 0), Vec2(1, 0.2), Vec2(0.3, 1.1)}};
}

struct TestMesh {
  Points vertices;
  Faces faces;
  Hole hole;
  MeshSides sides() const { return mesh_sides({vertices, faces}, hole); }
};

enum class Kind { triangles, quads, hexagons };

struct Shape {
  std::array<int, 3> edges = {8, 8, 8};
  int rings = 4;
  double depth = 0.15;  // of a ring, in the chart: over the distance to the middle
  double grading = 1;   // side 2 spaced by t^grading
  Kind kind = Kind::triangles;
};

/// Rings of faces around a triangle of the chart, the hole's sides straight there.
TestMesh make(const TestSurface& surface, const Shape& shape) {
  const Vec2 middle = (surface.corner[0] + surface.corner[1] + surface.corner[2]) / 3;
  std::vector<Vec2> rim;
  TestMesh m;
  for (int k = 0; k < 3; ++k) {
    m.hole.corners[k] = static_cast<Index>(rim.size());
    for (int j = 0; j < shape.edges[k]; ++j) {
      double t = static_cast<double>(j) / shape.edges[k];
      if (k == 0) t = std::pow(t, shape.grading);
      rim.push_back(surface.corner[k] + t * (surface.corner[(k + 1) % 3] - surface.corner[k]));
    }
  }
  const Index n = static_cast<Index>(rim.size());
  m.vertices.resize(n * (shape.rings + 1), 3);
  for (int ring = 0; ring <= shape.rings; ++ring)
    for (Index k = 0; k < n; ++k)
      m.vertices.row(ring * n + k) = surface.point(middle + (1 + shape.depth * ring) * (rim[k] - middle));
  for (Index k = 0; k < n; ++k) m.hole.rim.push_back(k);
  const auto add = [&](std::vector<Index> f) { m.faces.add(f); };
  for (int ring = 0; ring < shape.rings; ++ring)
    for (Index k = 0; k < n; k += shape.kind == Kind::hexagons ? 2 : 1) {
      const Index a = ring * n + k, b = ring * n + (k + 1) % n, c = b + n, d = a + n;
      if (shape.kind == Kind::triangles) {
        add({b, a, c});
        add({a, d, c});
      } else if (shape.kind == Kind::quads) {
        add({b, a, d, c});
      } else {
        const Index e = ring * n + (k + 2) % n;
        add({e, b, a, d, c, e + n});
      }
    }
  return m;
}

/// A regular triangulation of the chart with edges of length h, without a triangle of n edges a side near its middle.
TestMesh lattice(const TestSurface& surface, double h, int n, int rings = 8) {
  TestMesh m;
  const int size = n + 2 * rings + 1;
  const auto at = [&](int i, int j) { return static_cast<Index>(i + rings) * size + j + rings; };
  m.vertices.resize(size * size, 3);
  for (int i = -rings; i <= n + rings; ++i)
    for (int j = -rings; j <= n + rings; ++j)
      m.vertices.row(at(i, j)) = surface.point(Vec2(0.1 + h * (i + 0.5 * j), 0.05 + h * j * std::sqrt(0.75)));
  for (int i = -rings; i < n + rings; ++i)
    for (int j = -rings; j < n + rings; ++j) {
      if (!(i >= 0 && j >= 0 && i + j < n)) m.faces.add(std::vector<Index>{at(i, j), at(i + 1, j), at(i, j + 1)});
      if (!(i >= 0 && j >= 0 && i + j + 2 <= n)) m.faces.add(std::vector<Index>{at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  for (int k = 0; k < n; ++k) m.hole.rim.push_back(at(k, 0));
  for (int k = 0; k < n; ++k) m.hole.rim.push_back(at(n - k, k));
  for (int k = 0; k < n; ++k) m.hole.rim.push_back(at(0, n - k));
  m.hole.corners = {0, n, 2 * n};
  return m;
}

/// Three cylinders of radius 1 about lines through (1, 1, 1), parallel to the axes, that end in a hole of the cube's corner; the
/// planar quadrants between them; and the true normal on side i.
std::pair<TestMesh, std::function<Vec3(int, Vec3)>> fillets(int n) {
  TestMesh m;
  std::vector<Vec3> points;
  const auto index = [&](const Vec3& p) {
    for (std::size_t k = 0; k < points.size(); ++k)
      if ((points[k] - p).norm() < 1e-9) return static_cast<Index>(k);
    points.push_back(p);
    return static_cast<Index>(points.size() - 1);
  };
  const double step = 1.3 / n;
  const int rings = 5;
  // The cylinder along axis a starts on the plane across axis a + 1 and ends on that across axis a + 2.
  const auto arc = [&](int a, int k, int ring) {
    const double angle = 0.5 * std::numbers::pi * k / n;
    return Vec3(Vec3::Ones() + ring * step * Vec3::Unit(a) - std::cos(angle) * Vec3::Unit((a + 1) % 3) -
                std::sin(angle) * Vec3::Unit((a + 2) % 3));
  };
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c,
                       const Vec3& d) {  // a quad with its normal outward, from the core
    const Vec3 n0 = (b - a).cross(d - a);
    std::vector<Index> f = {index(a), index(b), index(c), index(d)};
    if (n0.dot((a + c) / 2 - Vec3::Constant(5)) < 0) std::reverse(f.begin() + 1, f.end());
    m.faces.add(std::array{f[0], f[1], f[2]});
    m.faces.add(std::array{f[0], f[2], f[3]});
  };
  for (int a = 0; a < 3; ++a) {
    for (int k = 0; k < n; ++k)
      for (int ring = 0; ring < rings; ++ring)
        add(arc(a, k, ring), arc(a, k + 1, ring), arc(a, k + 1, ring + 1), arc(a, k, ring + 1));
    const Vec3 corner = arc(a, 0, 0), x = step * Vec3::Unit(a), y = step * Vec3::Unit((a + 2) % 3);
    for (int i = 0; i < rings; ++i)
      for (int j = 0; j < rings; ++j)
        add(corner + i * x + j * y, corner + (i + 1) * x + j * y, corner + (i + 1) * x + (j + 1) * y,
            corner + i * x + (j + 1) * y);
  }
  m.vertices.resize(static_cast<Index>(points.size()), 3);
  // seen from outside the cylinders follow each other as 0, 2, 1, each from its end to its start
  for (int j = 0; j < 3; ++j) {
    m.hole.corners[j] = static_cast<Index>(m.hole.rim.size());
    for (int k = n; k > 0; --k) m.hole.rim.push_back(index(arc((3 - j) % 3, k, 0)));
  }
  for (std::size_t k = 0; k < points.size(); ++k) m.vertices.row(static_cast<Index>(k)) = points[k];
  const auto normal = [](int side, Vec3 p) {
    const int a = (5 - side) % 3;  // side i starts at corner i + 1
    Vec3 d = p - Vec3::Ones();
    d[a] = 0;
    return Vec3(d.normalized());
  };
  return {m, normal};
}

double degrees(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi; }

/// Rms angle, degrees, between the estimated planes and the true ones, over points of the sides, ends included.
double normal_error(const MeshSides& s, const std::function<Vec3(Vec3)>& normal, int samples = 97) {
  double sum = 0;
  for (const Side& side : s.sides)
    for (int k = 0; k < samples; ++k) {
      const double t = static_cast<double>(k) / (samples - 1);
      sum += std::pow(degrees(side.normal(t), normal(side.c(t))), 2);
    }
  return std::sqrt(sum / (3 * samples));
}

double corner_mismatch(const MeshSides& s) {
  double worst = 0;
  for (int k = 0; k < 3; ++k) worst = std::max(worst, degrees(s.sides[(k + 1) % 3].normal(1), s.sides[(k + 2) % 3].normal(0)));
  return worst;
}

void add_noise(TestMesh& m, double share) {
  double edge = 0;
  const Index n = static_cast<Index>(m.hole.rim.size());
  for (Index k = 0; k < n; ++k) edge += (m.vertices.row(k) - m.vertices.row((k + 1) % n)).norm() / static_cast<double>(n);
  std::mt19937 random(7);
  for (Index k = 0; k < m.vertices.size(); ++k) {  // Box and Muller: the same numbers with every standard library
    const double u = (random() + 0.5) / 4294967296.0, v = (random() + 0.5) / 4294967296.0;
    m.vertices.data()[k] += share * edge * std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
  }
}

double difference(const MeshSides& a, const MeshSides& b) {
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    for (double t : {0.0, 0.17, 0.5, 0.93, 1.0}) {
      worst = std::max(worst, (a.sides[i].c(t) - b.sides[i].c(t)).norm());
      worst = std::max(worst, (a.sides[i].r(t) - b.sides[i].r(t)).norm());
    }
  return worst;
}

}  // namespace

TEST_CASE("mesh sides pass through their rim vertices at chord-length parameters") {
  const TestMesh m = make(torus(), {.edges = {40, 10, 5}, .grading = 1.6});
  const MeshSides s = m.sides();
  for (int i = 0; i < 3; ++i) {
    const Index from = m.hole.corners[(i + 1) % 3];
    const std::vector<double>& t = s.parameters[i];
    REQUIRE(static_cast<int>(t.size()) == std::array<int, 3>{10, 5, 40}[i] + 1);
    double length = 0;
    for (std::size_t k = 0; k < t.size(); ++k) {
      const Vec3 p = m.vertices.row((from + k) % m.hole.rim.size());
      CHECK((s.sides[i].c(t[k]) - p).norm() < 2e-15 * 4);
      if (k) length += (p - Vec3(m.vertices.row((from + k - 1) % m.hole.rim.size()))).norm();
    }
    CHECK(s.sides[i].c.breaks() == t);
    CHECK((s.sides[i].c(t[1]) - s.sides[i].c(0)).norm() == Approx(t[1] * length));
  }
}

TEST_CASE("planes of a mesh: r points outward, r x c' is the outer side, planes meet at the corners") {
  for (const TestSurface& surface : {sphere(), torus(), saddle()}) {
    const MeshSides s = make(surface, {}).sides();
    CHECK(corner_mismatch(s) < 1e-9);
    const Vec3 middle = surface.point((surface.corner[0] + surface.corner[1] + surface.corner[2]) / 3);
    for (const Side& side : s.sides)
      for (double t : {0.0, 0.2, 0.5, 0.8, 1.0}) {
        CHECK(side.normal(t).dot(surface.normal(side.c(t))) > 0.99);
        const Vec3 along = side.c.derivative_at(t).normalized(), across = side.r(t) - along * along.dot(side.r(t));
        CHECK(across.dot(side.c(t) - middle) > 0);
        CHECK(across.norm() / side.c.derivative_at(t).norm() == Approx(1).margin(0.3));
      }
  }
}

TEST_CASE("planes of a mesh converge with order two or more on sphere, torus and saddle") {
  const std::array<TestSurface, 3> surfaces = {sphere(), torus(), saddle()};
  for (const TestSurface& surface : surfaces) {
    double last = INFINITY;
    for (int n : {8, 16, 32}) {
      const MeshSides s = make(surface, {.edges = {n, n, n}, .depth = 1.6 / n}).sides();
      const double error = normal_error(s, surface.normal);
      CHECK(error < last / 3.5);
      last = error;
    }
    CHECK(last < 0.01);
  }
}

TEST_CASE("flat surroundings are exact, whatever the faces") {
  for (Kind kind : {Kind::triangles, Kind::quads, Kind::hexagons})
    for (int rings : {1, 2, 4}) {
      const MeshSides s = make(plane(), {.edges = {6, 4, 2}, .rings = rings, .kind = kind}).sides();
      CHECK(normal_error(s, plane().normal) < 1e-12 * 180 / std::numbers::pi);
      CHECK(s.surroundings_error < 1e-3);
    }
}

TEST_CASE("flat faces round a cube's corner keep their own planes") {
  // the corner of a cube cut off: every side lies in one face of it, four rows of faces wide
  TestMesh m;
  std::vector<Vec3> points;
  const auto index = [&](const Vec3& p) {
    for (std::size_t k = 0; k < points.size(); ++k)
      if ((points[k] - p).norm() < 1e-9) return static_cast<Index>(k);
    points.push_back(p);
    return static_cast<Index>(points.size() - 1);
  };
  const int n = 6, wide = 10;
  for (int side = 0; side < 3; ++side) {
    const auto at = [&](int x, int y) {
      return index(Vec3::Ones() * wide - x * Vec3::Unit((side + 1) % 3) - y * Vec3::Unit((side + 2) % 3));
    };
    for (int x = 0; x < wide; ++x)
      for (int y = 0; y < wide; ++y) {
        if (x + y >= n) m.faces.add(std::vector<Index>{at(x, y), at(x, y + 1), at(x + 1, y)});
        if (x + y + 1 >= n) m.faces.add(std::vector<Index>{at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)});
      }
  }
  for (Index f = 0; f < m.faces.size(); ++f)  // outer side: away from the origin
    std::swap(m.faces.corners[3 * f + 1], m.faces.corners[3 * f + 2]);
  for (int side = 0; side < 3; ++side) {
    m.hole.corners[side] = static_cast<Index>(m.hole.rim.size());
    for (int k = 0; k < n; ++k)
      m.hole.rim.push_back(index(Vec3::Ones() * wide - k * Vec3::Unit((side + 2) % 3) - (n - k) * Vec3::Unit((side + 1) % 3)));
  }
  m.vertices.resize(static_cast<Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) m.vertices.row(static_cast<Index>(k)) = points[k];
  // the rim must hold the faces' edges reversed
  bool reversed = false;
  for (Index f = 0; f < m.faces.size(); ++f)
    for (int c = 0; c < 3; ++c)
      if (m.faces[f][c] == m.hole.rim[1] && m.faces[f][(c + 1) % 3] == m.hole.rim[0]) reversed = true;
  REQUIRE(reversed);
  const MeshSides s = m.sides();
  for (int i = 0; i < 3; ++i)
    for (double t : {0.0, 0.3, 1.0}) CHECK(degrees(s.sides[i].normal(t), Vec3::Unit((i + 1) % 3)) < 1e-10);
  CHECK(corner_mismatch(s) == Approx(90));
  CHECK(s.surroundings_error < 1e-3);
}

TEST_CASE("a sharp edge beside the hole does not turn the planes") {
  // flat for some rows around the hole, then bent down
  const double h = 0.1, row = h * std::sqrt(0.75);
  const int n = 5;
  for (double angle : {20.0, 45.0, 80.0})
    for (int rows : {1, 2, 3}) {
      TestSurface box = plane();
      box.point = [=](Vec2 u) {
        const double x = u[0] - 0.1, y = u[1] - 0.05, s = std::sqrt(0.75);
        const double outside = std::max({-y, s * (x - n * h) + 0.5 * y, -s * x + 0.5 * y});
        return Vec3(x, y, -std::tan(angle * std::numbers::pi / 180) * std::max(outside - rows * row - 1e-12, 0.0));
      };
      const MeshSides s = lattice(box, h, n).sides();
      CAPTURE(angle, rows);
      CHECK(normal_error(s, [](Vec3) { return Vec3::UnitZ(); }) < 1e-9);
      CHECK(s.surroundings_error < 0.01);
    }
}

TEST_CASE("fillets that end at the corners: the jump of curvature there costs nothing") {
  // three cylinder fillets of radius 1 meet in a hole, with planar quadrants between them
  double last = INFINITY;
  for (int n : {8, 16, 32}) {
    const auto [m, normal] = fillets(n);
    const MeshSides s = m.sides();
    double error = 0;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k <= 60; ++k)
        error = std::max(error, degrees(s.sides[i].normal(k / 60.0), normal(i, s.sides[i].c(k / 60.0))));
    CHECK(error < last / 3.5);
    CHECK(corner_mismatch(s) < 1e-9);
    last = error;
  }
  CHECK(last < 1e-3);
}

TEST_CASE("thin triangles at most double the error of the planes") {
  for (const TestSurface& surface : {sphere(), torus()}) {
    const double regular = normal_error(make(surface, {.edges = {16, 16, 16}, .depth = 0.1}).sides(), surface.normal);
    const double shallow = normal_error(make(surface, {.edges = {16, 16, 16}, .depth = 0.1 / 50}).sides(), surface.normal);
    const double deep = normal_error(make(surface, {.edges = {800, 800, 800}, .depth = 0.1}).sides(), surface.normal);
    CAPTURE(regular, shallow, deep);
    CHECK(shallow < 2 * regular);
    CHECK(deep < 2 * regular);
  }
}

TEST_CASE("noise of 1% of the edge length leaves the planes of a sphere within 1 degree, and is reported") {
  TestMesh m = make(sphere(), {.edges = {32, 32, 32}, .depth = 1.6 / 32});
  add_noise(m, 0.01);
  const MeshSides s = m.sides();
  double sum = 0, count = 0;
  for (int i = 0; i < 3; ++i)
    for (double t : s.parameters[i]) {
      sum += std::pow(degrees(s.sides[i].normal(t), sphere().normal(s.sides[i].c(t))), 2);
      ++count;
    }
  const double error = std::sqrt(sum / count);
  CHECK(error < 0.7);
  CHECK(s.surroundings_error > error / 3);
  CHECK(s.surroundings_error < error * 3);
  // between the vertices no curve through them can do better than their chords, 0.8 degrees
  CHECK(normal_error(s, sphere().normal) < 1.1);
}

TEST_CASE("the reported error of the surroundings is of the size of the true one") {
  for (const TestSurface& surface : {sphere(), torus(), saddle()})
    for (int rings : {1, 4})
      for (int n : {6, 12, 24}) {
        const MeshSides s = make(surface, {.edges = {n, n, n}, .rings = rings, .depth = 1.6 / n}).sides();
        const double error = normal_error(s, surface.normal);
        CAPTURE(rings, n, error);
        CHECK(s.surroundings_error > error / 5);
        // one ring does not tell how the surface bends away: on these it happens to be known better than it can be told
        CHECK(s.surroundings_error < error * (rings == 1 ? 10 : 5));
      }
}

TEST_CASE("curve and cross derivative are twice continuously differentiable, q is the normal curvature across") {
  const MeshSides s = make(sphere(), {.edges = {12, 12, 12}, .depth = 0.13}).sides();
  for (const Side& side : s.sides) {
    for (std::size_t k = 1; k + 1 < side.c.breaks().size(); ++k)
      for (int order : {1, 2}) {
        const double t = side.c.breaks()[k], e = 1e-9;
        CHECK((side.c.derivative_at(t - e, order) - side.c.derivative_at(t + e, order)).norm() < 1e-5);
        CHECK((side.r.derivative_at(t - e, order) - side.r.derivative_at(t + e, order)).norm() < 1e-5);
      }
    for (double t : {0.0, 0.4, 1.0}) {
      const Vec3 n = side.normal(t), r = side.r(t), dc = side.c.derivative_at(t);
      CHECK(n.dot(side.q(t)) == Approx(-r.squaredNorm()).epsilon(0.01));
      // on the unit sphere n' = c', so that n . r' = -r . c' = 0 where r is square to c'
      CHECK(n.dot(side.c.derivative_at(t, 2)) == Approx(-dc.squaredNorm()).epsilon(0.01));
    }
  }
}

TEST_CASE("how well the curvature across is known is told, in 1 / length, and does not depend on the size") {
  for (double noise : {0.0, 1e-3, 1e-2}) {
    TestMesh m = make(sphere(), {.edges = {24, 24, 24}, .depth = 0.07});
    add_noise(m, noise);
    const MeshSides s = m.sides();
    double error = 0, told = 0;  // mean squares
    for (const Side& side : s.sides) {
      told += std::pow(side.curvature_error, 2) / 3;
      for (int k = 0; k <= 24; ++k) {
        const double t = side.rim[k], curvature = side.normal(t).dot(side.q(t)) / side.r(t).squaredNorm();
        error += std::pow(curvature + 1, 2) / 75;
      }
    }
    CAPTURE(noise, std::sqrt(error), std::sqrt(told));
    CHECK(told > error / 16);
    CHECK(told < error * 16);
    m.vertices *= 1e3;
    CHECK(m.sides().sides[1].curvature_error == Approx(1e-3 * s.sides[1].curvature_error).epsilon(1e-4));
  }
}

TEST_CASE("a rim that zigzags along the surface keeps its planes") {
  const TestSurface straight = sphere();
  TestSurface wavy = straight;
  wavy.point = [=](Vec2 u) { return straight.point(u + 0.012 * Vec2(std::sin(37 * u[1]), std::cos(41 * u[0]))); };
  const MeshSides s = make(wavy, {.edges = {24, 24, 24}, .depth = 0.07}).sides();
  CHECK(normal_error(s, straight.normal) < 0.05);
}

TEST_CASE("sides of one and two edges bend with the surface") {
  for (int n : {1, 2}) {
    double last = INFINITY;
    for (double h : {0.1, 0.05}) {
      const TestMesh m = lattice(sphere(), h, n);
      const MeshSides s = m.sides();
      const double error = normal_error(s, sphere().normal);
      CHECK(error < last / 3.5);
      double height = 0;
      for (const Side& side : s.sides)
        for (double t : {0.25, 0.5, 0.75}) height = std::max(height, std::abs(side.c(t).norm() - 1));
      CHECK(height < 0.02 * h * h);  // a chord would be n^2 h^2 / 8 inside
      last = error;
    }
    CHECK(last < 0.01);
  }
}

TEST_CASE("three faces are surroundings enough") {
  TestMesh m;
  m.vertices.resize(4, 3);
  m.vertices << 1, 0, 0, 0, 1, 0, 0, 0, 1, -0.3, -0.3, -0.3;
  for (int k = 0; k < 3; ++k) m.faces.add(std::vector<Index>{(k + 1) % 3, k, 3});
  m.hole = {{0, 1, 2}, {0, 1, 2}};
  const MeshSides s = m.sides();
  for (const Side& side : s.sides)
    for (double t : {0.0, 0.5, 1.0}) {
      CHECK(side.normal(t).norm() == Approx(1));
      CHECK(side.normal(t).dot(side.c(t) + Vec3::Constant(0.1)) > 0);
    }
  CHECK(s.surroundings_error > 1);
}

TEST_CASE("mesh sides do not depend on numbering, place, turn or size") {
  const TestMesh m = make(torus(), {.edges = {9, 7, 5}});
  const MeshSides s = m.sides();
  SECTION("vertices and faces in another order") {
    TestMesh p = m;
    std::vector<Index> to(m.vertices.rows());
    for (std::size_t k = 0; k < to.size(); ++k) to[k] = static_cast<Index>((k * 31 + 11) % to.size());
    REQUIRE(to.size() % 31 != 0);
    for (std::size_t k = 0; k < to.size(); ++k) p.vertices.row(to[k]) = m.vertices.row(k);
    for (Index& v : p.hole.rim) v = to[v];
    p.faces = Faces();
    for (Index f = m.faces.size() - 1; f >= 0; --f) {
      std::vector<Index> face;
      for (Index v : m.faces[f]) face.push_back(to[v]);
      std::rotate(face.begin(), face.begin() + f % 3, face.end());
      p.faces.add(face);
    }
    CHECK(difference(s, p.sides()) < 1e-7);
  }
  SECTION("another corner first") {
    TestMesh p = m;
    std::rotate(p.hole.rim.begin(), p.hole.rim.begin() + m.hole.corners[1], p.hole.rim.end());
    p.hole.corners = {0, m.hole.corners[2] - m.hole.corners[1], static_cast<Index>(m.hole.rim.size()) - m.hole.corners[1]};
    MeshSides q = p.sides();
    std::rotate(q.sides.begin(), q.sides.begin() + 2, q.sides.end());
    CHECK(difference(s, q) < 1e-7);
  }
  SECTION("scale 1e-6 to 1e6, turned and far from the origin") {
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    for (double scale : {1e-6, 1e6}) {
      const Vec3 shift = scale * Vec3(100, -300, 50);
      TestMesh p = m;
      for (Index k = 0; k < p.vertices.rows(); ++k) p.vertices.row(k) = scale * turn * Vec3(m.vertices.row(k)) + shift;
      MeshSides q = p.sides();
      for (Side& side : q.sides) {
        const auto back = [&](const PiecewisePolynomial& f, const Vec3& from) {
          return PiecewisePolynomial::fit(
              [&](std::span<const double> t, std::span<double> out) {
                for (std::size_t k = 0; k < t.size(); ++k)
                  Eigen::Map<Vec3>(out.data() + 3 * k) = turn.transpose() * (f(t[k]) - from) / scale;
              },
              3, 1e-9, 5, 8);
        };
        side = {back(side.c, shift), back(side.r, Vec3::Zero()), {}};
      }
      CHECK(difference(s, q) < 1e-6);
    }
  }
}

TEST_CASE("only what is near the hole counts") {
  TestMesh m = make(sphere(), {});
  const Index n = m.vertices.rows();
  Points more(n + 3, 3);
  more << m.vertices, Points::Constant(3, 3, 50);
  more(n + 1, 0) = NAN;
  m.vertices = more;
  m.faces.add(std::vector<Index>{n, n + 1, n + 2});
  CHECK(difference(make(sphere(), {}).sides(), m.sides()) < 1e-12);
}

TEST_CASE("mesh sides refuse what cannot be read, with the place") {
  const TestMesh good = make(sphere(), {});
  const auto refusal = [](const TestMesh& m) {
    try {
      m.sides();
    } catch (const Refusal& r) {
      return r.where();
    }
    return std::vector<Index>();
  };
  TestMesh m = good;
  m.vertices(30, 1) = NAN;  // next to the rim
  CHECK(refusal(m) == std::vector<Index>{30});
  m = good;
  m.vertices(5, 1) = INFINITY;
  CHECK(refusal(m) == std::vector<Index>{5});
  m = good;
  m.vertices.row(5) = m.vertices.row(6);
  CHECK(refusal(m) == std::vector<Index>{5, 6});
  m = good;
  for (Index k = 0; k < m.vertices.rows(); ++k) m.vertices.row(k) = Vec3(m.vertices.row(k)).sum() * Vec3(1, 2, 3);
  CHECK(!refusal(m).empty());
  m = good;
  m.faces = Faces();
  for (Index f = 2; f < good.faces.size(); ++f) m.faces.add(good.faces[f]);
  CHECK(refusal(m) == std::vector<Index>{0, 1});
}

namespace {

/// The corner of a box whose three edges are rounded with radius 1: strips of single long faces, and the flat sides of the box.
TestMesh rounded_box(int segments, double length) {
  TestMesh m;
  std::vector<Vec3> points;
  const auto add = [&](const Vec3& p) {
    points.push_back(p);
    return static_cast<Index>(points.size()) - 1;
  };
  std::array<Index, 3> corner;
  for (int k = 0; k < 3; ++k) corner[k] = add(Vec3::Unit(k));
  std::array<std::vector<Index>, 3> near,
      far;  // along side k, from corner k to corner k + 1; the strip runs along the third axis
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = Vec3::Unit(k), b = Vec3::Unit((k + 1) % 3), back = -length * Vec3::Unit((k + 2) % 3);
    for (int j = 0; j <= segments; ++j) {
      const double angle = std::numbers::pi / 2 * j / segments;
      const Vec3 p = std::cos(angle) * a + std::sin(angle) * b;
      near[k].push_back(j == 0 ? corner[k] : j == segments ? corner[(k + 1) % 3] : add(p));
      far[k].push_back(add(p + back));
    }
    for (int j = 0; j < segments; ++j) m.faces.add(std::vector<Index>{near[k][j + 1], near[k][j], far[k][j], far[k][j + 1]});
    m.hole.corners[k] = static_cast<Index>(m.hole.rim.size());
    m.hole.rim.insert(m.hole.rim.end(), near[k].begin(), near[k].end() - 1);
  }
  for (int k = 0; k < 3; ++k) {  // the flat side across axis k, between the strips that start and end at its corner
    const Index opposite = add(Vec3::Unit(k) - length * (Vec3::Ones() - Vec3::Unit(k)));
    m.faces.add(std::vector<Index>{corner[k], far[(k + 2) % 3].back(), opposite, far[k].front()});
  }
  m.vertices.resize(static_cast<Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) m.vertices.row(static_cast<Index>(k)) = points[k];
  return m;
}

}  // namespace

TEST_CASE("strips of long faces tell their planes, as beside a bevelled corner") {
  for (int segments : {4, 8, 16})
    for (double length : {2.0, 10.0, 100.0}) {
      INFO(segments << " segments, length " << length);
      const MeshSides sides = rounded_box(segments, length).sides();
      double worst = 0;
      for (const Side& side : sides.sides)
        for (int k = 0; k <= 20; ++k) {
          const Vec3 p = side.c(k / 20.0);
          worst = std::max(
              worst, std::atan2(side.normal(k / 20.0).cross(p).norm(), side.normal(k / 20.0).dot(p)) * 180 / std::numbers::pi);
        }
      CHECK(worst < 2);
      CHECK(sides.surroundings_error < 3);
    }
}

namespace {

/// Root mean square angle, degrees, of the planes at the rim's vertices against those of a ball of radius 1 at the origin.
double off_the_ball(const MeshSides& sides, bool corners) {
  double squares = 0, count = 0;
  for (int i = 0; i < 3; ++i)
    for (double t : sides.parameters[i]) {
      if (!corners && (t == 0 || t == 1)) continue;
      squares += std::pow(degrees_between(sides.sides[i].normal(t), sides.sides[i].c(t)), 2);
      ++count;
    }
  return std::sqrt(squares / count);
}

}  // namespace

TEST_CASE("beside a bevel of one segment the reported error is of the size of the true one") {
  for (double length : {1.0, 2.0, 10.0}) {
    const MeshSides sides = rounded_box(1, length).sides();
    const double error = off_the_ball(sides, true);
    CAPTURE(length, error);
    CHECK(sides.surroundings_error > error / 2);
    CHECK(sides.surroundings_error < error * 2);
  }
}

TEST_CASE("beside a bevel of two segments and more, where it ends in planes, these and its turns tell its planes exactly") {
  for (int segments : {2, 3, 4, 6})
    for (double length : {0.4, 1.0, 2.0, 10.0}) {
      const MeshSides sides = rounded_box(segments, length).sides();
      CAPTURE(segments, length);
      CHECK(off_the_ball(sides, true) < 1e-4);
      CHECK(sides.surroundings_error < 1e-2);
    }
}

namespace {

/// rounded_box() with sections that are superellipses of an exponent, those of circles 2, and stretched.
TestMesh bevelled_box(int segments, double length, double exponent, const Vec3& stretch) {
  TestMesh box = rounded_box(segments, length);
  for (Index k = 0; k < box.vertices.rows(); ++k)
    for (int x = 0; x < 3; ++x)
      if (const double at = box.vertices(k, x); at > 0) box.vertices(k, x) = at < 1e-9 ? 0 : std::pow(at, 2 / exponent);
  box.vertices *= stretch.asDiagonal();
  return box;
}

/// Root mean square angle, degrees, of the planes at the rim's vertices against its own.
double off_bevel(const MeshSides& sides, double exponent, const Vec3& stretch) {
  double squares = 0, count = 0;
  for (int i = 0; i < 3; ++i)
    for (double t : sides.parameters[i]) {
      const Vec3 p = sides.sides[i].c(t).cwiseQuotient(stretch).cwiseAbs();
      const Vec3 normal = p.array().pow(exponent - 1).matrix().cwiseQuotient(stretch);
      squares += std::pow(degrees_between(sides.sides[i].normal(t), normal), 2);
      ++count;
    }
  return std::sqrt(squares / count);
}

}  // namespace

TEST_CASE("beside a bevel of two segments and more with different widths the planes are exact") {
  for (const Vec3& stretch : {Vec3(1, 1, 1.3), Vec3(1, 2, 0.7)})
    for (int segments : {2, 3, 4})
      for (double length : {0.43, 0.5, 3.0}) {
        const MeshSides sides = bevelled_box(segments, length, 2, stretch).sides();
        CAPTURE(segments, length, stretch);
        CHECK(off_bevel(sides, 2, stretch) < 1e-4);
        CHECK(sides.surroundings_error < 1e-2);
      }
}

TEST_CASE("beside a bevel of few segments with another section the reported error is of the size of the true one") {
  const Vec3 stretch(1, 1.4, 0.8);
  for (int segments : {3, 4})
    for (double exponent : {1.5, 1.8, 2.3, 2.9})
      for (double length : {0.43, 3.0}) {
        const MeshSides sides = bevelled_box(segments, length, exponent, stretch).sides();
        const double error = off_bevel(sides, exponent, stretch);
        CAPTURE(segments, exponent, length, error);
        CHECK(sides.surroundings_error > error / 1.6);
        CHECK(sides.surroundings_error < error * 3.6);
      }
}

TEST_CASE("a bevel of two segments leaves the plane beside it smoothly, may do so, or has an edge there") {
  const auto said = [](double exponent) { return bevelled_box(2, 1, exponent, Vec3::Ones()).sides().surroundings_error; };
  const auto leans = [](double of_turn) {  // exponent at which the outer faces lean by this much of the turn in the middle
    const double lean = std::numbers::pi / 2 * of_turn / (1 + 2 * of_turn);
    return std::log(0.5) / std::log(1 / (1 + std::tan(lean)));
  };
  CHECK(said(leans(0.76)) > 2 * said(leans(0.74)));
  CHECK(said(leans(1.98)) > 2 * said(leans(2.02)));
}

TEST_CASE("beside strips of equal facets the planes are those of the facets' mean, which is exact there") {
  for (int segments : {5, 8, 12})
    for (double length : {3.0, 10.0, 100.0}) {
      CAPTURE(segments, length);
      CHECK(off_the_ball(rounded_box(segments, length).sides(), false) < 1e-9);
    }
}

TEST_CASE("one row of faces is not taken for all there is to know where it leans by much") {
  const TestSurface ring = torus();
  const MeshSides s = make(ring, {.edges = {7, 7, 7}, .rings = 4, .depth = 1.6 / 7}).sides();
  CHECK(normal_error(s, ring.normal) < 0.9);
}
