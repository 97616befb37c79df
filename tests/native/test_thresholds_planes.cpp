// Which of the planes estimated at a rim vertex is taken, on both sides of each threshold.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_drafts.h"
#include "tripatch/estimate/side_planes.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

constexpr double one_degree = std::numbers::pi / 180;

/// Whether the second of two neighborhoods of six rings is taken where it is so much likelier. Both planes may be there.
bool second_taken(FlatDrafts& flat, double likelier, double rough = 0) {
  SideDraft side = flat.side();
  const SideFit fit = choose(flat.w, along(flat, {leaning(0, rather, 0), leaning(0.01, rather, likelier)}), side, rough);
  return fit.ends[0].normal[1] < -0.005;
}

}  // namespace

TEST_CASE("a smaller neighborhood is taken that predicts better by half in the logarithm, where there is noise by two",
          "[thresholds]") {
  FlatDrafts flat(4);
  CHECK_FALSE(second_taken(flat, 0.49));
  CHECK(second_taken(flat, 0.51));
  const double noisy = 1e-5;  // a deviation of 3.2e-3 of an edge
  CHECK_FALSE(second_taken(flat, 1.98, noisy));
  CHECK(second_taken(flat, 2.02, noisy));
}

TEST_CASE("a rim has noise from a deviation of 0.003 edges on", "[thresholds]") {
  FlatDrafts flat(4);
  for (const double deviation : {2.95e-3, 3.05e-3}) CHECK(second_taken(flat, 1, deviation * deviation) == (deviation < 3e-3));
}

TEST_CASE("a side turns coarsely from 0.3 radians an edge on", "[thresholds]") {
  for (const double turn : {0.297, 0.303}) {
    FlatDrafts flat(4);
    for (int k = 0; k <= 4; ++k)  // an arc out of the plane; its chords turn by 2 sin(a / 2)
      flat.side().faces[k] = Vec3(std::sin((k - 2) * turn), 0, std::cos((k - 2) * turn));
    Vec3 p = Vec3::Zero();
    for (int k = 0; k <= 4; ++k) {
      flat.side().position[k] = p;
      const double angle = (k - 1.5) * 2 * std::asin(turn / 2);
      p += Vec3(std::cos(angle), 0, -std::sin(angle));
    }
    CHECK(second_taken(flat, 1) == (turn < 0.3));
  }
}

TEST_CASE("vertices up to two places away are judged together", "[thresholds]") {
  FlatDrafts flat(6);
  for (const int place : {2, 3}) {
    Fits fits = along(flat, {leaning(0, rather, 0), leaning(0.01, rather, 0)});
    fits[1][place].density = {6};
    SideDraft side = flat.side();
    CHECK((choose(flat.w, fits, side, 0).ends[0].normal[1] < -0.005) == (place == 2));
  }
}

TEST_CASE("a plane leans by a fiftieth, and by twice what the faces near it do, before another is taken", "[thresholds]") {
  for (const double faces_lean : {0.0, 0.1})
    for (const double more : {-0.002, 0.002}) {
      FlatDrafts flat(4);
      for (Vec3& n : flat.side().faces) n = Vec3(0, faces_lean, std::sqrt(1 - faces_lean * faces_lean));
      // what a normal leans by against the faces' own, and one that does not
      const auto plane = [&](double lean) { return leaning(std::sin(std::asin(lean) - std::asin(faces_lean)), certain, 0); };
      SideDraft side = flat.side();
      const VertexFit steep = plane(0.02 + 2 * faces_lean + more);
      const SideFit fit = choose(flat.w, along(flat, {steep, plane(0)}), side, 0);
      CHECK((fit.ends[0].normal == steep.normal) == (more < 0));
    }
}

TEST_CASE("nor better than by a quarter of what the faces lean by, over the square of the rings", "[thresholds]") {
  // faces lean by 0.1: two rings tell a plane to 0.00625. Against one that is known to half of that they have to predict better by
  // the logarithm of 2 more.
  for (const double more : {-0.03, 0.03}) {
    FlatDrafts flat(4);
    for (Vec3& n : flat.side().faces) n = Vec3(0, 0.1, std::sqrt(0.99));
    SideDraft side = flat.side();
    const double known = std::pow(0.25 * 0.1 / 4 / 2, 2), never = -100;
    const VertexFit large = leaning(0, known, 0), other = leaning(0, known, never),
                    two = leaning(0.01, certain, 0.5 + std::log(2) + more);
    CHECK((choose(flat.w, along(flat, {large, other, other, two}), side, 0).ends[0].normal == two.normal) == (more > 0));
  }
}

TEST_CASE("less certain neighborhoods have to predict better, more certain ones by no less than nothing", "[thresholds]") {
  FlatDrafts flat(4);
  for (const double likelier : {-0.02, 0.02}) {
    SideDraft side = flat.side();
    const VertexFit small = leaning(0.01, certain / 100, likelier);
    CHECK((choose(flat.w, along(flat, {leaning(0, certain, 0), small}), side, 0).ends[0].normal == small.normal) ==
          (likelier > 0));
  }
}

TEST_CASE("the facets' mean is taken within five standard deviations of the plane and a fiftieth", "[thresholds]") {
  for (const auto& [lean, variance, taken] :
       {std::tuple(4.95e-3, certain, true), {5.05e-3, certain, false}, {0.0198, rather, true}, {0.0202, rather, false}}) {
    FlatDrafts flat(4);
    SideDraft side = flat.side();
    const double chord = 2 * std::sin(std::asin(lean) / 2);  // what two unit normals differ by
    choose(flat.w, along(flat, {leaning(lean * lean / chord, variance, 0)}), side, 0);
    CHECK((side.normal[2] == Vec3::UnitZ()) == taken);
  }
}

TEST_CASE("faces in one plane are the plane of a side that turns by five degrees, to a thousandth of a degree", "[thresholds]") {
  for (const auto& [turn, apart, is_plane] :
       {std::tuple(4.9, 0.0, false), {5.1, 0.0, true}, {30.0, 0.98e-3, true}, {30.0, 1.02e-3, false}}) {
    FlatDrafts flat(4);
    flat.side().tangent[4] = Vec3(std::cos(turn * one_degree), std::sin(turn * one_degree), 0);
    flat.w.area[flat.side().face[2]] = Vec3(std::sin(apart * one_degree), 0, std::cos(apart * one_degree));
    SideDraft side = flat.side();
    const SideFit fit = choose(flat.w, along(flat, {leaning(0.01, certain, 0), leaning(0.01, certain, 0)}), side, 0);
    CHECK((fit.ends[0].normal[1] == 0) == is_plane);
  }
}
