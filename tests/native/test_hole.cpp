#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <complex>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

#include "test_refusals.h"
#include "tripatch/hole/hole.h"
#include "tripatch/hole/outer_borders.h"

using namespace tripatch;

namespace {

using Vec2 = Eigen::Vector2d;
using Map = std::function<Vec3(Vec2)>;
using Loop = std::vector<Index>;

struct Model {
  Points vertices;
  Faces faces;
  Mesh mesh() const { return {vertices, faces}; }
};

Vec3 flat(Vec2 p) { return {p[0], p[1], 0}; }

Model model(const std::vector<Vec3>& vertices, const std::vector<std::vector<Index>>& faces) {
  Model m;
  m.vertices.resize(vertices.size(), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) m.vertices.row(k) = vertices[k];
  for (const auto& face : faces) m.faces.add(face);
  return m;
}

/// Three rings of triangles around a rim that runs counter-clockwise in the plane, mapped to space. The rim is 0 .. n-1; new faces
/// run along it in this order.
Model surround(const std::vector<Vec2>& rim, const Map& map = flat, double ring = 0.15) {
  const Index n = static_cast<Index>(rim.size());
  Vec2 center = Vec2::Zero();
  double length = 0;
  for (Index k = 0; k < n; ++k) {
    const Vec2 step = rim[(k + 1) % n] - rim[k];
    center += step.norm() * (rim[k] + rim[(k + 1) % n]) / 2;
    length += step.norm();
  }
  center /= length;
  std::vector<Vec3> vertices;
  std::vector<std::vector<Index>> faces;
  for (int j = 0; j <= 3; ++j)
    for (Index k = 0; k < n; ++k) vertices.push_back(map(center + (1 + ring * j) * (rim[k] - center)));
  for (Index j = 0; j < 3; ++j)
    for (Index k = 0; k < n; ++k) {
      const Index a = j * n + k, b = j * n + (k + 1) % n;
      faces.push_back({b, a, b + n});
      faces.push_back({a, a + n, b + n});
    }
  return model(vertices, faces);
}

/// A polygon with counts[i] edges on its side i, spaced by `spacing`.
std::vector<Vec2> polygon(
    const std::vector<Vec2>& corners, const std::vector<int>& counts,
    const std::function<double(int, double)>& spacing = [](int, double t) { return t; }) {
  std::vector<Vec2> points;
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (int k = 0; k < counts[i]; ++k)
      points.push_back(corners[i] + spacing(i, double(k) / counts[i]) * (corners[(i + 1) % corners.size()] - corners[i]));
  return points;
}

std::vector<Vec2> regular(int corners, int edges_per_side, double radius = 1) {
  std::vector<Vec2> c;
  for (int k = 0; k < corners; ++k)
    c.push_back(radius * Vec2(std::cos(2 * std::numbers::pi * k / corners), std::sin(2 * std::numbers::pi * k / corners)));
  return polygon(c, std::vector<int>(corners, edges_per_side));
}

/// A smooth rim r(angle).
std::vector<Vec2> polar(int n, const std::function<double(double)>& r) {
  std::vector<Vec2> points;
  for (int k = 0; k < n; ++k) {
    const double a = 2 * std::numbers::pi * k / n;
    points.push_back(r(a) * Vec2(std::cos(a), std::sin(a)));
  }
  return points;
}

Loop first_loop(const Model& m) {
  Loop rim(m.vertices.rows() / 4);
  std::iota(rim.begin(), rim.end(), Index{0});
  return rim;
}

std::vector<Index> corner_vertices(const Hole& hole) {
  std::vector<Index> c;
  for (Index k : hole.corners) c.push_back(hole.rim[k]);
  return c;
}

std::vector<Index> detected(const Model& m) { return corner_vertices(make_hole(m.mesh(), first_loop(m), std::nullopt)); }

struct Answer {
  std::string code;
  Loop where;
};
Answer refusal(const std::function<void()>& act) {
  try {
    act();
  } catch (const CodedRefusal& r) {
    return {code_of(r.message()), r.where()};
  }
  return {"", {}};
}
Answer refused(const Model& m, const Loop& rim, std::optional<std::array<Index, 3>> corners = std::nullopt) {
  return refusal([&] { make_hole(m.mesh(), rim, corners); });
}
Answer refused(const Model& m) { return refused(m, first_loop(m)); }

const std::vector<Vec2> triangle = {{-0.1, -0.2}, {1.1, 0.1}, {0.4, 0.9}};

Model triangular(int a, int b, int c) { return surround(polygon(triangle, {a, b, c})); }

// ---- surfaces of the ten holes that this project is measured on

Map sphere(const Eigen::Matrix3d& corners, std::vector<Vec2>& uv) {
  const Vec3 z = (corners.col(0) + corners.col(1) + corners.col(2)).normalized();
  const Vec3 x = Vec3(0.3, -0.2, 1).cross(z).normalized(), y = z.cross(x);
  uv.clear();
  for (int k = 0; k < 3; ++k)
    uv.emplace_back(corners.col(k).dot(x) / corners.col(k).dot(z), corners.col(k).dot(y) / corners.col(k).dot(z));
  return [=](Vec2 p) -> Vec3 { return (z + p[0] * x + p[1] * y).normalized(); };
}
Vec3 torus(Vec2 p) {
  const double d = 2 + 0.8 * std::cos(p[1]);
  return {d * std::cos(p[0]), d * std::sin(p[0]), 0.8 * std::sin(p[1])};
}
Vec3 saddle(Vec2 p) { return {p[0], p[1], p[0] * p[0] - p[1] * p[1]}; }
Vec3 helicoid(Vec2 p) { return {p[0], p[1] * std::cos(1.2 * p[0]), p[1] * std::sin(1.2 * p[0])}; }
Vec3 franke(Vec2 p) {
  const double x = 9 * p[0], y = 9 * p[1];
  const auto sq = [](double a) { return a * a; };
  return {p[0], p[1],
          0.75 * std::exp(-(sq(x - 2) + sq(y - 2)) / 4) + 0.75 * std::exp(-sq(x + 1) / 49 - (y + 1) / 10) +
              0.5 * std::exp(-(sq(x - 7) + sq(y - 3)) / 4) - 0.2 * std::exp(-sq(x - 4) - sq(y - 7))};
}

/// Three cylinders that round off the edges of a cube, radii r, and end at a hole at its corner (equal radii: a sphere is missing).
Model fillets(int n, Vec3 r, Loop& corners) {
  const int axes[3][3] = {{0, 2, 1}, {2, 1, 0}, {1, 0, 2}};  // of the cylinder, of the plane where it starts, where it ends
  std::vector<Vec3> vertices;
  std::vector<std::vector<Index>> faces;
  std::map<std::array<long, 3>, Index> known;
  const auto vertex = [&](const Vec3& p) {
    const auto [it, fresh] =
        known.try_emplace({std::lround(p[0] * 1e7), std::lround(p[1] * 1e7), std::lround(p[2] * 1e7)}, vertices.size());
    if (fresh) vertices.push_back(p);
    return it->second;
  };
  const double step = 1.3 * r.mean() / n;
  const auto quads = [&](int na, int nb, const std::function<Vec3(int, int)>& p) {
    for (int a = 0; a < na; ++a)
      for (int b = 0; b < nb; ++b)
        faces.push_back({vertex(p(a, b)), vertex(p(a + 1, b)), vertex(p(a + 1, b + 1)), vertex(p(a, b + 1))});
  };
  const auto arc = [&](int i, int k) -> Vec3 {
    const auto [ax, p0, p1] = axes[i];
    const double s = double(k) / n, angle = s * std::numbers::pi / 2;
    Vec3 p;
    p[p1] = r[ax] * (1 - std::sin(angle));
    p[p0] = r[ax] * (1 - std::cos(angle));
    p[ax] = r[p1] + (r[p0] - r[p1]) * s * s * (3 - 2 * s);
    return p;
  };
  corners.clear();
  for (int i = 0; i < 3; ++i) corners.push_back(vertex(arc(i, 0)));
  for (int i = 0; i < 3; ++i) {
    const auto [ax, p0, p1] = axes[i];
    quads(n, 4, [&, ax = ax](int a, int b) -> Vec3 { return arc(i, a) + b * step * Vec3::Unit(ax); });
    // the plane quadrant beyond the start of this arc, between its own strip and that of the arc before
    quads(4, 4, [&, ax = ax, p1 = p1](int a, int b) -> Vec3 {
      return arc(i, 0) + a * step * Vec3::Unit(ax) + b * step * Vec3::Unit(p1);
    });
  }
  return model(vertices, faces);
}

/// A grid of nx by ny quads in the plane but for some.
Model grid(int nx, int ny, const std::set<std::pair<int, int>>& missing) {
  std::vector<Vec3> vertices;
  std::vector<std::vector<Index>> faces;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) vertices.emplace_back(i, j, 0);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Index a = j * (nx + 1) + i;
      if (!missing.count({i, j})) faces.push_back({a, a + 1, a + nx + 2, a + nx + 1});
    }
  return model(vertices, faces);
}

