#include "tripatch/fill/spline_fill.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "tripatch/constructions/methods.h"
#include "tripatch/creases/creased_fill.h"
#include "tripatch/creases/features.h"
#include "tripatch/fill/select.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/canonical_part.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/messages.h"
#include "tripatch/output/doubled_edges.h"
#include "tripatch/output/pair_quads.h"
#include "tripatch/output/polygon_cover.h"
#include "tripatch/patch/moved_surface.h"
#include "tripatch/quads/grown_quads.h"
#include "tripatch/quads/quad_repair.h"
#include "tripatch/quads/quad_smoothing.h"
#include "tripatch/quads/spread.h"
#include "tripatch/report/crossings.h"
#include "tripatch/report/dihedrals.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/disc.h"
#include "tripatch/spline/plane_fill.h"
#include "tripatch/spline/plane_patch.h"

namespace tripatch {
namespace {

/// Normals of a fill without a surface: those of its triangles, weighted by their angles.
Points triangle_normals(const Points& points, const std::vector<std::array<Index, 3>>& triangles) {
  Points normals = Points::Zero(points.rows(), 3);
  for (const std::array<Index, 3>& t : triangles) {
    const Vec3 n = Vec3(points.row(t[1]) - points.row(t[0])).cross(Vec3(points.row(t[2]) - points.row(t[0]))).stableNormalized();
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = points.row(t[(k + 1) % 3]) - points.row(t[k]), v = points.row(t[(k + 2) % 3]) - points.row(t[k]);
      normals.row(t[k]) += angle_between(u, v) * n;
    }
  }
  for (Index k = 0; k < normals.rows(); ++k) normals.row(k) = Vec3(normals.row(k)).stableNormalized();
  return normals;
}

/// Places of a loop on a circle, by its lengths: those of a fill without a surface.
PlanePoints on_circle(const Points& rim) {
  const Index n = rim.rows();
  Eigen::VectorXd along(n);
  double length = 0;
  for (Index k = 0; k < n; ++k) {
    along[k] = length;
    length += (rim.row((k + 1) % n) - rim.row(k)).norm();
  }
  PlanePoints uv(n, 2);
  for (Index k = 0; k < n; ++k) {
    const double turn = 2 * std::numbers::pi * (length > 0 ? along[k] / length : static_cast<double>(k) / static_cast<double>(n));
    uv.row(k) << std::cos(turn), std::sin(turn);
  }
  return uv * (length / (2 * std::numbers::pi));
}

/// Of new vertices: amid those of the rim that their triangles join them to.
PlanePoints amid_rim(const PlanePoints& rim_uv, Index added, const std::vector<std::array<Index, 3>>& triangles) {
  const Index r = rim_uv.rows();
  PlanePoints sum = PlanePoints::Zero(added, 2);
  Eigen::VectorXd count = Eigen::VectorXd::Zero(added);
  for (const std::array<Index, 3>& t : triangles)
    for (Index v : t)
      for (Index other : t) {
        if (v < r || other >= r) continue;
        sum.row(v - r) += rim_uv.row(other);
        count[v - r] += 1;
      }
  return count.cwiseMax(1).cwiseInverse().asDiagonal() * sum;
}

/// No edge of the mesh is doubled: where the rim leaves no other way, the fill's has a vertex in its middle.
void halve_doubled(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, PlaneFill& made) {
  const Index r = static_cast<Index>(rim.size());
  const auto halved = halve_doubled_edges(around, rim, r + made.vertices.rows(), made.triangles);
  const Index added = static_cast<Index>(halved.size());
  if (added == 0) return;
  Points middle(added, 3);
  PlanePoints uv(added, 2);
  for (Index k = 0; k < added; ++k) {
    const auto [a, b] = halved[k];
    middle.row(k) = (mesh.vertices.row(rim[a]) + mesh.vertices.row(rim[b])) / 2;
    if (made.field) uv.row(k) = (made.rim_uv.row(a) + made.rim_uv.row(b)) / 2;
  }
  if (made.field) {
    Points normals;
    std::tie(middle, normals) = made.surface->positions_and_normals(as_rows(uv));
    made.deviation = stacked(made.deviation, made.field->deviation(uv, normals));
    made.normals = stacked(made.normals, normals);
    made.uv = stacked(made.uv, uv);
  }
  made.vertices = stacked(made.vertices, middle);
}

/// The deviation at other places of a fill: between that of its vertices.
Eigen::VectorXd deviation_at(const PlaneFill& made, const PlanePoints& uv) {
  const Eigen::VectorXd of_rim = made.field->deviation(made.rim_uv, made.surface->normals(as_rows(made.rim_uv)));
  return PlaneTriangles(made.triangles, stacked(made.rim_uv, made.uv)).carried(uv, stacked(of_rim, made.deviation));
}

/// Two triangles a quad.
std::vector<std::array<Index, 3>> halves_of(const Faces& faces) {
  std::vector<std::array<Index, 3>> triangles;
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 2; k < faces[f].size(); ++k) triangles.push_back({faces[f][0], faces[f][k - 1], faces[f][k]});
  return triangles;
}

