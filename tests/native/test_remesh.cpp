#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "tripatch/output/domain_mesh.h"
#include "tripatch/output/remesh.h"
#include "tripatch/triangulation/min_weight_triangulation.h"

using namespace tripatch;

namespace {

/// z (or all of x) over the plane; counts what it is asked.
class Graph final : public Surface {
public:
  explicit Graph(std::function<Vec3(double, double)> f) : f_(std::move(f)) {}
  void evaluate(const double* b, Index n, int order, double* out) const override {
    REQUIRE(order == 0);
    ++batches;
    points += n;
    for (Index k = 0; k < n; ++k) Eigen::Map<Vec3>(out + 3 * k) = f_(b[3 * k], b[3 * k + 1]);
  }
  mutable Index batches = 0, points = 0;

private:
  std::function<Vec3(double, double)> f_;
};

const auto flat = [](double u, double v) { return Vec3(u, v, 0); };
const auto wave = [](double u, double v) { return Vec3(u, v, 0.2 * std::sin(3 * u) * std::cos(2 * v)); };

using Rim = std::vector<Eigen::Vector2d>;

Rim circle(int n, double radius = 1, bool backwards = false, Eigen::Vector2d middle = {0, 0}) {
  Rim rim;
  for (int k = 0; k < n; ++k) {
    const double a = (backwards ? -1 : 1) * 2 * std::numbers::pi * k / n;
    rim.push_back(middle + radius * Eigen::Vector2d(std::cos(a), std::sin(a)));
  }
  return rim;
}

/// A polygon of loops, started from a rough fill in the plane.
PlanePolygon polygon(const std::vector<Rim>& loops, const Graph& surface) {
  PlanePolygon p;
  RimSurroundings rim;
  Index n = 0;
  for (const Rim& loop : loops) {
    if (n) rim.islands.push_back(n);
    n += static_cast<Index>(loop.size());
  }
  Points plane = Points::Zero(n, 3);
  Index row = 0;
  for (const Rim& loop : loops)
    for (const auto& uv : loop) plane.row(row++) << uv[0], uv[1], 0;
  p.uv = plane.leftCols<2>();
  p.points = surface.positions(plane);
  p.rim = n;
  p.triangles = min_weight_triangulation(plane, rim).triangles;
  surface.batches = surface.points = 0;
  return p;
}

double twice_area(const PlaneTriangulation& m, const std::array<Index, 3>& t) {
  const Eigen::RowVector2d a = m.uv.row(t[1]) - m.uv.row(t[0]), b = m.uv.row(t[2]) - m.uv.row(t[0]);
  return a[0] * b[1] - a[1] * b[0];
}

std::map<std::pair<Index, Index>, int> directed_edges(const std::vector<std::array<Index, 3>>& triangles) {
  std::map<std::pair<Index, Index>, int> directed;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k) ++directed[{t[k], t[(k + 1) % 3]}];
  return directed;
}

/// What must hold of every result; empty when it does.
std::string flaw(const PlanePolygon& p, const PlaneTriangulation& m, const Graph& surface) {
  if (m.uv.topRows(p.uv.rows()) != p.uv || m.points.topRows(p.uv.rows()) != p.points) return "the polygon's rows";
  double area = 0, before = 0;
  for (const auto& t : m.triangles) {
    if (!(twice_area(m, t) > 0)) return "a triangle turned over";
    area += twice_area(m, t);
  }
  for (const auto& t : p.triangles) before += twice_area(m, t);
  if (std::abs(area - before) > 1e-9 * before) return "the polygon is not covered once";
  const auto directed = directed_edges(m.triangles), given = directed_edges(p.triangles);
  std::set<std::pair<Index, Index>> joined;
  for (const auto& [a, b] : p.joined) joined.insert({std::min(a, b), std::max(a, b)});
  bool doubled = false;
  for (const auto& [edge, count] : directed) {
    if (count != 1) return "an edge twice in one direction";
    const bool inner = directed.count({edge.second, edge.first});
    if (!inner && (!given.count(edge) || given.count({edge.second, edge.first}))) return "a border edge that is none of the rim";
    doubled |= inner && joined.count({std::min(edge.first, edge.second), std::max(edge.first, edge.second)});
  }
  for (const auto& [edge, count] : given)
    if (!given.count({edge.second, edge.first}) && !directed.count(edge)) return "a rim edge without a triangle";
  if (doubled != m.doubles_edges) return "doubles_edges";
  Points b = Points::Zero(m.uv.rows(), 3);
  b.leftCols<2>() = m.uv;
  const Index inside = m.uv.rows() - p.uv.rows();
  if (inside && (surface.positions(b) - m.points).bottomRows(inside).cwiseAbs().maxCoeff() > 1e-12) return "not on the surface";
  return "";
}