std::vector<Loop> replaced_by(const std::vector<Loop>& loops, const std::vector<Index>& label) {
  std::vector<Loop> out = loops;
  for (Loop& loop : out)
    for (Index& v : loop) v = label[v];
  return out;
}

}  // namespace

// ---------------------------------------------------------------------------------------------------- find_holes

TEST_CASE("holes come shortest first, from the lowest vertex, in the direction of new faces") {
  const Model m = grid(7, 5, {{1, 1}, {4, 2}, {5, 2}, {2, 3}});
  const auto holes = find_holes(m.faces);
  REQUIRE(holes.size() == 4);
  CHECK(holes[0] == Loop{9, 10, 18, 17});
  CHECK(holes[1] == Loop{26, 27, 35, 34});
  CHECK(holes[2] == Loop{20, 21, 22, 30, 29, 28});
  CHECK(holes[3].size() == 24);
  CHECK(holes[3][0] == 0);
  CHECK(holes[3][1] == 8);  // around the outside the other way
  CHECK(find_holes(Faces{}).empty());
}

TEST_CASE("a closed mesh has no hole") {
  const Model m = model({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  CHECK(find_holes(m.faces).empty());
  CHECK(refusal([&] { find_hole(m.mesh()); }).code == "no_border");
}

TEST_CASE("holes that touch at vertices are told apart by the faces between them") {
  SECTION("at one vertex") {
    const auto holes = find_holes(grid(6, 6, {{1, 1}, {2, 2}}).faces);
    REQUIRE(holes.size() == 3);
    CHECK(holes[0] == Loop{8, 9, 16, 15});
    CHECK(holes[1] == Loop{16, 17, 24, 23});
  }
  SECTION("four in a ring, at four vertices, around one face that touches only them") {
    const auto holes = find_holes(grid(6, 6, {{2, 1}, {1, 2}, {3, 2}, {2, 3}}).faces);
    REQUIRE(holes.size() == 5);
    for (int k = 0; k < 4; ++k) CHECK(holes[k].size() == 4);
  }
  SECTION("a hole that encloses a face hanging at one vertex") {
    const auto holes = find_holes(grid(6, 6, {{1, 1}, {2, 1}, {3, 1}, {1, 2}, {3, 2}, {1, 3}, {2, 3}}).faces);
    std::size_t edges = 0;
    for (const Loop& loop : holes) {
      CHECK(std::set<Index>(loop.begin(), loop.end()).size() == loop.size());
      edges += loop.size();
    }
    CHECK(edges == 24 + 16);
  }
  SECTION("two discs that touch at two vertices enclose a hole") {
    // two half rings between the circles 0..3 (inner) and outer vertices; they share only vertices 0 and 2
    const Model m = model({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 2, 0}, {0, -2, 0}}, {{0, 4, 2, 1}, {2, 5, 0, 3}});
    const auto holes = find_holes(m.faces);
    REQUIRE(holes.size() == 2);
    CHECK(holes[0] == Loop{0, 1, 2, 3});
    CHECK(holes[1] == Loop{0, 5, 2, 4});
  }
}

TEST_CASE("a flipped face does not hide the hole") {
  Model m = grid(4, 4, {{1, 1}, {2, 1}});
  std::vector<std::vector<Index>> faces;
  for (Index f = 0; f < m.faces.size(); ++f) faces.emplace_back(m.faces[f].begin(), m.faces[f].end());
  std::reverse(faces[1].begin(), faces[1].end());  // below the hole
  m = model({}, faces);
  const auto holes = find_holes(m.faces);
  REQUIRE(holes.size() == 2);
  CHECK(holes[0] == Loop{6, 7, 8, 13, 12, 11});
}

TEST_CASE("any heap of faces gives simple loops of edges with one face") {
  std::mt19937 random(7);
  for (int round = 0; round < 400; ++round) {
    const Index n = 4 + random() % 12;
    Faces faces;
    const int count = 1 + random() % 30;
    for (int f = 0; f < count; ++f) {
      Loop face(random() % 6);
      for (Index& v : face) v = random() % n;  // repeated vertices, two corners and less included
      faces.add(face);
    }
    std::map<std::pair<Index, Index>, int> uses;
    for (Index f = 0; f < faces.size(); ++f)
      for (std::size_t k = 0; k < faces[f].size(); ++k) {
        const Index a = faces[f][k], b = faces[f][(k + 1) % faces[f].size()];
        if (a != b) ++uses[std::minmax(a, b)];
      }
    for (const Loop& loop : find_holes(faces)) {
      CHECK(loop.size() >= 3);
      CHECK(std::set<Index>(loop.begin(), loop.end()).size() == loop.size());
      for (std::size_t k = 0; k < loop.size(); ++k) {
        auto use = uses.find(std::minmax(loop[k], loop[(k + 1) % loop.size()]));
        REQUIRE(use != uses.end());
        CHECK(use->second == 1);
        uses.erase(use);  // no edge in two loops
      }
    }
  }
}

TEST_CASE("the loops do not depend on the order of the faces nor, but for names, on that of the vertices") {
  const Model m = grid(7, 7, {{1, 1}, {2, 2}, {4, 4}, {4, 5}, {5, 1}});
  const auto holes = find_holes(m.faces);
  std::mt19937 random(3);
  std::vector<Index> order(m.faces.size()), label(m.vertices.rows());
  std::iota(order.begin(), order.end(), Index{0});
  std::iota(label.begin(), label.end(), Index{0});
  std::shuffle(order.begin(), order.end(), random);
  Faces shuffled;
  for (Index f : order) shuffled.add(m.faces[f]);
  CHECK(find_holes(shuffled) == holes);
  std::shuffle(label.begin(), label.end(), random);
  for (Index& v : shuffled.corners) v = label[v];
  auto expected = replaced_by(holes, label);
  for (Loop& loop : expected) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  auto found = find_holes(shuffled);
  std::sort(expected.begin(), expected.end());
  std::sort(found.begin(), found.end());
  CHECK(found == expected);
}

TEST_CASE("negative vertex indices are refused") {
  Faces faces;
  faces.add(Loop{0, 1, -1});
  CHECK_THROWS_AS(find_holes(faces), InvalidArgument);
}

// ---------------------------------------------------------------------------------------------------- corner detection

TEST_CASE("the corners of the measured holes are found") {
  const int n = GENERATE(2, 4, 8, 16, 32);
  const std::vector<int> even(3, n);
  std::vector<Vec2> uv;
  const std::vector<Index> expected = {0, n, 2 * n};
  SECTION("an octant of a sphere") {
    const Map map = sphere(Eigen::Matrix3d::Identity(), uv);
    CHECK(detected(surround(polygon(uv, even), map, 0.6 / n)) == expected);
  }
  SECTION("ten degrees of a sphere") {
    Eigen::Matrix3d c;
    const double a = 10 * std::numbers::pi / 180 / std::sqrt(3);
    for (int k = 0; k < 3; ++k)
      c.col(k) << std::sin(a) * std::cos(2 * std::numbers::pi * k / 3), std::sin(a) * std::sin(2 * std::numbers::pi * k / 3),
          std::cos(a);
    const Map map = sphere(c, uv);
    CHECK(detected(surround(polygon(uv, even), map)) == expected);
  }
  SECTION("torus") {
    CHECK(detected(surround(polygon({{-0.5, -0.6}, {0.9, 0.1}, {-0.1, 1.9}}, even), torus, std::min(1.5 / n, 0.2))) == expected);
  }
  SECTION("saddle") {
    std::vector<Vec2> c;
    for (int k = 0; k < 3; ++k)
      c.push_back(0.8 * Vec2(std::cos(2 * std::numbers::pi * k / 3 + 0.4), std::sin(2 * std::numbers::pi * k / 3 + 0.4)));
    CHECK(detected(surround(polygon(c, even), saddle, 2.0 / n)) == expected);
  }
  if (n >= 8) SECTION("Franke's function") {
      // so steep that its outer border has three corners of its own, too
      CHECK(corner_vertices(find_hole(
                surround(polygon({{0.1, 0.1}, {0.9, 0.15}, {0.35, 0.9}}, even), franke, 4.0 / 3 / n).mesh())) == expected);
    }
  SECTION("rounded cube corners") {
    for (const Vec3& r : {Vec3(1, 1, 1), Vec3(1, 0.7, 0.5)}) {
      Loop corners;
      const Model m = fillets(n, r, corners);
      std::sort(corners.begin(), corners.end());
      auto found = corner_vertices(find_hole(m.mesh()));
      CHECK(found[0] == corners[0]);
      std::sort(found.begin(), found.end());
      CHECK(found == corners);
    }
  }
  if (n >= 8) SECTION("helicoid with graded sides") {
      const std::vector<int> counts = {std::max(2, 40 * n / 16), std::max(2, 10 * n / 16), std::max(2, 5 * n / 16)};
      const auto graded = [](int i, double t) { return i == 0 ? std::pow(t, 1.6) : i == 1 ? t : std::pow(t, 0.7); };
      CHECK(detected(surround(polygon({{0, -0.5}, {4, -0.2}, {1.2, 1}}, counts, graded), helicoid, 1.0 / n)) ==
            std::vector<Index>{0, counts[0], counts[0] + counts[1]});
    }
}

TEST_CASE("few edges are enough") {
  CHECK(detected(triangular(1, 1, 1)) == std::vector<Index>{0, 1, 2});
  CHECK(detected(triangular(2, 1, 1)) == std::vector<Index>{0, 2, 3});
  CHECK(detected(triangular(1, 2, 2)) == std::vector<Index>{0, 1, 3});
  CHECK(detected(triangular(3, 1, 1)) == std::vector<Index>{0, 3, 4});
  CHECK(detected(triangular(2, 2, 2)) == std::vector<Index>{0, 2, 4});
  CHECK(detected(triangular(20, 20, 1)) == std::vector<Index>{0, 20, 40});
  // a sliver: two corners closer to each other than the window
  CHECK(detected(surround(polygon({{0, 0}, {0.02, 0}, {0.01, 1}}, {1, 50, 50}))) == std::vector<Index>{0, 1, 51});
}

TEST_CASE("corners do not depend on start, direction, motion or scale") {
  const double scale = GENERATE(1e-6, 1.0, 1e6);
  const Vec3 axis = Vec3(0.2, -0.5, 0.9).normalized();
  const Eigen::AngleAxisd turn(2.1, axis);
  const auto moved = [&](Vec2 p) -> Vec3 { return scale * (turn * (torus(p) + Vec3(3, -7, 2))); };
  const Model m = surround(polygon({{-0.5, -0.6}, {0.9, 0.1}, {-0.1, 1.9}}, {9, 14, 11}), moved, 0.1);
  const Loop rim = first_loop(m);
  const Hole expected = make_hole(m.mesh(), rim, std::nullopt);
  CHECK(corner_vertices(expected) == std::vector<Index>{0, 9, 23});
  for (std::size_t start : {5, 9, 20})
    for (bool reversed : {false, true}) {
      Loop other = rim;
      std::rotate(other.begin(), other.begin() + start, other.end());
      if (reversed) std::reverse(other.begin(), other.end());
      const Hole hole = make_hole(m.mesh(), other, std::nullopt);
      CHECK(hole.rim == expected.rim);
      CHECK(hole.corners == expected.corners);
    }
}

TEST_CASE("a mesh turned inside out has the same corners, its rim the other way") {
  Model m = triangular(5, 7, 6);
  Faces turned;
  for (Index f = 0; f < m.faces.size(); ++f) turned.add(Loop(m.faces[f].rbegin(), m.faces[f].rend()));
  m.faces = turned;
  const Hole hole = make_hole(m.mesh(), first_loop(m), std::nullopt);
  CHECK(corner_vertices(hole) == std::vector<Index>{0, 12, 5});
  CHECK(hole.rim[1] == 17);
}

TEST_CASE("noise and uneven spacing do not move the corners") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int round = 0; round < 40; ++round) {
    // edges between a third and three times each other; every vertex off its place by up to 8% of the mean edge
    std::vector<Vec2> rim;
    Loop expected;
    const std::vector<Vec2> corners = {{0, 0}, {1, 0.1}, {0.3, 0.9}};
    for (int i = 0; i < 3; ++i) {
      expected.push_back(rim.size());
      std::vector<double> s = {0};
      const int count = 12 + random() % 30;
      for (int k = 0; k < count; ++k) s.push_back(s.back() + std::pow(3, unit(random)));
      for (int k = 0; k < count; ++k) rim.push_back(corners[i] + s[k] / s.back() * (corners[(i + 1) % 3] - corners[i]));
    }
    const double edge = 3.0 / rim.size();
    const Model m = surround(rim, [&](Vec2 p) -> Vec3 {
      const double z = unit(random), y = unit(random), x = unit(random);  // compilers order arguments differently
      return Vec3(p[0], p[1], 0.3 * p[0] * p[1]) + 0.08 / std::sqrt(3) * edge * Vec3(x, y, z);
    });
    CHECK(detected(m) == expected);
  }
}

