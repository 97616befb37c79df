// What makes a corner of a rim, on both sides of each threshold; clear corners are in test_thresholds_clear_corners.
#include <numbers>

#include "test_plane_rims.h"
#include "test_refusals.h"

using namespace tripatch;
using namespace tripatch::testing;

TEST_CASE("a corner turns by 40 degrees where a round rim would turn by 15", "[thresholds]") {
  CHECK(bowed(3, 39.8, 7).detected().empty());
  CHECK(bowed(3, 40.2, 7).detected() == std::vector<Index>{0, 8, 16});
}

TEST_CASE("a corner turns by one and a half times what a round rim would", "[thresholds]") {
  // of 12 edges by 30 degrees; the vertices next to the corners turn by more than half of what these do
  CHECK(bowed(3, 44.8, 3).detected().empty());
  CHECK(bowed(3, 45.2, 3).detected() == std::vector<Index>{0, 4, 8});
}

TEST_CASE("or by twice what the vertices beside it turn", "[thresholds]") {
  // of 8 edges, where 55 degrees are a corner in any case
  CHECK(PlaneRim({50, 25.2, 79.6, 25.2}, 2).detected() == std::vector<Index>{2, 6});
  CHECK(PlaneRim({50, 24.8, 80.4, 24.8}, 2).detected() == std::vector<Index>{0, 2, 4, 6});
}

TEST_CASE("55 degrees are a corner however few the edges are", "[thresholds]") {
  CHECK(PlaneRim({54.7, 62.65, 62.65}, 2).detected() == std::vector<Index>{1, 2, 4, 5});
  CHECK(PlaneRim({55.3, 62.35, 62.35}, 2).detected().size() == 6);
}

TEST_CASE("what turns beside a corner is part of it, up to 75 degrees", "[thresholds]") {
  // two corners each of which is cut off, half a window from where it begins to turn; the window is a 24th of the length
  const auto cut = [](double second, double edge) {
    const double window = 1, rest = 24 * window / 2 - 2 * edge;
    return PlaneRim({180 - second, second, 0, 0}, 2, {edge, edge, rest / 2, rest / 2}).detected();
  };
  CHECK(cut(74.5, 0.5) == std::vector<Index>{0, 4});
  CHECK(cut(75.5, 0.5) == std::vector<Index>{0, 1, 4, 5});
  // but where its edges are shorter than a twelfth of the window what it turns is noise
  CHECK(cut(80, 0.99 / 12) == std::vector<Index>{0, 4});
  CHECK(cut(80, 1.01 / 12) == std::vector<Index>{0, 1, 4, 5});
}

TEST_CASE("a rim has twelve corners at most that are told", "[thresholds]") {
  const auto said = [](const PlaneRim& rim) -> std::string {
    try {
      three_corners(rim.mesh(), Connectivity(rim.mesh()), rim.rim);
    } catch (const CodedRefusal& refusal) {
      return code_of(refusal.message()) + " " + std::to_string(refusal.where().size());
    }
    return "";
  };
  CHECK(said(straight({360.0 / 8}, 8, {8})) == "not_three_corners 8");
  // from ten on corners turn by less than 40 degrees; twelve are those of a star
  const auto star = [](int points) { return straight({360.0 / points + 60, -60}, points, {6, 6}); };
  CHECK(said(star(12)) == "not_three_corners 12");
  CHECK(said(star(13)) == "too_many_corners 13");
}

TEST_CASE("of two turns that differ by less than a millionth of a radian the one at the lower vertex is the corner",
          "[thresholds]") {
  for (const double lead : {0.9e-6, 1.1e-6}) {  // over a window half of what the turns differ by
    const double off = lead * 180 / std::numbers::pi;
    const PlaneRim rim({60 - off, 60 + off, 0, 0}, 3, {0.5, 0.5, 3.5, 3.5});
    CHECK(rim.detected() == (lead < 1e-6 ? std::vector<Index>{0, 4, 8} : std::vector<Index>{1, 5, 9}));
  }
}

TEST_CASE("corners of a grid are where three of its quads meet at the rim: triangles are no lines of a grid") {
  for (const bool quads : {true, false}) {
    // a round rim of twelve edges in a ring of quads, and at every fourth of its vertices one face more
    constexpr Index n = 12;
    std::vector<Vec3> points;
    const auto on_circle = [](double k, double radius) {
      return Vec3(radius * std::cos(2 * std::numbers::pi * k / n), radius * std::sin(2 * std::numbers::pi * k / n), 0);
    };
    for (Index k = 0; k < n; ++k) points.push_back(on_circle(static_cast<double>(k), 1));
    std::vector<std::array<Index, 2>> outer(n);  // the last vertex of the face before, the first of that behind
    Faces faces;
    for (Index k = 0; k < n; ++k) {
      const Index at = static_cast<Index>(points.size());
      const double place = static_cast<double>(k);
      if (k % 4 != 0) {
        points.push_back(on_circle(place, 1.5));
        outer[k] = {at, at};
        continue;
      }
      points.push_back(on_circle(place - 0.2, 1.5));
      points.push_back(on_circle(place + 0.2, 1.5));
      outer[k] = {at, at + 1};
      if (quads) points.push_back(on_circle(place, 1.7));
      faces.add(quads ? std::vector<Index>{k, at, at + 2, at + 1} : std::vector<Index>{k, at, at + 1});
    }
    for (Index k = 0; k < n; ++k) faces.add(std::vector<Index>{(k + 1) % n, k, outer[k][1], outer[(k + 1) % n][0]});
    Points vertices(static_cast<Index>(points.size()), 3);
    for (std::size_t k = 0; k < points.size(); ++k) vertices.row(static_cast<Index>(k)) = points[k];
    const Mesh mesh{vertices, faces};
    std::vector<Index> rim(n);
    std::iota(rim.begin(), rim.end(), Index{0});
    CHECK(detect_corners(mesh, Connectivity(mesh), rim) == (quads ? std::vector<Index>{0, 4, 8} : std::vector<Index>{}));
  }
}
