// Holes in solids with flat walls: what was there is known, so the closed mesh has the solid's volume and area, however the solid lies.
#include <Eigen/Geometry>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "tripatch/creases/features.h"
#include "tripatch/fill.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/mesh/border_loops.h"

using namespace tripatch;

namespace {

/// A closed mesh, or what is left of one.
struct Solid {
  Points vertices = Points(0, 3);
  Faces faces;

  Solid(const std::vector<Vec3>& points, const std::vector<std::vector<Index>>& of)
      : vertices(static_cast<Index>(points.size()), 3) {
    for (Index k = 0; k < vertices.rows(); ++k) vertices.row(k) = points[static_cast<std::size_t>(k)];
    for (const std::vector<Index>& face : of) faces.add(face);
  }

  /// Without the faces whose middles are gone, and the vertices that no face is at then.
  Solid without(const std::function<bool(const Vec3&)>& gone) const {
    std::map<Index, Index> number;
    std::vector<Vec3> points;
    std::vector<std::vector<Index>> kept;
    for (Index f = 0; f < faces.size(); ++f) {
      if (gone(middle(f))) continue;
      kept.emplace_back();
      for (Index v : faces[f]) {
        const auto [own, is_new] = number.emplace(v, static_cast<Index>(points.size()));
        if (is_new) points.push_back(vertices.row(v));
        kept.back().push_back(own->second);
      }
    }
    return {points, kept};
  }
  Solid moved(const std::function<Vec3(const Vec3&)>& map) const {
    Solid out = *this;
    for (Index k = 0; k < vertices.rows(); ++k) out.vertices.row(k) = map(vertices.row(k));
    return out;
  }
  Mesh mesh() const { return {vertices, faces}; }
  Vec3 middle(Index face) const {
    Vec3 sum = Vec3::Zero();
    for (Index v : faces[face]) sum += Vec3(vertices.row(v));
    return sum / static_cast<double>(faces[face].size());
  }
  std::vector<Index> rim() const {
    const auto loops = border_loops(Connectivity(mesh()));
    REQUIRE(loops.size() == 1);
    return loops[0];
  }
  double across() const { return diameter(mesh(), rim()); }
  Features features() const { return find_features(mesh(), Connectivity(mesh()), rim()); }
};

/// The cube from -1 to 1, each of its faces n x n quads.
Solid cube(int n) {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces;
  std::map<std::array<int, 3>, Index> at;
  const auto vertex = [&](const std::array<int, 3>& p) {
    const auto [found, is_new] = at.emplace(p, static_cast<Index>(points.size()));
    if (is_new) points.push_back(Vec3(p[0], p[1], p[2]) * 2 / n - Vec3::Ones());
    return found->second;
  };
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {0, n})
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          std::vector<Index> face;
          for (const auto& [u, v] : {std::array{0, 0}, std::array{1, 0}, std::array{1, 1}, std::array{0, 1}}) {
            std::array<int, 3> p;
            p[axis] = side;
            p[(axis + 1) % 3] = i + (side ? u : v);
            p[(axis + 2) % 3] = j + (side ? v : u);
            face.push_back(vertex(p));
          }
          faces.push_back(face);
        }
  return {points, faces};
}

/// A prism of n walls with radius 1, of every other corner `star`.
Solid prism(int n, double height, double star = 1) {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces(2);
  for (const double z : {0.0, height})
    for (int k = 0; k < n; ++k) {
      const double a = 2 * std::numbers::pi * k / n;
      points.emplace_back((k % 2 ? star : 1) * Vec3(std::cos(a), std::sin(a), 0) + z * Vec3::UnitZ());
    }
  for (Index k = 0; k < n; ++k) {
    faces[0].push_back(n - 1 - k);
    faces[1].push_back(n + k);
    faces.push_back({k, (k + 1) % n, n + (k + 1) % n, n + k});
  }
  return {points, faces};
}

