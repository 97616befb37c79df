// Which edges tell of the surface between their ends, on both sides of each threshold.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <numbers>

#include "tripatch/estimate/long_edges.h"

using namespace tripatch;

namespace {

/// Walls side by side, 1 wide and so high, each turned against the one before, as quads or cut into triangles.
struct Walls {
  Points points;
  Faces faces;

  Walls(Index count, double height, bool cut, double turn = 0.3) : points(2 * (count + 1), 3) {
    double x = 0, y = 0;
    for (Index k = 0; k <= count; ++k) {
      points.row(2 * k) << x, y, 0;
      points.row(2 * k + 1) << x, y, height;
      x += std::cos(turn * static_cast<double>(k));
      y += std::sin(turn * static_cast<double>(k));
    }
    for (Index k = 0; k < count; ++k) {
      const Index a = 2 * k;
      if (cut) {
        faces.add(std::array<Index, 3>{a, a + 2, a + 3});
        faces.add(std::array<Index, 3>{a, a + 3, a + 1});
      } else {
        faces.add(std::array<Index, 4>{a, a + 2, a + 3, a + 1});
      }
    }
  }
  std::vector<OnEdge> found() const { return points_on_long_edges(points, faces); }
};

}  // namespace

TEST_CASE("Edges of three times the length of short ones are sampled between their ends") {
  const bool cut = GENERATE(false, true);
  CHECK(Walls(6, 2.95, cut).found().empty());
  const Walls high(6, 3.05, cut);
  const std::vector<OnEdge> found = high.found();
  REQUIRE(found.size() == 7);  // the middle of every upright edge, of no diagonal
  for (const auto& [ends, share] : found) {
    CHECK(ends[1] == ends[0] + 1);
    CHECK(share == 0.5);
  }
  CHECK(Walls(6, 6.1, cut).found().size() == 14);
  CHECK(Walls(6, 1e6, cut).found().size() == 7 * 8);
}

TEST_CASE("Triangles tell of no more than their vertices where they are not cut from flat faces") {
  Walls bent(6, 6.1, true);
  for (Index k = 1; k < bent.points.rows(); k += 2) {  // walls that lean: no two triangles in one plane
    bent.points(k, 0) += 0.02 * bent.points(k, 1);
    bent.points(k, 1) -= 0.03 * bent.points(k, 0);
  }
  CHECK(bent.found().empty());
  Walls rounded(6, 6.1, true);  // by single precision
  for (Index k = 0; k < rounded.points.rows(); ++k)
    for (int axis = 0; axis < 3; ++axis) rounded.points(k, axis) = static_cast<float>(rounded.points(k, axis) + 10.1);
  CHECK(rounded.found().size() == 14);
}

TEST_CASE("Short edges are those that a quarter of all edges and lines across faces are shorter than") {
  for (const Index small : {1, 2}) {  // quads with edges of 0.45, of five lines each; 25 are the walls', 1 to 2.2 long
    const Walls walls(6, 2, false);
    Points points(14 + 4 * small, 3);
    points.topRows(14) = walls.points;
    Faces faces = walls.faces;
    for (Index k = 0; k < small; ++k) {
      const Index a = 14 + 4 * k;
      for (Index j = 0; j < 4; ++j)
        points.row(a + j) << static_cast<double>(k) + (j == 1 || j == 2 ? 0.45 : 0), -9, j < 2 ? 0 : 0.45;
      faces.add(std::array<Index, 4>{a, a + 1, a + 2, a + 3});
    }
    CHECK(points_on_long_edges(points, faces).empty() == (small == 1));  // 5 of 30 lines, 10 of 35
  }
}

TEST_CASE("Two triangles are of one flat face whose planes meet at an angle with a sine of 1e-4") {
  for (const double sine : {0.9e-4, 1.1e-4}) {
    Walls wall(1, 6.1, true);
    wall.points(1, 1) = sine * 6.1 / std::hypot(1, 6.1);  // so far from the other triangle's plane
    CHECK(wall.found().empty() == (sine > 1e-4));
  }
}

TEST_CASE("Flat triangles that are not much longer than wide come of no face that was cut") {
  for (const double height : {2.58, 2.66}) {  // a diagonal squared over twice the area is (1 + height^2) / height: 2.97 and 3.04
    Walls walls(6, height, true);
    Points points(walls.points.rows() + 14, 3);  // and a strip of small triangles next to, by which these are long
    points << walls.points, Points::Zero(14, 3);
    for (Index k = 0; k < 7; ++k) {
      points.row(14 + 2 * k) << 0.4 * static_cast<double>(k), -9, 0;
      points.row(15 + 2 * k) << 0.4 * static_cast<double>(k), -9, 0.4;
    }
    for (Index k = 0; k < 6; ++k) {
      const Index a = 14 + 2 * k;
      walls.faces.add(std::array<Index, 3>{a, a + 2, a + 3});
      walls.faces.add(std::array<Index, 3>{a, a + 3, a + 1});
    }
    CHECK(points_on_long_edges(points, walls.faces).empty() == (height < 2.6));
  }
}

TEST_CASE("Lines across faces of five corners and more lie on the surface, those across quads do not") {
  for (const Index n : {4, 12}) {
    Points points(n + 40, 3);
    Faces faces;
    std::vector<Index> face;
    for (Index k = 0; k < n; ++k) {
      const double turn = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
      points.row(k) << 10 * std::cos(turn), 10 * std::sin(turn), 0;
      face.push_back(k);
    }
    faces.add(face);
    for (Index k = 0; k < 20; ++k) {  // small quads, by which all that is long
      points.row(n + 2 * k) << static_cast<double>(k), 20, 0;
      points.row(n + 2 * k + 1) << static_cast<double>(k), 21, 0;
      if (k > 0) faces.add(std::array<Index, 4>{n + 2 * k - 2, n + 2 * k, n + 2 * k + 1, n + 2 * k - 1});
    }
    bool across = false;
    for (const auto& [ends, share] : points_on_long_edges(points, faces))
      across = across || (ends[1] < n && ends[1] - ends[0] > 1 && ends[1] - ends[0] < n - 1);
    CHECK(across == (n == 12));
  }
}

