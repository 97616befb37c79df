// What makes a corner of a rim, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>

#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/corners.h"
#include "tripatch/hole/rim_shape.h"

using namespace tripatch;

namespace {

/// A rim in the plane and one ring of triangles around it.
struct PlaneRim {
  Points vertices;
  Faces faces;
  std::vector<Index> rim;

  /// turns: degrees, at the vertices; lengths: of the edge after each. Both are taken `folds` times, and the turns of one round sum to
  /// 360 / folds: so the rim is closed.
  explicit PlaneRim(const std::vector<double>& turns, int folds, const std::vector<double>& lengths = {}) {
    const Index m = static_cast<Index>(turns.size()), n = folds * m;
    REQUIRE(std::accumulate(turns.begin(), turns.end(), 0.0) * folds == Approx(360));
    vertices = Points::Zero(2 * n, 3);
    Vec3 at = Vec3::Zero();
    double angle = 0;
    for (Index k = 0; k < n; ++k) {
      rim.push_back(k);
      vertices.row(k) = at;
      angle += turns[k % m] * M_PI / 180;
      at += (lengths.empty() ? 1 : lengths[k % m]) * Vec3(std::cos(angle), std::sin(angle), 0);
    }
    REQUIRE(at.norm() < 1e-9 * static_cast<double>(n));
    const Eigen::RowVector3d middle = vertices.topRows(n).colwise().mean();
    for (Index k = 0; k < n; ++k) vertices.row(n + k) = middle + 1.3 * (vertices.row(k) - middle);
    for (Index k = 0; k < n; ++k) {
      const Index next = (k + 1) % n;
      faces.add(std::array<Index, 3>{next, k, n + next});
      faces.add(std::array<Index, 3>{k, n + k, n + next});
    }
  }
  Mesh mesh() const { return {vertices, faces}; }
  std::vector<Index> clear() const { return clear_corners(mesh(), Connectivity(mesh()), rim); }
  std::vector<Index> detected() const { return detect_corners(mesh(), Connectivity(mesh()), rim); }
  bool round() const { return is_round(mesh(), Connectivity(mesh()), rim); }
};

/// `corners` of them turn by so many degrees, the other vertices, `between` from each to the next, by what is left, alike.
PlaneRim bowed(int corners, double degrees, int between) {
  std::vector<double> turns(between + 1, (360.0 / corners - degrees) / between);
  turns[0] = degrees;
  return PlaneRim(turns, corners);
}

/// Sides of so many straight edges.
PlaneRim straight(const std::vector<double>& turns, int folds, const std::vector<int>& edges) {
  std::vector<double> all;
  for (std::size_t i = 0; i < turns.size(); ++i) {
    all.push_back(turns[i]);
    all.insert(all.end(), edges[i] - 1, 0.0);
  }
  return PlaneRim(all, folds);
}

}  // namespace

TEST_CASE("a clear corner turns by 12 degrees", "[thresholds]") {
  CHECK(bowed(2, 11.9, 99).clear().empty());
  CHECK(bowed(2, 12.1, 99).clear().size() == 2);
}

TEST_CASE("a clear corner turns by two and a half times what the vertices beside it turn", "[thresholds]") {
  // four corners that turn by r times what five vertices between them do
  const auto times = [](double r) { return bowed(4, 90 * r / (r + 5), 5); };
  CHECK(times(2.47).clear().empty());
  CHECK(times(2.53).clear().size() == 4);
}

TEST_CASE("clear corners are two edges apart and three in the mean, and there are twelve at most", "[thresholds]") {
  CHECK(straight({90, 90}, 2, {3, 3}).clear().size() == 4);
  CHECK(straight({130, 50}, 2, {2, 4}).clear().size() == 4);
  CHECK(straight({130, 50}, 2, {1, 5}).clear().empty());
  CHECK(straight({130, 50}, 2, {2, 3}).clear().empty());
  CHECK(straight({30}, 12, {3}).clear().size() == 12);
  CHECK(straight({360.0 / 13}, 13, {3}).clear().empty());
}

TEST_CASE("sides are smooth whose edges turn to and fro by a fifth", "[thresholds]") {
  // the distance of an edge's direction from the mean of those beside it is twice the sine of half the angle between them
  for (const double off : {0.198, 0.202}) {
    const double turn = 2 * std::asin(off / 2) * 180 / M_PI;
    std::vector<double> turns = {90 - turn / 2};
    for (int k = 0; k < 9; ++k) turns.push_back(k % 2 ? -turn : turn);
    turns.back() -= turn / 2;
    const PlaneRim rim(turns, 4);
    const std::vector<Index> corners = {0, 10, 20, 30};
    CHECK(zigzag(rim.mesh(), rim.rim, corners) == Approx(off).epsilon(0.005));
    CHECK(rim.clear().size() == (off < 0.2 ? 4 : 0));
  }
}

TEST_CASE("a round rim turns nowhere by two and a half times its mean, or by 12 degrees", "[thresholds]") {
  CHECK(bowed(2, 2.5 * 9 - 0.2, 19).round());  // of 40 edges
  CHECK_FALSE(bowed(2, 2.5 * 9 + 0.2, 19).round());
  CHECK(bowed(2, 11.9, 99).round());
  CHECK_FALSE(bowed(2, 12.1, 99).round());
}

TEST_CASE("a corner turns by 40 degrees where a round rim would turn by 15", "[thresholds]") {
  CHECK(bowed(3, 39.8, 7).detected().empty());
  CHECK(bowed(3, 40.2, 7).detected() == std::vector<Index>{0, 8, 16});
}

TEST_CASE("a corner turns by one and a half times what a round rim would", "[thresholds]") {
  // of 12 edges by 30 degrees; the vertices beside the corners turn by more than half of what these do
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
    } catch (const Refusal& refusal) {
      return refusal.what();
    }
    return "";
  };
  CHECK(said(straight({360.0 / 8}, 8, {8})) == "Rim has 8 corners; select three");
  // from ten on corners turn by less than 40 degrees; twelve are those of a star
  const auto star = [](int points) { return straight({360.0 / points + 60, -60}, points, {6, 6}); };
  CHECK(said(star(12)) == "Rim has 12 corners; select three");
  CHECK(said(star(13)) == "Rim has more than 12 corners; select three");
}

TEST_CASE("what turns two vertices beside a clear corner is compared with it, what turns three beside is not", "[thresholds]") {
  const auto pair_at = [](int place) {
    std::vector<double> turns(12, 0.0);
    turns[0] = 80;
    turns[place] = turns[place + 1] = 50;
    return PlaneRim(turns, 2).clear();
  };
  CHECK(pair_at(2).empty());
  CHECK(pair_at(3) == std::vector<Index>{0, 12});
}

TEST_CASE("a round rim has eight edges", "[thresholds]") {
  CHECK_FALSE(bowed(2, 110, 2).round());  // of six
  CHECK(bowed(2, 100, 3).round());
}

TEST_CASE("of two turns that differ by less than a millionth of a radian the one at the lower vertex is the corner",
          "[thresholds]") {
  for (const double lead : {0.9e-6, 1.1e-6}) {  // over a window half of what the turns differ by
    const double off = lead * 180 / M_PI;
    const PlaneRim rim({60 - off, 60 + off, 0, 0}, 3, {0.5, 0.5, 3.5, 3.5});
    CHECK(rim.detected() == (lead < 1e-6 ? std::vector<Index>{0, 4, 8} : std::vector<Index>{1, 5, 9}));
  }
}
