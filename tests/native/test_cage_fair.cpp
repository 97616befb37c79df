#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/cage/cage_fair.h"
#include "tripatch/cage/cage_system.h"

using namespace tripatch;

namespace {

/// A grid of quads, `side` vertices each way, at place(i, j).
struct Grid {
  Points vertices;
  Faces faces;
  int side;

  template <class Place>
  Grid(int of, const Place& place) : vertices(of * of, 3), side(of) {
    for (int i = 0; i < side; ++i)
      for (int j = 0; j < side; ++j) vertices.row(i * side + j) = place(i, j);
    for (int i = 0; i + 1 < side; ++i)
      for (int j = 0; j + 1 < side; ++j)
        faces.add(std::array<Index, 4>{i * side + j, (i + 1) * side + j, (i + 1) * side + j + 1, i * side + j + 1});
  }
};

/// The vertices in the middle freed and moved out of the way, and where the fair cage has them.
/// held: the weight of their squared distances from where they were moved.
Points repaired(const Grid& given, int first, int last, FairHole& hole, double held = 0) {
  Points vertices = given.vertices;
  std::vector<Index> free;
  for (int i = first; i <= last; ++i)
    for (int j = first; j <= last; ++j) {
      free.push_back(i * given.side + j);
      vertices.row(free.back()) += Eigen::RowVector3d(0.03 * i, -0.02 * j, 0.4 - 0.05 * i);
    }
  Subdivision settings;
  settings.quality = 5;
  const LimitSurface limit({vertices, given.faces}, settings);
  CageSystem system(vertices, free);
  std::vector<FacePlace> places;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) places.push_back({0, (i + 0.5) / 4, (j + 0.5) / 4});
  std::vector<Sums> sums;
  std::vector<char> inside;
  for (int i = first - 2; i <= last + 1; ++i)
    for (int j = first - 2; j <= last + 1; ++j) {
      const LimitStencils stencils = limit.stencils(i * (given.side - 1) + j, places);
      sums.push_back(system.sums(stencils.vertices, stencils.p));
      inside.push_back(i >= first - 1 && i <= last && j >= first - 1 && j <= last);
    }
  std::vector<const Sums*> together;
  for (const Sums& s : sums) together.push_back(&s);
  system.prepare(together);
  hole.size = 1;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    hole.even.push_back(face_shape(sums[k], false));
    if (inside[k]) hole.inside.push_back(hole.even.back());
  }
  Points start(static_cast<Index>(free.size()), 3);
  for (std::size_t k = 0; k < free.size(); ++k) start.row(static_cast<Index>(k)) = vertices.row(free[k]);
  std::vector<FairHole> holes = {hole};
  CageSystem::Term stay = system.zero();
  for (int k = 0; k < static_cast<int>(free.size()); ++k)
    system.add(stay, {{k}, Weights::Ones(1, 1), Points::Zero(1, 3)}, 0, held * Eigen::Matrix3d::Identity(), Vec3::Zero());
  const Points found = fair_cage(system, start, holes, stay, {});
  hole = holes[0];
  for (std::size_t k = 0; k < free.size(); ++k) vertices.row(free[k]) = found.row(static_cast<Index>(k));
  return vertices;
}

}  // namespace

