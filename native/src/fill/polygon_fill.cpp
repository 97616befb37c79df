#include "tripatch/fill/polygon_fill.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "tripatch/constructions/methods.h"
#include "tripatch/math/canonical_start.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/triangles.h"
#include "tripatch/messages.h"
#include "tripatch/output/doubled_edges.h"
#include "tripatch/output/pair_quads.h"
#include "tripatch/output/polygon_cover.h"
#include "tripatch/output/remesh.h"
#include "tripatch/patch/moved_surface.h"
#include "tripatch/polygon/follow.h"
#include "tripatch/polygon/of_three.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {

namespace {

PlanePoints rim_places(const PolygonDomain& domain, const std::vector<std::vector<double>>& parameters) {
  std::vector<Vec2> places;
  for (int i = 0; i < domain.sides(); ++i)
    for (std::size_t k = 0; k + 1 < parameters[i].size(); ++k) places.push_back(domain.on_side(i, parameters[i][k]));
  PlanePoints uv(static_cast<Index>(places.size()), 2);
  for (std::size_t k = 0; k < places.size(); ++k) uv.row(static_cast<Index>(k)) = places[k];
  return uv;
}

/// A rim with its places in a domain from where its geometry begins it, in a mirror where it is walked backwards there: what is chosen
/// among equals does not hang on how the rim is given.
struct WalkedRim {
  WalkedRim(const Vec2& center, const Surface& patch, const PlanePoints& rim_uv, const Points& rim,
            const std::vector<Index>& corners) {
    CanonicalStarts beginnings(rim, {}, corners);
    beginnings.compare_along();
    if (!beginnings.decided()) beginnings.compare_with(patch.positions(as_rows((rim_uv.rowwise() + center.transpose()) / 2)));
    const CanonicalStart first = beginnings.left()[0];
    is_mirrored = first.backwards;
    turn = Vec2(1, is_mirrored ? -1 : 1);
    const SurfacePtr given(SurfacePtr(), &patch);
    surface = is_mirrored ? mirrored(given) : given;
    const Index r = rim.rows();
    for (Index k = 0; k < r; ++k) row.push_back(first.at(k, r));
    uv = rim_uv(row, Eigen::all);
    uv.col(1) *= turn[1];
    points = rim(row, Eigen::all);
    if (is_mirrored) points.col(0) *= -1;
  }