TEST_CASE("a corner rounded over a few edges is one corner") {
  std::vector<Vec2> rim;
  const std::vector<Vec2> center = {{0, 0}, {1, 0}, {0.5, std::sqrt(0.75)}};
  for (int i = 0; i < 3; ++i) {
    const Vec2 next = center[(i + 1) % 3] - center[i];
    for (int k = 0; k <= 4; ++k) {  // 120 degrees at radius 0.02
      const double a = std::numbers::pi * (5.0 / 6 + 2.0 / 3 * i + k / 6.0);
      rim.push_back(center[i] + 0.02 * Vec2(std::cos(a), std::sin(a)));
    }
    const Vec2 start = rim.back();
    for (int k = 1; k < 40; ++k) rim.push_back(start + k / 40.0 * next);
  }
  CHECK(detected(surround(rim)) == std::vector<Index>{2, 46, 90});
}

TEST_CASE("rims without three clear corners are refused, with the corners that they have") {
  for (int edges : {1, 2, 8, 30}) {
    const Answer square = refused(surround(regular(4, edges)));
    CHECK(square.code == "not_three_corners");
    CHECK(square.where == Loop{0, edges, 2 * edges, 3 * edges});
    const Answer pentagon = refused(surround(regular(5, edges)));
    CHECK(pentagon.code == "not_three_corners");
    CHECK(pentagon.where == Loop{0, edges, 2 * edges, 3 * edges, 4 * edges});
  }
  for (int n : {9, 12, 20, 64, 1000}) CHECK(refused(surround(regular(n, 1))).code == "no_clear_corners");
  // round, but with edges of very different length
  CHECK(refused(surround(polar(40, [](double) { return 1.0; }), [](Vec2 p) -> Vec3 {
          const double a = std::atan2(p[1], p[0]), b = a + 0.6 * std::sin(a);
          return {p.norm() * std::cos(b), p.norm() * std::sin(b), 0};
        })).code == "no_clear_corners");
  CHECK(refused(surround(polar(90, [](double a) { return 1 + 0.1 * std::cos(3 * a); }))).code == "no_clear_corners");
  std::vector<Vec2> half = {{0, -1}, {0, 1}};  // half a disc
  for (int k = 1; k < 20; ++k) half.emplace_back(-std::sin(std::numbers::pi * k / 20), std::cos(std::numbers::pi * k / 20));
  CHECK(refused(surround(half)).code == "not_three_corners");
  std::vector<Vec2> drop = {{2, 0}};
  for (int k = 0; k <= 24; ++k)
    drop.emplace_back(std::cos(std::numbers::pi * (1.0 / 3 + 4.0 / 3 * k / 24)),
                      std::sin(std::numbers::pi * (1.0 / 3 + 4.0 / 3 * k / 24)));
  const Answer one = refused(surround(drop));
  CHECK(one.code == "not_three_corners");
  CHECK(one.where == Loop{0});
  CHECK(refused(surround(regular(5, 4))).where.size() == 5);
  std::vector<Vec2> star;
  for (int k = 0; k < 40; ++k)
    star.push_back((k % 2 ? 0.7 : 1.3) * Vec2(std::cos(std::numbers::pi * k / 20), std::sin(std::numbers::pi * k / 20)));
  CHECK(refused(surround(star)).code == "too_many_corners");
}

