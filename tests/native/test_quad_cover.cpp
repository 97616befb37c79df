#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "test_refusals.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/jet.h"
#include "tripatch/output/quad_cover.h"

using namespace tripatch;

namespace {

/// The flat triangle (0, 0), (1, 0), (0, 1) with a bump inside: its quads' middles lie off it by their size squared.
double bump(double height, const Vec3& b) { return height * 27 * b.prod(); }
class Bump : public JetSurface<Bump> {
public:
  explicit Bump(double height) : height_(height) {}
  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    for (int x = 0; x < 2; ++x) p += b[x + 1] * JetPoint<N>(Vec3(Vec3::Unit(x)));
    return p + (height_ * 27 * b[0] * b[1] * b[2]) * JetPoint<N>(Vec3(Vec3::UnitZ()));
  }
  Vec3 corner(int i) const { return i == 0 ? Vec3::Zero() : Vec3(Vec3::Unit(i - 1)); }

private:
  double height_;
};

/// A rim with these edge counts on its sides, its vertices on the patch.
struct Rim {
  Points vertices;
  Faces faces;
  Hole hole;
  std::array<std::vector<double>, 3> parameters;
  Rim(const std::array<int, 3>& edges, const Surface& patch) {
    std::vector<Vec3> b;
    for (int i : {2, 0, 1}) {
      hole.corners[(i + 1) % 3] = static_cast<Index>(b.size());
      for (int k = 0; k <= edges[i]; ++k) {
        const double t = static_cast<double>(k) / edges[i];
        parameters[i].push_back(t);
        if (k == edges[i]) break;
        b.push_back((1 - t) * Vec3::Unit((i + 1) % 3) + t * Vec3::Unit((i + 2) % 3));
        hole.rim.push_back(static_cast<Index>(hole.rim.size()));
      }
    }
    Points rows(static_cast<Index>(b.size()), 3);
    for (std::size_t k = 0; k < b.size(); ++k) rows.row(static_cast<Index>(k)) = b[k];
    vertices = patch.positions(rows);
  }
  Cover cover(const Surface& patch, const LayoutOptions& options, bool own_rim = false) const {
    return cover_with_quads({vertices, faces}, hole, parameters, patch, options, own_rim);
  }
};

/// Largest distance of a quad's middle from the point of the bump at its middle in the domain.
double deviation(const Cover& cover, double height) {
  double worst = 0;
  for (Index f = 0; f < cover.faces.size(); ++f) {
    Vec3 b = Vec3::Zero();
    double z = 0;
    for (Index v : cover.faces[f]) {
      b += cover.barycentric.row(v) / 4.0;
      z += bump(height, cover.barycentric.row(v)) / 4.0;
    }
    worst = std::max(worst, std::abs(z - bump(height, b)));
  }
  return worst;
}

Index triangles(const Cover& cover) {
  Index count = 0;
  for (Index f = 0; f < cover.faces.size(); ++f) count += cover.faces[f].size() == 3;
  return count;
}

}  // namespace

TEST_CASE("the fewest rows of quads are taken that keep the tolerance", "[quad_cover]") {
  const double height = 0.3;
  const Bump patch(height);
  const Rim rim({4, 4, 4}, patch);
  std::vector<double> reached;
  for (int rows = 0; rows <= max_extra_rows; ++rows) reached.push_back(deviation(rim.cover(patch, {.rows = rows}), height));
  for (std::size_t k = 1; k < reached.size(); ++k) {
    INFO("rows " << k);
    REQUIRE(reached[k] < reached[k - 1]);
    const auto quads = [&](const LayoutOptions& options) { return rim.cover(patch, options).faces.size(); };
    CHECK(quads({.tolerance = reached[k] * 1.001}) == quads({.rows = static_cast<int>(k)}));
    CHECK(quads({.tolerance = reached[k - 1] * 0.999}) == quads({.rows = static_cast<int>(k)}));
  }
  CHECK(rim.cover(patch, {.tolerance = reached.back() * 1.001}).warnings.empty());
  const Cover beyond = rim.cover(patch, {.tolerance = reached.back() * 0.999});
  REQUIRE(beyond.warnings.size() == 1);
  CHECK(beyond.warnings[0].code == Code::tolerance_out_of_reach);
  CHECK(beyond.faces.size() == rim.cover(patch, {.rows = max_extra_rows}).faces.size());
}

TEST_CASE("where no rows would come within a thousandth and nobody asked for it, none are added", "[quad_cover]") {
  const Bump patch(0.9);
  const Rim rim({4, 4, 4}, patch);
  const Cover cover = rim.cover(patch, {});
  REQUIRE(deviation(rim.cover(patch, {.rows = max_extra_rows}), 0.9) > 2e-3);
  CHECK(cover.rows == 0);
  CHECK(cover.warnings.empty());
  CHECK(cover.faces.size() == rim.cover(patch, {.rows = 0}).faces.size());
}

TEST_CASE("an odd rim has its longest edge split, or a triangle, or neither where the rim is the fill's own", "[quad_cover]") {
  const Bump patch(0.1);
  const Rim rim({4, 4, 5}, patch);  // side 0, the hypotenuse, has the longest edges
  const Cover split = rim.cover(patch, {.rows = 0});
  CHECK(triangles(split) == 0);
  CHECK(split.rim == 14);
  REQUIRE(split.split_edges.size() == 1);
  const std::size_t place = longest_edge({rim.vertices, rim.faces}, rim.hole.rim);
  CHECK(place >= 5);
  CHECK(place < 9);
  CHECK(split.split_edges[0] == std::array<Index, 2>{rim.hole.rim[place], rim.hole.rim[place + 1]});
  CHECK(split.split_t == std::vector<double>{0.5});
  CHECK(split.rim_vertices[place + 1] == -1);
  CHECK(std::count(split.rim_vertices.begin(), split.rim_vertices.end(), -1) == 1);
  const Vec3 middle =
      0.5 * (split.barycentric.row(static_cast<Index>(place)) + split.barycentric.row(static_cast<Index>(place) + 2));
  CHECK((split.barycentric.row(static_cast<Index>(place) + 1).transpose() - middle).norm() < 1e-15);

  for (const Cover& whole : {rim.cover(patch, {.rows = 0, .split_odd = false}), rim.cover(patch, {.rows = 0}, true)}) {
    CHECK(triangles(whole) == 1);
    CHECK(whole.split_edges.empty());
    CHECK(whole.rim_vertices == rim.hole.rim);
  }
}

TEST_CASE("of edges that are equal to rounding the first is the longest", "[quad_cover]") {
  Points square(4, 3);
  square << 0, 0, 0, 1, 0, 0, 1, 1 + 1e-12, 0, 0, 1, 0;
  const Hole hole = {{0, 1, 2, 3}, {0, 1, 2}};
  const Faces none;
  CHECK(longest_edge({square, none}, hole.rim) == 0);
  square(2, 1) = 1 + 1e-6;
  CHECK(longest_edge({square, none}, hole.rim) == 1);
}
