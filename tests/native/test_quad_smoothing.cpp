// Where quads are moved to: no vertex inside can be moved a little so that their corners are less distorted. The distortion is written down here
// from its definition, so that Newton's derivatives, the costs of its steps and the order in which corners are looked at are all seen.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "test_surfaces.h"
#include "tripatch/quads/polygon_layout.h"
#include "tripatch/quads/quad_smoothing.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

Points in_space(const PlanePoints& uv, const Surface* surface) {
  Points rows = Points::Zero(uv.rows(), 3);
  rows.leftCols(2) = uv;
  return surface ? surface->positions(rows) : rows;
}

Vec3 normal_at(const PlanePoints& uv, Index v, const Surface* surface) {
  if (!surface) return Vec3::UnitZ();
  Points row = Points::Zero(1, 3);
  row.leftCols(2) = uv.row(v);
  return surface->normals(row).row(0);
}

/// Of the corners that a vertex takes part in, each edge over the width of the row that it lies across: the third power of half the sum of the
/// squares over the area, with the planes as they are in `base`.
template <class Width>
double distortion(const PlaneLayout& layout, const PlanePoints& base, Index moved, const Surface* surface, const Width& width) {
  const Points x = in_space(layout.uv, surface);
  double sum = 0;
  for (Index f = 0; f < layout.faces.size(); ++f) {
    const auto q = layout.faces[f];
    for (std::size_t k = 0; k < 4; ++k) {
      const Index v = q[k], next = q[(k + 1) % 4], last = q[(k + 3) % 4];
      if (v != moved && next != moved && last != moved) continue;
      const Vec3 a = (x.row(next) - x.row(v)) / width(v, next), b = (x.row(last) - x.row(v)) / width(v, last);
      const double area = normal_at(base, v, surface).dot(a.cross(b));
      sum += std::pow(0.5 * (a.squaredNorm() + b.squaredNorm()) / area, 3);
    }
  }
  return sum;
}

/// How many ways there are to move a vertex inside, by a ten thousandth of the outline, that lessen the distortion.
template <class Width>
int ways_down(const PlaneLayout& layout, const Surface* surface, const Width& width) {
  const double step = 1e-4;
  int ways = 0;
  for (Index v = layout.rim; v < layout.uv.rows(); ++v) {
    const double here = distortion(layout, layout.uv, v, surface, width);
    for (int k = 0; k < 8; ++k) {
      PlaneLayout other = layout;
      other.uv.row(v) += step * Eigen::RowVector2d(std::cos(k * std::numbers::pi / 4), std::sin(k * std::numbers::pi / 4));
      ways += distortion(other, layout.uv, v, surface, width) < here;
    }
  }
  return ways;
}

/// n x m quads between four curved sides with vertices at uneven distances; those inside are near their places and not at them.
struct Grid {
  static constexpr Index n = 5, m = 4;
  PlaneLayout layout;
  std::vector<Index> number;  // of the vertex at i, j

  Grid() : number((n + 1) * (m + 1)) {
    const auto set = [&](Index i, Index j, Index v) { number[j * (n + 1) + i] = v; };
    Index next = 0;
    for (Index i = 0; i < n; ++i) set(i, 0, next++);
    for (Index j = 0; j < m; ++j) set(n, j, next++);
    for (Index i = n; i > 0; --i) set(i, m, next++);
    for (Index j = m; j > 0; --j) set(0, j, next++);
    layout.rim = next;
    for (Index j = 1; j < m; ++j)
      for (Index i = 1; i < n; ++i) set(i, j, next++);
    layout.uv.resize(next, 2);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> some(-0.03, 0.03);
    for (Index j = 0; j <= m; ++j)
      for (Index i = 0; i <= n; ++i) {
        const double s = static_cast<double>(i) / n, t = static_cast<double>(j) / m, u = s + 0.2 * s * (1 - s),
                     v = t - 0.15 * t * (1 - t);
        layout.uv.row(at(i, j)) << u + 0.1 * std::sin(2 * v), v * (0.8 + 0.2 * u) - 0.1 * u * u;
        if (at(i, j) >= layout.rim) layout.uv.row(at(i, j)) += Eigen::RowVector2d(some(random), some(random));
      }
    for (Index j = 0; j < m; ++j)
      for (Index i = 0; i < n; ++i)
        layout.faces.add(std::array<Index, 4>{at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
  }
  Index at(Index i, Index j) const { return number[j * (n + 1) + i]; }

  /// Of the row that an edge lies across: the geometric mean of its two ends on the rim.
  double width(const Points& x, Index a, Index b) const {
    const auto place = [&](Index v) { return std::find(number.begin(), number.end(), v) - number.begin(); };
    const Index i = place(a) % (n + 1), j = place(a) / (n + 1), k = place(b) % (n + 1), l = place(b) / (n + 1);
    const auto apart = [&](Index v, Index w) { return (x.row(v) - x.row(w)).norm(); };
    return i == k ? std::sqrt(apart(at(0, j), at(0, l)) * apart(at(n, j), at(n, l)))
                  : std::sqrt(apart(at(i, 0), at(k, 0)) * apart(at(i, m), at(k, m)));
  }
};

constexpr int many_sweeps = 60;

}  // namespace

TEST_CASE("smoothed quads of a grid lie where their distortion is least, in the plane and on a surface") {
  const SurfacePtr saddle = formula_surface([](const auto& b) {
    const auto u = b[0], v = b[1];
    JetPoint<std::decay_t<decltype(u)>::order> p;
    p.x = {u + 0.2 * v * v, v - 0.3 * u * v, 0.6 * u * u - 0.5 * v * v + 0.3 * u};
    return p;
  });
  for (const Surface* surface : {static_cast<const Surface*>(nullptr), static_cast<const Surface*>(saddle.get())}) {
    CAPTURE(surface != nullptr);
    Grid grid;
    const Points start = in_space(grid.layout.uv, surface);
    const auto width = [&](Index a, Index b) { return grid.width(start, a, b); };
    REQUIRE(ways_down(grid.layout, surface, width) > 0);
    smooth_quads(grid.layout, many_sweeps, 0, surface);
    CHECK(ways_down(grid.layout, surface, width) == 0);
  }
}

TEST_CASE("smoothed quads round poles of three, five and six lie where their distortion is least") {
  for (int n : {3, 5, 6}) {
    CAPTURE(n);
    // a regular outline of four edges a side: all its rows are equally wide
    PlaneLayout layout;
    layout.rim = 4 * n;
    layout.uv.resize(layout.rim, 2);
    std::vector<RimCorner> corners;
    const auto corner = [&](int i) {
      return Eigen::RowVector2d(std::cos(2 * std::numbers::pi * i / n), std::sin(2 * std::numbers::pi * i / n));
    };
    for (int i = 0; i < n; ++i) {
      corners.push_back({4 * i, 1});
      for (int k = 0; k < 4; ++k) layout.uv.row(4 * i + k) = (1 - k / 4.) * corner(i) + k / 4. * corner(i + 1);
    }
    layout = polygon_layout(layout.uv, corners);
    REQUIRE(layout.poles.size() == 1);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> some(-0.02, 0.02);
    for (Index v = layout.rim; v < layout.uv.rows(); ++v) layout.uv.row(v) += Eigen::RowVector2d(some(random), some(random));
    const double edge = (layout.uv.row(1) - layout.uv.row(0)).norm();
    const auto width = [&](Index, Index) { return edge; };
    REQUIRE(ways_down(layout, nullptr, width) > 0);
    smooth_quads(layout, many_sweeps);
    CHECK(ways_down(layout, nullptr, width) == 0);
  }
}