TEST_CASE("where the rim turns the other way there is no corner") {
  // a notch of the surroundings reaches into the hole on one side
  std::vector<Vec2> rim;
  for (Vec2 p : polygon({{0, 0}, {1, 0}, {0.5, 0.9}}, {30, 30, 30})) {
    if (rim.size() < 30) p[1] += 0.1 * std::exp(-60 * (p[0] - 0.5) * (p[0] - 0.5));
    rim.push_back(p);
  }
  CHECK(detected(surround(rim)) == std::vector<Index>{0, 30, 60});
  // a concave corner
  CHECK(detected(surround(polygon({{0, 0}, {0.5, 0.25}, {1, 0}, {0.5, 0.9}}, {8, 8, 16, 16}))) == std::vector<Index>{0, 16, 32});
}

TEST_CASE("a rim of ten thousand edges") {
  const Model m = triangular(5000, 3000, 2000);
  CHECK(detected(m) == std::vector<Index>{0, 5000, 8000});
  CHECK(refused(surround(regular(10000, 1))).code == "no_clear_corners");
}

// ---------------------------------------------------------------------------------------------------- given corners

TEST_CASE("given corners win, whatever the turn") {
  const Model round = surround(regular(24, 1));
  const Loop rim = first_loop(round);
  const Hole hole = make_hole(round.mesh(), rim, {{17, 3, 20}});
  CHECK(hole.rim[0] == 17);
  CHECK(hole.rim[1] == 18);
  CHECK(hole.corners == std::array<Index, 3>{0, 3, 10});
  CHECK(corner_vertices(hole) == std::vector<Index>{17, 20, 3});
  CHECK(corner_vertices(make_hole(round.mesh(), {rim.rbegin(), rim.rend()}, {{17, 3, 20}})) == std::vector<Index>{17, 20, 3});
  // on a rim of three edges they only say which is the first
  CHECK(corner_vertices(make_hole(triangular(1, 1, 1).mesh(), {0, 1, 2}, {{2, 1, 0}})) == std::vector<Index>{2, 0, 1});
}

