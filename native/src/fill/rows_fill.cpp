#include "tripatch/fill/rows_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <numeric>

#include "tripatch/cage/sided_rim.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/fill/rows_in_mesh.h"
#include "tripatch/grid/continued_quads.h"
#include "tripatch/grid/continued_rows.h"
#include "tripatch/grid/quad_rows.h"
#include "tripatch/grid/rows_surface.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/messages.h"
#include "tripatch/output/doubled_edges.h"
#include "tripatch/quads/wanted_quads.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/plane_patch.h"

namespace tripatch {
namespace {

/// Of the side of a block, in edges: of more the matrices of its differences would take longer than other fills.
constexpr Index max_edges = count::hundreds;
/// Vertices inside an outline that is no block, for the same reason: of so many it takes half a second.
constexpr Index max_inside = 2000;
/// Right angles by which the rim of a hole in a grid turns; a pole of five or three rows makes one more or less.
constexpr Index right_angles_of_grid = 4;
/// Rows beyond the rim that the surface goes through: what the spline does at its ends is a fourteenth of that two rows within.
constexpr Index rows_of_surface = count::pair;
/// Positions of a block with its rows around.
class Block {
public:
  Block(const Mesh& mesh, const QuadRows& rows, const Points& inside) : mesh_(mesh), rows_(rows), inside_(inside) {}
  bool is_new(Index i, Index j) const { return i > 0 && i < rows_.n() && j > 0 && j < rows_.m(); }
  Index row_of_new(Index i, Index j) const { return (i - 1) * (rows_.m() - 1) + j - 1; }
  Index vertex(Index i, Index j) const { return is_new(i, j) ? mesh_.vertices.rows() + row_of_new(i, j) : rows_.at(i, j); }
  Vec3 at(Index i, Index j) const {
    return is_new(i, j) ? Vec3(inside_.row(row_of_new(i, j))) : Vec3(mesh_.vertices.row(rows_.at(i, j)));
  }