double smallest_angle(const PlaneTriangulation& m) {
  double least = 180;
  for (const auto& t : m.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = m.points.row(t[k]), u = m.points.row(t[(k + 1) % 3]), v = m.points.row(t[(k + 2) % 3]);
      least = std::min(least, std::atan2((u - p).cross(v - p).norm(), (u - p).dot(v - p)) * 180 / std::numbers::pi);
    }
  return least;
}

}  // namespace

TEST_CASE("a round hole gets triangles as large as its rim's edges ask for") {
  for (int n : {3, 4, 6, 12, 40, 150, 400}) {
    for (const auto& f : {std::function<Vec3(double, double)>(flat), std::function<Vec3(double, double)>(wave)}) {
      const Graph surface(f);
      const PlanePolygon p = polygon({circle(n)}, surface);
      const PlaneTriangulation m = remesh(p, {}, surface);
      const Index batches = surface.batches, points = surface.points;
      INFO(n << ": " << m.triangles.size() << " triangles, smallest angle " << smallest_angle(m) << ", " << batches
             << " batches of " << points << " points");
      CHECK(flaw(p, m, surface) == "");
      CHECK(smallest_angle(m) > 24);
      const auto count = static_cast<double>(m.triangles.size());
      CHECK(count < 0.35 * n * n + 2 * n);
      if (n >= 40) CHECK(count > 0.13 * n * n);
      CHECK(batches < 50);
      CHECK(points < 4 * m.uv.rows() + 50);
      if (n >= 12) CHECK(triangles_wanted(p, {}) == Approx(count).epsilon(0.4));
    }
  }
}

