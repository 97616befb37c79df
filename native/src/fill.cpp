#include "tripatch/fill.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <tuple>

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/output/cage.h"
#include "tripatch/output/quad_layout.h"
#include "tripatch/output/triangulate.h"
#include "tripatch/patch/fairing.h"
#include "tripatch/patch/methods.h"

namespace tripatch {
namespace {

int continuity_level(const std::string& name) {
  static const std::array<const char*, 3> names = {"G0", "G1", "G2"};
  for (int level = 0; level < 3; ++level)
    if (name == names[level]) return level;
  throw InvalidArgument("continuity must be auto, G0, G1 or G2, not '" + name + "'");
}

/// The continuity of each side: "auto" takes the method's own; more than the method keeps is refused.
std::array<int, 3> resolve_continuity(const std::array<std::string, 3>& asked, const Method& method) {
  const int own = continuity_level(method.continuity);
  std::array<int, 3> level;
  for (int i = 0; i < 3; ++i) {
    level[i] = asked[i] == "auto" ? own : continuity_level(asked[i]);
    if (level[i] > own)
      throw Refusal(std::string("The method ") + method.name + " keeps " + method.continuity + " along the rim, not " + asked[i]);
  }
  return level;
}

void check_options(const FillOptions& options) {
  for (double bulge : options.bulge)
    if (!(bulge > 0) || !std::isfinite(bulge)) throw InvalidArgument("bulge must be greater than 0");
  if (!options.optimal_shape)
    for (double lambda : options.shape)
      if (!(lambda > 0 && lambda < 1)) throw InvalidArgument("shape must lie between 0 and 1, ends excluded");
  if (options.output != "triangles" && options.output != "quads" && options.output != "cage")
    throw InvalidArgument("output must be triangles, quads or cage");
  if (options.odd != "split" && options.odd != "triangle") throw InvalidArgument("odd must be split or triangle");
  const bool triangles = options.output == "triangles";
  if (options.resolution && (*options.resolution < (triangles ? 1 : 0) || *options.resolution > (triangles ? 10000 : 100)))
    throw InvalidArgument(triangles ? "resolution must be from 1 to 10000" : "resolution must be from 0 to 100");
  if (options.tolerance && !(*options.tolerance > 0)) throw InvalidArgument("tolerance must be greater than 0");
}

Hole hole_of(const Mesh& mesh, const FillOptions& options) {
  if (options.rim) return make_hole(mesh, *options.rim, options.corners, options.replaced);
  if (!options.corners) return find_hole(mesh);
  for (const std::vector<Index>& loop : find_holes(mesh.faces))
    if (std::find(loop.begin(), loop.end(), (*options.corners)[0]) != loop.end())
      return make_hole(mesh, loop, options.corners, options.replaced);
  throw Refusal("The corner is not on the border of the mesh", {(*options.corners)[0]});
}

/// What the two sources of surroundings have in common.
struct Surroundings {
  Sides sides;
  std::array<std::vector<double>, 3> parameters;
  std::vector<std::string> warnings;
  double error = 0;
  Points border;  ///< empty: the rim's own vertices are reused
};

Surroundings surroundings_of(const Mesh& mesh, const Hole& hole, const FillOptions& options) {
  if (options.limit) {
    LimitSides limit = limit_sides(mesh, hole, options.subdivision, options.replaced);
    return {std::move(limit.sides), std::move(limit.parameters), std::move(limit.warnings), limit.surroundings_error,
            std::move(limit.border)};
  }
  MeshSides estimated = mesh_sides(mesh, hole, options.replaced);
  return {std::move(estimated.sides), std::move(estimated.parameters), {}, estimated.surroundings_error, {}};
}

/// Barycentric coordinates of the rim's own vertices: a border has several points an edge.
Points rim_barycentric(const Hole& hole, const Surroundings& surroundings) {
  std::vector<Vec3> rows;
  for (int i : {2, 0, 1}) {
    const std::vector<double>& t = surroundings.parameters[i];
    const std::size_t edges = hole.side(i).size() - 1, stride = (t.size() - 1) / edges;
    for (std::size_t e = 0; e < edges; ++e) {
      Vec3 b = Vec3::Zero();
      b[(i + 1) % 3] = 1 - t[e * stride];
      b[(i + 2) % 3] = t[e * stride];
      rows.push_back(b);
    }
  }
  Points out(static_cast<Index>(rows.size()), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) out.row(static_cast<Index>(k)) = rows[k];
  return out;
}

RibbonOptions ribbon_options(const FillOptions& options, const std::array<int, 3>& continuity) {
  RibbonOptions ribbons;
  ribbons.cross_boundary = options.cross_boundary;
  ribbons.bulge = options.bulge;
  for (int i = 0; i < 3; ++i) ribbons.tangent[i] = continuity[i] > 0;
  return ribbons;
}

/// What the output room made: rows of barycentric coordinates, the first `rim` of them around, and faces by row.
struct Cover {
  Points barycentric;
  Index rim = 0;
  Faces faces;
  std::vector<Index> rim_vertices;  ///< of the mesh, one a rim row; -1 where an edge was split
};

/// Splits the longest rim edge: quads need an even number around.
void split_longest(const Mesh& mesh, const Hole& hole, Surroundings& surroundings, Cover& cover, Fill& fill) {
  const auto length = [&](std::size_t k) {
    return (mesh.vertices.row(hole.rim[k]) - mesh.vertices.row(hole.rim[(k + 1) % hole.rim.size()])).norm();
  };
  std::size_t place = 0;
  for (std::size_t k = 1; k < hole.rim.size(); ++k)
    if (length(k) > (1 + 1e-9) * length(place)) place = k;
  std::size_t edge = place;
  for (int i : {2, 0, 1}) {
    std::vector<double>& t = surroundings.parameters[i];
    if (edge < t.size() - 1) {
      t.insert(t.begin() + static_cast<Index>(edge) + 1, 0.5 * (t[edge] + t[edge + 1]));
      break;
    }
    edge -= t.size() - 1;
  }
  cover.rim_vertices.insert(cover.rim_vertices.begin() + static_cast<Index>(place) + 1, -1);
  fill.split_edges.push_back({hole.rim[place], hole.rim[(place + 1) % hole.rim.size()]});
  fill.split_t.push_back(0.5);
}

/// The largest distance of the quads' middles from the patch: how far the flat-sided fill is from the smooth one.
double deviation(const Cover& cover, const Points& rim, const Surface& patch) {
  Points vertices = patch.positions(cover.barycentric);
  vertices.topRows(cover.rim) = rim;
  Points middle(cover.faces.size(), 3), b(cover.faces.size(), 3);
  for (Index f = 0; f < cover.faces.size(); ++f) {
    Vec3 p = Vec3::Zero(), q = Vec3::Zero();
    for (Index v : cover.faces[f]) {
      p += vertices.row(v);
      q += cover.barycentric.row(v);
    }
    middle.row(f) = p / static_cast<double>(cover.faces[f].size());
    b.row(f) = q / q.sum();
  }
  return (patch.positions(b) - middle).rowwise().norm().maxCoeff();
}

double diameter(const Points& points) {
  double d = 0;
  const Index step = std::max<Index>(1, points.rows() / 200);
  for (Index i = 0; i < points.rows(); i += step)
    for (Index k = 0; k < i; k += step) d = std::max(d, (points.row(i) - points.row(k)).norm());
  return d;
}

void cover_with_quads(const Points& rim, const Surroundings& surroundings, const FillOptions& options, Cover& cover, Fill& fill) {
  const double tolerance = options.tolerance.value_or(1e-3 * diameter(rim));
  const int first = options.resolution.value_or(0), last = options.resolution.value_or(4);
  for (int rows = first; rows <= last; ++rows) {
    QuadLayout layout = quad_layout(surroundings.parameters, rows, options.pole_offset);
    cover.barycentric = std::move(layout.barycentric);
    cover.rim = layout.rim;
    cover.faces = std::move(layout.faces);
    if (options.resolution) return;
    if (deviation(cover, fill.patch->positions(cover.barycentric.topRows(cover.rim)), *fill.patch) <= tolerance) return;
  }
  fill.report.warnings.push_back("Four extra rows of quads do not reach the tolerance; set the resolution by hand");
}

/// The faces as faces of the mesh (the rim's vertices reused) or, with a border, as a mesh of their own.
void take(const Cover& cover, const Points& border, const std::vector<Index>& rim, Index n, Fill& fill) {
  fill.rim = rim;
  std::vector<Index> index(cover.barycentric.rows()), rows;  // of the mesh; rows that become new vertices, split edges first
  const bool own = border.rows() > 0;
  for (Index k = 0; k < cover.barycentric.rows(); ++k) {
    const bool reused = !own && k < cover.rim && cover.rim_vertices[k] >= 0;
    index[k] = reused ? cover.rim_vertices[k] : n + static_cast<Index>(rows.size());
    if (!reused) rows.push_back(k);
  }
  fill.barycentric.resize(static_cast<Index>(rows.size()), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) fill.barycentric.row(static_cast<Index>(k)) = cover.barycentric.row(rows[k]);
  std::tie(fill.vertices, fill.normals) = fill.patch->positions_and_normals(fill.barycentric);
  if (own) {
    fill.vertices.topRows(border.rows()) = border;
    for (Index k = 0; k < border.rows(); ++k) fill.border.push_back(k);
  }
  fill.faces = cover.faces;
  for (Index& v : fill.faces.corners) v = index[v];
}

/// Fairing by the energy asked for; "auto" leaves fills alone that meet their surroundings in position only.
void make_fair(const Method& method, const RibbonOptions& ribbons, const Boundary& boundary, const FillOptions& options,
               Fill& fill) {
  if (options.fairing.empty() || options.fairing == "none") return;
  const std::array<bool, 3>& tangent = ribbons.tangent;
  if (options.fairing == "auto") {
    if (!(tangent[0] && tangent[1] && tangent[2])) return;
  }
  FairingOptions fairing;
  fairing.energy = options.fairing;
  for (int i = 0; i < 3; ++i) fairing.slopes_free[i] = options.bulge[i] == 1;
  fairing.rebuild = [&](const Sides& sides) {
    return build(method, sides, ribbons, {options.shape, options.optimal_shape, options.as_printed});
  };
  fairing.folds = [&](const Surface& patch) { return count_folds(patch, fill.sides); };
  FairResult fair_result = fair(fill.patch, fill.sides, boundary, fairing);
  fill.patch = std::move(fair_result.patch);
  fill.report.fairing = fair_result.energy;
  fill.report.energy_before = fair_result.before;
  fill.report.energy_after = fair_result.after;
  fill.report.warnings = std::move(fair_result.warnings);
}

std::string degrees(double angle) {
  std::ostringstream text;
  text.precision(2);
  text << angle << " degrees";
  return text.str();
}

}  // namespace

namespace {

/// The mesh with its longest rim edge split, and the hole in it: the new vertex is the last, a corner of the face beside the rim.
Hole split_mesh(const Mesh& mesh, const Hole& hole, Points& vertices, Faces& faces, Fill& result) {
  std::size_t place = 0;
  const std::size_t n = hole.rim.size();
  const auto length = [&](std::size_t k) {
    return (mesh.vertices.row(hole.rim[k]) - mesh.vertices.row(hole.rim[(k + 1) % n])).norm();
  };
  for (std::size_t k = 1; k < n; ++k)
    if (length(k) > (1 + 1e-9) * length(place)) place = k;
  const Index a = hole.rim[place], b = hole.rim[(place + 1) % n], middle = mesh.vertices.rows();
  vertices.resize(middle + 1, 3);
  vertices << Points(mesh.vertices), 0.5 * (mesh.vertices.row(a) + mesh.vertices.row(b));
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    std::vector<Index> face(mesh.faces[f].begin(), mesh.faces[f].end());
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index from = face[k], to = face[(k + 1) % face.size()];
      if ((from == a && to == b) || (from == b && to == a)) {
        face.insert(face.begin() + static_cast<Index>(k) + 1, middle);
        break;
      }
    }
    faces.add(face);
  }
  result.split_edges.push_back({a, b});
  result.split_t.push_back(0.5);
  Hole split = hole;
  split.rim.insert(split.rim.begin() + static_cast<Index>(place) + 1, middle);
  for (Index& corner : split.corners) corner += corner > static_cast<Index>(place);
  return split;
}