/// The four places of a rim, a quarter of it apart, at which it turns most in the plane: the first of them.
Index max_turned(const PlanePoints& rim) {
  const Index n = rim.rows();
  std::vector<double> turn;
  for (Index k = 0; k < n; ++k) {
    const Vec2 in = rim.row(k) - rim.row((k + n - 1) % n), out = rim.row((k + 1) % n) - rim.row(k);
    turn.push_back(std::atan2(in[0] * out[1] - in[1] * out[0], in.dot(out)));
  }
  Index best = 0;
  double most = 0;
  for (Index k = 0; k < n; ++k) {
    const double sum = turn[k] + turn[(k + n / 4) % n] + turn[(k + n / 2) % n] + turn[(k + n / 2 + n / 4) % n];
    if (k == 0 || clearly_more(sum, most)) most = sum, best = k;
  }
  return best;
}

/// A layout of a circle or a square, brought into the plane of a fill. first: row of the rim with which the layout begins.
std::optional<PlaneLayout> brought_into_plane(const PlaneFill& made, std::optional<PlaneLayout> layout, Index first) {
  if (!layout) return {};
  const Index r = made.rim_uv.rows();
  PlanePoints rim_at(r, 2);
  for (Index k = 0; k < r; ++k) rim_at.row((k + first) % r) = layout->uv.row(k);
  const Index inside = layout->uv.rows() - r;
  const PlaneTriangles spread = spread_triangles(made.triangles, r + made.uv.rows(), rim_at);
  layout->uv.bottomRows(inside) = spread.carried(layout->uv.bottomRows(inside), stacked(made.rim_uv, made.uv));
  layout->uv.topRows(r) = made.rim_uv;
  for (Index& v : layout->faces.corners)
    if (v < r) v = (v + first) % r;
  return layout;
}

/// Of triangles whose quads are smoothed afterwards: any corner will do.
constexpr PairQuadsOptions any_pairs = {.largest_free_corner = 90};

/// Kinds of quads that are tried, one after the other: a grid between four corners; what grows in from the rim as the faces around have it, or
/// as the angles there do; else a disc with four poles. Grid and disc may have any quality while nothing is turned over.
enum class QuadsIn { grid, as_faces, as_angles, disc };

std::optional<PlaneLayout> layout_of(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                     const std::vector<Index>& corners, QuadsIn which, int rows, const PlaneFill& made) {
  const Index edges = made.rim_uv.rows();
  if (which == QuadsIn::grid) return brought_into_plane(made, square_layout(edges, corners, rows), 0);
  if (which == QuadsIn::disc) return brought_into_plane(made, disc_layout(edges, rows), max_turned(made.rim_uv));
  const WantedQuads wanted = which == QuadsIn::as_faces ? WantedQuads::by_number : WantedQuads::by_angle;
  std::optional<PlaneLayout> layout = grown_quads(made.rim_uv, wanted_quads(mesh.vertices, around, rim, wanted));
  if (layout && rows > 0) layout = with_rows(*layout, rows);
  return layout;
}

