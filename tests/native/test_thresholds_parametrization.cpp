// What decides between and about triangles before there is a surface, on both sides of each threshold.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "test_triangles.h"
#include "tripatch/parametrization/parametrization.h"
#include "tripatch/report/crossings.h"
#include "tripatch/spline/disc.h"
#include "tripatch/spline/minimize_bending.h"
#include "tripatch/triangulation/min_weight_triangulation.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

Points circle(Index n) {
  Points p(n, 3);
  for (Index k = 0; k < n; ++k) {
    const double a = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n);
    p.row(k) << std::cos(a), std::sin(a), 0;
  }
  return p;
}

}  // namespace

TEST_CASE("up to 200 vertices the best triangulation of all is taken, of more the best of parts", "[thresholds]") {
  const auto thirds = [](Index n) {  // edges between every third vertex, where parts begin
    const Triangles triangles = min_weight_triangulation(circle(n)).triangles;
    Index count = 0;
    for (Index k = 0; k < n; k += 3) count += has_edge(triangles, k, (k + 3) % n);
    return count;
  };
  CHECK(thirds(198) < 66);
  CHECK(thirds(201) == 67);
}

TEST_CASE("angles whose squared cosines round to the same 256th are equally good, and the area decides", "[thresholds]") {
  Points x(4, 3);  // over 1-3 the area is less
  x << -1, 0, 0, 0, -0.9, 0.3, 1, 0, 0, 0, 0.9, 0.3;
  const auto normal = [&](Index a, Index b, Index c) -> Vec3 {
    return Vec3(x.row(b) - x.row(a)).cross(Vec3(x.row(c) - x.row(a))).normalized();
  };
  // the face beyond edge 0-1 is at such angles to the triangles there over 0-2 and over 1-3
  const auto over_02 = [&](double square_02, double square_13) {
    const Vec3 n = normal(0, 1, 2), m = normal(0, 1, 3), across = n.cross(m).normalized();
    Eigen::Matrix3d rows;
    rows << n.transpose(), m.transpose(), across.transpose();
    Vec3 beyond = rows.inverse() * Vec3(std::sqrt(square_02), std::sqrt(square_13), 0);
    beyond += across * std::sqrt(1 - beyond.squaredNorm());
    RimSurroundings rim;
    rim.normals = Points::Zero(4, 3);
    rim.normals.row(0) = beyond;
    return has_edge(min_weight_triangulation(x, rim).triangles, 0, 2);
  };
  CHECK_FALSE(over_02(64.4 / 256, 63.6 / 256));
  CHECK(over_02(64.6 / 256, 63.6 / 256));
}

TEST_CASE("a triangle has no normal whose doubled area is a ten-thousandth of two of its edges squared", "[thresholds]") {
  for (const double share : {0.97e-4, 1.03e-4}) {
    Points x(4, 3);  // over 1-3 there is a needle under the line, else the same plane
    x << 0.5, 1, 0, 0, 0, 0, 0.5, -1.25 * share, 0, 1, 0, 0;
    CHECK(has_edge(min_weight_triangulation(x).triangles, 1, 3) == (share > 1e-4));
  }
}

TEST_CASE("triangles of rims of up to 1,000 vertices do not go through each other, of more they may", "[thresholds]") {
  Points corners(6, 3);  // of their triangulations that with the least worst angle goes through itself
  corners << -0.28, 0.57, -0.38, 0.08, -0.97, -0.08, 0.4, -0.53, 0.61, 0.4, -0.46, 0.58, 0.31, -0.27, -0.36, 0.58, -0.26, -0.3;
  for (const Index n : {6, 500, 1000, 1001, 1100}) {
    Points rim(n, 3);
    for (Index side = 0, at = 0; side < 6; ++side) {
      const Index from = at, end = n * (side + 1) / 6;
      for (; at < end; ++at) {
        const double t = static_cast<double>(at - from) / static_cast<double>(end - from);
        rim.row(at) = (1 - t) * corners.row(side) + t * corners.row((side + 1) % 6);
      }
    }
    const RoughFill made = min_weight_triangulation(rim);
    CHECK(crosses_itself(rim, made.triangles) == (n > 1000));
    CHECK(made.crossing.empty() == (n > 1000));
  }
}

TEST_CASE("triangles are laid out a thousandth of their longest edge high at least, and those of no size with some",
          "[thresholds]") {
  for (const double height : {0.8e-3, 1.2e-3}) {
    const Points x = (Points(3, 3) << 0, 0, 0, 1, 0, 0, 0.4, height, 0).finished();
    const PlanePoints uv = parametrize(x, {{0, 1, 2}}, {200, 0})->uv;
    const Eigen::RowVector2d along = uv.row(1) - uv.row(0), up = uv.row(2) - uv.row(0);
    CHECK((along[0] * up[1] - along[1] * up[0]) / along.squaredNorm() == Approx(std::max(height, 1e-3)).epsilon(1e-4));
  }
  const PlanePoints uv = parametrize(Points::Zero(3, 3), {{0, 1, 2}}, {200, 0})->uv;
  double longest = 0;
  for (int k = 0; k < 3; ++k) longest = std::max(longest, (uv.row(k) - uv.row((k + 1) % 3)).norm());
  CHECK(longest == Approx(1e-4).epsilon(1e-4));
}

