#include "tripatch/fill.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>

#include "tripatch/boundary/surroundings.h"
#include "tripatch/cage/cage_fill.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/math/parallel.h"
#include "tripatch/output/cover.h"
#include "tripatch/output/quad_cover.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

/// Degrees between the tangent planes of two sides at their corner that are worth a warning: a mesh of some 16 edges a side estimates
/// its planes to a few tenths of one.
constexpr double corner_mismatch_warned = 1;

class Stopwatch {
public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void check_options(const FillOptions& options) {
  check(options);
  const bool triangles = options.output == Output::triangles;
  if (options.resolution && (*options.resolution < (triangles ? 1 : 0) || *options.resolution > (triangles ? 10000 : 100)))
    throw InvalidArgument(triangles ? "resolution must be from 1 to 10000" : "resolution must be from 0 to 100");
}

Hole hole_of(const Mesh& mesh, const FillOptions& options) {
  if (options.rim) return make_hole(mesh, *options.rim, options.corners, options.replaced);
  if (!options.corners) return find_hole(mesh);
  for (const std::vector<Index>& loop : find_holes(mesh.faces))
    if (std::find(loop.begin(), loop.end(), (*options.corners)[0]) != loop.end())
      return make_hole(mesh, loop, options.corners, options.replaced);
  throw Refusal("The corner is not on the border of the mesh", {(*options.corners)[0]});
}

LayoutOptions layout_options(const FillOptions& options) {
  return {options.resolution, options.tolerance, options.odd == Odd::split, options.pole_offset};
}

std::string degrees(double angle) {
  std::ostringstream text;
  text.precision(angle < 99.5 ? 2 : 3);
  text << angle << " degrees";
  return text.str();
}

/// What is said of every fill, whatever it is made of.
void complete_report(const Hole& hole, const FillOptions& options, const std::array<double, 3>& corner_mismatch_deg,
                     Report& report) {
  report.method = find_method(options.method).name;
  report.method_reason = "it was asked for";
  for (int k = 0; k < 3; ++k) {
    report.corners[k] = hole.rim[hole.corners[k]];
    if (corner_mismatch_deg[k] > corner_mismatch_warned)
      report.warnings.push_back("The tangent planes of the two sides differ by " + degrees(corner_mismatch_deg[k]) +
                                " at corner " + std::to_string(k) + " (vertex " + std::to_string(report.corners[k]) + ")");
  }
  if (report.folds > 0) report.warnings.push_back("The patch folds over itself at " + std::to_string(report.folds) + " places");
}

/// The path of three sides: what surrounds them, the patch between them, the faces on it, and how well all that fits.
Fill fill_with_patch(const Mesh& mesh, const Hole& hole, const FillOptions& options) {
  const Surroundings surroundings = surroundings_of(
      mesh, hole, options.surroundings == SurroundingsFrom::limit ? &options.subdivision : nullptr, options.replaced);

  MadePatch made = patch_from_sides(surroundings.sides, options);
  Fill fill;
  fill.patch = std::move(made.patch);
  fill.report = std::move(made.report);
  fill.sides.assign(surroundings.sides.begin(), surroundings.sides.end());

  const bool own_rim = surroundings.border.rows() > 0;
  const Cover cover = options.output == Output::quads
                          ? cover_with_quads(mesh, hole, surroundings.parameters, *fill.patch, layout_options(options), own_rim)
                          : cover_with_triangles(hole, surroundings.parameters, *fill.patch, options.resolution);
  deliver(cover, surroundings.border, mesh.vertices.rows(), fill);
  fill.rim = hole.rim;
  fill.rim_barycentric = rim_barycentric(hole, surroundings);
  fill.rim_normals = fill.patch->normals(fill.rim_barycentric);

  Report& report = fill.report;
  measure_seam(*fill.patch, surroundings.sides, report);
  report.triangles_folded = count_folded_edges(mesh.vertices, fill.vertices, fill.faces);
  report.surroundings_error = surroundings.error;
  report.warnings.insert(report.warnings.begin(), surroundings.warnings.begin(), surroundings.warnings.end());
  complete_report(hole, options, made.corner_mismatch_deg, report);
  return fill;
}

/// Whether the patch's own shape is asked for.
bool is_shaped(const FillOptions& options) {
  return options.tension > 0 || options.center || options.center_offset != 0 || options.bulge != std::array<double, 3>{1, 1, 1} ||
         std::find(options.continuity.begin(), options.continuity.end(), SideContinuity::free) != options.continuity.end();
}

/// The path of cages, fitted together: layouts, the fairest cages on them, patches between their sides, the cages fitted to these.
std::vector<Fill> fill_with_cages(const Mesh& mesh, const std::vector<Hole>& holes, const FillOptions& options) {
  CageOptions cage_options;
  cage_options.rim = options.cage_rim;
  CageFill cages(mesh, holes, options.subdivision, options.replaced, layout_options(options), cage_options);

  // The border of an open cage, to which an exact rim holds, is flat across and round at corners: a patch that is made fair bends
  // sharply behind it, and no cage follows. Elsewhere curvature shall vary least: in the cage, whose patch follows it, or where
  // the patch's own shape is asked for, in the patch.
  const bool exact = options.cage_rim == CageRim::exact, automatic = options.fairing == Fairing::automatic;
  const bool follows = automatic && !exact && !is_shaped(options);
  FillOptions wanted = options;
  if (automatic && exact && options.tension == 0) wanted.fairing.reset();
  std::vector<Fill> fills(holes.size());
  std::vector<SurfacePtr> patches;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    MadePatch made = patch_from_sides(cages.sides(h), wanted, follows ? &cages.points(h) : nullptr);
    fills[h].patch = made.patch;
    fills[h].report = std::move(made.report);
    patches.push_back(std::move(made.patch));
  }