/// The same fill with other faces of its surface; false, and as it was, where they fold more than its own or cross each other. points: of
/// the layout, the rim's first.
bool take_faces(const Mesh& mesh, const std::vector<Index>& rim, const std::vector<AdjacentFace>& beyond,
                const PlaneLayout& layout, const Points& points, PlaneFill& made) {
  const Index added = points.rows() - layout.rim;
  Faces cut = layout.faces;
  begin_at_shorter_diagonals(points, Points(0, 3), cut);
  Faces in_mesh = cut;
  for (Index& v : in_mesh.corners) v = v < layout.rim ? rim[static_cast<std::size_t>(v)] : mesh.vertices.rows() + v - layout.rim;
  if (count_folded_edges(mesh.vertices, points.bottomRows(added), in_mesh, beyond) > made.folds) return false;
  if (crosses_itself(points, halves_of(cut))) return false;
  const PlanePoints uv = layout.uv.bottomRows(added);
  const Points normals = made.surface->normals(as_rows(uv));
  made.deviation = deviation_at(made, uv);
  made.vertices = points.bottomRows(added);
  made.uv = uv;
  made.normals = normals;
  made.triangles = halves_of(cut);
  return true;
}

/// The same fill with quads; empty where they are not good.
std::optional<PlaneLayout> quads_of(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                    const std::vector<Index>& corners, QuadsIn which, int rows, PlaneFill& made) {
  std::optional<PlaneLayout> layout = layout_of(mesh, around, rim, corners, which, rows, made);
  if (!layout || doubles_edges(around, rim, layout->faces)) return {};
  const Points border = mesh.vertices(rim, Eigen::all), points = smoothed_on(*layout, *made.surface, border);
  const double wanted = which == QuadsIn::grid || which == QuadsIn::disc ? 0 : min_sine;
  if (!points.allFinite() || !(quad_quality(points, layout->faces).least >= wanted)) return {};
  if (!take_faces(mesh, rim, faces_beyond(mesh, around, {rim}), *layout, points, made)) return {};
  return layout;
}

/// The same with `rows` extra rows, or half as many and so on where these do not fit; says how many there are.
std::optional<PlaneLayout> quads_of(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                                    const std::vector<Index>& corners, int& rows, PlaneFill& made) {
  if (!made.field) return {};
  for (;; rows /= 2) {
    for (const QuadsIn which : {QuadsIn::grid, QuadsIn::as_faces, QuadsIn::as_angles, QuadsIn::disc})
      if (std::optional<PlaneLayout> layout = quads_of(mesh, around, rim, corners, which, rows, made)) return layout;
    if (rows == 0) return {};
  }
}

/// Quads of pairs of the fill's triangles, whatever their corners are before they are smoothed on its surface. loops: of its rim.
std::optional<PlaneLayout> paired_quads(const Mesh& mesh, const Connectivity& around,
                                        const std::vector<std::vector<Index>>& loops, const std::vector<Index>& rim,
                                        PlaneFill& made) {
  const Points border = mesh.vertices(rim, Eigen::all);
  PlaneLayout layout;
  layout.rim = border.rows();
  layout.uv = stacked(made.rim_uv, made.uv);
  layout.faces = pair_quads(stacked(border, made.vertices), made.triangles, any_pairs);
  remove_doublets(layout);
  const Points points = smoothed_on(layout, *made.surface, border);
  if (!points.allFinite()) return {};
  layout.faces = with_bad_quads_halved(points, layout.faces);
  if (!take_faces(mesh, rim, faces_beyond(mesh, around, loops), layout, points, made)) return {};
  return layout;
}