TEST_CASE("derivatives of a face's shape are those of the limit surface", "[cage]") {
  const Grid grid(8, [](int i, int j) { return Vec3(0.2 * i, 0.2 * j + 0.01 * i * j, std::sin(0.5 * i) * std::cos(0.4 * j)); });
  Subdivision settings;
  settings.quality = 5;
  const LimitSurface limit({grid.vertices, grid.faces}, settings);
  const Index face = 3 * 7 + 3;
  std::vector<FacePlace> places;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) places.push_back({0, (i + 0.5) / 4, (j + 0.5) / 4});
  const LimitStencils stencils = limit.stencils(face, places);
  const CageSystem none(grid.vertices, {});
  const FaceShape shape = face_shape(none.sums(stencils.vertices, stencils.p), false);
  const Points derivatives = shape.derivatives.at(Points(0, 3));
  const FacePlace at = {0, 0.25, 0.75};  // the second of the places
  const LimitStencils there = limit.stencils(face, {&at, 1});
  Points vertices(static_cast<Index>(there.vertices.size()), 3);
  for (Index k = 0; k < vertices.rows(); ++k) vertices.row(k) = grid.vertices.row(there.vertices[k]);
  CHECK((derivatives.row(9) - there.pu * vertices).norm() < 1e-12);
  CHECK((derivatives.row(10) - there.pv * vertices).norm() < 1e-12);
  const double h = 1e-4;
  const std::array<FacePlace, 2> beside = {FacePlace{0, 0.25 - h, 0.75}, FacePlace{0, 0.25 + h, 0.75}};
  const LimitStencils two = limit.stencils(face, beside);
  vertices.resize(static_cast<Index>(two.vertices.size()), 3);
  for (Index k = 0; k < vertices.rows(); ++k) vertices.row(k) = grid.vertices.row(two.vertices[k]);
  const Points slopes = two.pu * vertices;
  CHECK((derivatives.row(11) - (slopes.row(1) - slopes.row(0)) / (2 * h)).norm() < 1e-6);
}

TEST_CASE("a flat grid and a cylinder of even steps are fair already", "[cage]") {
  FairHole hole;
  const Grid flat(10, [](int i, int j) { return Vec3(0.2 * i, 0.3 * j, 1); });
  CHECK((repaired(flat, 4, 5, hole) - flat.vertices).norm() < 1e-7);
  hole = {};
  // B-splines of evenly spaced points round a circle have curvature that varies by a little
  const Grid cylinder(12, [](int i, int j) { return Vec3(std::cos(0.15 * i), std::sin(0.15 * i), 0.15 * j); });
  CHECK((repaired(cylinder, 5, 6, hole) - cylinder.vertices).rowwise().norm().maxCoeff() < 1e-4);
}

TEST_CASE("a fair cage goes on with a sphere, much nearer than the least third derivatives do", "[cage]") {
  // a cube's face seen from the middle: what the lines do is not what they do in a plane
  const Grid sphere(12, [](int i, int j) { return Vec3(0.25 * (i - 5.5), 0.25 * (j - 5.5), 1).normalized(); });
  FairHole hole;
  const Points found = repaired(sphere, 3, 8, hole);
  CHECK(hole.after < 0.1 * hole.before);
  double off = 0;
  for (int i = 3; i <= 8; ++i)
    for (int j = 3; j <= 8; ++j) off = std::max(off, std::abs(found.row(i * 12 + j).norm() - 1));
  CHECK(off < 2e-3);
}

TEST_CASE("a fair cage stays the nearer to where it is held the more that weighs", "[cage]") {
  const Grid sphere(12, [](int i, int j) { return Vec3(0.25 * (i - 5.5), 0.25 * (j - 5.5), 1).normalized(); });
  double last = INFINITY;
  for (double held : {0.0, 10.0, 1e3, 1e6}) {
    FairHole hole;
    const Points found = repaired(sphere, 4, 7, hole, held);
    double moved = 0;
    for (int i = 4; i <= 7; ++i)
      for (int j = 4; j <= 7; ++j) {
        const Eigen::RowVector3d there =
            sphere.vertices.row(i * 12 + j) + Eigen::RowVector3d(0.03 * i, -0.02 * j, 0.4 - 0.05 * i);
        moved = std::max(moved, (found.row(i * 12 + j) - there).norm());
      }
    CHECK(moved < last);
    last = moved;
  }
  CHECK(last < 1e-3);
}

TEST_CASE("a cage without vertices inside has an empty system") {
  const Grid flat(3, [](int i, int j) { return Eigen::RowVector3d(i, j, 0); });
  CageSystem system(flat.vertices, {});
  system.prepare({});
  CHECK(system.zero().g.size() == 0);
  CHECK(system.zero().h.nonZeros() == 0);
}
