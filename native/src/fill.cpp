#include "tripatch/fill.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <tuple>

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/output/cage_fill.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/output/triangulate.h"
#include "tripatch/patch/fairing.h"
#include "tripatch/patch/methods.h"
#include "tripatch/patch/szilvasi_nagy.h"

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

/// The method's patch; its warnings and the path of an optimal lambda go into the report.
SurfacePtr construct(const Method& method, const Boundary& boundary, const FillOptions& options, Report& report) {
  MethodOptions own = options.own;
  own.warnings = &report.warnings;
  SurfacePtr patch = method.from_boundary(boundary, own);
  if (const auto blend = std::dynamic_pointer_cast<const SzilvasiNagy>(patch))
    for (const SzilvasiNagy::Step& step : blend->path()) report.shape_path.emplace_back(step.shape, step.energy);
  return patch;
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
  fairing.rebuild = [&](const Sides& sides) { return build(method, sides, ribbons, options.own); };
  fairing.folds = [&](const Surface& patch) { return count_folds(patch, fill.sides); };
  FairResult fair_result = fair(fill.patch, fill.sides, boundary, fairing);
  fill.patch = std::move(fair_result.patch);
  fill.report.fairing = fair_result.energy;
  fill.report.energy_before = fair_result.before;
  fill.report.energy_after = fair_result.after;
  for (std::string& warning : fair_result.warnings) fill.report.warnings.push_back(std::move(warning));
}

std::string degrees(double angle) {
  std::ostringstream text;
  text.precision(2);
  text << angle << " degrees";
  return text.str();
}

LayoutOptions layout_options(const FillOptions& options) {
  return {options.resolution, options.tolerance, options.odd == "split", options.pole_offset};
}

/// The fill as a cage; its report has the seam between the limit surfaces.
Fill cage_of(const Mesh& mesh, const Hole& hole, const FillOptions& options, const Method& method) {
  const std::array<int, 3> continuity = resolve_continuity(options.continuity, method);
  Report fairing;
  const auto fair_patch = [&](const Sides& sides) {
    Fill made;
    made.sides = sides;
    const RibbonOptions ribbons = ribbon_options(options, continuity);
    const Boundary boundary = make_boundary(sides, ribbons);
    made.patch = construct(method, boundary, options, made.report);
    // The limit rim of an open cage is smooth at its corners, and a cage follows bending better than variation of curvature: its
    // surroundings then move a fifth to an eighth as much. A region to be replaced has ordinary corners on a known surface.
    FillOptions wanted = options;
    if (wanted.fairing == "auto" && options.replaced.empty()) wanted.fairing = "thin_plate";
    make_fair(method, ribbons, boundary, wanted, made);
    fairing = made.report;
    return made.patch;
  };
  CageOptions cage_options;
  cage_options.rim = options.cage_rim;
  CageFill cage =
      fill_with_cage(mesh, hole, options.subdivision, options.replaced, layout_options(options), cage_options, fair_patch);
  Fill result;
  result.vertices = std::move(cage.vertices);
  result.faces = std::move(cage.faces);
  result.barycentric = std::move(cage.barycentric);
  result.rim = hole.rim;
  result.rim_barycentric = std::move(cage.rim_barycentric);
  result.normals = cage.patch->normals(result.barycentric);
  result.rim_normals = cage.patch->normals(result.rim_barycentric);
  result.split_edges = std::move(cage.split_edges);
  result.split_t = std::move(cage.split_t);
  result.moved = std::move(cage.moved);
  result.moved_to = std::move(cage.moved_to);
  result.creases = std::move(cage.creases);
  result.patch = std::move(cage.patch);
  result.sides = std::move(cage.sides);
  result.report = std::move(cage.report);
  result.report.fairing = fairing.fairing;
  result.report.energy_before = fairing.energy_before;
  result.report.energy_after = fairing.energy_after;
  result.report.shape_path = std::move(fairing.shape_path);
  result.report.warnings.insert(result.report.warnings.end(), fairing.warnings.begin(), fairing.warnings.end());
  return result;
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
    Fill result = cage_of(mesh, hole, options, method);
    result.report.folds = count_folds(*result.patch, result.sides);
    finish(hole, {0, 0, 0}, result.report);
    result.report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }
  Surroundings surroundings = surroundings_of(mesh, hole, options);
  Fill result;
  result.sides = surroundings.sides;
  if (!options.limit)  // with it the sides know the rim's own vertices, and the parameters are those of the border
    for (int i = 0; i < 3; ++i) result.sides[i].rim = surroundings.parameters[i];
  const std::array<int, 3> continuity = resolve_continuity(options.continuity, method);
  const RibbonOptions ribbons = ribbon_options(options, continuity);
  const Boundary boundary = make_boundary(result.sides, ribbons);
  result.patch = construct(method, boundary, options, result.report);
  make_fair(method, ribbons, boundary, options, result);

  result.rim_barycentric = rim_barycentric(hole, surroundings);
  Cover cover;
  cover.rim_vertices = hole.rim;
  if (options.output == "quads") {
    cover = cover_with_quads(mesh, hole, surroundings.parameters, *result.patch, layout_options(options),
                             surroundings.border.rows() > 0);
    result.split_edges = std::move(cover.split_edges);
    result.split_t = std::move(cover.split_t);
    result.report.warnings.insert(result.report.warnings.end(), cover.warnings.begin(), cover.warnings.end());
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