/// Whether a fill is tangent to nothing, as a warning says of it.
bool leaves_surroundings(const std::optional<Message>& plainer) {
  return plainer && (plainer->code == Code::least_bending || plainer->code == Code::rim_alone_followed);
}

/// follows: the surroundings are samples of the surface; creased: creases meet sharply.
void state_seam(const Mesh& mesh, const Connectivity& around, const SplineFillOptions& options, bool follows, bool creased,
                Fill& fill) {
  Report& report = fill.report;
  const auto is_continued = [&](Index v) { return !options.continued || !options.continued->at(v).empty(); };
  const bool alone = options.planes.rows() == 0 && std::ranges::none_of(fill.rim, is_continued);
  report.continuity = std::vector(follows ? 1 : 0, alone ? SeamContinuity::g0 : SeamContinuity::g1);
  if (alone || (!follows && !creased)) measure_dihedrals(mesh, around, fill);
  report.seam_angle_max_by_side = std::vector(follows ? 1 : 0, report.seam_angle_max);
  report.seam_angle_rms_by_side = std::vector(follows ? 1 : 0, report.seam_angle_rms);
}

/// The fill of a part of a mesh. loops: of its border, the rim first.
Fill fill_in_part(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops,
                  const SplineFillOptions& options) {
  const std::vector<Index>& rim = loops[0];
  Fill fill;
  for (const std::vector<Index>& loop : loops) fill.rim.insert(fill.rim.end(), loop.begin(), loop.end());
  PlaneFillOptions own = {options.quads ? std::nullopt : options.resolution, {}, nullptr, options.through};
  std::optional<PlaneFill> creased;
  if (options.features) {
    Features features = find_features(mesh, around, rim);
    creased = fill_across_creases(mesh, around, rim, features, own);
    if (features.walls && !(creased && features.walls->are_flat)) {  // or as the ends of creases say
      features.walls.reset();
      std::optional<PlaneFill> other = fill_across_creases(mesh, around, rim, features, own);
      if (other && (!creased || root_mean_square(other->deviation) < root_mean_square(creased->deviation)))
        creased = std::move(other);
    }
  }
  own.continued = options.continued;
  own.planes = options.planes;
  PlaneFill made = creased ? std::move(*creased) : fill_over_plane(mesh, around, loops, own);

  std::optional<PlaneLayout> quads;
  int rows = options.resolution.value_or(0);
  if (options.quads && !creased && loops.size() == 1 && options.through.empty())
    quads = quads_of(mesh, around, rim, options.corners, rows, made);
  if (!creased && !quads) halve_doubled(mesh, around, fill.rim, made);
  if (options.quads && !creased && !quads && made.field && options.through.empty()) {
    quads = paired_quads(mesh, around, loops, fill.rim, made);
    rows = 0;
  }
  const Index r = static_cast<Index>(fill.rim.size()), n = mesh.vertices.rows();
  const auto mesh_index = [&](Index row) { return row < r ? fill.rim[row] : n + row - r; };
  const Points points = stacked(Points(mesh.vertices(fill.rim, Eigen::all)), made.vertices);
  if (options.quads) {
    const Faces faces = quads ? quads->faces : pair_quads(points, made.triangles, {}, made.creases);
    for (Index f = 0; f < faces.size(); ++f) {
      std::vector<Index> face;
      for (Index v : faces[f]) face.push_back(mesh_index(v));
      fill.faces.add(face);
    }
  } else {
    for (const std::array<Index, 3>& t : made.triangles)
      fill.faces.add(std::array<Index, 3>{mesh_index(t[0]), mesh_index(t[1]), mesh_index(t[2])});
  }
  fill.vertices = std::move(made.vertices);
  fill.uv = std::move(made.uv);
  fill.rim_uv = std::move(made.rim_uv);
  fill.deviation = std::move(made.deviation);
  if (made.surface) fill.patch = std::make_shared<PlanePatch>(made.surface, fill.rim_uv);
  if (made.surface) {
    fill.normals = std::move(made.normals);
    fill.rim_normals = creased ? made.rim_normals : made.surface->normals(as_rows(fill.rim_uv));
  } else {
    fill.rim_uv = on_circle(points.topRows(r));
    fill.uv = amid_rim(fill.rim_uv, points.rows() - r, made.triangles);
    const Points normals = triangle_normals(points, made.triangles);
    fill.rim_normals = normals.topRows(r);
    fill.normals = normals.bottomRows(normals.rows() - r);
  }

  for (const auto& [a, b] : made.creases) fill.feature_edges.push_back({mesh_index(a), mesh_index(b)});

  Report& report = fill.report;
  report.method = spline_method;
  const bool follows = made.surface && !leaves_surroundings(made.plainer);  // the surroundings are samples of the surface
  state_seam(mesh, around, options, follows, creased.has_value(), fill);
  report.surroundings_error = made.surroundings_error;
  report.rim_folded = made.rim_folds;
  measure_faces(mesh, fill.vertices, fill.faces, faces_beyond(mesh, around, loops), report);
  if (fill.deviation.size() > 0) report.deviation_max = fill.deviation.maxCoeff();
  report.rows = quads ? rows : 0;
  if (quads && rows < options.resolution.value_or(0))
    report.warnings.push_back({Code::fewer_rows, {{"rows", rows}, {"wanted", *options.resolution}}});
  for (Index pole : quads ? quads->poles : std::vector<Index>())
    report.poles.push_back({mesh_index(pole), std::ranges::count(quads->faces.corners, pole)});
  if (made.plainer) report.warnings.push_back(*made.plainer);
  return fill;
}

