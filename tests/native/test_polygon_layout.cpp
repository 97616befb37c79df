// Layouts of quads for any number of sides: what every one of them is, and how good the regular ones are.
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "tripatch/quads/polygon_layout.h"

using namespace tripatch;

namespace {

struct Outline {
  PlanePoints rim;
  std::vector<RimCorner> corners;
};

/// Straight sides between corners on a circle; two sides: arcs of 120 degrees.
Outline outline(const std::vector<Index>& counts, double turn = 0) {
  const int n = static_cast<int>(counts.size());
  Outline out;
  std::vector<Eigen::Vector2d> places;
  const auto on_circle = [](double angle) { return Eigen::Vector2d(std::cos(angle), std::sin(angle)); };
  for (int i = 0; i < n; ++i) {
    out.corners.push_back({static_cast<Index>(places.size()), 0});
    const double from = 2 * std::numbers::pi * i / n + turn, to = 2 * std::numbers::pi * (i + 1) / n + turn;
    for (Index k = 0; k < counts[i]; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(counts[i]);
      if (n == 2) {
        const double side = i == 0 ? -1 : 1, angle = side * std::numbers::pi / 2 + (t - 0.5) * 2 * std::numbers::pi / 3;
        places.emplace_back(on_circle(angle) - side * Eigen::Vector2d(0, 0.5));
      } else {
        places.emplace_back((1 - t) * on_circle(from) + t * on_circle(to));
      }
    }
  }
  out.rim.resize(static_cast<Index>(places.size()), 2);
  for (std::size_t k = 0; k < places.size(); ++k) out.rim.row(static_cast<Index>(k)) = places[k];
  return out;
}

Index triangles_in(const PlaneLayout& layout) {
  Index triangles = 0;
  for (Index f = 0; f < layout.faces.size(); ++f) triangles += layout.faces[f].size() == 3;
  return triangles;
}

/// Rim edges once and forwards, inner ones once each way, faces of three or four corners, one disc.
bool is_disc(const PlaneLayout& layout) {
  std::map<std::pair<Index, Index>, int> edges;
  for (Index f = 0; f < layout.faces.size(); ++f) {
    const auto face = layout.faces[f];
    if (face.size() != 3 && face.size() != 4) return false;
    for (std::size_t k = 0; k < face.size(); ++k) ++edges[{face[k], face[(k + 1) % face.size()]}];
  }
  for (const auto& [edge, uses] : edges) {
    const bool rim = edge.first < layout.rim && edge.second == (edge.first + 1) % layout.rim;
    if (uses != 1 || (!rim && !edges.contains({edge.second, edge.first}))) return false;
  }
  for (Index v = 0; v < layout.rim; ++v)
    if (!edges.contains({v, (v + 1) % layout.rim})) return false;
  const Index undirected = (static_cast<Index>(edges.size()) + layout.rim) / 2;
  return layout.uv.rows() - undirected + layout.faces.size() == 1;
}

QuadQuality quality_of(const PlaneLayout& layout) {
  Points points = Points::Zero(layout.uv.rows(), 3);
  points.leftCols(2) = layout.uv;
  return quad_quality(points, layout.faces);
}

}  // namespace

TEST_CASE("polygon layout: any counts on any number of sides give a disc, of quads where the sum is even") {
  std::mt19937 random(7);
  for (int n = 2; n <= 12; ++n)
    for (int trial = 0; trial < 12; ++trial) {
      std::vector<Index> counts;
      for (int i = 0; i < n; ++i) counts.push_back(1 + static_cast<Index>(random() % (trial % 2 == 0 ? 4 : 9)));
      Index sum = 0;
      for (Index c : counts) sum += c;
      if (sum < 3) continue;
      const Outline given = outline(counts);
      const PlaneLayout layout = polygon_layout(given.rim, given.corners, trial % 3 == 0 ? 1 : 0);
      CAPTURE(n, counts);
      CHECK(is_disc(layout));
      CHECK(triangles_in(layout) == sum % 2);
    }
}

TEST_CASE("polygon layout: regular rims of two to twelve sides turn no corner over") {
  for (int n = 2; n <= 12; ++n)
    for (Index count : {4, 6, n > 6 ? 16 : 8}) {
      const Outline given = outline(std::vector<Index>(n, count));
      const PlaneLayout layout = polygon_layout(given.rim, given.corners);
      CAPTURE(n, count, layout.poles.size());
      CHECK(triangles_in(layout) == 0);
      CHECK(layout.poles.size() <= 4);
      // the rim itself has corners of 60 degrees (three sides, least sine 0.87) and of 120 (two sides)
      CHECK(quality_of(layout).least > 0.8);
    }
}

