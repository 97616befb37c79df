// What a mesh of a domain takes for an area, on both sides of each threshold.
#include <catch2/catch.hpp>

#include "tripatch/output/domain_mesh.h"

using namespace tripatch;

namespace {

/// Four triangles around vertex 4, which the surface makes so many times as narrow in one direction.
class Star final : public DomainMesh {
public:
  explicit Star(double narrow) : DomainMesh(4) {
    const std::array<Vec2, 5> places = {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1), Vec2(0.1, 0.2)};
    for (const Vec2& u : places) add_vertex(Vec3(0, u[0], u[1]), Vec3(u[0], narrow * u[1], 0));
    for (int k = 0; k < 4; ++k) triangles_.push_back({{4, k, (k + 1) % 4}, {-1, (k + 1) % 4, (k + 3) % 4}});
    size_.assign(5, 1);
    triangle_of_ = {0, 1, 2, 3, 0};
  }
  bool knows_way() { return way_of(4).has_value(); }
  using DomainMesh::positive;

private:
  double wanted(const Vec3&) const override { return 1; }
  bool wants_flip(int, int, int, int) const override { return false; }
};

}  // namespace

TEST_CASE("a triangle of a domain has an area from a billionth of its longest edge on", "[thresholds]") {
  const auto has_area = [](double height) { return Star::positive(Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 0.5, height)); };
  CHECK_FALSE(has_area(0.97e-9));
  CHECK(has_area(1.03e-9));
  CHECK_FALSE(has_area(-1));
}

TEST_CASE("a vertex of a domain has a way to go where the surface is a millionth as wide as long", "[thresholds]") {
  CHECK_FALSE(Star(0.97e-6).knows_way());
  CHECK(Star(1.03e-6).knows_way());
}