/// Rings of faces beyond those that a fill looks at: neighbors of neighbors are looked at too.
constexpr int rings_beyond = count::few;

/// reach: as a share of the hole's diameter.
std::vector<Index> faces_looked_at(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops,
                                   const Connectivity* continued, double reach) {
  double length = 0;
  Index edges = 0;
  for (const std::vector<Index>& loop : loops) {
    length = std::max(length, diameter(mesh, loop));
    edges += static_cast<Index>(loop.size());
  }
  const auto disc = [&](const Connectivity& part) {
    const int rings = static_cast<int>(std::max<Index>(edges, max_crease_rings));
    return disc_around(mesh, part, loops, reach * length, rings, max_triangles_around(edges));
  };
  std::vector<Index> vertices = disc(around).vertices;
  if (continued) {
    const Disc more = disc(*continued);
    vertices.insert(vertices.end(), more.vertices.begin(), more.vertices.end());
  }
  return rings_around(around, vertices, rings_beyond).all_faces();
}

bool has_face(const Connectivity& mesh, Index face) {
  const std::span<const Connectivity::Corner> at = mesh.at(mesh.faces()[face][0]);
  return std::any_of(at.begin(), at.end(), [&](Connectivity::Corner c) { return mesh.face(c) == face; });
}

void mirror(Points& points) { points.col(0) *= -1; }

/// The options of a fill in a part.
SplineFillOptions in_part(const CanonicalPart& part, const SplineFillOptions& options) {
  SplineFillOptions own = options;
  own.continued = nullptr;
  if (options.planes.rows() > 0) own.planes = options.planes(part.row, Eigen::all);
  own.corners.clear();
  for (std::size_t k = 0; k < part.row.size(); ++k)
    if (std::ranges::count(options.corners, part.row[k]) > 0) own.corners.push_back(static_cast<Index>(k));
  if (!part.mirrored) return own;
  mirror(own.planes);
  for (Through& met : own.through) {
    met.point[0] *= -1;
    if (met.normal) (*met.normal)[0] *= -1;
  }
  return own;
}

