#include "tripatch/fill/any_rim_fill.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

#include "tripatch/annulus/annulus_fill.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/fill/select.h"
#include "tripatch/fill/spline_fill.h"
#include "tripatch/hole/corners.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/output/shaped.h"
#include "tripatch/polygon/domain.h"
#include "tripatch/quads/quad_smoothing.h"
#include "tripatch/quads/spread.h"
#include "tripatch/report/dihedrals.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {

namespace {

/// A fill that continues its surroundings is at least this much larger than one that meets all of them at an angle. A cap of a
/// sphere is, compared with its disc, where both meet at 25 degrees, and from there on an edge tells faces apart. Of balls and
/// cylinders cut through bevels it was 0.8 to 1.04 times as large, and 3 to 9 times nearer.
constexpr double larger_at_angle = share::little + 1;

/// Of the new faces, scene units squared.
double area(const Mesh& mesh, const Fill& fill) {
  double sum = 0;
  for (Index f = 0; f < fill.faces.size(); ++f) sum += area_of(mesh, fill, f).norm();
  return sum;
}

/// The spline, which does not continue what meets the hole at an angle, unless that is the plainer way. given: corners of the rim, in its
/// order; none: as detected.
Fill fill_beside_sharp_sides(const FillContext& context, const Connectivity& around, const std::vector<Index>& rim,
                             const std::vector<Index>& given, SplineFillOptions options) {
  std::vector<Index> places = places_in(rim, given);
  try {
    if (given.empty()) places = detect_corners(context.mesh, around, rim);
  } catch (const Refusal&) {  // faces without area tell nothing
  }
  std::vector<double> angles;
  if (places.size() >= 2 && places.size() <= static_cast<std::size_t>(max_sides))
    angles = sharp_sides(context.mesh, around, rim, places);
  if (!any_sharp(angles)) return fill_with_spline(context.mesh, around, rim, {}, options);
  const std::vector<Index> beyond = not_continued(context.mesh, around, rim, places, angles);
  const Connectivity continued(context.mesh, beyond);
  options.continued = &continued;
  Fill fill = fill_with_spline(context.mesh, around, rim, {}, options);
  if (!fill.feature_edges.empty()) return fill;  // each part continues from what is next to it
  const auto sharp = std::count_if(angles.begin(), angles.end(), [](double angle) { return angle > 0; });
  options.continued = nullptr;
  Fill smooth = fill_with_spline(context.mesh, around, rim, {}, options);
  const double larger = std::cmp_equal(sharp, angles.size()) ? larger_at_angle : 1;
  const bool as_plain = area(context.mesh, smooth) < larger * area(context.mesh, fill);
  if (as_plain && harm(smooth.report) <= harm(fill.report)) return smooth;
  fill.report.warnings.push_back({Code::sharp_sides, {{"sharp", sharp}, {"sides", angles.size()}}});
  return fill;
}

/// In its surroundings no face is left.
Connectivity without_faces(const Mesh& mesh) {
  std::vector<Index> all(static_cast<std::size_t>(mesh.faces.size()));
  std::iota(all.begin(), all.end(), Index(0));
  return Connectivity(mesh, all);
}

/// No vertex is on two of the loops.
void check_apart(std::vector<Index> all, const std::vector<std::vector<Index>>& islands) {
  for (const std::vector<Index>& island : islands) all.insert(all.end(), island.begin(), island.end());
  std::sort(all.begin(), all.end());
  if (const auto twice = std::adjacent_find(all.begin(), all.end()); twice != all.end())
    throw CodedRefusal(Code::borders_share_vertex, {*twice});
}

}  // namespace

bool asks_for_sides(const FillOptions& options) {
  const std::vector<std::string> others = not_taken(find_method(patch_method), options, true);
  return std::ranges::any_of(not_taken(find_method(spline_method), options, true),
                             [&](const std::string& name) { return std::ranges::find(others, name) == others.end(); });
}

bool is_shaped_by_hand(const FillOptions& options) {
  return !options.through.empty() || is_shaped(options) || asks_for_sides(options);
}