  /// Places of the rows along an axis, 0 at the rim's first: they are as far apart as the block's points are in the mean.
  std::vector<double> places(int axis, Index first, Index last) const {
    const Index count = axis == 0 ? rows_.m() : rows_.n();
    std::vector<double> steps, places;
    for (Index i = first; i < last; ++i) {
      double sum = 0;
      for (Index j = 0; j <= count; ++j)
        sum += (axis == 0 ? at(i + 1, j) - at(i, j) : at(j, i + 1) - at(j, i)).norm() / static_cast<double>(count + 1);
      steps.push_back(sum);
    }
    const double mean = std::accumulate(steps.begin(), steps.end(), 0.0) / static_cast<double>(steps.size());
    double place = 0;
    places.push_back(place);
    for (double step : steps) places.push_back(place += std::max(step, tolerance::slight * mean));
    const double origin = places[static_cast<std::size_t>(-first)];
    for (double& each : places) each -= origin;
    return places;
  }

private:
  const Mesh& mesh_;
  const QuadRows& rows_;
  const Points& inside_;
};

Faces quads_of(const QuadRows& rows, const Block& block) {
  Faces faces;
  for (Index i = 0; i < rows.n(); ++i)
    for (Index j = 0; j < rows.m(); ++j)
      faces.add(std::array{block.vertex(i, j), block.vertex(i + 1, j), block.vertex(i + 1, j + 1), block.vertex(i, j + 1)});
  return faces;
}

/// Cuts each quad along its shorter diagonal.
void halve_quads(const Mesh& mesh, Fill& fill) {
  begin_at_shorter_diagonals(mesh.vertices, fill.vertices, fill.faces);
  Faces halves;
  for (Index f = 0; f < fill.faces.size(); ++f) {
    const std::span<const Index> quad = fill.faces[f];
    halves.add(std::array{quad[0], quad[1], quad[2]});
    halves.add(std::array{quad[0], quad[2], quad[3]});
  }
  fill.faces = std::move(halves);
}

/// The surface, and places and normals of the rim and of what is new.
void put_on_surface(const QuadRows& rows, const Block& block, Fill& fill) {
  std::array<Index, 2> first{}, last{};
  for (int axis : {0, 1}) {
    const Index edges = axis == 0 ? rows.n() : rows.m();
    first[axis] = std::max(rows.first(axis), -rows_of_surface);
    last[axis] = std::min(rows.last(axis), edges + rows_of_surface);
  }
  const std::vector<double> u = block.places(0, first[0], last[0]), v = block.places(1, first[1], last[1]);
  Points points(static_cast<Index>(u.size() * v.size()), 3);
  for (Index i = first[0], row = 0; i <= last[0]; ++i)
    for (Index j = first[1]; j <= last[1]; ++j, ++row) points.row(row) = block.at(i, j).transpose();
  const auto place = [&](Index i, Index j) {
    return Vec2(u[static_cast<std::size_t>(i - first[0])], v[static_cast<std::size_t>(j - first[1])]);
  };
  fill.rim_uv.resize(static_cast<Index>(fill.rim.size()), 2);
  Index k = 0;
  const Index n = rows.n(), m = rows.m();
  for (Index i = 0; i < n; ++i) fill.rim_uv.row(k++) = place(i, 0);
  for (Index j = 0; j < m; ++j) fill.rim_uv.row(k++) = place(n, j);
  for (Index i = n; i > 0; --i) fill.rim_uv.row(k++) = place(i, m);
  for (Index j = m; j > 0; --j) fill.rim_uv.row(k++) = place(0, j);
  fill.uv.resize(fill.vertices.rows(), 2);
  for (Index i = 1; i < n; ++i)
    for (Index j = 1; j < m; ++j) fill.uv.row(block.row_of_new(i, j)) = place(i, j);
  const auto surface = std::make_shared<RowsSurface>(u, v, points);
  fill.patch = std::make_shared<PlanePatch>(surface, fill.rim_uv);
  fill.normals = surface->normals(as_rows(fill.uv));
  fill.rim_normals = surface->normals(as_rows(fill.rim_uv));
}

std::vector<Index> rim_from_corner(const QuadRows& rows, const std::vector<Index>& rim) {
  std::vector<Index> from = rim;
  std::rotate(from.begin(), std::find(from.begin(), from.end(), rows.at(0, 0)), from.end());
  return from;
}

double mean_edge(const Mesh& mesh, const std::vector<Index>& rim) {
  double sum = 0;
  for (std::size_t k = 0; k < rim.size(); ++k)
    sum += (mesh.vertices.row(rim[(k + 1) % rim.size()]) - mesh.vertices.row(rim[k])).norm();
  return sum / static_cast<double>(rim.size());
}

void report_rows(const Mesh& mesh, const Connectivity& around, double deviation, Fill& fill) {
  Report& report = fill.report;
  report.method = rows_method;
  report.seam_angle_max_by_side = report.seam_angle_rms_by_side = {0};
  report.continuity = {SeamContinuity::g1};  // its surroundings are rows of the surface
  report.surroundings_error = std::atan(deviation / mean_edge(mesh, fill.rim)) * 180 / std::numbers::pi;
  if (fill.deviation.size() > 0) report.deviation_max = fill.deviation.maxCoeff();
  measure_faces(mesh, fill.vertices, fill.faces, faces_beyond(mesh, around, {fill.rim}), report);
}

/// Nine of ten blocks are off by no more than what their rows miss: of a normal distribution, so many standard deviations.
constexpr double deviations_missed = 1.645;

/// What is left to be told of quads that are made.
void complete(const FillContext& context, double missed, Output output, bool features, Fill& fill) {
  const double deviation = missed / deviations_missed;
  fill.deviation = Eigen::VectorXd::Constant(fill.vertices.rows(), deviation);
  const RowsInMesh in_mesh(context, fill);
  if (!fill.patch) fill.rim_normals = in_mesh.normals_of_rim(), fill.normals = in_mesh.normals_of_new();
  if (features) fill.feature_edges = in_mesh.creases();
  if (output == Output::triangles) halve_quads(context.mesh, fill);
  report_rows(context.mesh, context.left, deviation, fill);
}

std::optional<Fill> fill_block(const FillContext& context, const std::vector<Index>& rim, const QuadRows& rows, Output output,
                               bool features) {
  const Index n = rows.n(), m = rows.m();
  Fill fill;
  fill.rim = rim_from_corner(rows, rim);
  check_positions(context.mesh, context.left, fill.rim);
  const std::array<Index, 4> corners = {0, n, n + m, 2 * n + m};
  const bool is_strip = n == 1 || m == 1;
  ContinuedRows made = continued_rows(context.mesh.vertices, rows);
  if (!made.inside.allFinite() || !std::isfinite(made.missed)) return {};
  fill.vertices = std::move(made.inside);
  const Block block(context.mesh, rows, fill.vertices);
  fill.faces = quads_of(rows, block);
  // only single rows have edges between vertices of the rim, and no others
  if (is_strip && doubles_edges_of_mesh(context.left, fill.rim, fill.faces)) return {};
  put_on_surface(rows, block, fill);
  if (!fill.normals.allFinite() || !fill.rim_normals.allFinite()) return {};  // next to coordinates beyond all measure
  for (Index place : corners) fill.report.corners.push_back(fill.rim[static_cast<std::size_t>(place)]);
  complete(context, made.missed, output, features, fill);
  return fill;
}

/// A layout with its faces, and the vertices inside, in the order in which they are reached from the rim's first edge: whatever the shape
/// of the rim, as of a shape key, fills of one outline have the same faces.
QuadLayout in_order_from_rim(const QuadLayout& layout) {
  const Connectivity mesh(layout.faces, layout.barycentric.rows());
  QuadLayout ordered = layout;
  ordered.faces = Faces();
  std::vector<Index> number(static_cast<std::size_t>(layout.barycentric.rows()), -1);
  Index count = layout.rim;
  for (Index k = 0; k < count; ++k) number[static_cast<std::size_t>(k)] = k;
  std::vector<char> is_taken(static_cast<std::size_t>(layout.faces.size()), 0);
  std::vector<std::array<Index, 2>> edges = {{0, 1}};
  for (std::size_t next = 0; next < edges.size(); ++next) {
    const auto corner = mesh.edge(edges[next][0], edges[next][1]);
    if (!corner || std::exchange(is_taken[static_cast<std::size_t>(mesh.face(*corner))], 1)) continue;
    const std::span<const Index> quad = layout.faces[mesh.face(*corner)];
    std::array<Index, 4> face{};
    for (std::size_t k = 0; k < 4; ++k) {
      const Index v = quad[(mesh.place(*corner) + k) % 4], w = quad[(mesh.place(*corner) + k + 1) % 4];
      Index& own = number[static_cast<std::size_t>(v)];
      if (own < 0) own = count++;
      ordered.barycentric.row(own) = layout.barycentric.row(v);
      face[k] = own;
      edges.push_back({w, v});
    }
    ordered.faces.add(face);
  }
  for (Index& pole : ordered.poles) pole = number[static_cast<std::size_t>(pole)];
  return ordered;
}

/// The layout of quads that the rim alone tells of: all faces around are quads, whose rows close inside, or but for a right angle.
std::optional<QuadLayout> layout_of_rows(const FillContext& context, const std::vector<Index>& rim) {
  if (!is_among_quads(context.left, rim)) return {};
  Index turns = 0;  // right angles of the rim
  for (std::size_t k = 0; k < rim.size(); ++k)
    turns += 2 - std::lround(coarse(quads_left(context.mesh.vertices, context.left, rim, k)));
  if (std::abs(turns - right_angles_of_grid) > max_poles) return {};
  const std::optional<QuadLayout> layout = grown_layout(rim, context.mesh.vertices, context.left);
  if (!layout || std::ranges::any_of(layout->faces.offsets, [](Index at) { return at % 4 != 0; })) return {};
  return in_order_from_rim(*layout);
}

}  // namespace

std::optional<Fill> fill_with_rows_over(const FillContext& context, const std::vector<Index>& rim, const QuadLayout& layout,
                                        Output output, bool features) {
  const Index n = context.mesh.vertices.rows(), r = layout.rim;
  const QuadsInside quads = {rim, layout.faces, layout.barycentric.rows() - r};
  if (quads.inside > max_inside || !go_on(context.mesh.vertices, context.left, quads) ||
      doubles_edges(context.left, rim, layout.faces))
    return {};
  check_positions(context.mesh, context.left, rim);
  ContinuedRows made = continued_quads(context.mesh.vertices, context.left, quads);
  if (made.order == 0 || !made.inside.allFinite()) return {};
  Fill fill;
  fill.rim = rim;
  fill.vertices = std::move(made.inside);
  fill.faces = layout.faces;
  for (Index& v : fill.faces.corners) v = v < r ? rim[static_cast<std::size_t>(v)] : n + v - r;
  if (layout.in_plane) {
    fill.rim_uv = layout.barycentric.topRows(r).leftCols(2);
    fill.uv = layout.barycentric.bottomRows(quads.inside).leftCols(2);
  }
  for (const Index pole : layout.poles)
    fill.report.poles.push_back({n + pole - r, std::ranges::count(layout.faces.corners, pole)});
  complete(context, made.missed, output, features, fill);
  if (!fill.normals.allFinite() || !fill.rim_normals.allFinite()) return {};  // as of a block
  return fill;
}

std::optional<Fill> fill_with_rows(const FillContext& context, const std::vector<Index>& rim, Output output, bool features) {
  if (const std::optional<QuadRows> rows = quad_rows(context.left, rim))
    return rows->n() > max_edges || rows->m() > max_edges ? std::nullopt : fill_block(context, rim, *rows, output, features);
  const std::optional<QuadLayout> layout = layout_of_rows(context, rim);
  return layout ? fill_with_rows_over(context, rim, *layout, output, features) : std::nullopt;
}

Fill fill_with_rows_only(const FillContext& context, const std::vector<Index>& rim, const Corners& corners,
                         const FillOptions& options) {
  if (options.surroundings == SurroundingsFrom::limit)
    throw CodedRefusal(Code::limit_needs_three_corners, {{"reason", Message{Code::reads_mesh, {{"method", rows_method}}}}});
  std::optional<Fill> fill = fill_with_rows(context, check_topology(context.left, rim), options.output, options.features);
  const auto is_other = [&](Index v) { return std::ranges::find(fill->report.corners, v) == fill->report.corners.end(); };
  if (!fill || (corners && (corners->size() != fill->report.corners.size() || std::ranges::any_of(*corners, is_other))))
    throw CodedRefusal(Code::no_rows_of_quads, rim);
  return std::move(*fill);
}

}  // namespace tripatch
