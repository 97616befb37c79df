#include "tripatch/spline/mended_attempt.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tripatch/math/thresholds.h"
#include "tripatch/output/domain_mesh.h"
#include "tripatch/spline/averaged_models.h"
#include "tripatch/spline/minimize_bending.h"
#include "tripatch/triangulation/untangle.h"

namespace tripatch {
namespace {

/// Of the area of few triangles, and of how many fine ones that asks for: a field whose fine ones have more of both folds between the few.
/// Of 18 fills of rims of 220 to 370 edges those that served had 1.00 to 1.02 times the area and 0.6 to 1.4 times the triangles; seven
/// that folded avoidably had 1.6 to 40 and 2.9 to 6.
constexpr double more_area = factor::slight, more_triangles = factor::clear;

/// Of triangles as fine as the rim, by the few.
MostTriangles max_triangles_on(const Attempt& few, double edge) {
  const double area = area_of(few.made.points, few.made.triangles), asked = area / (area_of_triangle * edge * edge);
  return {static_cast<std::size_t>(std::min(more_triangles * asked, 1 / tolerance::solved)), more_area * area};
}

/// Orders of a second model, and whether it keeps the planes next to the rim.
struct Bends {
  std::vector<int> orders;
  bool keep_planes = true;
};

/// Triangles of which bending more takes no time.
constexpr std::size_t few_to_bend = count::hundred;

/// Whether triangles that bend least fold so much that other orders do as well: it is their layout that is wrong.
bool is_hopeless(const PlaneRim& rim, const Attempt& bent) {
  const Index folds = count_folded_edges(bent.made.points, bent.made.triangles, rim.beyond) - max_folds(rim, bent);
  return bent.made.triangles.size() > few_to_bend && is_past_mending(folds, bent.made.triangles.size());
}

}  // namespace

bool is_finer(const PlaneRim& rim, const PlaneFillOptions& options) {
  return options.resolution && 2 * *options.resolution > rim.points.rows() && options.through.empty() &&
         options.planes.rows() == 0;
}

bool refine(const PlaneRim& rim, std::optional<int> resolution, Attempt& result) {
  const Index r = rim.points.rows();
  const PlanePoints places = result.made.uv;
  const MostTriangles most = result.few && !resolution ? max_triangles_on(result, rim.edge) : MostTriangles();
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(places.rows());
  if (result.second) spread.tail(places.rows() - r) = spread_of_models(result);
  result.made = triangulated(polygon_of(rim, result.rim_uv), rim.through, resolution, result, most);
  if (result.made.unfinished || !result.made.points.allFinite() || !stays_near(result.made.points, rim)) return false;
  result.on_field = result.made.points;
  const PlanePoints inside = result.made.uv.bottomRows(result.made.uv.rows() - r);
  if (result.second) result.spread = carried(spread, places, std::max(rim.edge, tolerance::tiny), inside);
  result.second.reset();
  return !result.made.doubles_edges || rim.doubles_edges;
}

Index unfolded(const PlaneRim& rim, Attempt& result) {
  const Index folds = count_folded_edges(result.made.points, result.made.triangles, rim.beyond);
  if (folds == 0) return 0;
  const Index r = rim.points.rows();
  PlaneTriangulation& made = result.made;
  const Index most = max_folds(rim, result);
  if (folds > most && is_past_mending(folds, made.triangles.size())) return folds;
  for (const Index allowed : {Index{0}, most}) {
    Index left = untangle(made.points, made.triangles, r, allowed, rim.beyond);
    if (left <= allowed) return left;
    if (allowed < most) continue;
    std::vector<std::array<Index, 3>> flipped = made.triangles;
    left = flip_folded(made.points, flipped, rim.surroundings.joined, allowed, rim.beyond);
    if (left > allowed) left = untangle(made.points, flipped, r, allowed, rim.beyond);
    if (left > allowed) return left;
    made.triangles = std::move(flipped);
    return left;
  }
  return 0;
}

bool stays_folded(const PlaneRim& rim, Attempt looked_at) {
  return unfolded(rim, looked_at) > max_folds(rim, looked_at) || crosses(rim, looked_at);
}

bool serves(const PlaneRim& rim, Attempt& result) {
  return unfolded(rim, result) <= max_folds(rim, result) &&
         count_folded_edges(result.made.points, result.made.triangles, {}) <= rim.folds_of_plain && !crosses(rim, result);
}

Disc with_two_rings(const Mesh& mesh, const Connectivity& continued, const std::vector<std::vector<Index>>& loops,
                    const Disc& disc) {
  return disc.rings < 2 ? disc_around(mesh, continued, loops, 0, 2) : disc;
}

bool second_alone(const Disc& disc, const PlaneRim& rim, Work& work, Attempt& result) {
  if (disc.triangles.empty() || result.made.points.rows() == disc.rim || result.met) return false;
  std::array<std::optional<SecondModels>, 2> of_result;  // that need not keep the planes next to the rim, and that do
  for (const auto& [orders, keep_planes] : {Bends{{2, 3}}, {{2}}, {{2, 3}, false}, {{2}, false}, {{1}}}) {
    Attempt alone = result;
    std::optional<SecondModels>& models = of_result[keep_planes];
    if (!models) models.emplace(alone.made.points, alone.made.triangles, disc, keep_planes);
    std::optional<SecondModel> second = models->by(orders);
    for (int round = 0; round < 2; ++round) {  // the second by angles of triangles that do not fold
      if (work.is_spent()) return false;
      work.add(alone.made.points.rows());
      if (round > 0) second = second_model(alone.made.points, alone.made.triangles, disc, orders, keep_planes);
      if (!second || !take_second(rim, *second, 1, alone)) break;
      if (!serves(rim, alone)) {
        if (is_hopeless(rim, alone)) return false;
        continue;
      }
      result = std::move(alone);
      return true;
    }
  }
  return false;
}

bool few_alone(const Disc& disc, const PlaneRim& rim, std::optional<int> resolution, Work& work, Attempt& result) {
  Attempt few = result;
  few.surface = few.field;
  few.second.reset();
  if (few.met || !refine(rim, edges_in_layouts, few) || !second_alone(disc, rim, work, few)) return false;
  few.surface = through_vertices(few.made.uv, few.made.points, disc.rim, rim.edge);
  if (!few.surface) return false;
  few.few = true;
  if (!refine(rim, resolution, few) || !serves(rim, few)) return false;
  result = std::move(few);
  return true;
}

}  // namespace tripatch