TEST_CASE("Long edges that go on into others and turn there are those of a round surface") {
  const auto found = [](double turn, double height_of_next) {
    Points points(4 * 7, 3);  // seven upright zigzags in a row, 1 apart, of three edges each
    Faces faces;
    for (Index k = 0; k < 7; ++k)
      for (Index j = 0; j < 4; ++j) {
        const double lean = j == 0 ? -std::sin(turn) * height_of_next : j == 3 ? -std::sin(turn) * height_of_next : 0;
        const double up = j == 0   ? -std::cos(turn) * height_of_next
                          : j == 3 ? 6 + std::cos(turn) * height_of_next
                          : j == 2 ? 6
                                   : 0;
        points.row(4 * k + j) << static_cast<double>(k), lean, up;
      }
    for (Index k = 0; k < 6; ++k)
      for (Index j = 0; j < 3; ++j) faces.add(std::array<Index, 4>{4 * k + j, 4 * k + 4 + j, 4 * k + 5 + j, 4 * k + 1 + j});
    bool amid = false;
    for (const auto& [ends, share] : points_on_long_edges(points, faces))
      amid = amid || (ends[0] % 4 == 1 && ends[1] == ends[0] + 1);
    return amid;
  };
  CHECK(found(0.048, 3.5));
  CHECK_FALSE(found(0.052, 3.5));
  CHECK(found(0.5, 2.9));  // a wall between short edges
  CHECK_FALSE(found(0.5, 3.1));
}

TEST_CASE("Without faces, and where edges have no length, nothing is told") {
  CHECK(points_on_long_edges(Points(0, 3), Faces()).empty());
  Walls flat(6, 0, false);
  flat.points.setZero();
  CHECK(flat.found().empty());
}

TEST_CASE("Whether what goes on from a long edge turns, and is about as long, does not hang on rounding") {
  // of two edges that continue as straight one is long and one short; and edges of just half the length continue
  for (const double beyond : {0.2, 0.5}) {
    Walls walls(6, 6.1, false);
    const Index n = walls.points.rows();
    Points points(n + 14, 3);
    points.topRows(n) = walls.points;
    Faces faces = walls.faces;
    for (Index k = 0; k < 7; ++k) {  // a row more on either side, that leans out
      const Eigen::RowVector3d out(0.3 * std::cos(0.3 * static_cast<double>(k)), 0.3 * std::sin(0.3 * static_cast<double>(k)), 1);
      points.row(n + 2 * k) = points.row(2 * k) - beyond * 6.1 * Eigen::RowVector3d(-out[0], -out[1], 1).normalized();
      points.row(n + 2 * k + 1) = points.row(2 * k + 1) + beyond * 6.1 * out.normalized();
    }
    for (Index k = 0; k < 6; ++k) {
      const Index a = 2 * k, b = n + 2 * k;
      faces.add(std::array<Index, 4>{b, b + 2, a + 2, a});
      faces.add(std::array<Index, 4>{a + 1, a + 3, b + 3, b + 1});
    }
    const std::size_t count = points_on_long_edges(points, faces).size();
    for (int turn = 1; turn < 12; ++turn) {
      Eigen::Matrix3d about;
      const double c = std::cos(turn), s = std::sin(turn);
      about << c, s, 0, -s * s, c * s, c, s * c, -c * c, s;
      CHECK(points_on_long_edges(points * about, faces).size() == count);
    }
  }
}

namespace {

/// A box of 1 x 6 x 1 squares that are 20, 1 and 30 long; where x is 20 it is so much higher, over half of that, at either end.
std::pair<Points, Faces> box_of(double higher) {
  const std::array<Index, 3> squares = {1, 6, 1}, step = {1, 2, 14};
  Points box(28, 3);
  for (Index k = 0; k < 28; ++k) {
    const double x = static_cast<double>(k % 2);
    box.row(k) << 20 * x, static_cast<double>(k / 2 % 7), (k < 14 ? -15 : 15) * (1 + higher * x);
  }
  Faces faces;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool far : {false, true}) {
      const int first = (axis + 1) % 3, second = (axis + 2) % 3;
      const Index u = step[first], v = step[second];
      for (Index i = 0; i < squares[first]; ++i)
        for (Index j = 0; j < squares[second]; ++j) {
          const Index a = (far ? squares[axis] * step[axis] : 0) + i * u + j * v;
          faces.add(far ? std::array{a, a + u, a + u + v, a + v} : std::array{a, a + v, a + u + v, a + u});
        }
    }
  return {box, faces};
}

}  // namespace

TEST_CASE("Edges at right angles to a long one do not go on from it, however a box lies") {
  const auto [box, faces] = box_of(0);
  const std::size_t count = points_on_long_edges(box, faces).size();
  REQUIRE(count > 0);
  for (int turn = 1; turn < 40; ++turn) {
    const Eigen::Matrix3d about =
        (Eigen::AngleAxisd(turn, Vec3(1, 2, 3).normalized()) * Eigen::AngleAxisd(2 * turn, Vec3(0, 0, 1))).toRotationMatrix();
    CHECK(points_on_long_edges(box * about, faces).size() == count);
  }
}
