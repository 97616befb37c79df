// The inner points are moved by a transfinite blend of the rim's parameters.
#include "tripatch/output/regular_grid.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/math/triangular_grid.h"
#include "tripatch/output/domain_mesh.h"

namespace tripatch {
namespace {

/// Shapes (1: equilateral) of the grid's worst triangle below which remeshing does better: it reaches 0.2 and more in rims that the grid
/// squeezes so far (the rims of test_triangulate). In the domain the patch may stretch them back; in space nothing does.
constexpr double min_shape_in_domain = share::tenth, min_shape_in_space = share::fifth;

/// So many of the grid are worth a thread: each takes some 20 ns.
constexpr Index grid_points_a_thread = count::quadratic;

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
  std::vector<double> even;
  for (Index k = 0; k <= n; ++k) even.push_back(static_cast<double>(k) / static_cast<double>(n));
  std::array<std::vector<double>, 3> shift;  // of the parameter against the even one
  for (int i = 0; i < 3; ++i)
    for (Index k = 0; k <= n; ++k) shift[i].push_back(parameters[i][k] - even[k]);
  const auto place_row = [&](Index q) {
    double* out = mesh.barycentric.data() + 3 * grid_vertex(n, 1, q);  // inner vertices come in this order
    for (Index p = 1; p + q < n; ++p, out += 3) {
      const Index r = n - p - q;
      double b0 = even[r], b1 = even[p], b2 = even[q];
      // seen from a corner, the shift of the opposite side fades like the square of the distance
      const auto move = [&](const std::vector<double>& along, double share, Index step, double& back, double& on) {
        const double at = static_cast<double>(step) / share;
        const Index first = std::min(static_cast<Index>(at), n - 1);
        const double e = along[first] + (at - static_cast<double>(first)) * (along[first + 1] - along[first]);
        back -= share * share * e;
        on += share * share * e;
      };
      move(shift[0], even[p + q], q, b1, b2);
      move(shift[1], even[q + r], r, b2, b0);
      move(shift[2], even[r + p], p, b0, b1);
      out[0] = b0;
      out[1] = b1;
      out[2] = 1 - b0 - b1;
    }
  };
  mesh.triangles.resize(n * n);
  const auto join_row = [&](Index q) {  // with the next one
    std::array<Index, 3>* triangle = mesh.triangles.data() + n * n - (n - q) * (n - q);
    Index here = grid_vertex(n, 0, q), next = grid_vertex(n, 0, q + 1);
    for (Index p = 0; p + q < n; ++p) {
      const Index after = grid_vertex(n, p + 1, q);
      *triangle++ = {here, after, next};
      if (p + q + 1 < n) {
        const Index next_after = grid_vertex(n, p + 1, q + 1);
        *triangle++ = {after, next_after, next};
        next = next_after;
      }
      here = after;
    }
  };
  const auto make_row = [&](Index q) {
    if (q > 0) place_row(q);
    join_row(q);
  };
  // a long row and a short one together are as much as any other two
  parallel_for(0, (n + 1) / 2, std::max<Index>(1, grid_points_a_thread / n), [&](Index from, Index to) {
    for (Index k = from; k < to; ++k) {
      make_row(k);
      if (k != n - 1 - k) make_row(n - 1 - k);
    }
  });
  return mesh;
}

/// No triangle turned over or squeezed in the domain, measured in the equilateral triangle?
bool fits_in_domain(const TriangleMesh& mesh) {
  const double* const b = mesh.barycentric.data();
  return holds_for_all(static_cast<Index>(mesh.triangles.size()), [&](Index k) {
    const std::array<Index, 3>& t = mesh.triangles[k];
    using InPlane = Eigen::Map<const Vec3>;
    const InPlane x(b + 3 * t[0]), y(b + 3 * t[1]), z(b + 3 * t[2]);
    const Vec3 u = y - x, v = z - x, w = z - y;
    const double area = u[1] * v[2] - u[2] * v[1];  // all three of u x v, whose shape() is 6 of them over the squares
    return area > 0 && 6 * area >= min_shape_in_domain * (u.squaredNorm() + v.squaredNorm() + w.squaredNorm());
  });
}

/// And in space, on a part of the grid, corners left out?
bool fits_in_space(const TriangleMesh& mesh, Index n, const Surface& patch) {
  const Index stride = (n + 11) / 12, rows = n / stride;
  const TriangularGrid grid = {rows};
  Points b(grid.size(), 3);
  for (Index q = 0; q <= rows; ++q)
    for (Index p = 0; p + q <= rows; ++p) b.row(grid.at(p, q)) = mesh.barycentric.row(grid_vertex(n, stride * p, stride * q));
  const Points x = patch.positions(b);
  auto squeezed = [&](Index a, Index c, Index d) { return shape(x.row(a), x.row(c), x.row(d)) < min_shape_in_space; };
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
    // the last of the first row, and the one before it; the last of all, and the one in the middle of the row before it
    const std::array<Index, 2> there = corner == 0   ? std::array<Index, 2>{0, 1}
                                       : corner == 1 ? std::array{2 * n - 2, 2 * n - 3}
                                                     : std::array{n * n - 1, n * n - 3};
    for (Index k : there) {
      std::array<Index, 3>& t = mesh.triangles[k];
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