/// The fill as a cage; result.report has the seam between the limit surfaces.
void fill_with_cage(const Mesh& mesh, const Hole& hole, const FillOptions& options, const Method& method, Fill& result) {
  Points split_vertices;
  Faces split_faces;
  const bool split = hole.rim.size() % 2 == 1 && options.odd == "split";
  const Hole rim = split ? split_mesh(mesh, hole, split_vertices, split_faces, result) : hole;
  const Points& vertices = split ? split_vertices : (split_vertices = mesh.vertices);
  const Mesh cage = {vertices, split ? split_faces : mesh.faces};

  const std::array<int, 3> continuity = resolve_continuity(options.continuity, method);
  const auto fair_patch = [&](const Sides& sides) {
    Fill made;
    made.sides = sides;
    const RibbonOptions ribbons = ribbon_options(options, continuity);
    const Boundary boundary = make_boundary(sides, ribbons);
    made.patch = method.from_boundary(boundary, {options.shape, options.optimal_shape, options.as_printed});
    // The limit rim of an open cage is smooth at its corners, and a cage follows bending better than variation of curvature: its
    // surroundings then move a fifth to an eighth as much. A region to be replaced has ordinary corners on a known surface.
    FillOptions fairing = options;
    if (fairing.fairing == "auto" && options.replaced.empty()) fairing.fairing = "thin_plate";
    make_fair(method, ribbons, boundary, fairing, made);
    result.report.fairing = made.report.fairing;
    result.report.energy_before = made.report.energy_before;
    result.report.energy_after = made.report.energy_after;
    return made.patch;
  };
  std::array<std::vector<double>, 3> parameters;
  for (int i = 0; i < 3; ++i) {
    const std::size_t edges = rim.side(i).size() - 1;
    for (std::size_t k = 0; k <= edges; ++k) parameters[i].push_back(static_cast<double>(k) / static_cast<double>(edges));
  }
  Points rim_points(static_cast<Index>(rim.rim.size()), 3);
  for (std::size_t k = 0; k < rim.rim.size(); ++k) rim_points.row(static_cast<Index>(k)) = vertices.row(rim.rim[k]);
  const double tolerance = options.tolerance.value_or(1e-3 * diameter(rim_points));

  CageOptions cage_options;
  cage_options.rim = options.cage_rim;
  QuadLayout layout;
  CageFit fit;
  const int first = options.resolution.value_or(0), last = options.resolution.value_or(4);
  for (int rows = first; rows <= last; ++rows) {
    layout = quad_layout(parameters, rows, options.pole_offset);
    fit = fit_cage(cage, rim, options.subdivision, options.replaced, layout.barycentric, layout.faces, fair_patch, cage_options,
                   fit);
    if (fit.deviation_max <= tolerance) break;
  }
  Report& report = result.report;
  if (!options.resolution && fit.deviation_max > tolerance)
    report.warnings.push_back("Four extra rows of quads do not reach the tolerance; set the resolution by hand");

  const Index inside = fit.vertices.rows(), around = layout.rim, n = mesh.vertices.rows();
  result.patch = fit.patch;
  result.sides = fit.sides;
  result.rim = hole.rim;
  result.vertices.resize(inside + split, 3);  // a split edge's vertex comes first
  result.barycentric.resize(inside + split, 3);
  std::vector<Index> index(layout.barycentric.rows());
  Index on_rim = 0;
  result.rim_barycentric.resize(static_cast<Index>(hole.rim.size()), 3);
  for (Index k = 0; k < around; ++k) {
    index[k] = rim.rim[k];
    if (split && rim.rim[k] == n) {
      result.vertices.row(0) = vertices.row(n);
      result.barycentric.row(0) = layout.barycentric.row(k);
    } else {
      result.rim_barycentric.row(on_rim++) = layout.barycentric.row(k);
    }
  }
  for (Index k = 0; k < inside; ++k) index[around + k] = n + split + k;
  result.vertices.bottomRows(inside) = fit.vertices;
  result.barycentric.bottomRows(inside) = layout.barycentric.bottomRows(inside);
  result.normals = result.patch->normals(result.barycentric);
  result.rim_normals = result.patch->normals(result.rim_barycentric);
  for (Index f = 0; f < layout.faces.size(); ++f) {
    std::vector<Index> face;
    for (Index v : layout.faces[f]) face.push_back(index[v]);
    result.faces.add(face);
  }
  for (std::size_t k = 0; k < fit.moved.size(); ++k) {
    if (fit.moved[k] == n && split) {
      result.vertices.row(0) = fit.moved_to.row(static_cast<Index>(k));
    } else {
      result.moved.push_back(fit.moved[k]);
    }
  }
  result.moved_to.resize(static_cast<Index>(result.moved.size()), 3);
  for (std::size_t k = 0, row = 0; k < fit.moved.size(); ++k)
    if (!(fit.moved[k] == n && split)) result.moved_to.row(static_cast<Index>(row++)) = fit.moved_to.row(static_cast<Index>(k));
  result.creases = fit.creases;

  report.cage_deviation_max = fit.deviation_max;
  report.cage_deviation_rms = fit.deviation_rms;
  report.surroundings_moved_max = fit.surroundings_max;
  report.surroundings_moved_rms = fit.surroundings_rms;
  report.surroundings_moved_where = fit.surroundings_where;
  report.corners_moved_max = fit.corners_moved;
  std::vector<double> all;
  double squares = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0;
    const std::vector<double>& angles = fit.seam_angles[i];
    const std::size_t edges = parameters[i].size() - 1, per = angles.size() / edges, before = all.size();
    for (std::size_t k = 0; k < angles.size(); ++k) {
      if (angles[k] < 0) continue;
      report.seam_angle_max_by_side[i] = std::max(report.seam_angle_max_by_side[i], angles[k]);
      if (k >= per && k < (edges - 1) * per) report.seam_angle_max_inside = std::max(report.seam_angle_max_inside, angles[k]);
      sum += angles[k] * angles[k];
      all.push_back(angles[k]);
    }
    squares += sum;
    report.seam_angle_rms_by_side[i] = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, all.size() - before)));
    report.seam_angle_max = std::max(report.seam_angle_max, report.seam_angle_max_by_side[i]);
  }
  if (!all.empty()) {
    report.seam_angle_rms = std::sqrt(squares / static_cast<double>(all.size()));
    std::nth_element(all.begin(), all.begin() + static_cast<Index>(all.size() / 2), all.end());
    report.seam_angle_median = all[all.size() / 2];
  }
  for (Index pole : layout.poles) {
    Index valence = 0;
    for (Index v : layout.faces.corners) valence += v == pole;
    report.poles.push_back({index[pole], valence});
    if (valence > 5)
      report.warnings.push_back("Pole of valence " + std::to_string(valence) + " at new vertex " +
                                std::to_string(index[pole] - n));
  }
}