/// The base and walls of a pyramid over n corners at radius 1, from there up to 0.3 of it below the top, which is at (0, 0, height). One
/// vertex of the rim is lower: a flat one tells nothing.
Solid pyramid(int n, double height) {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces(1);
  for (const double share : {0.3, 0.6, 1.0})
    for (int k = 0; k < n; ++k) {
      const double a = 2 * std::numbers::pi * k / n, own = share == 0.3 && k == 0 ? 0.4 : share;
      points.emplace_back(own * std::cos(a), own * std::sin(a), height * (1 - own));
    }
  for (Index k = 0; k < n; ++k) {
    faces[0].push_back(3 * n - 1 - k);
    for (Index row = 0; row < 2; ++row)
      faces.push_back({row * n + k, (row + 1) * n + k, (row + 1) * n + (k + 1) % n, row * n + (k + 1) % n});
  }
  return {points, faces};
}

struct Measures {
  double volume = 0, area = 0;
};

/// Of a closed mesh: every edge has two faces, which pass it in opposite directions.
Measures measures(const Points& points, const std::vector<FacesRef>& all) {
  Measures out;
  std::set<std::array<Index, 2>> edges;
  const Vec3 origin = points.row(0);
  for (const FacesRef& faces : all)
    for (Index f = 0; f < faces.size(); ++f) {
      const auto face = faces[f];
      Vec3 twice = Vec3::Zero();
      for (std::size_t k = 0; k < face.size(); ++k) {
        REQUIRE(edges.insert({face[k], face[(k + 1) % face.size()]}).second);
        if (k == 0 || k + 1 == face.size()) continue;
        const Vec3 a = Vec3(points.row(face[0])) - origin, b = Vec3(points.row(face[k])) - origin,
                   c = Vec3(points.row(face[k + 1])) - origin;
        twice += (b - a).cross(c - a);
        out.volume += a.dot(b.cross(c)) / 6;
      }
      out.area += twice.norm() / 2;
    }
  for (const auto& [a, b] : edges) REQUIRE(edges.count({b, a}) == 1);
  return out;
}

Measures measures(const Mesh& mesh) { return measures(mesh.vertices, {mesh.faces}); }
/// The same with its fill.
Measures closed(const Mesh& mesh, const Fill& fill) {
  Points points(mesh.vertices.rows() + fill.vertices.rows(), 3);
  points << mesh.vertices, fill.vertices;
  return measures(points, {mesh.faces, FacesRef(fill.faces)});
}

Fill filled(const Solid& solid, Output output = Output::triangles) {
  FillOptions options;
  options.rim = solid.rim();
  options.output = output;
  return fill(solid.mesh(), options);
}

/// Of n of its walls without the first ones.
Solid without_walls(const Solid& prism, int n, int lost) {
  const double last = 2 * std::numbers::pi * lost / n;
  return prism.without([&](const Vec3& p) {
    return p.head(2).norm() > 0.5 && std::fmod(std::atan2(p[1], p[0]) + 2 * std::numbers::pi, 2 * std::numbers::pi) < last;
  });
}

bool at_corner(const Vec3& p) { return p.minCoeff() > 0.1; }
/// Over the edge of the walls y = 1 and z = 1, with both ends of it.
bool at_edge(const Vec3& p) { return std::min(p[1], p[2]) > 0.1; }
/// The wall z = 1 and what is next to it of the walls x = 1 and y = 1.
bool at_top(const Vec3& p) { return std::max({p[0], p[1], p[2]}) > 0.999 && p[2] > 0.1; }

}  // namespace

TEST_CASE("what a box has lost at an edge, a corner, two of them, or with a whole wall comes back", "[walls]") {
  const auto turned = [](double scale, const Vec3& shift) {
    const Eigen::Matrix3d turn = Eigen::Quaterniond(0.3, -0.5, 0.4, 0.7).normalized().toRotationMatrix();
    return [=](const Vec3& p) { return Vec3(scale * (turn * p) + shift); };
  };
  const auto gone = GENERATE(0, 1, 2);
  const auto n = GENERATE(2, 3, 5);
  const Solid whole = cube(n), open = whole.without(std::array{&at_corner, &at_edge, &at_top}[static_cast<std::size_t>(gone)]);
  INFO("gone " << gone << ", n " << n);
  REQUIRE(open.features().found());
  for (const auto& [scale, shift] : {std::pair(1.0, 0.0), std::pair(1e-6, 0.0), std::pair(1e6, 3e6), std::pair(1.0, 1e4)})
    for (const Output output : {Output::triangles, Output::quads}) {
      INFO("gone " << gone << ", n " << n << ", scale " << scale << ", shift " << shift);
      const Solid lying = open.moved(turned(scale, Vec3::Constant(shift)));
      const Fill fill = filled(lying, output);
      const Measures made = closed(lying.mesh(), fill);
      CHECK(made.volume / std::pow(scale, 3) == Approx(8).epsilon(1e-9));
      CHECK(made.area / std::pow(scale, 2) == Approx(24).epsilon(1e-9));
      CHECK(fill.report.triangles_folded == 0);
      CHECK(fill.report.warnings.empty());
      CHECK_FALSE(fill.feature_edges.empty());
    }
}

