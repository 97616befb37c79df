// Meshes of domains that are narrow strips.
#include <catch2/catch.hpp>
#include <numbers>

#include "tripatch/output/domain_mesh.h"

using namespace tripatch;

namespace {

/// The same four triangles in a strip that lies aslant in the domain, which the surface leaves as it is.
class Strip final : public DomainMesh {
public:
  explicit Strip(double width) : DomainMesh(4) {
    const Vec2 along(std::cos(0.5), std::sin(0.5));
    across_ = Vec2(-along[1], along[0]);
    for (const Vec2& u : {Vec2(1, 0), Vec2(0.3, 1), Vec2(-1, 0.2), Vec2(0, -1), Vec2(0.1, 0.2)}) {
      const Vec2 at = u[0] * along + width * u[1] * across_;
      add_vertex(Vec3(0, at[0], at[1]), Vec3(at[0], at[1], 0));
    }
    for (int k = 0; k < 4; ++k) triangles_.push_back({{4, k, (k + 1) % 4}, {-1, (k + 1) % 4, (k + 3) % 4}});
    size_.assign(5, 1);
    triangle_of_ = {0, 1, 2, 3, 0};
  }
  /// Of its step in the domain and of that on the surface, which are one, what they differ by across the strip.
  double apart() {
    const Way way = way_of(4).value();
    return std::abs(across_.dot(way.step - way.in_space.head<2>()));
  }

private:
  double wanted(const Vec3&) const override { return 1; }
  Points positions(const std::vector<Vec3>&) const override { return {}; }
  bool wants_flip(int, int, int, int) const override { return false; }
  Vec2 across_;
};

}  // namespace

TEST_CASE("in a narrow strip of a domain that lies aslant a vertex goes as far as on the surface") {
  for (const double width : {1e-2, 1e-4, 1e-6}) CHECK(Strip(width).apart() < 1e-8 * width);
}