  cages.fit(std::move(patches));
  for (std::size_t h = 0; h < holes.size(); ++h) {
    cages.complete(h, fills[h]);
    if (follows) cages.report_energies(h, fills[h].report);
    complete_report(holes[h], options, {0, 0, 0}, fills[h].report);
  }
  return fills;
}

Refused refused(const Refusal& refusal) { return {refusal.what(), refusal.where()}; }

using Results = std::vector<std::variant<Fill, Refused>>;

/// Cages for several holes: those whose surroundings overlap are fitted together.
void fill_all_with_cages(const Mesh& mesh, const std::vector<FillOptions>& each, Results& results) {
  std::vector<Hole> holes;
  std::vector<std::size_t> place;  // of each hole in the results
  for (std::size_t k = 0; k < each.size(); ++k) {
    try {
      check_options(each[k]);
      holes.push_back(hole_of(mesh, each[k]));
      place.push_back(k);
    } catch (const Refusal& refusal) {
      results[k] = refused(refusal);
    }
  }
  const std::vector<Index> replaced = each.empty() ? std::vector<Index>() : each[0].replaced;
  for (const std::vector<std::size_t>& group : cage_groups(mesh, holes, replaced)) {
    std::vector<Hole> together;
    for (std::size_t h : group) together.push_back(holes[h]);
    const Stopwatch watch;
    try {
      std::vector<Fill> fills = fill_with_cages(mesh, together, each[place[group[0]]]);
      for (std::size_t k = 0; k < group.size(); ++k) {
        fills[k].report.seconds = watch.seconds() / static_cast<double>(group.size());
        results[place[group[k]]] = std::move(fills[k]);
      }
    } catch (const Refusal& refusal) {
      if (group.size() == 1) results[place[group[0]]] = refused(refusal);
      for (std::size_t h = 0; group.size() > 1 && h < group.size(); ++h) {  // one of them stands in the way of the others
        const std::size_t k = place[group[h]];
        try {
          results[k] = fill(mesh, each[k]);
        } catch (const Refusal& alone) {
          results[k] = refused(alone);
        }
      }
    }
  }
}

}  // namespace

Fill fill(const Mesh& mesh, const FillOptions& options) {
  const Stopwatch watch;
  check_options(options);
  if (!find_method(options.method).fills_holes)
    throw InvalidArgument(options.method + " joins three given surfaces; it does not fill a hole in a mesh");
  const Hole hole = hole_of(mesh, options);
  Fill result = options.output == Output::cage ? std::move(fill_with_cages(mesh, {hole}, options)[0])
                                               : fill_with_patch(mesh, hole, options);
  result.report.seconds = watch.seconds();
  return result;
}

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
  Results results(rims.size());
  const auto report_progress = [&](std::size_t done) {
    if (progress) progress(done);
  };
  if (options.output == Output::cage) {
    fill_all_with_cages(mesh, each, results);
    report_progress(rims.size());
    return results;
  }
  const auto fill_one = [&](std::size_t k) {
    try {
      results[k] = fill(mesh, each[k]);
    } catch (const Refusal& refusal) {
      results[k] = refused(refusal);
    }
  };
  parallel_for_each(rims.size(), fill_one, report_progress);
  return results;
}

}  // namespace tripatch