TEST_CASE("a wall of which nothing is left may have a rim of hundreds of edges", "[walls]") {
  const Solid open = cube(150).without(at_top);
  const Measures made = closed(open.mesh(), filled(open));
  CHECK(made.volume == Approx(8).epsilon(1e-9));
  CHECK(made.area == Approx(24).epsilon(1e-9));
}

TEST_CASE("walls that meet in a point by fours and more are a pyramid's", "[walls]") {
  for (int n = 4; n <= 12; ++n) {
    const Solid open = pyramid(n, 2);
    const std::optional<Walls> walls = open.features().walls;
    INFO("n " << n);
    REQUIRE(walls);
    CHECK(walls->nodes.size() == 1);
    const double base = n * std::sin(2 * std::numbers::pi / n) / 2;
    CHECK(closed(open.mesh(), filled(open)).volume == Approx(base * 2 / 3).epsilon(1e-9));
  }
}

TEST_CASE("walls are not continued beyond a wall that has lost nothing", "[walls]") {
  for (int n = 7; n < 16; ++n)
    for (const double height : {0.5, 2.0}) {
      const Solid open = without_walls(prism(n, height), n, 3);
      INFO(n << " walls, height " << height);
      CHECK_FALSE(open.features().walls);
      CHECK(filled(open).feature_edges.empty());
    }
}

TEST_CASE("one of the walls that meet may be left as a sliver, not two", "[walls]") {
  for (const bool two : {false, true}) {  // of the top a quad is left, of the wall x = 1 two rows or a quad
    const Solid open = cube(3).without([&](const Vec3& p) {
      const bool is_middle = std::abs(p[1]) < 0.1;
      if (p[2] > 0.999) return !is_middle || p[0] > -0.5;
      return p[0] > 0.999 && (two ? !is_middle || p[2] > -0.5 : p[2] > 0.5);
    });
    CHECK(open.features().walls.has_value() == !two);
    if (!two) CHECK(closed(open.mesh(), filled(open)).volume == Approx(8).epsilon(1e-9));
  }
}

TEST_CASE("what a prism has lost whole comes back as its rim tells it", "[walls]") {
  for (int n = 5; n < 15; ++n)
    for (const double height : {0.5, 2.0}) {
      const Solid whole = prism(n, height);
      const Measures all = measures(whole.mesh());
      const auto middle = [&](Index face) { return whole.middle(face); };
      const std::vector<std::vector<Index>> lost = {
          {2, 3},     // two walls
          {1, 2},     // a cap and a wall
          {1, 2, 3},  // what is at a vertex
      };
      for (const std::vector<Index>& gone : lost) {
        const Solid open = whole.without(
            [&](const Vec3& p) { return std::ranges::any_of(gone, [&](Index f) { return (p - middle(f)).norm() < 1e-9; }); });
        INFO(n << " walls, height " << height << ", lost " << gone.size() << ", the first " << gone[0]);
        const Measures made = closed(open.mesh(), filled(open));
        CHECK(made.volume == Approx(all.volume).epsilon(1e-9));
        CHECK(made.area == Approx(all.area).epsilon(1e-9));
      }
    }
}

