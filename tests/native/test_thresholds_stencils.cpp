// Which vertices tell the plane at a rim vertex, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_drafts.h"
#include "tripatch/estimate/stencils.h"
#include "tripatch/math/smoothstep.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

constexpr double one_degree = std::numbers::pi / 180;

/// Vertices that tell the plane at vertex k of side 2, and how much they count.
std::vector<Share> told(const FlatDrafts& flat, int k, int rings, bool widened = false) {
  SideSearch search(flat.w, flat.drafts, 2);
  Seen seen;
  look(flat.w, flat.drafts[2], k, {rings, widened, true, false}, search, seen);
  return seen.used;
}

/// Of one vertex; 0 where it is not among them.
double share_of(const FlatDrafts& flat, int k, int rings, int v, bool widened = false) {
  for (const auto& [vertex, share] : told(flat, k, rings, widened))
    if (vertex == v) return share;
  return 0;
}

Vec3 turned(double degrees) { return {std::sin(degrees * one_degree), 0, std::cos(degrees * one_degree)}; }

/// The vertices farthest from vertex k among those that tell its plane say nothing any more.
void silence(FlatDrafts& flat, const std::vector<std::array<int, 2>>& places) {
  for (const auto& [i, j] : places) flat.w.on_chord[flat.local(i, j)] = 1;
}

}  // namespace

TEST_CASE("what lies more than 0.35 edges beyond a side's end says nothing of it, and all within 0.1", "[thresholds]") {
  for (const double beyond : {0.05, 0.11, 0.2, 0.345, 0.355}) {
    FlatDrafts flat(4);
    const int v = flat.local(-1, -1);
    flat.w.position[v] = Vec3(-beyond, -1, 0);
    CHECK(share_of(flat, 0, 1, v) == Approx(smoothstep((0.35 - beyond) / 0.25)).margin(1e-12));
  }
}

TEST_CASE("nor what is 1.3 times as far from it as from its neighbor, and all that is as near", "[thresholds]") {
  for (const double ratio : {1.0, 1.06, 1.15, 1.29, 1.31}) {
    FlatDrafts flat(4);
    const int v = flat.local(-1, -1);
    flat.w.position[v] = Vec3(0, ratio / (1 + ratio), 0);  // between the side's first vertex and the neighbor's last but one
    CHECK(share_of(flat, 0, 1, v) == Approx(smoothstep((1.3 - ratio) / 0.25)).margin(1e-12));
  }
}

TEST_CASE("vertices count where they are turned by less than 60 degrees, and fully up to 37", "[thresholds]") {
  for (const double cosine : {0.49, 0.51, 0.6, 0.79, 0.81}) {
    FlatDrafts flat(4);
    const int v = flat.local(2, -1);
    flat.w.normal_at[v] = Vec3(0, std::sqrt(1 - cosine * cosine), cosine);
    CHECK(share_of(flat, 2, 1, v) == Approx(std::max(smoothstep((cosine - 0.5) / 0.3), 1e-6)));
  }
}

TEST_CASE("faces turned by 60 degrees are another sheet", "[thresholds]") {
  for (const double degrees : {59.5, 60.5}) {
    FlatDrafts flat(4);
    for (int i = -7; i < 11; ++i)  // the second row next to the hole, and nothing leads beyond it
      for (int f : flat.w.part.faces_at(flat.local(i, -2)))
        for (int v : flat.w.part[f])
          if (v == flat.local(i, -1)) flat.w.area[f] = flat.w.twice_area[f] * turned(degrees);
    CHECK((share_of(flat, 2, 4, flat.local(2, -2)) > 0) == (degrees < 60));
  }
}

TEST_CASE("a stencil stops growing at fifty vertices", "[thresholds]") {
  // five rings in front of a straight side are 66, six are 91
  std::vector<std::array<int, 2>> places;
  for (int i = -5; i <= 5; ++i) places.push_back({10 + i, -5});
  for (int i = -2; i <= 3; ++i) places.push_back({10 + i, -4});
  for (const std::size_t silent : {16, 17}) {
    FlatDrafts flat(20);
    silence(flat, {places.begin(), places.begin() + static_cast<std::ptrdiff_t>(silent)});
    CHECK(told(flat, 10, 6).size() == (silent == 16 ? 50 : 91 - 17));
  }
}

TEST_CASE("with fewer than eight vertices in front of the side beyond the rim what lies beside it is used", "[thresholds]") {
  // three rings from a corner have twelve beyond the rim
  const std::vector<std::array<int, 2>> places = {{0, -3}, {1, -3}, {2, -3}, {3, -3}, {3, -2}};
  for (const std::size_t silent : {4, 5}) {
    FlatDrafts flat(6);
    silence(flat, {places.begin(), places.begin() + static_cast<std::ptrdiff_t>(silent)});
    CHECK((share_of(flat, 0, 3, flat.local(-1, -1), true) > 0) == (silent == 5));
    CHECK(share_of(flat, 0, 3, flat.local(-1, -1), false) == 0);
  }
}

TEST_CASE("where all that is there tells a plane already it counts as it does") {
  FlatDrafts flat(4);
  silence(flat, {{-1, 0}, {-1, 1}, {0, 1}});
  const int v = flat.local(-1, -1);
  flat.w.position[v] = Vec3(-0.2, -1, 0);
  CHECK(share_of(flat, 0, 1, v, true) == Approx(smoothstep(0.15 / 0.25)));
}

TEST_CASE("beyond sharp edges nothing tells a plane, though faces there touch those that do") {
  for (const bool sharp : {false, true}) {
    FlatDrafts flat(4);
    const Submesh& part = flat.w.part;
    for (int f = 0; sharp && f + 1 < static_cast<int>(part.offsets.size()); ++f)
      for (int c = part.offsets[f]; c < part.offsets[f + 1]; ++c) {
        const int from = part[f][c - part.offsets[f]], to = part[f][(c + 1 - part.offsets[f]) % 4];
        if (flat.w.position[from][1] == -2 && flat.w.position[to][1] == -2) flat.w.across[c] = -1;
      }
    CHECK(share_of(flat, 2, 4, flat.local(2, -2)) > 0);
    CHECK((share_of(flat, 2, 4, flat.local(2, -3)) > 0) == !sharp);
  }
}

TEST_CASE("the curve through a rim knows its direction by the shorter edge beside a vertex, its bend by the longer one") {
  const auto measured = [](FlatDrafts& flat, int k) {
    SideSearch search(flat.w, flat.drafts, 2);
    Seen seen;
    measure(flat.w, flat.drafts[2], k, {1, false, true, false}, search, seen);
    return seen.stencil;
  };
  for (const double before : {0.5, 1.0, 1.4}) {
    FlatDrafts flat(6);
    flat.side().position[1] = Vec3(2 - before, 0, 0);
    const Stencil inside = measured(flat, 2);  // edges of length `before` and 1
    CHECK(inside.slope_noise == Approx(std::pow(1.1 / std::min(before, 1.0), 2)));
    CHECK(inside.slope_truncation == Approx(std::pow(std::max(before, 1.0), 3) / 24));
    const Stencil end = measured(flat, 6);  // one edge, of length 1
    CHECK(end.slope_noise == Approx(3.8 * 3.8));
    CHECK(end.slope_truncation == Approx(0.25));
  }
}