TEST_CASE("corners that are not three vertices of the rim") {
  const Model m = triangular(4, 4, 4);
  const Loop rim = first_loop(m);
  CHECK(refused(m, rim, {{0, 4, 15}}).code == "corner_not_on_rim");
  CHECK(refused(m, rim, {{0, 4, 15}}).where == Loop{15});
  CHECK_THROWS_AS(make_hole(m.mesh(), rim, {{0, 4, 4}}), InvalidArgument);
  CHECK_THROWS_AS(make_hole(m.mesh(), rim, {{4, 0, 4}}), InvalidArgument);
  CHECK_THROWS_AS(make_hole(m.mesh(), rim, {{0, 4, 1000}}), InvalidArgument);
  CHECK_THROWS_AS(make_hole(m.mesh(), rim, {{0, 4, -1}}), InvalidArgument);
}

TEST_CASE("sides run from corner to corner, both included") {
  const Hole hole = make_hole(triangular(2, 3, 1).mesh(), {0, 1, 2, 3, 4, 5}, std::nullopt);
  CHECK(hole.side(2) == Loop{0, 1, 2});
  CHECK(hole.side(0) == Loop{2, 3, 4, 5});
  CHECK(hole.side(1) == Loop{5, 0});
}

// ---------------------------------------------------------------------------------------------------- what is refused