bool is_continuity_open(const FillOptions& options) {
  return std::ranges::all_of(options.continuity, [](SideContinuity c) { return c == SideContinuity::automatic; });
}

Fill fill_any_rim(const FillContext& context, const std::vector<Index>& rim, const Corners& corners, const FillOptions& options) {
  if (options.surroundings == SurroundingsFrom::limit)
    throw CodedRefusal(Code::limit_needs_three_corners, {{"reason", Message{Code::reads_mesh, {{"method", spline_method}}}}});
  Messages warnings;
  const auto ordered = [&](const std::vector<Index>& loop) {
    std::vector<Index> checked = check_topology(context.left, loop);
    std::rotate(checked.begin(), std::min_element(checked.begin(), checked.end()), checked.end());
    check_finite(context.mesh, context.left, checked);
    try {
      check_positions(context.mesh, context.left, checked);
    } catch (const CodedRefusal& refusal) {  // no hindrance to triangles
      warnings.push_back(refusal.message());
    }
    return checked;
  };
  std::vector<std::vector<Index>> islands;
  for (const std::vector<Index>& island : options.islands) islands.push_back(ordered(island));
  SplineFillOptions own = {options.resolution, options.output == Output::quads, options.features, nullptr, options.through};
  std::optional<Connectivity> nothing;
  if (meets_position_only(options)) {
    own.continued = &nothing.emplace(without_faces(context.mesh));
    own.features = false;
  }
  // A neighborhood that was enough for three sides is not for this: rings are taken as far as half the hole's diameter.
  const std::optional<Connectivity> all =
      context.is_part() ? std::optional<Connectivity>(Connectivity(context.mesh, options.replaced)) : std::nullopt;
  std::vector<Index> loop = ordered(rim), at;  // from the first corner on; the others as the rim meets them
  check_apart(loop, islands);
  if (corners && !corners->empty()) {
    const auto first = std::find(loop.begin(), loop.end(), (*corners)[0]);
    if (first != loop.end()) std::rotate(loop.begin(), first, loop.end());
    for (Index v : loop)
      if (std::find(corners->begin(), corners->end(), v) != corners->end()) at.push_back(v);
    for (Index v : *corners)
      if (std::find(loop.begin(), loop.end(), v) == loop.end()) throw CodedRefusal(Code::corner_not_on_rim, {v});
    check_distinct(*corners, "corners");
  }
  own.corners = places_in(loop, at);
  const Connectivity& around = all ? *all : context.left;
  const bool looks_for_sharp = islands.empty() && (!corners || !corners->empty()) && is_continuity_open(options);
  Fill fill = looks_for_sharp ? fill_beside_sharp_sides(context, around, loop, at, own)
                              : fill_with_spline(context.mesh, around, loop, islands, own);
  if (options.method == spline_method && !fill.patch && loop.size() > 3) throw CodedRefusal(Code::no_surface_laid_out, loop);
  fill.report.warnings.insert(fill.report.warnings.begin(), warnings.begin(), warnings.end());
  fill.report.corners = std::move(at);
  return fill;
}

Fill fill_ring(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options) {
  if (options.islands.size() != 1) throw CodedRefusal(Code::ring_takes_two, {{"count", options.islands.size() + 1}});
  const auto ordered = [&](const std::vector<Index>& loop) {
    std::vector<Index> checked = check_topology(context.left, loop);
    std::rotate(checked.begin(), std::min_element(checked.begin(), checked.end()), checked.end());
    check_positions(context.mesh, context.left, checked);
    return checked;
  };
  const std::vector<Index> loop = ordered(rim), island = ordered(options.islands[0]);
  check_apart(loop, {island});
  return fill_with_annulus(context.mesh, context.left, loop, island, options);
}

