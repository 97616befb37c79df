#include "tripatch/spline/coarser_rim.h"

#include <algorithm>
#include <numbers>

#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/decimated.h"
#include "tripatch/spline/completed_fill.h"
#include "tripatch/spline/field_around.h"
#include "tripatch/spline/mended_attempt.h"

namespace tripatch {
namespace {

/// Of a long rim, and its surroundings, edges shorter than so many of a circle of the hole's diameter are collapsed. Caps of a sphere
/// with rims of 500 to 5,000 edges, 45 to 80 degrees wide, are farther off with 160, and with 240 the field takes the layout's errors for
/// noise now and then. But where the surroundings are narrow so many more that there are three rows of triangles: of caps and waves with
/// rims of 4,000 edges, 40 rings of faces wide, the fills were 2 to 30 times farther off.
constexpr double edges_of_circle = count::hundreds, max_edges_of_circle = 350, min_rows = count::few;
/// Surroundings that reach less far than this share of such an edge say too little then: of those caps with 5,000 edges, of which ten of
/// them are seen, one is four times farther off than seen from above.
constexpr double min_width = share::most;
/// Of a field fitted to more: with 600 and 200 caps and waves are as far off, with 100 some are farther.
constexpr Index max_centers = count::block;

/// A hole whose rim has a part of another's vertices.
struct CoarseHole {
  Points vertices;
  Faces faces;
  std::vector<std::vector<Index>> loops;
  std::vector<Index> rows;  ///< of the loops' vertices in the rim that has them all
  std::vector<Index> kept;  ///< of all vertices the row in the disc
};

/// loops: that the disc has all the vertices of.
CoarseHole coarse_hole(const Disc& disc, const std::vector<std::vector<Index>>& loops, double length) {
  const CoarserMesh coarse = decimated(disc.points, disc.triangles, length);
  CoarseHole hole{disc.points(coarse.kept, Eigen::all), faces_of(coarse.triangles), {}, {}, coarse.kept};
  Index end = 0;
  for (const std::vector<Index>& loop : loops) {
    end += static_cast<Index>(loop.size());
    hole.loops.emplace_back();
    for (std::size_t k = hole.rows.size(); k < coarse.kept.size() && coarse.kept[k] < end; ++k) {
      hole.loops.back().push_back(static_cast<Index>(k));
      hole.rows.push_back(coarse.kept[k]);
    }
  }
  return hole;
}

/// Rows in the disc of the best spread samples among a coarse hole's vertices.
std::vector<Index> spread_samples(const Disc& disc, const CoarseHole& hole, double length, Index most) {
  Disc known;
  known.rim = static_cast<Index>(hole.rows.size());
  known.points = hole.vertices;
  for (Index row : hole.kept) known.distance.push_back(disc.distance[row]);
  std::vector<Index> rows = spread_samples(known, length, most, most);
  for (Index& row : rows) row = hole.kept[row];
  return rows;
}

/// Places of all the rim's vertices, those of some of them given: in between along each loop.
PlanePoints between_known(const PlaneRim& rim, const std::vector<Index>& known, const PlanePoints& places) {
  PlanePoints uv(rim.points.rows(), 2);
  std::vector<Index> ends = rim.surroundings.islands;
  ends.push_back(uv.rows());
  Index start = 0;
  std::size_t first = 0;
  for (Index end : ends) {
    const Index n = end - start;
    std::size_t last = first;
    while (last < known.size() && known[last] < end) ++last;
    for (std::size_t k = first; k < last; ++k) {
      const std::size_t next = k + 1 < last ? k + 1 : first;
      const Index steps = (known[next] - known[k] + n - 1) % n + 1;
      for (Index j = 0; j < steps; ++j) {
        const double t = static_cast<double>(j) / static_cast<double>(steps);
        uv.row(start + (known[k] - start + j) % n) =
            (1 - t) * places.row(static_cast<Index>(k)) + t * places.row(static_cast<Index>(next));
      }
    }
    start = end;
    first = last;
  }
  return uv;
}

/// A long rim's fill on a field found otherwise. Nothing where triangles on it will not do.
std::optional<PlaneFill> on_field(const Disc& disc, const PlaneRim& rim, const PlaneFillOptions& options,
                                  const std::shared_ptr<const PolyharmonicSpline>& field, const PlanePoints& rim_uv,
                                  double fed_back) {
  Attempt result;
  result.surface = result.field = field;
  result.fed_back = fed_back;
  result.rim_uv = rim_uv;
  const PlanePolygon polygon = polygon_of(rim, result.rim_uv);
  if (polygon.triangles.empty()) return {};
  result.made = remesh(polygon, options.resolution, *result.surface);
  if (!result.made.points.allFinite() || !stays_near(result.made.points, rim)) return {};
  if (result.made.doubles_edges && !rim.doubles_edges) return {};
  result.on_field = result.made.points;
  const Index folds = count_folded_edges(result.made.points, result.made.triangles, rim.beyond), left = unfolded(rim, result);
  if (left > max_folds(rim, result) || crosses(rim, result)) return {};
  PlaneFill fill = completed(result, rim, disc);
  if (left < folds) fill.plainer = Message{Code::triangles_off_surface};
  return fill;
}

}  // namespace

std::optional<PlaneFill> on_coarser_rim(const Mesh& mesh, const Connectivity& around,
                                        const std::vector<std::vector<Index>>& loops, const PlaneFillOptions& options,
                                        const PlaneRim& rim) {
  const Index r = rim.points.rows();
  if (r <= long_rim || options.continued || !options.through.empty() || options.planes.rows() > 0) return {};
  const Disc disc = disc_around(mesh, around, loops, reach_share * rim.diameter, static_cast<int>(r), max_triangles_around(r));
  if (disc.rim != r) return {};  // the rim touches itself
  const double width = *std::max_element(disc.distance.begin(), disc.distance.end());
  const double circle = std::numbers::pi * rim.diameter, longest = circle / edges_of_circle;
  if (!(width > min_width * longest)) return {};
  double length = std::clamp(width / min_rows, circle / max_edges_of_circle, longest);
  const auto is_long = [](const CoarseHole& each) { return static_cast<Index>(each.rows.size()) > long_rim; };
  CoarseHole hole = coarse_hole(disc, loops, length);
  if (is_long(hole)) hole = coarse_hole(disc, loops, length = longest);
  if (is_long(hole)) return {};
  const Mesh coarse{hole.vertices, hole.faces};
  PlaneFillOptions own;
  own.only_likeliest = true;  // what is plainer is not used
  const PlaneFill from = fill_over_plane(coarse, Connectivity(coarse), hole.loops, own);
  if (!from.field || from.plainer) return {};
  const PlanePoints rim_uv = closest_points(*from.surface, rim.points, between_known(rim, hole.rows, from.rim_uv));
  const bool is_met = from.field->noise() < tolerance::slight * length;
  const std::vector<Index> centers = spread_samples(disc, hole, length, is_met ? max_samples : max_centers);
  const std::vector<Index> rows = is_met ? centers : fitted_rows(disc, centers);
  const PlanePoints places = places_on(*from.surface, rim_uv, disc, rows);
  std::optional<PlaneFill> fill;
  if (const auto field = field_through(disc.points(rows, Eigen::all), places, static_cast<Index>(centers.size()), rim.edge))
    fill = on_field(disc, rim, options, field, rim_uv, from.fed_back);
  if (fill && !fill->plainer) return fill;
  std::optional<PlaneFill> other = on_field(disc, rim, options, from.field, rim_uv, from.fed_back);
  return other && (!fill || !other->plainer) ? other : fill;
}

}  // namespace tripatch
