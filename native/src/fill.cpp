#include "tripatch/fill.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/output/triangulate.h"
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
  if (options.resolution && (*options.resolution < 1 || *options.resolution > 10000))
    throw InvalidArgument("resolution must be from 1 to 10000");
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

/// The triangles as faces of the mesh (the rim's vertices reused) or, with a border, as a mesh of their own.
void take(const TriangleMesh& triangles, const Points& border, const std::vector<Index>& rim, Index n, Fill& fill) {
  const bool own = border.rows() > 0;
  const Index rows = triangles.barycentric.rows(), first = own ? 0 : triangles.rim;
  fill.rim = rim;
  fill.barycentric = triangles.barycentric.bottomRows(rows - first);
  fill.vertices = fill.patch->positions(fill.barycentric);
  fill.normals = fill.patch->normals(fill.barycentric);
  if (own) {
    fill.vertices.topRows(border.rows()) = border;
    for (Index k = 0; k < border.rows(); ++k) fill.border.push_back(k);
  }
  for (const std::array<Index, 3>& triangle : triangles.triangles) {
    std::array<Index, 3> face;
    for (int k = 0; k < 3; ++k) face[k] = triangle[k] < first ? rim[triangle[k]] : n + triangle[k] - first;
    fill.faces.add(face);
  }
}

std::string degrees(double angle) {
  std::ostringstream text;
  text.precision(2);
  text << angle << " degrees";
  return text.str();
}

}  // namespace

Fill fill(const Mesh& mesh, const FillOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  check_options(options);
  const Method& method = find_method(options.method);
  if (!method.fills_holes)
    throw InvalidArgument(options.method + " joins three given surfaces; it does not fill a hole in a mesh");

  const Hole hole = hole_of(mesh, options);
  const Surroundings surroundings = surroundings_of(mesh, hole, options);
  RibbonOptions ribbon_options;
  ribbon_options.cross_boundary = options.cross_boundary;
  ribbon_options.bulge = options.bulge;
  const std::array<int, 3> continuity = resolve_continuity(options.continuity, method);
  for (int i = 0; i < 3; ++i) ribbon_options.tangent[i] = continuity[i] > 0;

  Fill result;
  result.sides = surroundings.sides;
  for (int i = 0; i < 3; ++i) result.sides[i].rim = surroundings.parameters[i];
  const Boundary boundary = make_boundary(result.sides, ribbon_options);
  result.patch = method.from_boundary(boundary, {options.shape, options.optimal_shape, options.as_printed});

  const TriangleMesh triangles =
      triangulate(surroundings.parameters, options.resolution, [&](const PointsRef& b) { return result.patch->positions(b); });
  take(triangles, surroundings.border, hole.rim, mesh.vertices.rows(), result);
  result.rim_barycentric = rim_barycentric(hole, surroundings);
  result.rim_normals = result.patch->normals(result.rim_barycentric);

  Report& report = result.report;
  measure_seam(*result.patch, result.sides, report);
  report.folds = count_folds(*result.patch, result.sides);
  report.surroundings_error = surroundings.error;
  report.warnings = surroundings.warnings;
  for (int k = 0; k < 3; ++k) {
    report.corners[k] = hole.rim[hole.corners[k]];
    if (boundary.corner_mismatch_deg[k] > 1)
      report.warnings.push_back("The tangent planes of the two sides differ by " + degrees(boundary.corner_mismatch_deg[k]) +
                                " at corner " + std::to_string(k) + " (vertex " + std::to_string(report.corners[k]) + ")");
  }
  if (report.folds > 0) report.warnings.push_back("The patch folds over itself at " + std::to_string(report.folds) + " places");
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