TEST_CASE("jagged and uneven rims stay valid, their triangles as good as they allow") {
  std::mt19937 random(11);
  const Graph surface(wave);
  for (int trial = 0; trial < 30; ++trial) {
    const int n = 5 + static_cast<int>(random() % 120);
    Rim rim;
    double angle = 0;
    std::vector<double> steps;
    for (int k = 0; k < n; ++k) steps.push_back(std::exp((trial % 3) * static_cast<double>(random() % 1000) / 1000));
    double all = 0;
    for (double s : steps) all += s;
    for (int k = 0; k < n; ++k) {
      const double radius = 1 + 2.0 / n * static_cast<double>(random() % 1000) / 1000;
      rim.push_back(radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      angle += 2 * std::numbers::pi * steps[k] / all;
    }
    const PlanePolygon p = polygon({rim}, surface);
    const PlaneTriangulation m = remesh(p, {}, surface);
    INFO(trial << ": rim " << n << ", " << m.triangles.size() << " triangles, smallest angle " << smallest_angle(m));
    CHECK(flaw(p, m, surface) == "");
    CHECK(static_cast<double>(m.triangles.size()) <= triangles_per_squared_edge * n * n);
    CHECK(smallest_angle(m) > 8);
  }
}

TEST_CASE("rims of very unequal edges are bounded") {
  const Graph surface(flat);
  Rim rim;  // a square with one side of 60 edges, the others of 4; and one with an edge of a millionth
  for (int k = 0; k < 60; ++k) rim.push_back({k / 60.0, 0});
  for (int k = 0; k < 4; ++k) rim.push_back({1, k / 4.0});
  for (int k = 0; k < 4; ++k) rim.push_back({1 - k / 4.0, 1});
  for (int k = 0; k < 4; ++k) rim.push_back({0, 1 - k / 4.0});
  const PlanePolygon p = polygon({rim}, surface);
  const PlaneTriangulation m = remesh(p, {}, surface);
  INFO(m.triangles.size());
  CHECK(flaw(p, m, surface) == "");
  CHECK(m.triangles.size() < 2500);
  CHECK(smallest_angle(m) > 12);
  const PlanePolygon tiny = polygon({{{0, 0}, {1e-6, 0}, {1, 1}, {0, 1}}}, surface);
  const PlaneTriangulation few = remesh(tiny, {}, surface);
  CHECK(flaw(tiny, few, surface) == "");
  CHECK(few.triangles.size() <= 5 * 16);
}

TEST_CASE("where a surface is torn or folds the number of triangles of a polygon stays bounded") {
  const Graph surface([](double u, double v) { return Vec3(u, v, v > 0.1 ? 30 * std::sin(40 * u) : 0); });
  const PlanePolygon p = polygon({circle(24)}, surface);
  const PlaneTriangulation m = remesh(p, {}, surface);
  CHECK(flaw(p, m, surface) == "");
  CHECK(m.triangles.size() <= 5 * 24 * 24);
}

TEST_CASE("a triangulation ends where it has more triangles and a larger area than it may") {
  const Graph surface([](double u, double v) { return Vec3(u, v, (1 - u * u - v * v) * std::sin(40 * u)); });
  const PlanePolygon p = polygon({circle(48)}, surface);
  const PlaneTriangulation whole = remesh(p, {}, surface);
  const Index points = std::exchange(surface.points, 0);
  REQUIRE(whole.triangles.size() > 2000);
  CHECK_FALSE(whole.unfinished);
  const PlaneTriangulation cut = remesh(p, {}, surface, {500, 5});
  CHECK(cut.unfinished);
  CHECK(cut.triangles.size() > 500);
  CHECK(surface.points < points / 4);
  for (const MostTriangles& most : {MostTriangles{500, 1e6}, {100'000, 5}}) {
    const PlaneTriangulation same = remesh(p, {}, surface, most);
    CHECK_FALSE(same.unfinished);
    CHECK(same.points == whole.points);
  }
}

TEST_CASE("islands and strips of the plane are remeshed") {
  const Graph surface(wave);
  for (double off : {0.0, 0.3}) {
    const PlanePolygon p = polygon({circle(60), circle(12, 0.2, true, {off, off}), circle(9, 0.15, true, {-0.5, 0.2})}, surface);
    const PlaneTriangulation m = remesh(p, {}, surface);
    CHECK(flaw(p, m, surface) == "");
    CHECK(smallest_angle(m) > 25);
  }
}

TEST_CASE("edges that the mesh has already are halved or turned away") {
  const Graph surface(flat);
  for (int n : {4, 5, 20}) {
    PlanePolygon p = polygon({circle(n)}, surface);
    for (Index a = 0; a < n; ++a)
      for (Index b = 0; b < a; ++b) p.joined.push_back({a, b});  // all of them
    for (std::optional<int> resolution : {std::optional<int>(), std::optional<int>(1)}) {
      const PlaneTriangulation m = remesh(p, resolution, surface);
      CHECK(flaw(p, m, surface) == "");
      CHECK_FALSE(m.doubles_edges);
    }
  }
}

TEST_CASE("creases stay") {
  const Graph surface([](double u, double v) { return Vec3(u, v, -std::abs(u)); });
  Rim rim = circle(40);
  PlanePolygon p = polygon({rim}, surface);
  const PlaneTriangulation without = remesh(p, {}, surface);
  // the crease from vertex 10 (0, 1) to 30 (0, -1): the two halves triangulated apart
  p.triangles.clear();
  for (int side = 0; side < 2; ++side) {
    std::vector<Index> rows;
    for (int k = 0; k <= 20; ++k) rows.push_back((10 + 20 * side + k) % 40);
    Points half = Points::Zero(21, 3);
    for (int k = 0; k <= 20; ++k) half.row(k) << p.uv(rows[k], 0), p.uv(rows[k], 1), 0;
    for (const auto& t : min_weight_triangulation(half).triangles) p.triangles.push_back({rows[t[0]], rows[t[1]], rows[t[2]]});
  }
  p.creases = {{10, 30}};
  const PlaneTriangulation m = remesh(p, {}, surface);
  CHECK(flaw(p, m, surface) == "");
  CHECK(m.creases.size() >= 8);
  double length = 0;
  const auto directed = directed_edges(m.triangles);
  for (const auto& [a, b] : m.creases) {
    CHECK(std::abs(m.uv(a, 0)) + std::abs(m.uv(b, 0)) < 1e-12);
    CHECK(directed.count({a, b}));
    length += (m.uv.row(a) - m.uv.row(b)).norm();
  }
  CHECK(length == Approx(2));
  CHECK(smallest_angle(m) > 20);
  for (const auto& t : m.triangles)  // none goes across
    CHECK_FALSE((std::min({m.uv(t[0], 0), m.uv(t[1], 0), m.uv(t[2], 0)}) < -1e-9 &&
                 std::max({m.uv(t[0], 0), m.uv(t[1], 0), m.uv(t[2], 0)}) > 1e-9));
}

TEST_CASE("rounding of the size of a hole does not choose among triangles of a part of it") {
  const Graph surface(flat);
  Rim rim;  // of eight squares, whose diagonals are as good
  for (int k = 0; k < 4; ++k) rim.push_back({k, 0});
  for (int k = 0; k < 2; ++k) rim.push_back({4, k});
  for (int k = 4; k > 0; --k) rim.push_back({k, 2});
  for (int k = 2; k > 0; --k) rim.push_back({0, k});
  PlanePolygon p = polygon({rim}, surface);
  const auto rounded = [&](double by, unsigned seed) {
    PlanePolygon q = p;
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> noise(-by, by);
    for (double& x : q.points.reshaped()) x += noise(random);
    q.uv = q.points.leftCols<2>();
    return q;
  };
  const double size = 2000, rounding = 1e-10 * size;
  const auto changes = [&](double by) {
    int count = 0;
    for (unsigned seed = 0; seed < 10; ++seed) {
      const PlanePolygon q = rounded(by, seed);
      if (remesh(q, 1, surface).triangles != remesh(p, 1, surface).triangles) ++count;
    }
    return count;
  };
  CHECK(changes(rounding) > 0);
  p.size = size;
  CHECK(changes(rounding) == 0);
  CHECK(changes(100 * rounding) > 0);
}

TEST_CASE("resolution sets how many triangles a polygon gets inside") {
  const Graph surface(wave);
  const PlanePolygon p = polygon({circle(48)}, surface);
  const PlaneTriangulation none = remesh(p, 1, surface), coarse = remesh(p, 4, surface), same = remesh(p, 16, surface),
                           fine = remesh(p, 64, surface);
  for (const auto* m : {&none, &coarse, &same, &fine}) CHECK(flaw(p, *m, surface) == "");
  CHECK(none.uv.rows() == 48);
  CHECK(coarse.triangles.size() < 200);
  CHECK(fine.triangles.size() > 2500);
  CHECK(fine.triangles.size() < 9000);
  CHECK(same.triangles.size() > 300);
  CHECK(same.triangles.size() < 700);
  CHECK(triangles_wanted(p, 1000) > 1e6);
}

TEST_CASE("a resolution far above the edges of a polygon is met by lattices inside, around islands and creases") {
  const Graph surface(wave);
  PlanePolygon p = polygon({circle(48), circle(12, 0.2, true, {0.3, 0.3})}, surface);
  std::set<std::pair<Index, Index>> rim;
  for (const auto& [edge, count] : directed_edges(p.triangles)) rim.insert(edge);
  for (const auto& t : p.triangles)
    for (int k = 0; k < 3 && p.creases.empty(); ++k)
      if (rim.count({t[(k + 1) % 3], t[k]})) p.creases = {{t[k], t[(k + 1) % 3]}};
  REQUIRE(p.creases.size() == 1);
  const double chord = (p.uv.row(p.creases[0][0]) - p.uv.row(p.creases[0][1])).norm();
  const PlaneTriangulation m = remesh(p, 300, surface), few = remesh(p, 150, surface);
  CHECK(flaw(p, m, surface) == "");
  CHECK(m.triangles.size() > 3 * few.triangles.size());
  CHECK(m.triangles.size() < 5 * few.triangles.size());
  CHECK(smallest_angle(m) > 0.5 * smallest_angle(few));
  double crease = 0;
  const auto directed = directed_edges(m.triangles);
  for (const auto& [a, b] : m.creases) {
    CHECK(directed.count({a, b}));
    crease += (m.uv.row(a) - m.uv.row(b)).norm();
  }
  CHECK(crease == Approx(chord));
}

TEST_CASE("a remeshed polygon is the same moved and scaled, and every time") {
  const Graph surface(wave);
  const PlanePolygon p = polygon({circle(40)}, surface);
  const PlaneTriangulation m = remesh(p, {}, surface), again = remesh(p, {}, surface);
  CHECK(m.uv == again.uv);
  CHECK(m.triangles == again.triangles);
  for (double scale : {1e-6, 1e6}) {
    PlanePolygon q = p;
    q.uv = scale * (p.uv.rowwise() + Eigen::RowVector2d(3, -1));
    q.points = scale * p.points;
    const Graph larger([&](double u, double v) { return Vec3(scale * wave(u / scale - 3, v / scale + 1)); });
    const PlaneTriangulation other = remesh(q, {}, larger);
    CHECK(static_cast<double>(other.triangles.size()) == Approx(static_cast<double>(m.triangles.size())).epsilon(0.1));
    CHECK(smallest_angle(other) > 30);
  }
  PlanePolygon bad = p;
  std::swap(bad.triangles[0][0], bad.triangles[0][1]);
  CHECK_THROWS_AS(remesh(bad, {}, surface), InvalidArgument);
  CHECK_THROWS_AS(remesh(p, 0, surface), InvalidArgument);
}

TEST_CASE("a domain that is not as large as what lies over it gets the triangles of one that is") {
  const Graph surface(wave);
  const PlanePolygon p = polygon({circle(40)}, surface);
  const PlaneTriangulation m = remesh(p, {}, surface);
  for (const double unit : {1e-3, 1.0 / 64, 64.0, 1e4}) {
    const Graph there([&](double u, double v) { return Vec3(wave(unit * u, unit * v)); });
    PlanePolygon small = p;
    small.uv /= unit;
    small.unit = unit;
    const PlaneTriangulation same = remesh(small, {}, there);
    INFO(unit << ": " << same.triangles.size() << " triangles for " << m.triangles.size());
    CHECK(same.triangles == m.triangles);
    CHECK(triangles_wanted(small, {}) == Approx(triangles_wanted(p, {})));
  }
}