  std::vector<Index> row;  // that is given, of each in the walk
  bool is_mirrored;
  Vec2 turn;           // what places are times in the walk
  SurfacePtr surface;  // as the walk sees it: not longer than the patch
  PlanePoints uv;
  Points points;
};

/// The polygon in triangles about its center, or these in pairs as quads where they are good ones. corners: rows of the rim, none: any may
/// be one. met: places that become vertices.
PlaneCover triangles_of(const Vec2& center, int sides, const Surface& patch, const PlanePoints& rim_uv, const Points& rim,
                        const std::vector<Index>& corners, std::vector<std::array<Index, 2>> joined,
                        std::optional<int> resolution, const std::vector<Vec2>& met = {}, bool paired = false) {
  const Index r = rim_uv.rows();
  const WalkedRim walk(center, patch, rim_uv, rim, corners);
  PlanePolygon polygon;
  polygon.uv.resize(r + 1, 2);
  polygon.uv << walk.uv, center.cwiseProduct(walk.turn).transpose();
  polygon.points.resize(r + 1, 3);
  polygon.points << walk.points, walk.surface->positions(as_rows(polygon.uv.bottomRows(1)));
  polygon.rim = r;
  polygon.sides = sides;
  polygon.unit = length_around(rim) / std::max(length_around(rim_uv), tolerance::tiny);
  for (Index k = 0; k < r; ++k) polygon.triangles.push_back({k, (k + 1) % r, r});
  std::vector<Index> place(r);  // in the walk
  for (Index k = 0; k < r; ++k) place[walk.row[k]] = k;
  for (auto& [a, b] : joined) a = place[a], b = place[b];
  polygon.joined = std::move(joined);
  for (const Vec2& there : met) {
    const PlanePoints own = there.cwiseProduct(walk.turn).transpose();
    if (!insert_row(polygon, own, Vec3(walk.surface->positions(as_rows(own)).row(0)))) throw CodedRefusal(Code::point_on_rim);
  }
  PlaneTriangulation made = remesh(polygon, resolution, *walk.surface);
  PlaneCover cover;
  cover.uv = made.uv;
  cover.uv.col(1) *= walk.turn[1];
  cover.uv.topRows(r) = rim_uv;
  cover.rim = r;
  for (Index k = 0; k < r; ++k) cover.rim_rows.push_back(k);
  const Faces faces = paired ? pair_quads(made.points, made.triangles) : faces_of(made.triangles);
  for (Index f = 0; f < faces.size(); ++f) {
    std::vector<Index> face;
    for (Index v : faces[f]) face.push_back(v < r ? walk.row[v] : v);
    if (walk.is_mirrored) std::reverse(face.begin(), face.end());
    cover.faces.add(face);
  }
  return cover;
}

/// Quads from where the rim's geometry begins it, as of triangles_of. corners: as polygon_layout takes them.
PlaneCover quads_of(const Vec2& center, const Surface& patch, const PlanePoints& rim_uv, const Points& rim,
                    const std::vector<RimCorner>& corners, const LayoutOptions& options, const std::vector<Vec2>& met) {
  const Index r = rim_uv.rows();
  std::vector<Index> places;
  for (const RimCorner& corner : corners) places.push_back(corner.place);
  const WalkedRim walk(center, patch, rim_uv, rim, places);
  std::vector<RimCorner> walked;
  for (Index k = 0; k < r; ++k)
    for (const RimCorner& corner : corners)
      if (corner.place == walk.row[k]) walked.push_back({k, corner.quads});
  std::vector<Vec2> there;
  for (const Vec2& place : met) there.push_back(place.cwiseProduct(walk.turn));
  PlaneCover cover = cover_polygon_with_quads(walk.uv, walk.points, walked, *walk.surface, options, there);
  cover.uv.col(1) *= walk.turn[1];
  for (Index& row : cover.rim_rows) row = row < 0 ? row : walk.row[row];
  if (cover.split) {
    auto& [a, b] = *cover.split;
    a = walk.row[a], b = walk.row[b];
    if (walk.is_mirrored) std::swap(a, b);
  }
  if (!walk.is_mirrored) return cover;
  Faces faces;
  for (Index f = 0; f < cover.faces.size(); ++f) {
    std::vector<Index> face(cover.faces[f].begin(), cover.faces[f].end());
    std::reverse(face.begin(), face.end());
    faces.add(face);
  }
  cover.faces = std::move(faces);
  return cover;
}

/// Where the sides of a polygon begin in its rim.
std::vector<Index> corner_rows(const std::vector<std::vector<double>>& parameters) {
  std::vector<Index> rows = {0};
  for (std::size_t i = 0; i + 1 < parameters.size(); ++i)
    rows.push_back(rows.back() + static_cast<Index>(parameters[i].size()) - 1);
  return rows;
}

/// How many quads the fill wants at the corners, where all faces around are quads.
std::vector<RimCorner> rim_corners(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                   const std::vector<Index>& corners) {
  std::vector<RimCorner> wanted;
  for (Index place : corners) {
    int quads = 0;
    bool all = true;
    for (Connectivity::Corner c : around.at(rim[place])) {
      ++quads;
      all = all && mesh.faces[around.face(c)].size() == 4;
    }
    wanted.push_back({place, all ? std::max(1, 4 - quads) : 0});
  }
  return wanted;
}

/// Vertices, normals and faces of a fill that has its rim and its patch, in a mesh of so many vertices.
void deliver(const PlaneCover& cover, Index vertices, Fill& fill) {
  std::vector<Index> index(cover.uv.rows()), rows;  // of the mesh; rows that become new vertices, that of a split edge first
  for (Index k = 0; k < cover.uv.rows(); ++k) {
    const bool reused = k < cover.rim && cover.rim_rows[k] >= 0;
    index[k] = reused ? fill.rim[cover.rim_rows[k]] : vertices + static_cast<Index>(rows.size());
    if (!reused) rows.push_back(k);
  }
  fill.uv = cover.uv(rows, Eigen::all);
  std::tie(fill.vertices, fill.normals) = fill.patch->positions_and_normals(as_rows(fill.uv));
  fill.faces = cover.faces;
  for (Index& v : fill.faces.corners) v = index[v];
  if (cover.split) {
    fill.split_edges.push_back({fill.rim[(*cover.split)[0]], fill.rim[(*cover.split)[1]]});
    fill.split_t.push_back(0.5);
  }
}

void report_fairing(const Faired& faired, Report& report) {
  report.fairing = faired.fairing;
  report.energy_before = faired.energy_before;
  report.energy_after = faired.energy_after;
  report.folds = faired.folds;
  report.warnings = faired.warnings;
}

/// vertices: of the mesh.
void report_layout(const PlaneCover& cover, Index vertices, Report& report) {
  report.rows = cover.rows;
  for (Index pole : cover.poles)
    report.poles.push_back({vertices + pole - cover.rim + (cover.split ? 1 : 0),
                            std::count(cover.faces.corners.begin(), cover.faces.corners.end(), pole)});
  report.warnings.insert(report.warnings.end(), cover.warnings.begin(), cover.warnings.end());
}

/// The rest of a report, once the fill is there.
void complete(const Mesh& mesh, const Connectivity& around, double surroundings_error, const Faired& faired,
              PolygonFill& result) {
  Report& report = result.fill.report;
  report.method = polygon_method;
  report.surroundings_error = surroundings_error;
  measure_faces(mesh, result.fill.vertices, result.fill.faces, faces_beyond(mesh, around, {result.fill.rim}), report);
  tell_folds(report);
  result.gave_up = faired.gave_up;
}

}  // namespace

