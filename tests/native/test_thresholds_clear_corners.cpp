// What makes a clear corner of a rim, and a rim round, on both sides of each threshold.
#include <numbers>

#include "test_plane_rims.h"
#include "tripatch/hole/rim_shape.h"

using namespace tripatch;
using namespace tripatch::testing;

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

TEST_CASE("a bend beside a corner that turns four times as much is no corner of its own", "[thresholds]") {
  const auto times = [](double r) { return PlaneRim({90 * r / (r + 1), 90 / (r + 1), 0, 0, 0, 0}, 4).clear(); };
  CHECK(times(3.95).empty());  // two corners an edge apart
  CHECK(times(4.05) == std::vector<Index>{0, 6, 12, 18});
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
  // the distance of an edge's direction from the mean of those next to it is twice the sine of half the angle between them
  for (const double off : {0.198, 0.202}) {
    const double turn = 2 * std::asin(off / 2) * 180 / std::numbers::pi;
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

TEST_CASE("the plane in which a rim turns is that of the faces within a third of its window", "[thresholds]") {
  // a window is a 24th of the rim: a third of it is just over two of 150 edges
  PlaneRim rim(std::vector<double>(150, 2.4), 1);
  const std::vector<double> flat = measure(rim.mesh(), Connectivity(rim.mesh()), rim.rim).turn;
  rim.vertices(150 + 75, 2) = 30;  // in faces at two vertices of the rim
  const std::vector<double> lifted = measure(rim.mesh(), Connectivity(rim.mesh()), rim.rim).turn;
  Index changed = 0;
  for (std::size_t k = 0; k < flat.size(); ++k) changed += std::abs(lifted[k] - flat[k]) > 1e-6;
  CHECK(changed == 2 + 2 * 2);
}

TEST_CASE("a round rim turns inwards no more than outwards: by two and a half times what each vertex would", "[thresholds]") {
  const auto dented = [](double inwards) {  // of 72 edges, which would turn by 5 degrees each
    std::vector<double> turns(36, (180 + inwards) / 35);
    turns[18] = -inwards;
    return PlaneRim(turns, 2).round();
  };
  CHECK(dented(12.4));
  CHECK_FALSE(dented(12.6));
}