/// A fill of a part as one of the mesh.
void bring_back(const CanonicalPart& part, const Mesh& mesh, const std::vector<std::vector<Index>>& loops, Fill& fill) {
  const Index n = mesh.vertices.rows(), own = part.vertices.rows();
  const auto number = [&](Index v) { return v < own ? part.vertex[v] : n + v - own; };
  for (Index& v : fill.faces.corners) v = number(v);
  for (Index f = 0; part.mirrored && f < fill.faces.size(); ++f)
    std::reverse(fill.faces.corners.begin() + fill.faces.offsets[f], fill.faces.corners.begin() + fill.faces.offsets[f + 1]);
  for (auto& [a, b] : fill.feature_edges) a = number(a), b = number(b);
  for (auto& pole : fill.report.poles) pole[0] = number(pole[0]);
  fill.rim.clear();
  for (const std::vector<Index>& loop : loops) fill.rim.insert(fill.rim.end(), loop.begin(), loop.end());
  const PlanePoints uv = fill.rim_uv;
  const Points normals = fill.rim_normals;
  for (Index k = 0; k < uv.rows(); ++k) {
    fill.rim_uv.row(part.row[k]) = uv.row(k);
    fill.rim_normals.row(part.row[k]) = normals.row(k);
  }
  if (part.mirrored) {
    mirror(fill.vertices);
    mirror(fill.normals);
    mirror(fill.rim_normals);
    for (PlanePoints* uv : {&fill.uv, &fill.rim_uv}) uv->array().rowwise() *= Eigen::Array<double, 1, 2>(1, -1);
  }
  if (const auto* plane = dynamic_cast<const PlanePatch*>(fill.patch.get()))
    fill.patch = std::make_shared<PlanePatch>(part.mirrored ? mirrored(plane->surface()) : plane->surface(), fill.rim_uv);
}

}  // namespace

bool is_flat_quadrilateral(const Points& rim, const Points& inside) {
  if (rim.rows() != 4 || inside.rows() == 0) return false;
  const Vec3 first = rim.row(2) - rim.row(0), other = rim.row(3) - rim.row(1);
  const Vec3 normal = first.cross(other).stableNormalized();
  const double reach = tolerance::same * std::max(first.norm(), other.norm());
  const auto lie = [&](const Points& points) {
    return (((points.rowwise() - rim.row(0)) * normal).array().abs() <= reach).all();
  };
  return lie(rim) && lie(inside);
}

Fill fill_with_spline(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim,
                      const std::vector<std::vector<Index>>& islands, const SplineFillOptions& options) {
  std::vector<std::vector<Index>> loops = {rim};
  loops.insert(loops.end(), islands.begin(), islands.end());
  SplineFillOptions asked = options;
  asked.features = options.features && islands.empty() && options.planes.rows() == 0 && may_have_features(mesh, around, rim);
  const double reach = asked.features ? std::max(crease_reach, farthest_reach) : farthest_reach;
  const CanonicalPart part = canonical_part(mesh, around, loops, faces_looked_at(mesh, around, loops, options.continued, reach));
  const Mesh own{part.vertices, part.faces};
  const Connectivity known(own);
  SplineFillOptions there = in_part(part, asked);
  std::optional<Connectivity> continued;
  if (options.continued) {
    std::vector<Index> others;
    for (std::size_t f = 0; f < part.face.size(); ++f)
      if (!has_face(*options.continued, part.face[f])) others.push_back(static_cast<Index>(f));
    continued.emplace(own, others);
    there.continued = &*continued;
  }
  try {
    Fill fill = fill_in_part(own, known, part.loops, there);
    const bool as_rim = !there.quads && !there.resolution && there.through.empty() && islands.empty();
    if (as_rim && is_flat_quadrilateral(own.vertices(part.loops[0], Eigen::all), fill.vertices)) {
      there.resolution = 1;
      fill = fill_in_part(own, known, part.loops, there);
    }
    bring_back(part, mesh, loops, fill);
    return fill;
  } catch (const CodedRefusal& refusal) {
    throw CodedRefusal(with_vertices(refusal.message(), [&](Index v) { return part.vertex.at(static_cast<std::size_t>(v)); }));
  }
}

}  // namespace tripatch
