#include "tripatch/spline/plane_attempt.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/parametrization/parametrization.h"
#include "tripatch/report/crossings.h"
#include "tripatch/spline/base_surface.h"
#include "tripatch/triangulation/plane_triangles.h"

namespace tripatch {
namespace {

/// Where the fill's area exceeds that of the rough one by this factor the layout is repeated with the fill in it. Of 84 holes of scanned and
/// modelled meshes 7 are, and without it all are 2.3% farther in the mean; always repeated, 1.2%.
constexpr double strongly_curved = share::little + 1;
/// Layouts, at most: none of those 84 holes asks for more; of 72 others (reference.cpp) with two of them two are 17% farther.
constexpr int layouts = 3;
/// More samples than of a rim where a strongly curved surface has no noise: there more of them tell more. 30 fills in ellipsoids and balls,
/// 50 degrees to half of them, are half as far off with 200, 300 or 450, those of half an ellipsoid 0.54, 0.52 and 0.39 times, and take 1.4
/// to 1.6 times as long.
constexpr Index more_where_clear = 450;
/// Energy of a layout, 4 where nothing is deformed, from which on it is none. Of 1,658 layouts of random holes in even, bumpy and noisy meshes the
/// worst has 35, of 155 of known surfaces and scanned meshes 14. In meshes stretched by up to 1000 one of six has more, up to 1e9: fills over it
/// fold or are as far off as those of the next way, and where forty steps from there end rounding chooses.
constexpr double max_deformed = factor::extreme;
/// The layout of a strongly curved hole is that of its fill: what the fill errs, the layout errs, and with it the next fill. Where a
/// layout changes the area by this share of what the one before changed it, errors add up to 1 / (1 - share) of themselves; of more
/// than this share it is not believed.
constexpr double max_fed_back = share::most;
/// Cosine, of what surrounds long rims that are seen from above.
constexpr double max_leaning = share::half;
/// Fills of shorter rims with more triangles than this, as none in a flat round hole has, have so few in layouts too: where the field runs
/// away they are many, and take seconds to lay out and to bend.
constexpr std::size_t max_in_layouts = count::linear;
/// Degrees of the reference. Of known surfaces with no noise, holes to half a ball: with degree 4 foot points are smooth enough that
/// the field's distance from the truth falls to a hundredth of that over the layout. Higher degrees follow the layout's noise, and
/// noise of 2% of an edge. Scanned and modelled meshes have details: around 250 holes of them degree 6 is 5% nearer, 7 no more.
constexpr int stiff_degree = 4;
constexpr int free_degree = 6;
/// Where there are details, samples are foot points on references through those foot points again, of these degrees: the layout's errors
/// go. Of 216 holes in 25 scanned and modelled meshes they leave fills 3% nearer; 6 alone 1%, and two rings are too few for either. Not with
/// the fill in the layout: half a ball under noise is twice as far off with them. Nor of long rims and strips, which are strongly curved.
constexpr std::array<int, 3> further_degrees = {6, 6, 5};
constexpr int rings_for_further = count::few;
/// Where the noise is this share of an edge, or more, the fill is not known well enough to be worth it (as in field.cpp).
constexpr double too_rough = 0.03;
/// Where there is noise of this share of an edge or more on a surface without details, twice as far is nearer by a tenth: without noise
/// there is nothing to average, and beyond details the surface is another.
constexpr double min_noise = noise::some, noisy_reach_share = farthest_reach;

/// The surface at the middles of some triangles and of their edges: a look at it before it is triangulated.
Points looked_at(const PolyharmonicSpline& field, const PlanePoints& uv, const Triangles& triangles) {
  Points rows = Points::Zero(4 * static_cast<Index>(triangles.size()), 3);
  Index row = 0;
  for (const std::array<Index, 3>& t : triangles) {
    rows.row(row++).head<2>() = (uv.row(t[0]) + uv.row(t[1]) + uv.row(t[2])) / 3;
    for (int k = 0; k < 3; ++k) rows.row(row++).head<2>() = (uv.row(t[k]) + uv.row(t[(k + 1) % 3])) / 2;
  }
  return field.positions(rows);
}

/// Coordinates across the mean normal, where no triangle of the surroundings leans too much against it.
std::optional<PlanePoints> seen_from_above(const Disc& disc, const PlaneRim& rim) {
  Vec3 mean = Vec3::Zero();
  for (const std::array<Index, 3>& t : disc.triangles) mean += triangle_normal(disc.points, t);
  const Vec3 up = mean.stableNormalized();
  for (const std::array<Index, 3>& t : disc.triangles) {
    const Vec3 n = triangle_normal(disc.points, t);
    if (!(n.dot(up) >= max_leaning * n.norm())) return {};
  }
  const Vec3 u = up.unitOrthogonal(), v = up.cross(u), origin = disc.points.colwise().mean();
  PlanePoints uv(disc.points.rows(), 2);
  for (Index k = 0; k < uv.rows(); ++k) {
    const Vec3 x = Vec3(disc.points.row(k)) - origin;
    uv.row(k) << x.dot(u), x.dot(v);
  }
  if (domain_triangles(uv.topRows(disc.rim), rim).empty()) return {};
  return uv;
}

/// The disc's points in the plane, laid out with the hole as it is filled so far.
std::optional<PlanePoints> laid_out(const Disc& disc, const PlaneRim& rim, const Attempt* before) {
  const Index n = disc.points.rows();
  Points points = disc.points;
  Triangles triangles = before ? Triangles() : rim.rough;
  if (before) {
    const Index added = before->made.points.rows() - disc.rim;
    points.conservativeResize(n + added, 3);
    points.bottomRows(added) = before->made.points.bottomRows(added);
    for (std::array<Index, 3> t : before->made.triangles) {
      for (Index& v : t)
        if (v >= disc.rim) v += n - disc.rim;
      triangles.push_back(t);
    }
  }
  triangles.insert(triangles.end(), disc.triangles.begin(), disc.triangles.end());
  PlaneLayoutOptions options;
  options.tolerance = tolerance::slight;
  const std::optional<Parametrization> layout = parametrize(points, triangles, options);
  if (!layout || layout->energies.back() > max_deformed) return {};
  return PlanePoints(layout->uv.topRows(n));
}

/// The surface through points inside, where it comes nearest to them.
void meet(const std::vector<Through>& through, const Points& planes, const PlanePolygon& polygon, Attempt& result) {
  result.met_uv = nearest_places(*result.field, polygon.uv, polygon.triangles, through);
  result.met = std::make_shared<HermiteCorrection>(*result.field, result.rim_uv, result.met_uv, through, planes);
  result.surface = sum(result.field, result.met);
}

/// As fine as is asked for, or of few triangles where these would be too many.
void triangulate(const PlanePolygon& polygon, const PlaneRim& rim, const PlaneFillOptions& options, Attempt& result) {
  MostTriangles most;
  if (!options.resolution) most.count = max_in_layouts;
  result.made = triangulated(polygon, rim.through, options.resolution, result, most);
  result.few = result.made.unfinished;
  if (result.few) result.made = triangulated(polygon, rim.through, edges_in_layouts, result);
  result.on_field = result.made.points;
}

/// Places in the plane of the samples and of the rim.
struct Places {
  PlanePoints samples, rim;
  bool finite() const { return samples.allFinite() && rim.allFinite(); }
};

/// sampled: the samples begin with the rim, all of it.
Places on_reference(const BaseSurface& reference, const Places& places, const Points& samples, const Points& rim, bool sampled) {
  PlanePoints feet = reference.foot_points(places.samples, samples);
  PlanePoints of_rim = sampled ? PlanePoints(feet.topRows(rim.rows())) : reference.foot_points(places.rim, rim);
  return {std::move(feet), std::move(of_rim)};
}

/// The places laid out, their feet on a reference, and those on further ones, of which the last that will do are taken.
std::vector<Places> places_to_try(const Disc& disc, const BaseSurface& reference, const Places& laid, const Points& samples,
                                  bool further) {
  const Points rim = disc.points.topRows(disc.rim);
  const bool sampled =
      samples.rows() >= disc.rim && samples.topRows(disc.rim) == rim && laid.samples.topRows(disc.rim) == laid.rim;
  std::vector<Places> places = {laid, on_reference(reference, laid, samples, rim, sampled)};
  if (!further || !places.back().finite()) return places;
  Places feet = places.back();
  for (int degree : further_degrees)
    if (feet.finite()) feet = on_reference(BaseSurface(feet.samples, samples, degree), feet, samples, rim, sampled);
  places.push_back(std::move(feet));
  return places;
}

bool takes_further(const Disc& disc, const PlaneRim& rim) {
  return disc.rings >= rings_for_further && disc.rim <= long_rim && rim.surroundings.islands.empty();
}

/// max_left: nothing is fitted where the reference leaves more.
std::optional<Attempt> attempt(const Disc& disc, const PlaneRim& rim, const std::vector<Index>& samples,
                               const FieldOptions& fields, const PlaneFillOptions& options, const Attempt* before,
                               double max_left = std::numeric_limits<double>::infinity()) {
  std::optional<PlanePoints> uv;
  if (disc.rim > long_rim) uv = seen_from_above(disc, rim);
  const bool from_above = uv.has_value();
  if (!uv) uv = laid_out(disc, rim, before);
  if (!uv) return {};
  const PlanePoints places_laid = with_points_on_edges(disc, *uv);
  std::vector<Index> known;
  for (Index k : samples)
    if (places_laid.row(k).allFinite()) known.push_back(k);
  if (known.size() < 4 || !uv->topRows(disc.rim).allFinite()) return {};
  const Points at = with_points_on_edges(disc, disc.points)(known, Eigen::all);
  const PlanePoints laid = places_laid(known, Eigen::all);
  // The stiffest polynomial that the samples allow: where the freer one leaves out details of the mesh they pull the stiff one about.
  const BaseSurface free(laid, at, free_degree);
  const bool details = free.distance_across() > detail * rim.edge;
  const BaseSurface reference = details ? free : BaseSurface(laid, at, stiff_degree);
  if (!(reference.distance_across() < max_left)) return {};
  std::vector<Places> places = {{laid, uv->topRows(disc.rim)}};
  if (!from_above)  // that is as smooth as the surface already
    places = places_to_try(disc, reference, places[0], at, details && !before && takes_further(disc, rim));
  for (; !places.empty(); places.pop_back()) {
    Attempt result;
    result.from_above = from_above;
    result.left_by_reference = reference.distance_across();
    result.rim_uv = places.back().rim;
    PlanePolygon polygon = polygon_of(rim, result.rim_uv);
    if (polygon.triangles.empty() || !places.back().finite()) continue;
    try {
      result.surface = result.field = std::make_shared<PolyharmonicSpline>(places.back().samples, at, fields);
    } catch (const InvalidArgument&) {  // places on a line, as of a slit whose two edges lie on each other
      continue;
    }
    if (!stays_near(looked_at(*result.field, result.rim_uv, polygon.triangles), rim)) {
      if (places.size() > 2) continue;
      return {};
    }
    if (!rim.through.empty() || options.planes.rows() > 0) meet(rim.through, options.planes, polygon, result);
    triangulate(polygon, rim, options, result);
    if (result.made.points.allFinite()) return result;
  }
  return {};
}

/// By the change of the area, and the change before it.
double fed_back(double before, double now, double change) {
  return std::min(std::abs(now - before) / std::max(std::abs(change), tolerance::tiny), max_fed_back);
}

}  // namespace

double details_in(const Attempt& result) { return share_of_details(result.field->noise(), result.left_by_reference); }

Index max_folds(const PlaneRim& rim, const Attempt& result) {
  if (rim.flipped.empty()) return rim.folds;
  const Points& points = result.made.points;
  const Triangles& triangles = result.made.triangles;
  const Index over_turned = count_folded_edges(points, triangles, rim.flipped) - count_folded_edges(points, triangles, {});
  return rim.folds + static_cast<Index>(rim.flipped.size()) - over_turned;
}

bool crosses(const PlaneRim& rim, const Attempt& result) {
  return !rim.may_cross && crosses_itself(result.made.points, result.made.triangles);
}

PlaneTriangulation triangulated(PlanePolygon polygon, const std::vector<Through>& through, std::optional<int> resolution,
                                const Attempt& result, const MostTriangles& most) {
  bool inside = true;
  for (std::size_t k = 0; k < through.size(); ++k)
    inside = inside && insert_row(polygon, result.met_uv.row(static_cast<Index>(k)), through[k].point);
  if (inside && (!result.met || all_positive(polygon.uv, polygon.triangles)))
    return remesh(polygon, resolution, *result.surface, most);
  PlaneTriangulation none;
  none.points = Points::Constant(1, 3, std::numeric_limits<double>::quiet_NaN());
  return none;
}

std::optional<Attempt> attempts(const Disc& disc, const PlaneRim& rim, const std::vector<Index>& samples,
                                const FieldOptions& fields, const PlaneFillOptions& options, Work& work) {
  std::optional<Attempt> result;
  double area = rim.area, change = 0;
  const bool is_long = disc.rim > long_rim && !options.resolution;
  PlaneFillOptions in_layouts = options;
  if (is_long) in_layouts.resolution = edges_in_layouts;
  for (int round = 0; round < layouts; ++round) {
    std::optional<Attempt> next = attempt(disc, rim, samples, fields, in_layouts, result ? &*result : nullptr);
    work.add(disc.points.rows() + (next ? next->made.points.rows() : 0));
    if (!next || !stays_near(next->made.points, rim)) break;
    if (next->few && next->made.doubles_edges && !rim.doubles_edges) break;
    if (next->few) in_layouts.resolution = edges_in_layouts;
    next->few = in_layouts.resolution != options.resolution;
    const double now = area_of(next->made.points, next->made.triangles);
    const bool as_good_as_it_gets = next->from_above || (!is_long && next->field->noise() > too_rough * rim.edge);
    const bool same_area = now < strongly_curved * area && area < strongly_curved * now;
    const bool settled = as_good_as_it_gets || (same_area && !(is_long && round == 0));
    if (!next->from_above && (!same_area || round > 0)) next->fed_back = fed_back(area, now, round > 0 ? change : now);
    result = std::move(next);
    change = now - area;
    area = now;
    if (settled) break;
  }
  return result;
}

bool look_farther(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops, const PlaneRim& rim,
                  const FieldOptions& fields, const PlaneFillOptions& options, Disc& disc, Attempt& result) {
  const auto between = [&](double low, double x, double high) { return low * rim.edge < x && x < high * rim.edge; };
  if (!between(min_noise, result.field->noise(), too_rough) || !between(-1, result.left_by_reference, detail)) return false;
  Disc wide = disc_to_sample(mesh, around, loops, noisy_reach_share * rim.diameter, rings_followed);
  if (wide.rings <= disc.rings) return false;
  std::optional<Attempt> next = attempt(wide, rim, spread_samples(wide, rim.edge), fields, options, &result, detail * rim.edge);
  if (!next || !stays_near(next->made.points, rim)) return false;
  next->fed_back = result.fed_back;
  next->few |= result.few;
  result = std::move(*next);
  disc = std::move(wide);
  return true;
}

bool look_closer(const Disc& disc, const PlaneRim& rim, const FieldOptions& fields, const PlaneFillOptions& options,
                 Attempt& result) {
  if (result.fed_back == 0 || disc.rim > long_rim || result.met) return false;
  if (!(result.field->noise() < min_noise * rim.edge)) return false;
  const auto folds = [&](const Attempt& each) { return count_folded_edges(each.made.points, each.made.triangles, rim.beyond); };
  std::optional<Attempt> next = attempt(disc, rim, spread_samples(disc, rim.edge, more_where_clear), fields, options, &result);
  if (!next || !stays_near(next->made.points, rim) || folds(*next) > folds(result)) return false;
  next->fed_back = result.fed_back;
  next->few |= result.few;
  result = std::move(*next);
  return true;
}

}  // namespace tripatch
