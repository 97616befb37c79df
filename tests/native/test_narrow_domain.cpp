// Meshes of domains that are narrow strips.
#include <catch2/catch.hpp>
#include <numbers>

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
  using DomainMesh::face_away;
  using DomainMesh::positive;
  using DomainMesh::set_lowest;

private:
  double wanted(const Vec3&) const override { return 1; }
  Points positions(const std::vector<Vec3>&) const override { return {}; }
  bool wants_flip(int, int, int, int) const override { return false; }
};

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

/// Four right-angled triangles around vertex 4 in a plane, of which vertex 2, half as far off as the others, is folded so far over it.
class Folded final : public DomainMesh {
public:
  explicit Folded(double angle) : DomainMesh(4) {
    const std::array<Vec3, 5> places = {Vec3(1, 0, 0), Vec3(0, 1, 0), 0.5 * Vec3(-std::cos(angle), 0, std::sin(angle)),
                                        Vec3(0, -1, 0), Vec3(0, 0, 0)};
    for (const Vec3& x : places) add_vertex(Vec3(0, x[0], x[1]), x);
    for (int k = 0; k < 4; ++k) triangles_.push_back({{4, k, (k + 1) % 4}, {-1, (k + 1) % 4, (k + 3) % 4}});
    size_.assign(5, 1);
    triangle_of_ = {0, 1, 2, 3, 0};
  }
  double quality() { return star_quality(4, Vec3(0, 0, 0)); }

private:
  double wanted(const Vec3&) const override { return 1; }
  Points positions(const std::vector<Vec3>&) const override { return {}; }
  bool wants_flip(int, int, int, int) const override { return false; }
};

/// A regular hexagon of triangles around vertex 6, of which vertex 1 lies so far from there; vertex 6 may only be pulled onto vertex 0.
class Hexagon final : public DomainMesh {
public:
  explicit Hexagon(double far) : DomainMesh(6) {
    for (int k = 0; k < 7; ++k) {
      const double angle = k * std::numbers::pi / 3, r = k == 6 ? 0 : k == 1 ? far : 1;
      const Vec2 u(r * std::cos(angle), r * std::sin(angle));
      add_vertex(Vec3(0, u[0], u[1]), Vec3(u[0], u[1], 0));
    }
    for (int k = 0; k < 6; ++k) triangles_.push_back({{6, k, (k + 1) % 6}, {-1, (k + 1) % 6, (k + 5) % 6}});
    size_.assign(7, 2);
    triangle_of_ = {0, 1, 2, 3, 4, 5, 0};
  }
  std::size_t triangles_left() {
    collapse_short();
    return alive_triangles();
  }
  double flattest() const { return shape_of(0, 1, 2); }

private:
  double wanted(const Vec3&) const override { return 2; }
  Points positions(const std::vector<Vec3>&) const override { return {}; }
  bool wants_flip(int, int, int, int) const override { return false; }
  bool may_join(int from, int) const override { return from == 0; }
};

/// A thousand triangles in a polygon, whose edges are flipped time and again, for ever where nobody but this stops it.
class Restless final : public DomainMesh {
public:
  static constexpr int count = 1000;
  explicit Restless() : DomainMesh(count + 2) {
    for (int k = 0; k < count + 2; ++k) {
      const double angle = 2 * std::numbers::pi * k / (count + 2);
      add_vertex(Vec3(0, std::cos(angle), std::sin(angle)), Vec3(std::cos(angle), std::sin(angle), 0));
    }
    for (int t = 0; t < count; ++t) triangles_.push_back({{0, t + 1, t + 2}, {-1, t + 1 < count ? t + 1 : -1, t - 1}});
    triangle_of_.assign(count + 2, 0);
  }
  /// Edges looked at, for each triangle, until flips end that are wanted so often.
  double looks(int wanted) {
    looks_at_ = 0;
    wanted_ = wanted * count;
    look_at_all();
    flip_all();
    return static_cast<double>(looks_at_) / count;
  }

private:
  double wanted(const Vec3&) const override { return 1; }
  Points positions(const std::vector<Vec3>&) const override { return {}; }
  bool wants_flip(int, int, int, int) const override { return ++looks_at_ < wanted_; }
  mutable int looks_at_ = 0;
  int wanted_ = 0;
};

}  // namespace

TEST_CASE("in a narrow strip of a domain that lies aslant a vertex goes as far as on the surface") {
  for (const double width : {1e-2, 1e-4, 1e-6}) CHECK(Strip(width).apart() < 1e-8 * width);
}
