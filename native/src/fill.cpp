#include "tripatch/fill.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <future>
#include <map>
#include <numeric>
#include <set>
#include <sstream>
#include <thread>
#include <tuple>

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/cage/cage_fill.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/math/parallel.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/output/triangulate.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

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

std::string degrees(double angle) {
  std::ostringstream text;
  text.precision(angle < 99.5 ? 2 : 3);
  text << angle << " degrees";
  return text.str();
}

LayoutOptions layout_options(const FillOptions& options) {
  return {options.resolution, options.tolerance, options.odd == "split", options.pole_offset};
}

/// Fills as cages, fitted together; their reports have the seams between the limit surfaces.
std::vector<Fill> cages_of(const Mesh& mesh, const std::vector<Hole>& holes, const FillOptions& options) {
  // The border of an open cage, to which an exact rim holds, is flat across and round at corners: a patch that is made fair bends
  // sharply behind it, and no cage follows. Elsewhere curvature shall vary least: in the cage, whose patch follows it, or where
  // the patch's own shape is asked for, in the patch.
  FillOptions wanted = options;
  const bool shaped = options.tension > 0 || options.center || options.center_offset != 0 ||
                      options.bulge != std::array<double, 3>{1, 1, 1} ||
                      std::find(options.continuity.begin(), options.continuity.end(), "Free") != options.continuity.end();
  const bool follows = options.fairing == "auto" && options.cage_rim != CageRim::exact && !shaped;
  if (options.fairing == "auto" && options.cage_rim == CageRim::exact && options.tension == 0) wanted.fairing = "none";
  std::vector<Fill> results(holes.size());
  std::vector<Report> reports(holes.size());
  std::vector<CageRequest> requests;
  for (std::size_t h = 0; h < holes.size(); ++h)
    requests.push_back({holes[h], [&, &report = reports[h]](const Sides& sides, const SurfacePoints& points) {
                          MadePatch made = patch_from_sides(sides, wanted, follows ? &points : nullptr);
                          report = std::move(made.report);
                          return made.patch;
                        }});
  CageOptions cage_options;
  cage_options.rim = options.cage_rim;
  std::vector<CageFill> cages =
      fill_with_cages(mesh, requests, options.subdivision, options.replaced, layout_options(options), cage_options);
  for (std::size_t h = 0; h < holes.size(); ++h) {
    Fill& result = results[h];
    CageFill& cage = cages[h];
    result.vertices = std::move(cage.vertices);
    result.faces = std::move(cage.faces);
    result.barycentric = std::move(cage.barycentric);
    result.rim = holes[h].rim;
    result.rim_barycentric = std::move(cage.rim_barycentric);
    result.patch = std::move(cage.patch);
    result.sides.assign(cage.sides.begin(), cage.sides.end());
    result.normals = result.patch->normals(result.barycentric);
    result.rim_normals = result.patch->normals(result.rim_barycentric);
    result.split_edges = std::move(cage.split_edges);
    result.split_t = std::move(cage.split_t);
    result.moved = std::move(cage.moved);
    result.moved_to = std::move(cage.moved_to);
    result.creases = std::move(cage.creases);
    const Report& fair = reports[h];
    result.report = std::move(cage.report);
    result.report.continuity = fair.continuity;
    if (!follows) {  // else the energy is that of the limit surface
      result.report.fairing = fair.fairing;
      result.report.energy_before = fair.energy_before;
      result.report.energy_after = fair.energy_after;
    }
    result.report.shape_path = fair.shape_path;
    result.report.warnings.insert(result.report.warnings.begin(), fair.warnings.begin(), fair.warnings.end());
    result.report.folds = fair.folds;
  }
  return results;
}

/// Holes in groups: those that share faces of their first two rings belong together.
std::vector<std::vector<std::size_t>> groups_of(const Mesh& mesh, const std::vector<Hole>& holes,
                                                const std::vector<Index>& replaced) {
  std::vector<std::size_t> group(holes.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto root = [&](std::size_t h) {
    while (group[h] != h) h = group[h];
    return h;
  };
  std::vector<std::vector<Index>> faces_at(mesh.vertices.rows());
  const std::set<Index> gone(replaced.begin(), replaced.end());
  for (Index f = 0; f < mesh.faces.size(); ++f)
    if (!gone.contains(f))
      for (Index v : mesh.faces[f]) faces_at[v].push_back(f);
  std::map<Index, std::size_t> owner;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    std::set<Index> front(holes[h].rim.begin(), holes[h].rim.end()), faces;
    for (int ring = 0; ring < 2; ++ring) {
      for (Index v : front) faces.insert(faces_at[v].begin(), faces_at[v].end());
      for (Index f : faces) front.insert(mesh.faces[f].begin(), mesh.faces[f].end());
    }
    for (Index f : faces) {
      const auto [place, fresh] = owner.try_emplace(f, h);
      if (!fresh) group[root(h)] = root(place->second);
    }
  }
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t h = 0; h < holes.size(); ++h) members[root(h)].push_back(h);
  std::vector<std::vector<std::size_t>> result;
  for (auto& [first, all] : members) result.push_back(std::move(all));
  return result;
}

