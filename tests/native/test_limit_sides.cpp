// The sides of a hole on the limit surface of its cage.
#include <catch2/catch.hpp>
#include <cmath>

#include "test_cages.h"
#include "tripatch/boundary/limit_sides.h"
#include "tripatch/boundary/surroundings.h"

using namespace tripatch;
using tripatch::testing::CubeCorner;

namespace {

LimitSides sides_of(const CubeCorner& corner) {
  const Connectivity around(corner.mesh());
  return limit_sides(corner.mesh(), around, around, corner.hole, {});
}

Vec3 at(const PiecewisePolynomial& c, double t) {
  Vec3 p;
  c.taylor(t, 0, p.data());
  return p;
}

}  // namespace

TEST_CASE("sides of a flat cage lie in its plane, meet at the corners, and face away from the hole") {
  const CubeCorner corner(5, 2, [](double, double) { return 0.0; });
  const LimitSides limit = sides_of(corner);
  for (int i = 0; i < 3; ++i) {
    const Side &side = limit.sides[i], &next = limit.sides[(i + 1) % 3];
    CHECK((at(side.c, 1) - at(next.c, 0)).norm() < 1e-12);
    for (double t : {0.1, 0.37, 0.5, 0.8}) {
      CHECK(std::abs(at(side.c, t)[2]) < 1e-12);
      CHECK(std::abs(at(side.r, t)[2]) < 1e-12);
      CHECK(std::abs(std::abs(side.normal(t)[2]) - 1) < 1e-12);
      CHECK(at(side.r, t).dot(at(side.c, t)) > 0);  // the hole's middle is the origin
    }
  }
  CHECK(limit.surroundings_error == 0);
}

TEST_CASE("points of the limit's rim are those of its sides at their parameters, equally many to each edge") {
  const CubeCorner corner(6, 2, [](double x, double y) { return 0.1 * x * x - 0.2 * x * y + 0.05 * y * y * y; });
  const LimitSides limit = sides_of(corner);
  Index count = 0;
  for (int i = 0; i < 3; ++i) {
    const std::vector<double>& t = limit.parameters[i];
    REQUIRE(t.size() > 5);
    CHECK(t.front() == 0);
    CHECK(t.back() == Approx(1));
    CHECK((t.size() - 1) % 4 == 0);  // of four edges
    for (std::size_t k = 1; k < t.size(); ++k) CHECK(t[k] - t[k - 1] == Approx(1 / static_cast<double>(t.size() - 1)));
    count += static_cast<Index>(t.size()) - 1;
  }
  REQUIRE(limit.border.rows() == count);
  Index row = 0;
  for (int i : {2, 0, 1})  // from corner 0 on
    for (std::size_t k = 0; k + 1 < limit.parameters[i].size(); ++k, ++row)
      CHECK((at(limit.sides[i].c, limit.parameters[i][k]) - Vec3(limit.border.row(row))).norm() < 1e-5);
}

TEST_CASE("sides of a cage that is moved are its sides, moved") {
  CubeCorner corner(5, 1, [](double x, double y) { return 0.2 * x * x - 0.1 * x * y; });
  const LimitSides here = sides_of(corner);
  const Eigen::RowVector3d way(3, -2, 5);
  corner.vertices.rowwise() += way;
  const LimitSides there = sides_of(corner);
  for (int i = 0; i < 3; ++i)
    for (double t : {0.0, 0.3, 0.9}) {
      CHECK((at(there.sides[i].c, t) - at(here.sides[i].c, t) - way.transpose()).norm() < 1e-9);
      CHECK((there.sides[i].normal(t) - here.sides[i].normal(t)).norm() < 1e-8);
    }
}

TEST_CASE("vertices of the rim are where their edges end, however many points the border has between them") {
  const CubeCorner corner(5, 2, [](double x, double y) { return 0.1 * x * y; });
  const Connectivity around(corner.mesh());
  for (int level : {1, 3}) {
    Subdivision settings;
    settings.level = level;
    const Surroundings found = surroundings_of(corner.mesh(), around, around, corner.hole, &settings);
    const Points b = rim_barycentric(corner.hole, found);
    REQUIRE(b.rows() == static_cast<Index>(corner.hole.rim.size()));
    CHECK(found.border.rows() == b.rows() << level);
    CHECK((b.rowwise().sum().array() - 1).abs().maxCoeff() < 1e-15);
    for (Index k = 0; k < b.rows(); ++k) {  // a point of the side opposite the corner whose coordinate is 0
      int side = 0;
      b.row(k).minCoeff(&side);
      const Vec3 p = at(found.sides[side].c, b(k, (side + 2) % 3));
      CHECK((p - found.border.row(k << level).transpose()).norm() < 1e-12);
    }
  }
}