TEST_CASE("walls that meet sharply are no folds but their own", "[walls]") {
  for (const double width : {0.1, 0.3, 1.0}) {  // a prism over a narrow triangle: a, d, b, c, e around it, at three heights
    std::vector<Vec3> points;
    for (const double z : {0.0, 1.0, 2.0})
      for (const Vec2& p : {Vec2(0, 0), Vec2(0.5, -width / 2), Vec2(1, -width), Vec2(1, width), Vec2(0.5, width / 2)})
        points.emplace_back(p[0], p[1], z);
    std::vector<std::vector<Index>> faces = {{4, 3, 2, 1, 0}, {10, 11, 14}, {11, 12, 13, 14}};
    for (Index row = 0; row < 10; row += 5)
      for (Index k = 0; k < 5; ++k) faces.push_back({row + k, row + (k + 1) % 5, row + 5 + (k + 1) % 5, row + 5 + k});
    const Solid whole(points, faces), open = whole.without([](const Vec3& p) { return p[0] < 0.4 && p[2] > 1; });
    const Fill fill = filled(open);
    const Measures made = closed(open.mesh(), fill), all = measures(whole.mesh());
    INFO("width " << width);
    REQUIRE(open.features().walls);
    CHECK(made.volume == Approx(all.volume).epsilon(1e-9));
    CHECK(made.area == Approx(all.area).epsilon(1e-9));
    CHECK(fill.report.triangles_folded <= fill.report.rim_folded);
    CHECK((fill.report.triangles_folded > 0) == (width < 0.5));
  }
}

TEST_CASE("a flat rim in a wall that ends at it is filled in that wall", "[walls]") {
  for (const int n : {2, 3, 5}) {
    const Solid whole = cube(n),
                open = whole.without([&](const Vec3& p) { return p[2] > 0.999 && p.head<2>().minCoeff() > 1 - 2.0 / n; });
    const Measures made = closed(open.mesh(), filled(open));
    INFO("n " << n);
    CHECK(made.volume == Approx(8).epsilon(1e-9));
    CHECK(made.area == Approx(24).epsilon(1e-9));
  }
  for (int n = 4; n < 13; ++n)
    for (const double height : {0.5, 2.0}) {  // one wall of a prism
      const Solid whole = prism(n, height),
                  open = whole.without([&](const Vec3& p) { return (p - whole.middle(2)).norm() < 1e-9; });
      INFO(n << " walls, height " << height);
      CHECK(closed(open.mesh(), filled(open)).volume == Approx(measures(whole.mesh()).volume).epsilon(1e-9));
    }
}