TEST_CASE("polygon layout: four sides of opposite equal counts are a grid, five equal ones have one pole of valence five") {
  const Outline four = outline({7, 4, 7, 4});
  const PlaneLayout grid = polygon_layout(four.rim, four.corners);
  CHECK(grid.poles.empty());
  CHECK(grid.faces.size() == 28);
  const Outline five = outline({6, 6, 6, 6, 6});
  const PlaneLayout pole = polygon_layout(five.rim, five.corners);
  REQUIRE(pole.poles.size() == 1);
  CHECK(std::count(pole.faces.corners.begin(), pole.faces.corners.end(), pole.poles[0]) == 5);
  CHECK(pole.uv.row(pole.poles[0]).norm() < 1e-3);
}

TEST_CASE("polygon layout: counts that differ by two cost four sides one pair of poles") {
  const Outline given = outline({8, 6, 6, 6});
  const PlaneLayout layout = polygon_layout(given.rim, given.corners);
  CHECK(layout.poles.size() == 2);
  CHECK(quality_of(layout).least > 0.8);
}

TEST_CASE("polygon layout: the faces around say how many quads a corner wants") {
  Outline given = outline({6, 6, 6, 6, 6, 6});
  CHECK(polygon_layout(given.rim, given.corners).poles.empty());  // two of the corners count as straight
  for (RimCorner& corner : given.corners) corner.quads = 1;
  std::vector<int> at(given.rim.rows(), 0);
  const PlaneLayout layout = polygon_layout(given.rim, given.corners);
  for (Index v : layout.faces.corners)
    if (v < layout.rim) ++at[v];
  for (const RimCorner& corner : given.corners) CHECK(at[corner.place] == 1);
}

TEST_CASE("polygon layout: turned by one corner it is the same layout") {
  const Outline given = outline({6, 6, 6, 6, 6}), turned = outline({6, 6, 6, 6, 6}, 2 * std::numbers::pi / 5);
  const QuadQuality a = quality_of(polygon_layout(given.rim, given.corners)),
                    b = quality_of(polygon_layout(turned.rim, turned.corners));
  CHECK(a.least == Approx(b.least).epsilon(1e-6));
  CHECK(a.mean == Approx(b.mean).epsilon(1e-6));
}

TEST_CASE("polygon layout: asked for again it is the same, and what differs in rim, corners or rows is another") {
  const Outline plain = outline({6, 6, 6, 6, 6, 6}), turned = outline({6, 6, 6, 6, 6, 6}, 0.1);
  std::vector<RimCorner> other = plain.corners;
  for (RimCorner& corner : other) corner.quads = 1;
  const auto all = [&] {
    return std::vector<PlaneLayout>{polygon_layout(plain.rim, plain.corners, 0), polygon_layout(plain.rim, plain.corners, 1),
                                    polygon_layout(turned.rim, turned.corners, 0), polygon_layout(plain.rim, other, 0)};
  };
  const std::vector<PlaneLayout> first = all(), again = all();
  for (std::size_t k = 0; k < first.size(); ++k) {
    CHECK(first[k].uv == again[k].uv);
    CHECK(first[k].faces.corners == again[k].faces.corners);
  }
  CHECK(first[1].uv.rows() > first[0].uv.rows());
  CHECK(first[2].uv != first[0].uv);
  CHECK((first[3].uv.rows() != first[0].uv.rows() || first[3].uv != first[0].uv));
}

TEST_CASE("polygon layout: of more than two rows each further one is a ring more, before that the layout may change", "") {
  std::mt19937 random(3);
  int others = 0;
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<Index> counts;
    for (int i = 0, n = 3 + trial % 5; i < n; ++i) counts.push_back(2 + static_cast<Index>(random() % 7));
    const Outline given = outline(counts);
    const auto faces = [&](int rows) { return polygon_layout(given.rim, given.corners, rows).faces.size(); };
    const Index ring = given.rim.rows();
    CAPTURE(counts);
    CHECK(faces(3) - faces(2) == ring);
    CHECK(faces(5) - faces(2) == 3 * ring);
    others += faces(2) - faces(1) != ring;
  }
  CHECK(others > 0);
}
