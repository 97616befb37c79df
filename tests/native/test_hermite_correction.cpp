// Points that a surface over a plane meets exactly: the conditions, what stays, derivatives, and what is known then.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "tripatch/spline/hermite_correction.h"
#include "tripatch/spline/polyharmonic_spline.h"

using namespace tripatch;

namespace {

/// A ring of places about the origin, and a bowl over them.
PlanePoints ring_of_places(Index n) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  PlanePoints places(n, 2);
  for (Index k = 0; k < n;) {
    places.row(k) << uniform(random), uniform(random);
    if (places.row(k).norm() > 0.6 && places.row(k).norm() < 1) ++k;
  }
  return places;
}

Points bowl_over(const PlanePoints& at) {
  Points out(at.rows(), 3);
  for (Index k = 0; k < at.rows(); ++k) out.row(k) << at(k, 0), at(k, 1), 0.4 * at.row(k).squaredNorm();
  return out;
}

Points rows_over(const PlanePoints& uv) {
  Points rows = Points::Zero(uv.rows(), 3);
  rows.leftCols(2) = uv;
  return rows;
}

struct Bowl {
  PlanePoints samples = ring_of_places(150), rim = PlanePoints(24, 2);
  PolyharmonicSpline field{samples, bowl_over(samples), {}};
  Bowl() {
    for (Index k = 0; k < 24; ++k)
      rim.row(k) << 0.6 * std::cos(k * std::numbers::pi / 12), 0.6 * std::sin(k * std::numbers::pi / 12);
  }
};

const std::vector<Through> three_points = {
    {Vec3(0.1, -0.2, 0.3), {}}, {Vec3(-0.3, 0.1, -0.1), Vec3(0.2, -0.1, 1)}, {Vec3(0.2, 0.3, 0.2), Vec3(0, 0.3, 1)}};

PlanePoints three_places() {
  PlanePoints places(3, 2);
  places << 0.1, -0.2, -0.28, 0.12, 0.2, 0.25;
  return places;
}

}  // namespace

TEST_CASE("points and normals are met to rounding and the rim stays with its slopes") {
  const Bowl bowl;
  const HermiteCorrection added(bowl.field, bowl.rim, three_places(), three_points);
  const auto [positions, normals] =
      sum(std::make_shared<PolyharmonicSpline>(bowl.field), std::make_shared<HermiteCorrection>(added))
          ->positions_and_normals(rows_over(three_places()));
  for (Index k = 0; k < 3; ++k) {
    CHECK((Vec3(positions.row(k)) - three_points[k].point).norm() < 1e-12);
    if (three_points[k].normal) CHECK(Vec3(normals.row(k)).cross(three_points[k].normal->normalized()).norm() < 1e-9);
  }
  std::vector<double> jets(9 * 24);
  added.evaluate(rows_over(bowl.rim).data(), 24, 1, jets.data());
  CHECK(Eigen::VectorXd::Map(jets.data(), 9 * 24).norm() < 1e-7);
}

TEST_CASE("a surface is turned into planes along its rim, which stays where it is") {
  const Bowl bowl;
  Points planes(24, 3);  // steeper than the bowl by a tenth
  for (Index k = 0; k < 24; ++k) planes.row(k) = Vec3(-0.9 * bowl.rim(k, 0), -0.9 * bowl.rim(k, 1), 1).normalized();
  const auto added = std::make_shared<HermiteCorrection>(bowl.field, bowl.rim, PlanePoints(0, 2), std::vector<Through>(), planes);
  const auto [positions, normals] =
      sum(std::make_shared<PolyharmonicSpline>(bowl.field), added)->positions_and_normals(rows_over(bowl.rim));
  CHECK((normals - planes).norm() < 1e-7);
  CHECK(added->positions(rows_over(bowl.rim)).norm() < 1e-7);
  CHECK(added->positions(Points::Zero(1, 3)).norm() > 1e-3);  // and the inside follows
}

TEST_CASE("what meets points has the derivatives of its positions") {
  const Bowl bowl;
  const HermiteCorrection added(bowl.field, bowl.rim, three_places(), three_points);
  const double h = 1e-4;
  PlanePoints around(5, 2);
  around << 0.05, 0.07, 0.05 + h, 0.07, 0.05 - h, 0.07, 0.05, 0.07 + h, 0.05, 0.07 - h;
  for (int order : {1, 2, 3}) {
    const int size = jet_size(order), below = jet_size(order - 1);
    Eigen::MatrixXd jets(5, 3 * size);
    std::vector<double> flat(static_cast<std::size_t>(5 * 3 * size));
    added.evaluate(rows_over(around).data(), 5, order, flat.data());
    for (Index k = 0; k < 5; ++k) jets.row(k) = Eigen::RowVectorXd::Map(&flat[3 * size * k], 3 * size);
    // the coefficient of du^order is that of du^(order - 1), derived by u, over the order
    const auto top = [&](Index k, int first) { return Eigen::RowVector3d(jets.row(k).segment<3>(3 * first)); };
    const int lower = jet_size(order - 2 < 0 ? 0 : order - 2) * (order > 1);
    CHECK(((top(1, lower) - top(2, lower)) / (2 * h) - order * top(0, below)).norm() <
          1e-5 * std::max(1.0, top(0, below).norm()));
  }
}

TEST_CASE("nothing is left to know at points that are met and more farther off") {
  const Bowl bowl;
  const HermiteCorrection added(bowl.field, bowl.rim, three_places(), three_points);
  PlanePoints at(5, 2);
  at << three_places(), bowl.rim.topRows(1), -0.1, -0.1;
  Points up = Points::Zero(5, 3);
  up.col(2).setOnes();
  const Eigen::VectorXd before = bowl.field.deviation(at, up);
  const Eigen::VectorXd left = added.deviation_left(at, before, before.head(3));
  CHECK(left.head(3).maxCoeff() < 1e-6 * before.maxCoeff());
  CHECK(left[3] <= before[3]);  // at the rim nothing is added
  CHECK((left[4] > 0 && left[4] < before[4]));
}

TEST_CASE("the nearest place of a point above its surface is below it and inside") {
  const Bowl bowl;
  PlanePoints corners(5, 2);
  corners << -0.5, -0.5, 0.5, -0.5, 0.5, 0.5, -0.5, 0.5, 0, 0;
  const std::vector<std::array<Index, 3>> triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  // under the middle of the bowl, farther than its center of curvature is from its other side; and beyond the border
  const PlanePoints places =
      nearest_places(bowl.field, corners, triangles, {{Vec3(0, 0, -3), {}}, {Vec3(0.2, 0.1, 0.02), {}}, {Vec3(2, 0, 0), {}}});
  CHECK(places.row(0).norm() < 1e-3);
  CHECK((places.row(1) - Eigen::RowVector2d(0.2, 0.1)).norm() < 0.02);
  CHECK(places(2, 0) < 0.5);
}

TEST_CASE("two points over one place are refused") {
  const Bowl bowl;
  PlanePoints places(2, 2);
  places << 0.1, 0.1, 0.1, 0.1;
  CHECK_THROWS_AS(HermiteCorrection(bowl.field, bowl.rim, places, {{Vec3(0, 0, 1), {}}, {Vec3(0, 0, 2), {}}}), Refusal);
}
