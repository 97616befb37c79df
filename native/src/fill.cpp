#include "tripatch/fill.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

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
  const MeshSides surroundings = mesh_sides(mesh, hole, options.replaced);
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
  const Index inside = triangles.barycentric.rows() - triangles.rim, n = mesh.vertices.rows();
  result.rim = hole.rim;
  result.rim_barycentric = triangles.barycentric.topRows(triangles.rim);
  result.barycentric = triangles.barycentric.bottomRows(inside);
  result.rim_normals = result.patch->normals(result.rim_barycentric);
  result.normals = result.patch->normals(result.barycentric);
  result.vertices = result.patch->positions(result.barycentric);
  for (const std::array<Index, 3>& triangle : triangles.triangles) {
    std::array<Index, 3> face;
    for (int k = 0; k < 3; ++k) face[k] = triangle[k] < triangles.rim ? hole.rim[triangle[k]] : n + triangle[k] - triangles.rim;
    result.faces.add(face);
  }

  Report& report = result.report;
  measure_seam(*result.patch, result.sides, report);
  report.folds = count_folds(*result.patch, result.sides);
  report.surroundings_error = surroundings.surroundings_error;
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