LayoutOptions layout_options(const FillOptions& options) {
  return {options.resolution, options.tolerance, options.odd == Odd::split, options.pole_offset};
}

PolygonPatchOptions polygon_options(const FillOptions& options) {
  PolygonPatchOptions own;
  if (options.cross_boundary != CrossBoundary::consistent && options.method != automatic_method)  // which tells of it
    throw CodedArgument(Code::value_needs_three_sides,
                        {{"option", "cross_boundary"}, {"value", name_of(options.cross_boundary)}});
  own.continuity = options.continuity.values();
  own.bulge = options.bulge.values();
  own.fairing = options.fairing;
  own.tension = options.tension;
  own.center = options.center;
  own.center_offset = options.center_offset;
  own.through = options.through;
  return own;
}

PolygonTriangles triangulate_polygon(const PolygonSurface& patch, const std::vector<std::vector<double>>& parameters,
                                     std::optional<int> resolution) {
  const PlanePoints rim = rim_places(patch.domain(), parameters);
  PlaneCover cover = triangles_of(patch.domain().center(), patch.domain().sides(), patch, rim, patch.positions(as_rows(rim)),
                                  corner_rows(parameters), {}, resolution);
  return {std::move(cover.uv), std::move(cover.faces)};
}

PolygonTriangles triangulate_disc(const Surface& patch, const std::vector<double>& parameters, std::optional<int> resolution) {
  PlanePoints rim(static_cast<Index>(parameters.size()) - 1, 2);
  for (Index k = 0; k < rim.rows(); ++k) rim.row(k) = on_circle(parameters[k]);
  if (rim.rows() < 3) throw InvalidArgument("a round rim has three edges or more");
  PlaneCover cover = triangles_of(Vec2::Zero(), 3, patch, rim, patch.positions(as_rows(rim)), {}, {}, resolution);
  return {std::move(cover.uv), std::move(cover.faces)};
}

MadePatch patch_over_polygon(const SideList& sides, const PolygonDomain& domain, const FillOptions& options,
                             const SurfacePoints* points) {
  PolygonPatchOptions own = polygon_options(options);
  own.domain = domain;
  if (points) own.fairing.reset();
  PolygonPatch made = polygon_patch(sides, own);
  MadePatch result;
  result.patch = made.patch;
  if (points) {
    const double size = polygon_boundary(made.sides, {}, &domain).size;
    result.patch = std::make_shared<OverPolygon>(domain, follow_over_polygon(made.patch, domain, *points, size));
    made.folds = count_polygon_folds(*result.patch, domain, made.sides);
  }
  report_fairing(made, result.report);
  result.report.continuity = made.continuity;
  result.gave_up = made.gave_up;
  return result;
}

