// Which vertices tell the plane at a rim vertex.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_drafts.h"
#include "tripatch/estimate/stencils.h"
#include "tripatch/math/smoothstep.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

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

/// The vertices farthest from vertex k among those that tell its plane say nothing any more.
void silence(FlatDrafts& flat, const std::vector<std::array<int, 2>>& places) {
  for (const auto& [i, j] : places) flat.w.on_chord[flat.local(i, j)] = 1;
}

}  // namespace

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