namespace {

/// Faces whose vertices are numbered from those of a fill's rim on.
Faces numbered_from_rim(const FillContext& context, const Faces& in_mesh, const Fill& fill) {
  const Index n = context.mesh.vertices.rows(), r = static_cast<Index>(fill.rim.size());
  std::map<Index, Index> row;
  for (Index k = 0; k < r; ++k) row[fill.rim[static_cast<std::size_t>(k)]] = k;
  Faces faces = in_mesh;
  for (Index& v : faces.corners) v = v < n ? row.at(v) : r + v - n;
  return faces;
}

/// The faces of a fill cut into triangles.
std::vector<std::array<Index, 3>> triangles_in_plane(const FillContext& context, const Fill& fill) {
  const Faces faces = numbered_from_rim(context, fill.faces, fill);
  std::vector<std::array<Index, 3>> triangles;
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 2; k < faces[f].size(); ++k) triangles.push_back({faces[f][0], faces[f][k - 1], faces[f][k]});
  return triangles;
}

/// The quads of another fill between the same boundaries in the plane of a fill; places inside are not set.
PlaneLayout layout_in_plane(const FillContext& context, const Fill& other, const Fill& fill) {
  PlaneLayout layout;
  layout.rim = fill.rim_uv.rows();
  layout.uv = stacked(fill.rim_uv, PlanePoints(PlanePoints::Zero(other.vertices.rows(), 2)));
  layout.faces = numbered_from_rim(context, other.faces, fill);
  return layout;
}

/// A fill with the quads of another one as they are laid out in its plane; nothing where they do worse there than its own.
std::optional<Fill> with_faces_of(const FillContext& context, const std::vector<std::vector<Index>>& loops, const Fill& other,
                                  const PlaneLayout& layout, double least, Fill fill) {
  PlanePoints uv = layout.uv.bottomRows(other.vertices.rows());
  const auto before = harm(fill.report);
  Eigen::VectorXd deviation(fill.deviation.size() > 0 ? uv.rows() : 0);
  for (Index k = 0; k < deviation.size(); ++k) {
    Index nearest = 0;
    (fill.uv.rowwise() - uv.row(k)).rowwise().squaredNorm().minCoeff(&nearest);
    deviation[k] = fill.deviation[nearest];
  }
  fill.uv = std::move(uv);
  fill.deviation = std::move(deviation);
  std::tie(fill.vertices, fill.normals) = fill.patch->positions_and_normals(as_rows(fill.uv));
  if (!is_finite(fill)) return {};
  const Points points = stacked(Points(context.mesh.vertices(fill.rim, Eigen::all)), fill.vertices);
  if (!(quad_quality(points, layout.faces).least > least)) return {};
  fill.faces = other.faces;
  fill.report.rows = other.report.rows;
  fill.report.poles = other.report.poles;
  measure_faces(context.mesh, fill.vertices, fill.faces, faces_beyond(context.mesh, context.left, loops), fill.report);
  if (harm(fill.report) > before) return {};
  return fill;
}

/// Places of a ring's plane on a cylinder, by turns and from 0 at the outer circle to 1 at the inner.
PlanePoints on_cylinder(const PlanePoints& places, double inner) {
  PlanePoints at(places.rows(), 2);
  for (Index k = 0; k < at.rows(); ++k)
    at.row(k) << std::atan2(places(k, 1), places(k, 0)) / (2 * std::numbers::pi), (1 - places.row(k).norm()) / (1 - inner);
  return at;
}

/// The faces of a ring on the surface of another fill between the same boundaries.
std::optional<Fill> ring_on_surface(const FillContext& context, const std::vector<std::vector<Index>>& loops, const Fill& ring,
                                    const Fill& fill) {
  if (!fill.patch || fill.uv.rows() == 0 || fill.rim != ring.rim) return {};
  PlaneLayout layout = layout_in_plane(context, ring, fill);
  const double inner = ring.rim_uv.bottomRows(1).norm();
  PlanePoints ends_at = on_cylinder(ring.rim_uv, inner);
  for (Index k = 0; k < ends_at.rows(); ++k) ends_at(k, 1) = std::round(ends_at(k, 1));
  const SpreadRing spread(triangles_in_plane(context, fill), stacked(fill.rim_uv, fill.uv), ends_at);
  const PlanePoints inside_at = on_cylinder(ring.uv, inner);
  for (Index k = 0; k < inside_at.rows(); ++k) layout.uv.row(layout.rim + k) = spread.carried(inside_at.row(k));
  smoothed_on(layout, *fill.patch, context.mesh.vertices(fill.rim, Eigen::all));
  return with_faces_of(context, loops, ring, layout, 0, fill);
}

}  // namespace

