#include "tripatch/spline/plane_fill.h"

#include <algorithm>
#include <array>

#include "tripatch/math/thresholds.h"
#include "tripatch/report/crossings.h"
#include "tripatch/spline/averaged_models.h"
#include "tripatch/spline/coarser_rim.h"
#include "tripatch/spline/completed_fill.h"
#include "tripatch/spline/mended_attempt.h"

namespace tripatch {
namespace {

/// Vertices of a fill times those of its rim: where there are more, fewer triangles are bent by themselves, of which each try takes 0.2 s there.
constexpr Index max_bent = count::million;
/// Of the rim's diameter: half of its edges are longer, or none of what follows is tried. In a ball, a torus and a flat grid with vertices
/// pulled far out of the rim surfaces were laid out down to 5e-10 and none from 1e-10 on, after up to seven seconds.
constexpr double min_edge = 2e-10;

/// Triangles without a surface: the rim's own, or those that join its edges to its middle. The latter are used if only they leave
/// no fold between them and no crossing, and do not fold more over the faces beyond. They are also used if they fold less where
/// the rim's own cross.
PlaneFill plain(const PlaneRim& rim, bool are_first) {
  PlaneFill fill;
  fill.triangles = rim.rough;
  fill.folds = rim.own_folds;
  fill.rim_folds = rim.own_folds + static_cast<Index>(rim.flipped.size());
  fill.doubles_edges = rim.doubles_edges;
  const bool crossed = crosses_itself(rim.points, rim.rough);
  const bool serves = (are_first || fill.folds == 0) && count_folded_edges(rim.points, rim.rough, {}) == 0 && !crossed;
  if (serves || !rim.surroundings.islands.empty()) return fill;
  const Index r = rim.points.rows();
  Points points(r + 1, 3);
  points << rim.points, rim.points.colwise().mean();
  Triangles fan;
  for (Index k = 0; k < r; ++k) fan.push_back({k, (k + 1) % r, r});
  const Index folds = count_folded_edges(points, fan, rim.beyond);
  if (count_folded_edges(points, fan, {}) > 0 || crosses_itself(points, fan) || (folds > fill.folds && !crossed)) return fill;
  fill.vertices = points.bottomRows(1);
  fill.folds = folds;
  fill.triangles = std::move(fan);
  fill.doubles_edges = false;
  return fill;
}

/// The rim and the new vertices of a plain fill.
Points points_of(const PlaneRim& rim, const PlaneFill& fill) {
  Points points(rim.points.rows() + fill.vertices.rows(), 3);
  points << rim.points, fill.vertices;
  return points;
}

/// Of a rim alone: least bending and two that are smoother. On faces between walls, planes to saddles, the mixture that the likelihood makes
/// of them is 2 to 20 times nearer than least bending.
const std::vector<double> of_rim_alone = {2, 2.5, 3.5};

/// A way to fill, the likeliest first.
struct Way {
  double reach;
  int rings;
  std::vector<double> orders;
  std::optional<Message> why;
};

/// Of the ways the likeliest that will do, else `best`, the plain triangles. work: is added to; once it is spent, no other way is tried.
PlaneFill likeliest(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops,
                    const PlaneFillOptions& options, const PlaneRim& rim, Work& work, PlaneFill best) {
  const std::array<Way, 4> ways = {
      Way{reach_share, rings_followed, FieldOptions().orders, {}}, Way{0, 2, {2, 3}, Message{Code::two_rings_followed}},
      Way{0, 1, {2}, Message{Code::one_ring_followed}}, Way{0, 0, of_rim_alone, Message{Code::rim_alone_followed}}};
  const Connectivity& continued = options.continued ? *options.continued : around;
  const bool finer = is_finer(rim, options);  // the surface is that of triangles like the rim's, which bend in far less time
  PlaneFillOptions coarse = options;
  if (finer) coarse.resolution.reset();
  bool is_known = false;  // whether the next way would do what was done already: several may see the rim alone
  for (const Way& way : ways) {
    if (options.only_likeliest && &way != ways.data()) break;
    if (is_known || work.is_spent() || (way.rings == 0 && best.surface)) break;
    Disc disc = disc_to_sample(mesh, continued, loops, way.reach * rim.diameter, way.rings);
    if (disc.triangles.empty() && way.rings > 0 && !options.continued) continue;
    const bool sees_rim_alone = disc.triangles.empty();
    is_known = sees_rim_alone;
    const std::vector<Index> samples = spread_samples(disc, rim.edge);
    FieldOptions fields;
    fields.orders = sees_rim_alone ? of_rim_alone : way.orders;
    fields.unit = std::max(rim.edge, tolerance::tiny);
    std::optional<Attempt> result = attempts(disc, rim, samples, fields, coarse, work);
    work.limit();
    if (!result || (result->made.doubles_edges && !rim.doubles_edges)) continue;
    if (way.reach > 0) {
      PlaneFillOptions own = coarse;
      if (result->few) own.resolution = edges_in_layouts;
      const bool farther = look_farther(mesh, continued, loops, rim, fields, own, disc, *result);
      const bool closer = look_closer(disc, rim, fields, own, *result);
      is_known = sees_rim_alone && !farther && !closer;
    }
    average_models(disc, rim, *result);
    hold_back(disc, rim, *result);
    const std::optional<Attempt> before = finer || result->few ? result : std::nullopt;
    bool is_hopeless = result->few && stays_folded(rim, *result);
    if (before && !is_hopeless && !refine(rim, options.resolution, *result)) {
      if (!result->made.unfinished) continue;
      is_hopeless = true;
      result = before;
    }
    const Index folds = count_folded_edges(result->made.points, result->made.triangles, rim.beyond);
    const Index left = unfolded(rim, *result);
    const bool is_long = disc.rim > long_rim;  // bending its thousands of triangles takes longer than all the rest
    // Where the faces beyond fold the rim itself, the triangles of the fill need not fold among themselves.
    const bool folds_inside =
        left > 0 && count_folded_edges(result->made.points, result->made.triangles, {}) > rim.folds_of_plain;
    const Index most = max_folds(rim, *result);
    const bool fails = is_hopeless || left > most || folds_inside || crosses(rim, *result);
    if (fails && options.only_likeliest) break;
    const bool prefers_second = !is_long && mostly_details(details_in(*result)) && (fails || way.reach == 0);
    bool bends_least = false;
    if (prefers_second || (fails && !is_long)) {
      Attempt alone = before ? *before : *result;
      const Disc rings = with_two_rings(mesh, continued, loops, disc);
      const bool few = alone.few || disc.rim * alone.made.points.rows() > max_bent;
      bends_least = few ? few_alone(rings, rim, options.resolution, work, alone) : second_alone(rings, rim, work, alone);
      if (bends_least && finer && !few) bends_least = refine(rim, options.resolution, alone) && serves(rim, alone);
      if (bends_least) result = std::move(alone);
    }
    if (fails && !bends_least) continue;
    if (bends_least && !prefers_second && best.surface) continue;
    PlaneFill fill = completed(*result, rim, disc);
    fill.plainer = bends_least ? Message{Code::least_bending} : way.why;
    if (!fill.plainer && left < folds) fill.plainer = Message{Code::triangles_off_surface};
    if (bends_least ? prefers_second : folds <= most) return fill;
    is_known = sees_rim_alone && way.reach == 0;  // of the first way details do not ask for least bending
    // A plainer way that need not be mended is nearer, and where there is noise alone one that need not bend least; else the plainest.
    best = std::move(fill);
  }
  return best;
}

}  // namespace

Index folds_of_rim(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops) {
  const PlaneRim rim = plane_rim(mesh, around, loops);
  const Index flipped = static_cast<Index>(rim.flipped.size());
  return count_folded_edges(rim.points, min_weight_triangulation(rim.points, rim.surroundings).triangles, rim.beyond) + flipped;
}

PlaneFill fill_over_plane(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops,
                          const PlaneFillOptions& options) {
  PlaneRim rim = plane_rim(mesh, around, loops);
  rim.through = options.through;
  rim.of_hole = options.size;
  rim.surroundings.joined.insert(rim.surroundings.joined.end(), options.joined.begin(), options.joined.end());
  const RoughFill rough = min_weight_triangulation(rim.points, rim.surroundings);
  rim.rough = rough.triangles;
  rim.folds = rim.own_folds = count_folded_edges(rim.points, rim.rough, rim.beyond);
  if (!rough.crossing.empty()) rim.folds = std::min(rim.folds, count_folded_edges(rim.points, rough.crossing, rim.beyond));
  rim.doubles_edges = rough.doubles_edges;
  PlaneFill best = plain(rim, rough.crossing.empty());
  const Points plain_points = points_of(rim, best);
  rim.folds_of_plain = count_folded_edges(plain_points, best.triangles, {});
  const bool too_short = rim.diameter > 0 && !(rim.edge > min_edge * rim.diameter);
  best.plainer = Message{too_short ? Code::tiny_edges_plain_triangles : Code::plain_triangles};
  if (!rim.through.empty()) best.plainer->parameters.push_back({"through", ""});
  if (!(rim.diameter > 0) || too_short) return best;
  if (rim.points.rows() == 3 && !options.resolution && rim.through.empty()) {
    best.plainer.reset();
    return best;
  }
  // Triangles that cross themselves may lay out what does not.
  std::optional<PlaneFill> coarse = on_coarser_rim(mesh, around, loops, options, rim);
  if (coarse && coarse->folds == 0) return std::move(*coarse);
  PlaneFill fill = best;
  Work work;
  for (const Triangles* triangles : {&rough.crossing, &rough.triangles}) {
    if (fill.surface || triangles->empty()) continue;
    rim.rough = *triangles;
    rim.area = area_of(rim.points, rim.rough);
    fill = likeliest(mesh, around, loops, options, rim, work, best);
  }
  if (coarse && (!fill.surface || coarse->folds <= fill.folds)) return std::move(*coarse);
  if (fill.surface || !crosses_itself(plain_points, best.triangles)) return fill;
  rim.may_cross = true;
  return likeliest(mesh, around, loops, options, rim, work, best);
}

}  // namespace tripatch
