// The inner points are moved by a transfinite blend of the rim's parameters.
#include "tripatch/output/regular_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tripatch/math/ties.h"
#include "tripatch/math/triangular_grid.h"
#include "tripatch/output/domain_mesh.h"

namespace tripatch {
namespace {

/// Shapes (1: equilateral) of the grid's worst triangle below which remeshing does better: it reaches 0.2 and more in rims that the grid
/// squeezes so far (the rims of test_triangulate). In the domain the patch may stretch them back; in space nothing does.
constexpr double least_shape_in_domain = 0.1, least_shape_in_space = 0.2;

using Parameters = std::array<std::vector<double>, 3>;

/// Vertex of the grid p steps towards corner 1 and q steps towards corner 2, rim first.
Index grid_vertex(Index n, Index p, Index q) {
  if (q == 0) return p;
  if (p + q == n) return n + q;
  if (p == 0) return 3 * n - q;
  return 3 * n + (q - 1) * (n - 1) - q * (q - 1) / 2 + p - 1;
}

TriangleMesh blended_grid(const Parameters& parameters, const Points& rim, Index n) {
  TriangleMesh mesh;
  mesh.rim = 3 * n;
  mesh.barycentric.resize(TriangularGrid{n}.size(), 3);
  mesh.barycentric.topRows(3 * n) = rim;
  std::array<std::vector<double>, 3> shift;  // of the parameter against the even one
  for (int i = 0; i < 3; ++i)
    for (Index k = 0; k <= n; ++k) shift[i].push_back(parameters[i][k] - static_cast<double>(k) / static_cast<double>(n));
  for (Index q = 1; q < n; ++q)
    for (Index p = 1; p + q < n; ++p) {
      const std::array<Index, 3> step = {n - p - q, p, q};
      std::array<double, 3> b;
      for (int i = 0; i < 3; ++i) b[i] = static_cast<double>(step[i]) / static_cast<double>(n);
      for (int i = 0; i < 3; ++i) {  // seen from corner i, the shift of the opposite side fades like the square of the distance
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const double share = static_cast<double>(step[j] + step[k]) / static_cast<double>(n);
        const double at = static_cast<double>(step[k]) / share;
        const Index first = std::min(static_cast<Index>(at), n - 1);
        const double e = shift[i][first] + (at - static_cast<double>(first)) * (shift[i][first + 1] - shift[i][first]);
        b[j] -= share * share * e;
        b[k] += share * share * e;
      }
      mesh.barycentric.row(grid_vertex(n, p, q)) << b[0], b[1], 1 - b[0] - b[1];
    }
  mesh.triangles.reserve(n * n);
  std::vector<Index> row(n + 1), next(n + 1);  // vertices of a row of the grid, and of the next one
  for (Index p = 0; p <= n; ++p) row[p] = grid_vertex(n, p, 0);
  for (Index q = 0; q < n; ++q, std::swap(row, next)) {
    for (Index p = 0; p + q < n; ++p) next[p] = grid_vertex(n, p, q + 1);
    for (Index p = 0; p + q < n; ++p) {
      mesh.triangles.push_back({row[p], row[p + 1], next[p]});
      if (p + q + 1 < n) mesh.triangles.push_back({row[p + 1], next[p + 1], next[p]});
    }
  }
  return mesh;
}

/// No triangle turned over or squeezed in the domain, measured in the equilateral triangle?
bool fits_in_domain(const TriangleMesh& mesh) {
  for (const auto& t : mesh.triangles) {
    std::array<Vec3, 3> x;
    for (int k = 0; k < 3; ++k) x[k] = mesh.barycentric.row(t[k]);
    const Vec3 u = x[1] - x[0], v = x[2] - x[0];
    if (!(u[1] * v[2] - u[2] * v[1] > 0) || shape(x[0], x[1], x[2]) < least_shape_in_domain) return false;
  }
  return true;
}

/// And in space, on a part of the grid, corners left out?
bool fits_in_space(const TriangleMesh& mesh, Index n, const Surface& patch) {
  const Index stride = (n + 11) / 12, rows = n / stride;
  const TriangularGrid grid = {rows};
  Points b(grid.size(), 3);
  for (Index q = 0; q <= rows; ++q)
    for (Index p = 0; p + q <= rows; ++p) b.row(grid.at(p, q)) = mesh.barycentric.row(grid_vertex(n, stride * p, stride * q));
  const Points x = patch.positions(b);
  auto squeezed = [&](Index a, Index c, Index d) { return shape(x.row(a), x.row(c), x.row(d)) < least_shape_in_space; };
  for (Index q = 0; q < rows; ++q)
    for (Index p = 0; p + q < rows; ++p) {
      const bool corner = p + q == 0 || p + 1 == rows || q + 1 == rows;
      if (!corner && squeezed(grid.at(p, q), grid.at(p + 1, q), grid.at(p, q + 1))) return false;
      if (p + q + 1 < rows && squeezed(grid.at(p + 1, q), grid.at(p + 1, q + 1), grid.at(p, q + 1))) return false;
    }
  return true;
}

/// Where the rim goes straight on at a corner, the one triangle there has no area: its inner edge is turned towards the corner.
void mend_corners(TriangleMesh& mesh, Index n, const Surface& patch) {
  for (int corner = 0; corner < 3 && n > 1; ++corner) {
    const Index c = corner * n, after = c + 1, before = (c + 3 * n - 1) % (3 * n);
    std::array<Index, 3>*tip = nullptr, *next = nullptr;
    for (auto& t : mesh.triangles) {
      int both = 0, tips = 0;
      for (Index v : t) both += v == after || v == before, tips += v == c;
      if (both == 2) (tips ? tip : next) = &t;
    }
    if (!tip || !next) continue;  // n == 2: another corner has taken the middle triangle
    Index across = 0;
    for (Index v : *next)
      if (v != after && v != before) across = v;
    Points q(4, 3);
    int row = 0;
    for (Index v : {c, after, across, before}) q.row(row++) = mesh.barycentric.row(v);
    q = patch.positions(q);
    const double now = std::min(shape(q.row(0), q.row(1), q.row(3)), shape(q.row(1), q.row(2), q.row(3)));
    const double then = std::min(shape(q.row(0), q.row(1), q.row(2)), shape(q.row(0), q.row(2), q.row(3)));
    if (clearly_more(then, now)) *tip = {c, after, across}, *next = {c, across, before};
  }
}

}  // namespace

std::optional<TriangleMesh> regular_grid(const Parameters& parameters, const Points& rim, const Surface& patch) {
  const Index n = static_cast<Index>(parameters[0].size()) - 1;
  TriangleMesh mesh = blended_grid(parameters, rim, n);
  if (!fits_in_domain(mesh) || !fits_in_space(mesh, n, patch)) return std::nullopt;
  mend_corners(mesh, n, patch);
  return mesh;
}

}  // namespace tripatch
