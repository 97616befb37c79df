// Tangent planes estimated from a plain mesh, against surfaces whose normals are known everywhere.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <random>

#include "tripatch/boundary/mesh_sides.h"

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
  for (int k = 0; k < 3; ++k) s.corner[k] = 0.8 * Vec2(std::cos(0.4 + 2 * M_PI * k / 3), std::sin(0.4 + 2 * M_PI * k / 3));
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

double degrees(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI; }

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
    m.vertices.data()[k] += share * edge * std::sqrt(-2 * std::log(u)) * std::cos(2 * M_PI * v);
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
        CHECK(side.r(t).dot(side.c(t) - middle) > 0);
        CHECK(side.r(t).norm() / side.c.derivative_at(t).norm() == Approx(1).margin(0.3));
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
      CHECK(normal_error(s, plane().normal) < 1e-12 * 180 / M_PI);
      CHECK(s.surroundings_error < 1e-10);
    }
}

TEST_CASE("noise of 1% of the edge length leaves the planes of a sphere within 1.2 degrees") {
  TestMesh m = make(sphere(), {.edges = {32, 32, 32}, .depth = 1.6 / 32});
  add_noise(m, 0.01);
  CHECK(normal_error(m.sides(), sphere().normal) < 1.2);
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
  m.vertices(30, 1) = NAN;  // beside the rim
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