TEST_CASE("rims that are none") {
  const Model m = grid(6, 6, {{2, 2}, {3, 2}});
  const Loop rim = {16, 17, 18, 25, 24, 23};
  CHECK(make_hole(m.mesh(), rim, {{16, 18, 24}}).rim == rim);
  CHECK(refused(m, {16, 17}).code == "rim_too_short");
  CHECK(refused(m, {16, 17, 18, 25, 24, 23, 16}).code == "rim_passes_twice");
  CHECK(refused(m, {16, 17, 18, 25, 24, 23, 16}).where == Loop{16});
  CHECK(refused(m, {16, 18, 25, 24, 23}).where == Loop{16, 18});  // no such edge
  CHECK(refused(m, {16, 18, 25, 24, 23}).code == "no_face_at_edge");
  CHECK(refused(m, {8, 9, 16, 15}).code == "faces_on_both_sides");
  CHECK_THROWS_AS(make_hole(m.mesh(), {16, 17, 1000}, std::nullopt), InvalidArgument);
  CHECK_THROWS_AS(make_hole(m.mesh(), {16, 17, -1}, std::nullopt), InvalidArgument);
}

TEST_CASE("a non-manifold edge on the rim, flipped neighbors") {
  Model m = triangular(3, 3, 3);
  m.faces.add(Loop{2, 1, 30});
  m.faces.add(Loop{2, 1, 31});
  CHECK(refused(m).code == "non_manifold_edge");
  CHECK(refused(m).where == Loop{1, 2});
  const auto flipped = [](Index face) {
    Model f = triangular(3, 3, 3);
    std::swap(f.faces.corners[3 * face], f.faces.corners[3 * face + 1]);
    return f;
  };
  // face 2k is at the rim edge from k to k + 1, face 2k + 1 touches the rim in vertex k only
  CHECK(refused(flipped(4)).where == Loop{2, 3});
  CHECK(refused(flipped(4)).code == "faces_flipped");
  CHECK(refused(flipped(5)).where == Loop{2, 12});
  CHECK(refused(flipped(5)).code == "face_flipped");
  CHECK(refused(flipped(18 * 2 + 5)).code == "");  // two rings away
}