namespace {

/// Values by side of three, which say them in the order of triangles, where side 2 begins at corner 0.
template <class T>
std::vector<T> from_first_corner(std::vector<T> values) {
  if (values.size() == 3) std::rotate(values.begin(), values.begin() + 2, values.end());
  return values;
}
template <class T>
void in_order_of_triangles(std::vector<T>& values) {
  if (values.size() == 3) std::rotate(values.begin(), values.begin() + 1, values.end());
}

}  // namespace

void report_patch(const PolygonPatch& made, Report& report) {
  report_fairing(made, report);
  report.continuity = made.continuity;
  report.seam_angle_max_by_side = made.seam_angle_max;
  report.seam_angle_rms_by_side = made.seam_angle_rms;
  report.seam_angle_max = *std::max_element(made.seam_angle_max.begin(), made.seam_angle_max.end());
  double squares = 0;
  for (double a : made.seam_angle_rms) squares += a * a / static_cast<double>(made.seam_angle_rms.size());
  report.seam_angle_rms = std::sqrt(squares);
  report.corner_planes_angle = made.corner_planes_angle;
  report.corner_normals_spread = made.corner_normals_spread;
  report.boundary_gap = made.boundary_gap;
  in_order_of_triangles(report.continuity);
  in_order_of_triangles(report.seam_angle_max_by_side);
  in_order_of_triangles(report.seam_angle_rms_by_side);
}

void report_patch(const RoundPatch& made, Report& report) {
  report_fairing(made, report);
  report.continuity = {made.continuity};
  report.seam_angle_max_by_side = {made.seam_angle_max};
  report.seam_angle_rms_by_side = {made.seam_angle_rms};
  report.seam_angle_max = made.seam_angle_max;
  report.seam_angle_rms = made.seam_angle_rms;
}

namespace {

/// Between three sides: the triangle's own patch, with the points that it meets inside.
PolygonPatch patch_of_three(const SideList& sides, const SideTerms& terms, const FillOptions& options) {
  FillOptions own = options;
  own.method = patch_method;
  own.through.clear();
  own.continuity = BySide<SideContinuity>({terms.continuity[1], terms.continuity[2], terms.continuity[0]});
  MadePatch made = patch_from_sides(Sides{sides[1], sides[2], sides[0]}, own);  // side 2 of a triangle begins at corner 0
  PolygonPatch out;
  out.patch = made.patch;
  out.fairing = made.report.fairing;
  out.energy_before = made.report.energy_before;
  out.energy_after = made.report.energy_after;
  out.folds = made.report.folds;
  out.gave_up = made.gave_up;
  out.warnings = std::move(made.report.warnings);
  const std::vector<SeamContinuity>& continuity = made.report.continuity;
  out.continuity = {continuity[2], continuity[0], continuity[1]};
  complete_patch(sides, options.through, out);
  return out;
}

}  // namespace

PolygonInput polygon_input(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                           const std::vector<Index>& corners, const FillOptions& options, const VertexPlanes& planes) {
  PolygonInput out;
  out.rim = rim;
  out.corners = corners;
  out.angles = sharp_sides(mesh, around, rim, corners);
  out.terms = terms_of_sides(BySide<SideContinuity>(from_first_corner(options.continuity.values())), out.angles);
  out.known = polygon_sides(mesh, around, rim, corners, out.terms.alone, planes);
  if (std::ranges::count(out.terms.alone, true) == 0) out.planes_error = out.known.surroundings_error;
  return out;
}