void finish(const Hole& hole, const std::array<double, 3>& corner_mismatch_deg, Report& report) {
  for (int k = 0; k < 3; ++k) {
    report.corners[k] = hole.rim[hole.corners[k]];
    if (corner_mismatch_deg[k] > 1)
      report.warnings.push_back("The tangent planes of the two sides differ by " + degrees(corner_mismatch_deg[k]) +
                                " at corner " + std::to_string(k) + " (vertex " + std::to_string(report.corners[k]) + ")");
  }
  if (report.folds > 0) report.warnings.push_back("The patch folds over itself at " + std::to_string(report.folds) + " places");
}

}  // namespace

Fill fill(const Mesh& mesh, const FillOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  check_options(options);
  const Method& method = find_method(options.method);
  if (!method.fills_holes)
    throw InvalidArgument(options.method + " joins three given surfaces; it does not fill a hole in a mesh");

  const Hole hole = hole_of(mesh, options);
  if (options.output == "cage") {
    Fill result;
    fill_with_cage(mesh, hole, options, method, result);
    result.report.folds = count_folds(*result.patch, result.sides);
    finish(hole, {0, 0, 0}, result.report);
    result.report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }
  Surroundings surroundings = surroundings_of(mesh, hole, options);
  Fill result;
  result.sides = surroundings.sides;
  for (int i = 0; i < 3; ++i) result.sides[i].rim = surroundings.parameters[i];
  const std::array<int, 3> continuity = resolve_continuity(options.continuity, method);
  const RibbonOptions ribbons = ribbon_options(options, continuity);
  const Boundary boundary = make_boundary(result.sides, ribbons);
  result.patch = method.from_boundary(boundary, {options.shape, options.optimal_shape, options.as_printed});
  make_fair(method, ribbons, boundary, options, result);

  result.rim_barycentric = rim_barycentric(hole, surroundings);
  Cover cover;
  cover.rim_vertices = hole.rim;
  if (options.output == "quads") {
    std::size_t around = 0;
    for (const std::vector<double>& t : surroundings.parameters) around += t.size() - 1;
    if (around % 2 == 1 && options.odd == "split" && surroundings.border.rows() == 0)
      split_longest(mesh, hole, surroundings, cover, result);
    cover_with_quads(result.patch->positions(result.rim_barycentric), surroundings, options, cover, result);
  } else {
    TriangleMesh triangles =
        triangulate(surroundings.parameters, options.resolution, [&](const PointsRef& b) { return result.patch->positions(b); });
    cover.barycentric = std::move(triangles.barycentric);
    cover.rim = triangles.rim;
    for (const std::array<Index, 3>& triangle : triangles.triangles) cover.faces.add(triangle);
  }
  take(cover, surroundings.border, hole.rim, mesh.vertices.rows(), result);
  result.rim_normals = result.patch->normals(result.rim_barycentric);

  Report& report = result.report;
  measure_seam(*result.patch, result.sides, report);
  report.folds = count_folds(*result.patch, result.sides);
  report.surroundings_error = surroundings.error;
  report.warnings.insert(report.warnings.begin(), surroundings.warnings.begin(), surroundings.warnings.end());
  finish(hole, boundary.corner_mismatch_deg, report);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::vector<std::variant<Fill, Refused>> fill_all(const Mesh& mesh, const std::vector<std::vector<Index>>& rims,
                                                  const FillOptions& options) {
  std::vector<std::variant<Fill, Refused>> results;
  for (const std::vector<Index>& rim : rims) {
    FillOptions one = options;
    one.rim = rim;
    try {
      results.emplace_back(fill(mesh, one));
    } catch (const Refusal& refusal) {
      results.emplace_back(Refused{refusal.what(), refusal.where()});
    }
  }
  return results;
}

}  // namespace tripatch