TEST_CASE("no crease shows at the rim of a lost face, and none is made", "[walls]") {
  const Solid octahedron({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                         {{1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}});
  CHECK_FALSE(octahedron.features().walls);
  CHECK(closed(octahedron.mesh(), filled(octahedron)).volume == Approx(4.0 / 3).epsilon(1e-9));
  const Solid open = cube(3).without([](const Vec3& p) { return p[2] > 0.9; });  // a cap is as likely as any
  CHECK_FALSE(open.features().walls);
}

TEST_CASE("a hole in the middle of a wall is flat whatever is around the wall", "[walls]") {
  for (const int n : {3, 5, 9}) {
    const Solid open =
        cube(n).without([&](const Vec3& p) { return p[2] > 0.999 && p.head<2>().cwiseAbs().maxCoeff() < 1.01 / n; });
    INFO("n " << n);
    CHECK(closed(open.mesh(), filled(open)).volume == Approx(8).epsilon(1e-9));
    CHECK(open.features().walls);
  }
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces;
  for (Index i = 0; i < 20; ++i)
    for (Index j = 0; j < 20; ++j) points.emplace_back(i, j, 0);
  for (Index i = 0; i < 19; ++i)
    for (Index j = 0; j < 19; ++j)
      if (i != 9 || j != 9) faces.push_back({20 * i + j, 20 * i + 20 + j, 20 * i + 21 + j, 20 * i + j + 1});
  const Solid sheet(points, faces);  // of a sheet any fill is
  const Mesh flat = sheet.mesh();
  const std::vector<Index> rim = {189, 190, 210, 209};
  CHECK_FALSE(find_walls(flat, Connectivity(flat), rim, diameter(flat, rim), {}));
}

TEST_CASE("the tip of a ball of triangles is no lost wall", "[walls]") {
  const double g = std::numbers::phi;  // an icosahedron without what is at the vertex (0, 1, g)
  const Solid whole({{-1, g, 0},
                     {1, g, 0},
                     {-1, -g, 0},
                     {1, -g, 0},
                     {0, -1, g},
                     {0, 1, g},
                     {0, -1, -g},
                     {0, 1, -g},
                     {g, 0, -1},
                     {g, 0, 1},
                     {-g, 0, -1},
                     {-g, 0, 1}},
                    {{0, 1, 7},
                     {0, 7, 10},
                     {10, 7, 6},
                     {10, 6, 2},
                     {10, 2, 11},
                     {0, 10, 11},
                     {3, 9, 4},
                     {3, 4, 2},
                     {3, 2, 6},
                     {3, 6, 8},
                     {3, 8, 9},
                     {4, 11, 2},
                     {6, 7, 8},
                     {1, 8, 7},
                     {9, 8, 1}});
  CHECK_FALSE(walls_end_at_flat_rim(whole.mesh(), Connectivity(whole.mesh()), whole.rim(), whole.across()));
  const Solid open = prism(5, 2).without([](const Vec3& p) { return p[2] > 1.9; });
  CHECK(walls_end_at_flat_rim(open.mesh(), Connectivity(open.mesh()), open.rim(), open.across()));
}

TEST_CASE("vertices are in a plane within 1e-4 of the hole", "[walls]") {
  const Solid open = cube(5).without(at_corner);
  for (const double off : {0.8, 1.25}) {
    const Solid bent = open.moved([&](const Vec3& p) {
      const bool beside = (p - Vec3(-0.2, 0.6, 1)).norm() < 1e-9;
      return Vec3(beside ? p + Vec3(0, 0, off * 1e-4 * open.across()) : p);
    });
    CHECK(bent.features().walls.has_value() == (off < 1));
  }
}

TEST_CASE("a wall of which nothing is left is told by a rim that turns by 20 degrees", "[walls]") {
  for (const double degrees : {18.0, 22.0}) {
    const double a = degrees * std::numbers::pi / 180;
    // the wall x = 1 is gone, with what is next to it; of its two edges that are left one runs aslant
    const Solid open = cube(4).without([](const Vec3& p) { return p[0] > 0.9 || (p[0] > 0.1 && std::max(p[1], p[2]) > 0.9); });
    REQUIRE(open.features().walls);
    const Solid sheared = open.moved([&](const Vec3& p) { return Vec3(p[0], p[1] + p[2] / std::tan(a), p[2]); });
    CHECK(sheared.features().walls.has_value() == (degrees > 20));
  }
}

TEST_CASE("walls that meet more than a diameter away do not close a hole", "[walls]") {
  double height = 1;
  const auto farness = [&] {
    const Solid open = pyramid(4, height);
    const Vec3 top(0, 0, height);
    double least = 10 * height;
    for (Index v : open.rim()) least = std::min(least, (Vec3(open.vertices.row(v)) - top).norm());
    return least / open.across();
  };
  for (const double share : {0.9, 1.1}) {
    while (farness() < share) height *= 1.01;
    const Solid open = pyramid(4, height);
    const Mesh mesh = open.mesh();
    CHECK(find_walls(mesh, Connectivity(mesh), open.rim(), open.across(), {}).has_value() == (share < 1));
  }
}

namespace {

/// What is left of a solid of n kites above and n below, as a cube is one that stands on a corner: those below, and faces that cut off its corners
/// where two of them meet one above.
Solid lower_kites(int n) {
  const double c = std::cos(std::numbers::pi / n), rise = 0.15, cut = 0.3;
  const Vec3 lowest(0, 0, -rise * (1 + c) / (1 - c));
  const auto corner = [&](Index k) {
    const double a = std::numbers::pi * static_cast<double>(k) / n;
    return Vec3(std::cos(a), std::sin(a), k % 2 ? rise : -rise);
  };
  std::vector<Vec3> points = {lowest};
  std::vector<std::vector<Index>> faces;
  for (Index k = 0; k < 2 * n; k += 2) {  // corner k is cut off, corner k + 1 is not
    for (const Vec3& to : {lowest, corner(k - 1), corner(k + 1)}) points.push_back(corner(k) + cut * (to - corner(k)));
    points.push_back(corner(k + 1));
    const Index own = 1 + 2 * k, next = 1 + (2 * k + 4) % (4 * n);
    faces.push_back({own + 2, own + 1, own});
    faces.push_back({0, next, next + 1, own + 3, own + 2, own});
  }
  return {points, faces};
}

/// A prism of n walls that has lost its cap and the upper ends of its walls: of two nothing, of the two next to these half, of the others all.
Solid jagged_prism(Index n) {
  const auto corner = [&](Index k, double height) {
    const double a = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    return Vec3(std::cos(a), std::sin(a), height);
  };
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces(1);
  for (Index k = 0; k < n; ++k) {
    points.push_back(corner(k, 0));
    faces[0].push_back(n - 1 - k);
  }
  for (Index k = 0; k < n; ++k) points.push_back(corner(k, k < 3 ? 1 : 0.5 + 0.1 * std::sin(2.5 * static_cast<double>(k))));
  points.emplace_back((corner(2, 1) + corner(3, 1)) / 2);
  points.emplace_back((corner(n - 1, 1) + corner(n, 1)) / 2);
  for (Index k = 0; k < n; ++k) {
    const Index next = (k + 1) % n;
    faces.push_back({k, next, n + next});
    if (k == 2) faces.back().push_back(2 * n);
    if (k == n - 1) faces.back().push_back(2 * n + 1);
    faces.back().push_back(n + k);
  }
  return {points, faces};
}

std::optional<Walls> walls_of(const Solid& open) {
  const Mesh mesh = open.mesh();
  return find_walls(mesh, Connectivity(mesh), open.rim(), open.across(), {});
}

}  // namespace

TEST_CASE("walls come back of which nothing is left where they are three, not four", "[walls]") {
  const std::optional<Walls> walls = walls_of(lower_kites(3));
  REQUIRE(walls);
  CHECK(walls->parts.size() == 3);
  CHECK((walls->nodes.at(0) - Vec3(0, 0, 0.45)).norm() < 1e-9);
  CHECK_FALSE(walls_of(lower_kites(4)));
}

TEST_CASE("a wall of which nothing is left is sought among eight planes that the rim tells, not nine", "[walls]") {
  CHECK(walls_of(jagged_prism(10)));  // the cap's, and one at each crease that the rim crosses: all but three
  CHECK_FALSE(walls_of(jagged_prism(11)));
}

TEST_CASE("walls in more than sixteen planes are not looked at", "[walls]") {
  for (const int n : {16, 18}) {  // a cap and a wall are lost: n - 1 walls and the other cap are next to
    const Solid whole = prism(n, 1, 0.6),
                open = whole.without([&](const Vec3& p) { return p[2] > 0.9 || (p - whole.middle(2)).norm() < 1e-9; });
    const Mesh mesh = open.mesh();
    CHECK(find_walls(mesh, Connectivity(mesh), open.rim(), open.across(), {}).has_value() == (n == 16));
  }
}

namespace {

/// The walls below a flat rim, a square of side 2 or what its corners and the middles of its edges make, moved outwards by so much. Each leans
/// by so many degrees against the rim's plane; the solid's lower cap is there.
Solid below_square(const std::vector<double>& leaning, double bulge = 0) {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> faces(1);
  const auto out = [&](std::size_t k) { return 1 / std::tan(leaning[k % 4] * std::numbers::pi / 180); };
  const std::array<Vec3, 4> normal = {-Vec3::UnitY(), Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitX()};
  for (const bool low : {false, true})
    for (std::size_t k = 0; k < 4; ++k) {  // side k leads from corner k to the next
      const auto outwards = [&](std::size_t side) -> Vec3 { return low ? Vec3(out(side) * normal[side % 4]) : Vec3::Zero(); };
      points.push_back(normal[(k + 3) % 4] + normal[k] + outwards(k + 3) + outwards(k) - (low ? 1 : 0) * Vec3::UnitZ());
      if (bulge > 0) points.push_back((1 + bulge) * normal[k] + outwards(k) - (low ? 1 : 0) * Vec3::UnitZ());
    }
  const Index n = static_cast<Index>(points.size()) / 2;
  for (Index k = 0; k < n; ++k) {
    faces[0].push_back(2 * n - 1 - k);
    faces.push_back({k, n + k, n + (k + 1) % n, (k + 1) % n});
  }
  return {points, faces};
}

bool walls_end(const Solid& open) {
  return walls_end_at_flat_rim(open.mesh(), Connectivity(open.mesh()), open.rim(), open.across());
}

}  // namespace

TEST_CASE("walls of a straight tube end at its flat rim whatever the angles between them", "[walls]") {
  for (const double degrees : {0.95, 1.05, 24.5, 25.5})
    CHECK(walls_end(below_square({90, 90, 90, 90}, std::tan(degrees * std::numbers::pi / 360))));
}