TEST_CASE("surroundings have 12,000 triangles at most", "[thresholds]") {
  constexpr Index n = 24, rings = 300;  // 48 triangles a ring
  Points vertices((rings + 1) * n, 3);
  Faces faces;
  std::vector<Index> rim;
  for (Index j = 0; j <= rings; ++j) vertices.middleRows(j * n, n) = (1 + 0.1 * static_cast<double>(j)) * circle(n);
  for (Index k = 0; k < n; ++k) {
    rim.push_back(k);
    for (Index j = 0; j < rings; ++j)
      faces.add(std::array<Index, 4>{j * n + (k + 1) % n, j * n + k, (j + 1) * n + k, (j + 1) * n + (k + 1) % n});
  }
  const Disc disc = disc_around({vertices, faces}, Connectivity(faces, vertices.rows()), {rim}, 1e9, 1000);
  CHECK(disc.rings == 250);
}

namespace {

/// A Laplacian of cotangents up to `steepest`, and areas of `least` of the mean triangle's at least.
struct Laplacian {
  Eigen::MatrixXd stiffness;
  Eigen::VectorXd areas;
  Laplacian(const Points& x, const Triangles& triangles, double steepest, double least)
      : stiffness(Eigen::MatrixXd::Zero(x.rows(), x.rows())), areas(Eigen::VectorXd::Zero(x.rows())) {
    double sum = 0;
    for (const std::array<Index, 3>& t : triangles)
      for (int k = 0; k < 3; ++k) {
        const Index a = t[(k + 1) % 3], b = t[(k + 2) % 3];
        const Vec3 u = x.row(a) - x.row(t[k]), v = x.row(b) - x.row(t[k]);
        const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
        const double twice = u.cross(v).norm(), weight = u.dot(v) / std::max(twice, longest / steepest) / 2;
        for (const auto& [i, j] : {std::pair(a, b), std::pair(b, a)}) stiffness(i, j) -= weight, stiffness(i, i) += weight;
        areas[t[k]] += twice / 6;
        sum += twice / 6;
      }
    areas = areas.cwiseMax(least * sum / static_cast<double>(triangles.size()));
  }
  Eigen::MatrixXd energy(int order) const {
    Eigen::MatrixXd out = stiffness;
    for (int k = 1; k < order; ++k) out = out * areas.cwiseInverse().asDiagonal() * stiffness;
    return out;
  }
};

/// A fan of eight triangles around vertex 0 and as many triangles around that; vertex 1 is so near to vertex 2.
std::pair<Points, Triangles> fan(double near) {
  Points x(17, 3);
  x << 0, 0, 0, circle(8), 2.2 * circle(8);
  x.row(1) = x.row(2) + near * (x.row(1) - x.row(2));
  for (Index k = 0; k < 17; ++k) x(k, 2) = 0.1 * std::sin(3.0 * static_cast<double>(k));
  x.row(1)[2] = x.row(2)[2];
  Triangles triangles;
  for (Index k = 0; k < 8; ++k) {
    const Index a = 1 + k, b = 1 + (k + 1) % 8;
    triangles.insert(triangles.end(), {{0, a, b}, {a, a + 8, b + 8}, {a, b + 8, b}});
  }
  return {x, triangles};
}

}  // namespace

TEST_CASE("cotangents are a hundred at most, and areas a thousandth of the mean one at least, where triangles bend least",
          "[thresholds]") {
  for (const double near : {0.02, 0.008}) {  // cotangents of 60 and 160 where two vertices nearly fall together
    const auto [x, triangles] = fan(near);
    const Points moved = *minimize_bending(x, triangles, {}, 0, 1, 1);
    const Points all = (Points(17, 3) << moved, x.bottomRows(16)).finished();
    const Laplacian own(x, triangles, 100, 1e-3);
    CHECK((own.energy(1).row(0) * all).norm() < 1e-12 * own.energy(1).row(0).norm());
  }
  // three triangles of a vertex in the middle of a tiny one, among others
  for (const double size : {0.01, 0.05}) {
    auto [x, triangles] = fan(1);
    triangles[0] = {0, 1, 17};
    triangles.insert(triangles.end(), {{1, 2, 17}, {2, 0, 17}});
    x.conservativeResize(18, 3);
    for (const Index v : {1, 2}) x.row(v) = x.row(0) + size * (x.row(v) - x.row(0));
    x.row(17) = (x.row(0) + x.row(1) + x.row(2)) / 3;
    const Points moved = *minimize_bending(x, triangles, {}, 17, 1, 2);
    const Points all = (Points(18, 3) << x.topRows(17), moved).finished();
    const Laplacian own(x, triangles, 100, 1e-3);
    CHECK((own.energy(2).row(17) * all).norm() < 1e-12 * own.energy(2).row(17).norm());
  }
}

TEST_CASE("the second model has a quarter of the triangles whose bending varies least", "[thresholds]") {
  const auto [x, triangles] = fan(1);
  Disc none;
  none.rim = 16;
  none.points = Points(16, 3);
  Points turned(17, 3);  // the rim first
  turned << x.bottomRows(16), x.topRows(1);
  Triangles rows = triangles;
  for (std::array<Index, 3>& t : rows)
    for (Index& v : t) v = (v + 16) % 17;
  SecondModels models(turned, rows, none);
  const SecondModel model = *models.by({2, 3});
  CHECK(models.by({2})->vertices == second_model(turned, rows, none, {2})->vertices);
  CHECK(models.by({1})->vertices == second_model(turned, rows, none, {1})->vertices);
  const Points bends = *minimize_bending(turned, rows, {}, 16, 1, 2), varies = *minimize_bending(turned, rows, {}, 16, 1, 3);
  REQUIRE((bends - varies).norm() > 1e-6);
  CHECK((model.vertices - (0.75 * bends + 0.25 * varies)).norm() < 1e-12);
  CHECK((model.apart - std::sqrt(0.75 * 0.25) * (varies - bends)).norm() < 1e-12);
}