PolygonFill fill_with_polygon(const Mesh& mesh, const Connectivity& around, const PolygonInput& input, const FillOptions& options,
                              bool folded_too) {
  const auto& [rim, corners, angles, terms, known, planes_error] = input;
  PolygonPatchOptions own = polygon_options(options);
  own.continuity = terms.continuity;
  own.bulge = from_first_corner(std::move(own.bulge));
  PolygonPatch made = corners.size() == 3 ? patch_of_three(known.sides, terms, options) : polygon_patch(known.sides, own);
  PolygonFill result;
  Fill& fill = result.fill;
  const Index r = static_cast<Index>(rim.size()), n = mesh.vertices.rows();
  const PlanePoints rim_uv = rim_places(made.domain, known.parameters);
  Points points(r, 3);
  for (Index k = 0; k < r; ++k) points.row(k) = mesh.vertices.row(rim[k]);
  PlaneCover cover;
  if (made.folds > 0 && !folded_too) {
    // nothing is laid out
  } else if (options.output == Output::quads) {
    cover = quads_of(made.domain.center(), *made.patch, rim_uv, points, rim_corners(mesh, around, rim, corners),
                     layout_options(options), made.met);
  } else {
    cover = triangles_of(made.domain.center(), made.domain.sides(), *made.patch, rim_uv, points, corners,
                         joined_rows(around, rim), options.resolution, made.met);
  }
  fill.rim = rim;
  fill.rim_uv = rim_uv;
  fill.rim_normals = made.patch->normals(as_rows(rim_uv));
  fill.patch = made.patch;
  deliver(cover, n, fill);
  fill.sides = std::move(made.sides);

  Report& report = fill.report;
  report_patch(made, report);
  if (options.output == Output::quads)  // whose rows begin at corners, wherever these are wanted
    std::erase_if(report.warnings, [](const Message& each) { return each.code == Code::straight_corner; });
  tell_sharp(angles, report.warnings);
  report_layout(cover, n, report);
  take_corners(rim, corners, report);
  tell_corners(report);
  in_order_of_triangles(fill.sides);
  complete(mesh, around, known.surroundings_error, made, result);
  return result;
}

namespace {

/// Of waves round a rim: so many as it has edges, but no more than these.
constexpr int max_waves = count::many_places;

int waves_of(const std::vector<Index>& rim) { return std::min(static_cast<int>(rim.size()), max_waves); }

}  // namespace

DiscInput disc_input(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, const FillOptions& options,
                     const VertexPlanes& planes) {
  if (static_cast<Index>(rim.size()) < min_round) throw CodedRefusal(Code::round_rim_too_short, rim);
  const auto [first, backwards] = beginning_of_closed(mesh, around, rim);
  std::vector<Index> own = rim;
  std::rotate(own.begin(), own.begin() + first, own.end());
  DiscInput out{rim, first, closed_side(mesh, around, own, backwards, planes)};
  if (!is_of_revolution(out.known.side, polygon_options(options), waves_of(rim))) out.planes_error = out.known.surroundings_error;
  return out;
}

PolygonFill fill_round(const Mesh& mesh, const Connectivity& around, const DiscInput& input, const FillOptions& options,
                       bool folded_too) {
  const auto& [rim, first, known, planes_error] = input;
  const Index r = static_cast<Index>(rim.size());
  const double begin = known.t[(r - first) % r];  // of the rim as it is given
  const RoundPatch as_known = round_patch(known.side, polygon_options(options), waves_of(rim));
  const RoundPatch made = begun_at(as_known, begin);
  PolygonFill result;
  Fill& fill = result.fill;
  PlanePoints rim_uv(r, 2), known_uv(r, 2);
  Points points(r, 3);
  for (Index k = 0; k < r; ++k) {
    rim_uv.row(k) = on_circle(known.t[(k - first + r) % r] - begin);
    known_uv.row(k) = on_circle(known.t[(k - first + r) % r]);
    points.row(k) = mesh.vertices.row(rim[k]);
  }
  fill.rim = rim;
  fill.rim_uv = rim_uv;
  fill.rim_normals = made.patch->normals(as_rows(rim_uv));
  fill.patch = made.patch;
  fill.sides = {made.side};
  const bool quads = options.output == Output::quads, laid_out = made.folds == 0 || folded_too;
  PlaneCover cover;
  if (laid_out && quads) {  // where the geometry begins: which of many equal layouts is taken hangs on it
    cover = quads_of(Vec2::Zero(), *as_known.patch, known_uv, points, {}, layout_options(options), as_known.met);
    const Vec2 turn = on_circle(begin);
    cover.uv *= (Eigen::Matrix2d() << turn[0], -turn[1], turn[1], turn[0]).finished();
  }
  if (laid_out && cover.faces.size() == 0) {
    cover = triangles_of(Vec2::Zero(), 3, *made.patch, rim_uv, points, {}, joined_rows(around, rim),
                         quads ? std::nullopt : options.resolution, made.met, quads);
  }
  deliver(cover, mesh.vertices.rows(), fill);
  Report& report = fill.report;
  result.of_revolution = made.of_revolution;
  report_patch(made, report);
  report_layout(cover, mesh.vertices.rows(), report);
  complete(mesh, around, known.surroundings_error, made, result);
  return result;
}

}  // namespace tripatch