void finish(const Hole& hole, const FillOptions& options, const std::array<double, 3>& corner_mismatch_deg, Report& report) {
  report.method = find_method(options.method).name;
  report.method_reason = "it was asked for";
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
    Fill result = std::move(cages_of(mesh, {hole}, options)[0]);
    finish(hole, options, {0, 0, 0}, result.report);
    result.report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
  }
  Surroundings surroundings = surroundings_of(mesh, hole, options);
  Fill result;
  result.sides.assign(surroundings.sides.begin(), surroundings.sides.end());
  MadePatch made = patch_from_sides(surroundings.sides, options);
  result.patch = std::move(made.patch);
  result.report = std::move(made.report);

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
  measure_seam(*result.patch, surroundings.sides, report);
  report.triangles_folded = count_folded_edges(mesh.vertices, result.vertices, result.faces);
  report.surroundings_error = surroundings.error;
  report.warnings.insert(report.warnings.begin(), surroundings.warnings.begin(), surroundings.warnings.end());
  finish(hole, options, made.corner_mismatch_deg, report);
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

namespace {

/// Cages for several holes: those whose surroundings overlap are fitted together.
void fill_all_with_cages(const Mesh& mesh, const std::vector<FillOptions>& each,
                         std::vector<std::variant<Fill, Refused>>& results) {
  std::vector<Hole> holes;
  std::vector<std::size_t> place;  // of each hole in the results
  for (std::size_t k = 0; k < each.size(); ++k) {
    try {
      check_options(each[k]);
      holes.push_back(hole_of(mesh, each[k]));
      place.push_back(k);
    } catch (const Refusal& refusal) {
      results[k] = Refused{refusal.what(), refusal.where()};
    }
  }
  for (const std::vector<std::size_t>& group : groups_of(mesh, holes, each.empty() ? std::vector<Index>{} : each[0].replaced)) {
    std::vector<Hole> together;
    for (std::size_t h : group) together.push_back(holes[h]);
    const auto start = std::chrono::steady_clock::now();
    try {
      const FillOptions& options = each[place[group[0]]];
      std::vector<Fill> fills = cages_of(mesh, together, options);
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      for (std::size_t k = 0; k < group.size(); ++k) {
        finish(together[k], options, {0, 0, 0}, fills[k].report);
        fills[k].report.seconds = seconds / static_cast<double>(group.size());
        results[place[group[k]]] = std::move(fills[k]);
      }
    } catch (const Refusal& refusal) {
      if (group.size() == 1) {
        results[place[group[0]]] = Refused{refusal.what(), refusal.where()};
        continue;
      }
      for (std::size_t h : group) {  // one of them stands in the way of the others
        try {
          results[place[h]] = fill(mesh, each[place[h]]);
        } catch (const Refusal& alone) {
          results[place[h]] = Refused{alone.what(), alone.where()};
        }
      }
    }
  }
}

}  // namespace

std::vector<std::variant<Fill, Refused>> fill_all(const Mesh& mesh, const std::vector<std::vector<Index>>& rims,
                                                  const FillOptions& options,
                                                  const std::vector<std::optional<std::array<Index, 3>>>& corners,
                                                  const Progress& progress) {
  if (options.center && rims.size() > 1)
    throw InvalidArgument("center is the middle of one hole; center_offset moves the middles of several");
  std::vector<FillOptions> each(rims.size(), options);
  for (std::size_t k = 0; k < rims.size(); ++k) {
    each[k].rim = rims[k];
    if (k < corners.size()) each[k].corners = corners[k];
  }
  std::vector<std::variant<Fill, Refused>> results(rims.size());
  if (options.output == "cage") {
    fill_all_with_cages(mesh, each, results);
    if (progress) progress(rims.size());
    return results;
  }
  std::atomic<std::size_t> next = 0, done = 0;
  std::atomic<bool> stop = false;
  const bool many = rims.size() > 1;
  const auto work = [&] {
    one_of_many = many;
    for (std::size_t k = next++; k < rims.size() && !stop; k = next++) {
      try {
        results[k] = fill(mesh, each[k]);
      } catch (const Refusal& refusal) {
        results[k] = Refused{refusal.what(), refusal.where()};
      } catch (...) {
        stop = true;
        throw;
      }
      ++done;
    }
  };
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  std::vector<std::future<void>> workers;
  for (std::size_t k = 0; k < std::min(cores, rims.size()); ++k) workers.push_back(std::async(std::launch::async, work));
  std::exception_ptr failure;
  for (std::future<void>& worker : workers) {
    try {
      while (worker.wait_for(std::chrono::milliseconds(100)) == std::future_status::timeout)
        if (progress && !stop) progress(done);
      worker.get();
    } catch (...) {
      stop = true;
      if (!failure) failure = std::current_exception();
      worker.wait();
    }
  }
  if (failure) std::rethrow_exception(failure);
  if (progress) progress(done);
  return results;
}

}  // namespace tripatch