TEST_CASE("numbers that are not finite: near the hole refused, far away no matter") {
  Model m = triangular(4, 4, 4);
  m.vertices(40, 1) = std::nan("");
  CHECK(detected(m) == std::vector<Index>{0, 4, 8});
  m.vertices(17, 2) = INFINITY;
  CHECK(refused(m).code == "vertex_not_finite");
  CHECK(refused(m).where == Loop{17});
  m = triangular(4, 4, 4);
  m.vertices(3, 0) = std::nan("");
  CHECK(refused(m, first_loop(m), {{0, 4, 8}}).where == Loop{3});
}

TEST_CASE("rim vertices at the same place") {
  Model m = triangular(4, 4, 4);
  m.vertices.row(6) = m.vertices.row(5);
  CHECK(refused(m).code == "edge_without_length");
  CHECK(refused(m).where == Loop{5, 6});
  m = triangular(4, 4, 4);
  m.vertices.row(9) = m.vertices.row(2);
  CHECK(refused(m).code == "vertices_at_one_place");
  CHECK(refused(m).where == Loop{2, 9});
}

TEST_CASE("surroundings without area") {
  Model m = triangular(2, 2, 2);
  m.faces = Faces();
  for (Index k = 0; k < 6; ++k) m.faces.add(Loop{(k + 1) % 6, k, k + 6});
  for (Index k = 0; k < 6; ++k) m.vertices.row(k + 6) = m.vertices.row(k);
  CHECK(refused(m).code == "faces_without_area");
  CHECK(corner_vertices(make_hole(m.mesh(), {0, 1, 2, 3, 4, 5}, {{0, 2, 4}})) == std::vector<Index>{0, 2, 4});
}

