#include "tripatch/fill.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/output/quad_layout.h"
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
  if (options.output != "triangles" && options.output != "quads") throw InvalidArgument("output must be triangles or quads");
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
  fill.vertices = fill.patch->positions(fill.barycentric);
  fill.normals = fill.patch->normals(fill.barycentric);
  if (own) {
    fill.vertices.topRows(border.rows()) = border;
    for (Index k = 0; k < border.rows(); ++k) fill.border.push_back(k);
  }
  for (Index f = 0; f < cover.faces.size(); ++f) {
    std::vector<Index> face;
    for (Index v : cover.faces[f]) face.push_back(index[v]);
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
  Surroundings surroundings = surroundings_of(mesh, hole, options);
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