Fill fill_around_islands(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options) {
  std::optional<Fill> ring;
  Message reason = {Code::has_islands};
  if (options.islands.size() == 1 && options.through.empty()) {
    try {
      ring = fill_ring(context, rim, options);
      ring->report.method_reason = Message{Code::joins_boundaries};
      reason = {Code::fits_better_than_ring};
    } catch (const CodedRefusal& refusal) {
      reason = {Code::no_ring_joins, {{"reason", refusal.message()}}};
    }
  }
  std::optional<Fill> spline;
  try {
    spline = fill_any_rim(context, rim, std::vector<Index>(), options);
    spline->report.method_reason = reason;
  } catch (const Refusal&) {
    if (!ring) throw;
  }
  if (ring && (!spline || harm(ring->report) < harm(spline->report))) return std::move(*ring);
  const double size = diameter(context.mesh, rim);
  if (ring && harm(ring->report) == harm(spline->report) && !(expected_error(*spline, size) < expected_error(*ring, size)))
    return std::move(*ring);
  if (options.islands.size() > 1 && (!spline->patch || !is_harmless(spline->report)))
    throw CodedRefusal(Code::boundaries_not_joined, {{"count", options.islands.size() + 1}}, rim);
  if (ring && options.output == Output::quads) {
    const auto island = ring->rim.end() - static_cast<std::ptrdiff_t>(options.islands[0].size());
    if (std::optional<Fill> rows =
            ring_on_surface(context, {{ring->rim.begin(), island}, {island, ring->rim.end()}}, *ring, *spline))
      return std::move(*rows);
  }
  return std::move(*spline);
}

std::optional<Fill> rows_on_surface(const FillContext& context, const Fill& rows, const Fill& fill) {
  if (!fill.patch || fill.uv.rows() == 0 || !fill.feature_edges.empty()) return {};
  PlaneLayout layout = layout_in_plane(context, rows, fill);
  for (Index k = 0; k < rows.vertices.rows(); ++k) {
    Index nearest = 0;
    (fill.vertices.rowwise() - rows.vertices.row(k)).rowwise().squaredNorm().minCoeff(&nearest);
    Vec2 place = fill.uv.row(nearest);
    for (int step = 0; step < tolerance::newton_steps; ++step) {
      const Foot foot = foot_at(*fill.patch, place, rows.vertices.row(k));
      if (!foot.step.allFinite()) return {};
      place += foot.step;
      if (foot.step.norm() <= tolerance::rounding * place.norm()) break;
    }
    layout.uv.row(layout.rim + k) = place;
  }
  return with_faces_of(context, {fill.rim}, rows, layout, min_sine, fill);
}

Fill fill_flat(const FillContext& context, const std::vector<Index>& rim, const FillOptions& options) {
  const Connectivity nothing = without_faces(context.mesh);
  Fill fill = fill_with_spline(context.mesh, context.left, rim, {},
                               {options.resolution, options.output == Output::quads, false, &nothing, options.through});
  fill.report.warnings = {{Code::flat_all_around}};
  return fill;
}

void close_if_flat(const FillContext& context, const FillOptions& options, Fill& fill) {
  if (!is_flat_quadrilateral(context.mesh.vertices(fill.rim, Eigen::all), fill.vertices)) return;
  fill.faces = fill_flat(context, fill.rim, options).faces;
  for (Points* each : {&fill.vertices, &fill.normals, &fill.barycentric}) each->resize(0, 3);
  fill.uv.resize(0, 2);
  fill.deviation.resize(0);
}

Fill fill_with_planes_of(const FillContext& context, const Fill& patch, const FillOptions& options) {
  const Connectivity nothing = without_faces(context.mesh);
  SplineFillOptions own = {options.resolution, options.output == Output::quads, false, &nothing, options.through,
                           patch.rim_normals};
  Fill fill = fill_with_spline(context.mesh, context.left, patch.rim, {}, own);
  fill.report.corners = patch.report.corners;
  fill.report.surroundings_error = patch.report.surroundings_error;
  return fill;
}

}  // namespace tripatch