TEST_CASE("a region to be replaced counts as not there") {
  const Model m = grid(8, 8, {});
  std::vector<Index> region;
  for (Index j = 2; j < 5; ++j)
    for (Index i = 2; i < 6; ++i) region.push_back(8 * j + i);
  const Loop rim = {20, 21, 22, 23, 24, 33, 42, 51, 50, 49, 48, 47, 38, 29};
  CHECK(corner_vertices(make_hole(m.mesh(), rim, {{20, 24, 50}}, region)) == std::vector<Index>{20, 24, 50});
  CHECK(refusal([&] { make_hole(m.mesh(), rim, std::nullopt, region); }).code == "not_three_corners");
  CHECK(refused(m, rim).code == "faces_on_both_sides");
  CHECK_THROWS_AS(make_hole(m.mesh(), rim, std::nullopt, {64}), InvalidArgument);
}

// ---------------------------------------------------------------------------------------------------- find_hole

TEST_CASE("the only hole with three corners") {
  CHECK(corner_vertices(find_hole(triangular(5, 4, 3).mesh())) == std::vector<Index>{0, 5, 9});
  // the outer border is a triangle as well, but turns the other way
  CHECK(corner_vertices(find_hole(triangular(1, 1, 1).mesh())) == std::vector<Index>{0, 1, 2});
}

TEST_CASE("outer borders turn the other way as a whole") {
  for (const Model& m : {triangular(1, 1, 1), triangular(5, 4, 3), surround(regular(4, 3))}) {
    const std::vector<Loop> loops = find_holes(m.faces);
    REQUIRE(loops.size() == 2);
    for (const Loop& loop : loops) CHECK(is_outer_border(m.mesh(), loop) == (loop[0] != 0));  // the rim comes first
  }
}

TEST_CASE("the border of a single face is no hole") {
  const Model triangle = model({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const Model square = model({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}});
  for (const Model& alone : {triangle, square}) CHECK(refusal([&] { find_hole(alone.mesh()); }).code == "loose_face");
}

TEST_CASE("no or several holes with three corners") {
  Model two = triangular(2, 2, 2);
  const Index n = two.vertices.rows();
  Points both(2 * n, 3);
  both << two.vertices, two.vertices.rowwise() + Eigen::RowVector3d(5, 0, 0);
  two.vertices = both;
  for (Index f = 0, count = two.faces.size(); f < count; ++f) {
    Loop face(two.faces[f].begin(), two.faces[f].end());
    for (Index& v : face) v += n;
    two.faces.add(face);
  }
  const Answer choice = refusal([&] { find_hole(two.mesh()); });
  CHECK(choice.code == "several_three_cornered_holes");
  CHECK(choice.where == Loop{0, 24});
  // trouble at one leaves the other
  two.vertices(n, 0) = std::nan("");
  CHECK(find_hole(two.mesh()).rim[0] == 0);

  // the outer border is not what is meant
  const Answer none = refusal([&] { find_hole(surround(regular(4, 3)).mesh()); });
  CHECK(none.code == "not_three_corners");
  CHECK(none.where == Loop{0, 3, 6, 9});
  const Answer squares = refusal([&] { find_hole(grid(7, 3, {{1, 1}, {3, 1}, {4, 1}}).mesh()); });
  CHECK(squares.code == "no_hole_fillable");
  const Model disc = model({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  CHECK(refusal([&] { find_hole(disc.mesh()); }).code == "only_outer_borders");
}

TEST_CASE("the outer border is not filled where the hole cannot be") {
  // its three edges would do for a rim
  Model m = triangular(1, 1, 1);
  CHECK(find_hole(m.mesh()).rim == Loop{0, 1, 2});
  m.vertices(1, 2) = std::nan("");
  CHECK(refusal([&] { find_hole(m.mesh()); }).code == "vertex_not_finite");
}

TEST_CASE("faces that name missing vertices") {
  Model m = triangular(2, 2, 2);
  m.faces.add(Loop{0, 1, 1000});
  CHECK_THROWS_AS(find_hole(m.mesh()), InvalidArgument);
  CHECK_THROWS_AS(make_hole(m.mesh(), first_loop(m), std::nullopt), InvalidArgument);
}
