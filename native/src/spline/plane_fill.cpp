#include "tripatch/spline/plane_fill.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/decimated.h"
#include "tripatch/mesh/triangles.h"
#include "tripatch/messages.h"
#include "tripatch/output/domain_mesh.h"
#include "tripatch/output/remesh.h"
#include "tripatch/parametrization/parametrization.h"
#include "tripatch/report/crossings.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/base_surface.h"
#include "tripatch/spline/disc.h"
#include "tripatch/spline/field_around.h"
#include "tripatch/spline/hermite_correction.h"
#include "tripatch/spline/minimize_bending.h"
#include "tripatch/spline/untangle.h"
#include "tripatch/triangulation/min_weight_triangulation.h"
#include "tripatch/triangulation/plane_triangles.h"

namespace tripatch {
namespace {

/// Surroundings as far as this share of the hole's diameter: with 0.5 the fills of scanned and modelled meshes are no nearer, and cost
/// more.
constexpr double reach_share = 0.25;
constexpr int max_rings = 40;
/// Where there is noise of this share of an edge or more on a surface without details, twice as far is nearer by a tenth: without noise
/// there is nothing to average, and beyond details the surface is another.
constexpr double min_noise = 0.003, noisy_reach_share = farthest_reach;
/// Samples of the field: so many and the rim's. The time grows with their cube; with 240 at least the distances of 220 holes from
/// what was there are within 2% of those with 160, but for known surfaces without noise, where they are a hundredth of a baseline's.
constexpr Index min_samples = 160, max_samples = 600;
constexpr Index more_than_rim = 100;
/// Relative, of squared distances over others: samples that are as far from those taken are taken in their order. More than a tie: a million
/// sizes from the origin distances across a mesh that is stretched by 1000 are rounded by 1e-7 of themselves.
constexpr double as_far = 1e-5;
/// The same where a strongly curved surface has no noise: there more of them tell more. 30 fills in ellipsoids and balls, 50 degrees to half
/// of them, are half as far off with 200, 300 or 450, those of half an ellipsoid 0.54, 0.52 and 0.39 times, and take 1.4 to 1.6 times as long.
constexpr Index more_where_clear = 450;
/// Where the fill's area exceeds that of the rough one by this factor the layout is repeated with the fill in it. Of 84 holes of scanned and
/// modelled meshes 7 are, and without it all are 2.3% farther in the mean; always repeated, 1.2%.
constexpr double strongly_curved = 1.05;
/// Layouts, at most: none of those 84 holes asks for more; of 72 others (reference.cpp) with two of them two are 17% farther.
constexpr int layouts = 3;
/// Where the noise is this share of an edge, or more, the fill is not known well enough to be worth it (as in field.cpp).
constexpr double too_rough = 0.03;
/// Of a step's share of the layout's energy: foot points do not see the rest. Twice and half of it move 84 fills by less than 0.5%.
constexpr double layout_tolerance = 1e-3;
/// Energy of a layout, 4 where nothing is deformed, from which on it is none. Of 1,658 layouts of random holes in even, bumpy and noisy meshes the
/// worst has 35, of 155 of known surfaces and scanned meshes 14. In meshes stretched by up to 1000 one of six has more, up to 1e9: fills over it
/// fold or are as far off as those of the next way, and where forty steps from there end rounding chooses.
constexpr double max_deformed = 100;
/// The layout of a strongly curved hole is that of its fill: what the fill errs, the layout errs, and with it the next fill. Where a
/// layout changes the area by this share of what the one before changed it, errors add up to 1 / (1 - share) of themselves; of more
/// than this share it is not believed.
constexpr double max_fed_back = 0.75;
/// Cosine, of what surrounds long rims that are seen from above.
constexpr double max_leaning = 0.5;
/// Where they are not, the fill in their layouts has a third of the rim in so many edges inside: its triangles would be ten times those
/// of the rings. Of six caps of a sphere, 60 degrees, rims of 600 to 1,050 edges that are jagged by 0.01 and 0.02, with 10, 40 and 200
/// five are as far off, one with 10 half as far; with 200 it takes twice as long.
constexpr int edges_in_layouts = 20;
/// The same of shorter rims' fills with more triangles than this, as none in a flat round hole has: where the field runs away they are many,
/// and take seconds to lay out and to bend.
constexpr std::size_t max_in_layouts = 30'000;
/// Of the area of few triangles, and of how many fine ones that asks for: a field whose fine ones have more of both folds between the few.
/// Of 18 fills of rims of 220 to 370 edges those that served had 1.00 to 1.02 times the area and 0.6 to 1.4 times the triangles; seven
/// that folded avoidably had 1.6 to 40 and 2.9 to 6.
constexpr double more_area = 1.4, more_triangles = 2;
/// Vertices of a fill times those of its rim: where there are more, fewer triangles are bent by themselves, of which each try takes 0.2 s there.
constexpr Index max_bent = 1'000'000;
/// Degrees of the reference. Of known surfaces with no noise, holes to half a ball: with degree 4 foot points are smooth enough that
/// the field's distance from the truth falls to a hundredth of that over the layout. Higher degrees follow the layout's noise, and
/// noise of 2% of an edge. Scanned and modelled meshes have details: around 250 holes of them degree 6 is 5% nearer, 7 no more.
constexpr int stiff_degree = 4;
constexpr int free_degree = 6;
/// Details: what a polynomial of the higher degree leaves, over an edge. With twice as much 84 holes are 0.7% farther, with half 0.8% nearer.
constexpr double detail = 0.05;
/// Where there are details, samples are foot points on references through those foot points again, of these degrees: the layout's errors
/// go. Of 216 holes in 25 scanned and modelled meshes they leave fills 3% nearer; 6 alone 1%, and two rings are too few for either. Not with
/// the fill in the layout: half a ball under noise is twice as far off with them. Nor of long rims and strips, which are strongly curved.
constexpr std::array<int, 3> further_degrees = {6, 6, 5};
constexpr int rings_for_further = 3;
/// Below this share of the second model it is not worth its time: half and twice of it change 8 of 84 fills, all together by less than 1%.
constexpr double min_share_of_second = 0.1;
/// A field that somewhere is this many diameters of the hole from the triangles that bend least, though there are details that no polynomial
/// explains, has overshot, as at the end of a fillet: between the bevels of cylinders it made funnels. Not one whose noise is this share
/// of an edge: that knows little and runs nowhere. Of 500 holes in 25 meshes made by Blender's tools, and the same cut into triangles, 8
/// are so far off; the triangles that bend least are 2.5 to 16 times nearer on three of them and a third farther at worst. From 0.13
/// on it is the same; with all noises some are 4 times farther.
constexpr double far_from_least_bent = 0.2, little_noise = 0.15;
/// The field that carries the difference over all of the hole: its order, and of how many points at most it is made; of half as many
/// 7 of 84 fills change, by 0.1% together.
constexpr double order_of_difference = 2.5;
constexpr Index points_of_difference = 240;
/// Places at the rim where the slope's deviation is looked at: it is a mean over them, which is only told.
constexpr Index slopes = 24;
/// Farther from the rim than this share of the hole's diameter a fill has left its neighborhood. A bound for what runs away: between half
/// and twice of it not one of 84 fills changes.
constexpr double farthest = 1.0;
/// Of the rim's diameter: half of its edges are longer, or none of what follows is tried. In a ball, a torus and a flat grid with vertices
/// pulled far out of the rim surfaces were laid out down to 5e-10 and none from 1e-10 on, after up to seven seconds.
constexpr double min_edge = 2e-10;

/// The rim as it is, and what is known next to it.
struct Rim {
  Points points;
  Triangles rough;
  Triangles rough_faces;
  RimSurroundings surroundings;
  std::vector<AdjacentFace> beyond;
  std::vector<Through> through;  // what shall be met inside
  Index folds = 0;               // so many a fill may have
  Index own_folds = 0;           // of its own triangles, which do not cross themselves: those of triangles that do may be fewer
  std::vector<AdjacentFace> flipped;  // those beyond that nothing folds over, as they are
  Index folds_of_plain = 0;           // between the triangles of plain() alone, not over the faces beyond
  bool doubles_edges = false;         // of the mesh, which the rough triangles do
  bool may_cross = false;             // its fill itself, for plain() does too
  double edge = 0, diameter = 0, area = 0;
  double of_hole = 0;  // the diameter of the hole that this is the rim of a part of, or less
};

Vec3 normal_of(const Points& p, const std::array<Index, 3>& t) {
  const Vec3 a = p.row(t[0]), b = p.row(t[1]), c = p.row(t[2]);
  return (b - a).cross(c - a);
}

double area_of(const Points& p, const Triangles& triangles) {
  double area = 0;
  for (const std::array<Index, 3>& t : triangles) area += 0.5 * normal_of(p, t).norm();
  return area;
}

Index folded_edges(const Points& p, const Triangles& triangles, std::span<const AdjacentFace> beyond) {
  return count_folded_edges(p, Points(0, 3), faces_of(triangles), beyond);
}

Rim rim_of(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops) {
  Rim rim;
  std::vector<Index> vertices;
  std::vector<double> lengths;
  std::vector<std::array<Index, 2>> row;  // (vertex, row), sorted
  for (const std::vector<Index>& loop : loops) {
    if (!vertices.empty()) rim.surroundings.islands.push_back(static_cast<Index>(vertices.size()));
    vertices.insert(vertices.end(), loop.begin(), loop.end());
  }
  const Index r = static_cast<Index>(vertices.size());
  rim.points.resize(r, 3);
  rim.surroundings.normals = Points::Zero(r, 3);
  for (Index k = 0; k < r; ++k) {
    rim.points.row(k) = mesh.vertices.row(vertices[k]);
    row.push_back({vertices[k], k});
  }
  std::sort(row.begin(), row.end());
  rim.beyond = faces_beyond_rows(mesh, around, loops);
  const std::vector<char> turned = flipped(mesh, around, loops);
  Index k = 0;
  for (const std::vector<Index>& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i, ++k) {
      rim.surroundings.normals.row(k) = rim.beyond[k].normal;
      if (turned[k]) {  // a fill that continues as the others do cannot but fold there
        rim.flipped.push_back(rim.beyond[k]);
        rim.beyond[k].normal.setZero();
      }
      const Index a = loop[i], b = loop[(i + 1) % loop.size()];
      lengths.push_back((mesh.vertices.row(a) - mesh.vertices.row(b)).norm());
      for (Connectivity::Corner c : around.at(a))
        for (Index other : {around.next(c), around.previous(c)}) {
          const auto found = std::lower_bound(row.begin(), row.end(), std::array<Index, 2>{other, -1});
          if (found != row.end() && (*found)[0] == other && k < (*found)[1]) rim.surroundings.joined.push_back({k, (*found)[1]});
        }
    }
  std::sort(rim.surroundings.joined.begin(), rim.surroundings.joined.end());
  rim.surroundings.joined.erase(std::unique(rim.surroundings.joined.begin(), rim.surroundings.joined.end()),
                                rim.surroundings.joined.end());
  std::nth_element(lengths.begin(), lengths.begin() + r / 2, lengths.end());
  rim.edge = lengths[r / 2];
  rim.diameter = diameter(rim.points);
  return rim;
}

/// Distances of a disc's vertices from the rim, and of its points on edges.
Eigen::VectorXd distances(const Disc& disc) {
  return with_points_on_edges(disc, Eigen::VectorXd(Eigen::VectorXd::Map(disc.distance.data(), disc.points.rows())));
}

/// The best spread samples, rows of the disc's vertices and of the points on its edges: all of the rim if there are not too many, then
/// always the one that is farthest from those taken, over its own distance from the rim. Were that in edges where the rim has more of them
/// than samples, all others would be of the rim too, and the slope next to it unseen. In an order of which every k-th is spread over all.
std::vector<Index> spread_samples(const Disc& disc, double edge, Index more = more_than_rim, Index most = max_samples) {
  const Points points = with_points_on_edges(disc, disc.points);
  const Eigen::VectorXd distance = distances(disc);
  const Index n = points.rows();
  const Index wanted = std::min(n, std::clamp(disc.rim + more, min_samples, most));
  std::vector<Index> taken;
  const Index of_rim = std::min(disc.rim, wanted / 2);
  for (Index k = 0; k < of_rim; ++k) taken.push_back(k * disc.rim / of_rim);
  const double none = -1;
  const bool leaves_no_others = disc.rim + more_than_rim > max_samples;
  const double spacing = leaves_no_others ? edge * static_cast<double>(disc.rim) / static_cast<double>(of_rim) : edge;
  const Eigen::ArrayXd far = (distance.array() + spacing).square();
  const Eigen::ArrayX3d at = points.array();
  Eigen::ArrayXd gap = Eigen::ArrayXd::Constant(n, std::numeric_limits<double>::infinity());  // squared; none where it is taken
  for (Index k : taken) gap[k] = none;
  for (std::size_t done = 0; std::cmp_less(taken.size(), wanted);) {
    for (; done < taken.size(); ++done) {
      const auto point = points.row(taken[done]);
      gap = gap.min((at.col(0) - point[0]).square() + (at.col(1) - point[1]).square() + (at.col(2) - point[2]).square());
    }
    const Eigen::ArrayXd value = gap / far;
    Index best = -1;
    double most = none;
    for (Index k = 0; k < n; ++k)
      if (gap[k] != none && value[k] > most + as_far * std::abs(most)) most = value[k], best = k;
    if (best < 0) break;
    taken.push_back(best);
    gap[best] = none;
  }
  return taken;
}

template <class M>
M rows_of(const M& all, const std::vector<Index>& rows) {
  M out(static_cast<Index>(rows.size()), all.cols());
  for (std::size_t k = 0; k < rows.size(); ++k) out.row(static_cast<Index>(k)) = all.row(rows[k]);
  return out;
}

/// Triangles of the rim's polygon in the plane, none turned over: the rough ones where they are that.
Triangles domain_triangles(const PlanePoints& uv, const Rim& rim) {
  return all_positive(uv, rim.rough) ? rim.rough : triangulate_polygon(uv, rim.surroundings.islands);
}

/// Whether points stay nearer to the rim, or to what shall be met, than a hole's diameter.
bool stay(const Points& points, const Rim& rim) {
  const Index r = rim.points.rows(), step = std::max<Index>(1, r / 200);
  const double most = farthest * farthest * rim.diameter * rim.diameter;
  for (Index k = 0; k < points.rows(); ++k) {
    bool near = false;
    for (Index j = 0; j < r && !near; j += step) near = (points.row(k) - rim.points.row(j)).squaredNorm() <= most;
    for (const Through& met : rim.through) near = near || (Vec3(points.row(k)) - met.point).squaredNorm() <= most;
    if (!near) return false;
  }
  return true;
}

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
std::optional<PlanePoints> seen_from_above(const Disc& disc, const Rim& rim) {
  Vec3 mean = Vec3::Zero();
  for (const std::array<Index, 3>& t : disc.triangles) mean += normal_of(disc.points, t);
  const Vec3 up = mean.stableNormalized();
  for (const std::array<Index, 3>& t : disc.triangles) {
    const Vec3 n = normal_of(disc.points, t);
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

/// One try: the surroundings laid out with what fills the hole so far, the field over them, and the hole triangulated.
struct Attempt {
  std::shared_ptr<const PolyharmonicSpline> field;
  SurfacePtr surface;  // the field, its average with a second model, or that which meets points inside
  std::shared_ptr<const HermiteCorrection> met;
  PlanePoints met_uv = PlanePoints(0, 2);
  PlanePoints rim_uv;
  PlaneTriangulation made;
  Points on_field = Points(0, 3);  // its vertices before any is moved, those of the rim where they are
  bool from_above = false;
  bool few = false;              // triangles, for the layouts: it is refined in the end
  double left_by_reference = 0;  // scene units
  std::optional<SecondModel> second;
  double share_of_second = 0;
  Eigen::VectorXd spread;  // variance of both models about their average, of each new vertex; none where there is one model
  double fed_back = 0;     // share of the fill's error that its layout hands on to it
};

/// The disc's points in the plane, laid out with the hole as it is filled so far.
std::optional<PlanePoints> laid_out(const Disc& disc, const Rim& rim, const Attempt* before) {
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
  options.tolerance = layout_tolerance;
  const std::optional<Parametrization> layout = parametrize(points, triangles, options);
  if (!layout || layout->energies.back() > max_deformed) return {};
  return PlanePoints(layout->uv.topRows(n));
}

PlanePolygon polygon_of(const Rim& rim, const PlanePoints& uv) {
  PlanePolygon polygon;
  polygon.uv = uv;
  if (uv.allFinite()) polygon.triangles = domain_triangles(uv, rim);
  polygon.points = rim.points;
  polygon.rim = rim.points.rows();
  polygon.joined = rim.surroundings.joined;
  polygon.size = rim.of_hole;
  return polygon;
}

/// The surface through points inside, where it comes nearest to them.
void meet(const std::vector<Through>& through, const Points& planes, const PlanePolygon& polygon, Attempt& result) {
  result.met_uv = nearest_places(*result.field, polygon.uv, polygon.triangles, through);
  result.met = std::make_shared<HermiteCorrection>(*result.field, result.rim_uv, result.met_uv, through, planes);
  result.surface = sum(result.field, result.met);
}

/// Triangles on the surface, with what is met inside as vertices: none of them finite where that cannot be.
PlaneTriangulation triangulated(PlanePolygon polygon, const std::vector<Through>& through, std::optional<int> resolution,
                                const Attempt& result, const MostTriangles& most = {}) {
  bool inside = true;
  for (std::size_t k = 0; k < through.size(); ++k)
    inside = inside && insert_row(polygon, result.met_uv.row(static_cast<Index>(k)), through[k].point);
  if (inside && (!result.met || all_positive(polygon.uv, polygon.triangles)))
    return remesh(polygon, resolution, *result.surface, most);
  PlaneTriangulation none;
  none.points = Points::Constant(1, 3, std::numeric_limits<double>::quiet_NaN());
  return none;
}

/// As fine as is asked for, or of few triangles where these would be too many.
void triangulate(const PlanePolygon& polygon, const Rim& rim, const PlaneFillOptions& options, Attempt& result) {
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

bool takes_further(const Disc& disc, const Rim& rim) {
  return disc.rings >= rings_for_further && disc.rim <= long_rim && rim.surroundings.islands.empty();
}

std::optional<Attempt> attempt(const Disc& disc, const Rim& rim, const std::vector<Index>& samples, const FieldOptions& fields,
                               const PlaneFillOptions& options, const Attempt* before) {
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
  const Points at = rows_of(with_points_on_edges(disc, disc.points), known);
  const PlanePoints laid = rows_of(places_laid, known);
  // The stiffest polynomial that the samples allow: where the freer one leaves out details of the mesh they pull the stiff one about.
  const BaseSurface free(laid, at, free_degree);
  const bool details = free.distance_across() > detail * rim.edge;
  const BaseSurface reference = details ? free : BaseSurface(laid, at, stiff_degree);
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
    if (!stay(looked_at(*result.field, result.rim_uv, polygon.triangles), rim)) {
      if (places.size() > 2) continue;
      return {};
    }
    if (!rim.through.empty() || options.planes.rows() > 0) meet(rim.through, options.planes, polygon, result);
    triangulate(polygon, rim, options, result);
    if (result.made.points.allFinite()) return result;
  }
  return {};
}

double details_in(const Attempt& result) { return share_of_details(result.field->noise(), result.left_by_reference); }

/// Every so many rows that they are not more than a difference is made of.
std::vector<Index> rows_of_difference(Index all) {
  std::vector<Index> rows;
  for (Index k = 0; k < all; k += (all + points_of_difference - 1) / points_of_difference) rows.push_back(k);
  return rows;
}

/// Nothing where the places lie on a line, or numbers are beyond all measure.
std::shared_ptr<const PolyharmonicSpline> field_of_difference(const PlanePoints& places, const Points& difference, double unit) {
  FieldOptions fields;
  fields.orders = {order_of_difference};
  fields.unit = std::max(unit, 1e-300);
  try {
    return std::make_shared<PolyharmonicSpline>(places, difference, fields);
  } catch (const InvalidArgument&) {
    return {};
  }
}

/// A surface through the vertices of a fill, those of its rim first: all of these, and as many inside as a field has samples.
SurfacePtr through_vertices(const PlanePoints& uv, const Points& points, Index rim, double unit) {
  const Index step = (uv.rows() - rim) / std::max<Index>(max_samples - rim, 1) + 1;
  std::vector<Index> rows(static_cast<std::size_t>(rim));
  std::iota(rows.begin(), rows.end(), Index{0});
  for (Index k = rim; k < uv.rows(); k += step) rows.push_back(k);
  return field_of_difference(rows_of(uv, rows), rows_of(points, rows), unit);
}

/// The new vertices so far between the field's and the second model's as the share says, the surface with them. False, and as it was,
/// where that leaves the rim's neighborhood.
bool take_second(const Rim& rim, const SecondModel& second, double share, Attempt& result) {
  const Index all = result.made.points.rows(), added = second.vertices.rows();
  const std::vector<Index> rows = rows_of_difference(all);
  Points other = result.made.points;
  other.bottomRows(added) = second.vertices;
  const PlanePoints places = rows_of(PlanePoints(result.made.uv), rows);
  Points known = rows_of(result.on_field, rows);
  const Index of_rim = std::ranges::lower_bound(rows, all - added) - rows.begin();
  known.topRows(of_rim) = result.field->positions(as_rows(places.topRows(of_rim)));
  const Points difference = share * (rows_of(other, rows) - known);
  const SurfacePtr change = field_of_difference(places, difference, rim.edge);
  if (!change) return false;
  Points points = result.made.points;
  points.bottomRows(added) =
      result.on_field.bottomRows(added) + change->positions(as_rows(PlanePoints(result.made.uv.bottomRows(added))));
  if (!points.allFinite() || !stay(points, rim)) return false;
  result.surface = sum(result.field, change);
  result.made.points = std::move(points);
  result.second = second;
  result.share_of_second = share;
  return true;
}

/// Folds that a fill may have: the rim's own, and one for each face that is turned over and that it does not fold over.
Index max_folds(const Rim& rim, const Attempt& result) {
  if (rim.flipped.empty()) return rim.folds;
  const Points& points = result.made.points;
  const Triangles& triangles = result.made.triangles;
  const Index over_turned = folded_edges(points, triangles, rim.flipped) - folded_edges(points, triangles, {});
  return rim.folds + static_cast<Index>(rim.flipped.size()) - over_turned;
}

/// The average with the second model where the surroundings are rough: with one that keeps the planes next to the rim, or, where that
/// folds more than the rim, with one that need not. As it was where that leaves the rim or folds more.
void average_models(const Disc& disc, const Rim& rim, Attempt& result) {
  const double share = share_of_second({result.field->noise() / std::max(rim.edge, 1e-300), result.field->roughness(),
                                        details_in(result), result.field->mean_order(), result.fed_back > 0});
  const Index r = disc.rim, added = result.made.points.rows() - r;
  if (share < min_share_of_second || added == 0 || r > long_rim || disc.triangles.empty() || result.met) return;
  const auto folds_of = [&](const Attempt& each) { return folded_edges(each.made.points, each.made.triangles, rim.beyond); };
  std::optional<Attempt> best;
  Index fewest = 0;
  for (const bool keep_planes : {true, false}) {
    const std::optional<SecondModel> second = second_model(result.made.points, result.made.triangles, disc, {2, 3}, keep_planes);
    Attempt average = result;
    if (!second || !take_second(rim, *second, share, average)) continue;
    const Index folds = folds_of(average);
    if (folds <= max_folds(rim, average)) {
      result = std::move(average);
      return;
    }
    if (best && folds >= fewest) continue;
    best = std::move(average);
    fewest = folds;
  }
  if (best && fewest <= folds_of(result)) result = std::move(*best);
}

/// Whether an attempt crosses itself where it need not.
bool crosses(const Rim& rim, const Attempt& result) {
  return !rim.may_cross && crosses_itself(result.made.points, result.made.triangles);
}

/// The triangles that bend least where the field runs far from them without a reason in the surroundings. result: tells of no points inside.
void hold_back(const Disc& disc, const Rim& rim, Attempt& result) {
  const Index r = disc.rim, added = result.made.points.rows() - r;
  if (added == 0 || r > long_rim || disc.triangles.empty() || result.met) return;
  if (!(result.left_by_reference > detail * rim.edge) || result.field->noise() > little_noise * rim.edge) return;
  const std::optional<SecondModel> least = second_model(result.made.points, result.made.triangles, disc, {2});
  if (!least) return;
  const double farthest_apart = (least->vertices - result.on_field.bottomRows(added)).rowwise().norm().maxCoeff();
  if (!(farthest_apart > far_from_least_bent * rim.diameter)) return;
  Attempt held = result;
  if (!take_second(rim, *least, 1, held)) return;
  const Index folds = folded_edges(held.made.points, held.made.triangles, rim.beyond);
  if (folds <= max_folds(rim, held) || folds <= folded_edges(result.made.points, result.made.triangles, rim.beyond))
    result = std::move(held);
}

/// Variance of both models about their average, of each new vertex.
Eigen::VectorXd spread_of_models(const Attempt& result) {
  const Index added = result.second->vertices.rows();
  const Points normals = result.surface->normals(as_rows(PlanePoints(result.made.uv.bottomRows(added))));
  const double share = std::min(result.share_of_second, max_of_second);
  const Points way = result.second->vertices - result.on_field.bottomRows(added);
  const Eigen::VectorXd between = way.cwiseProduct(normals).rowwise().sum();
  const Eigen::VectorXd apart = result.second->apart.cwiseProduct(normals).rowwise().sum();
  return share * (1 - share) * between.cwiseAbs2() + share * apart.cwiseAbs2();
}

/// Values at some places of the plane, carried to others: none below zero.
Eigen::VectorXd carried(const Eigen::VectorXd& values, const PlanePoints& places, double unit, const PlanePoints& to) {
  const std::vector<Index> rows = rows_of_difference(places.rows());
  Points known = Points::Zero(static_cast<Index>(rows.size()), 3);
  known.col(0) = rows_of(values, rows);
  const SurfacePtr field = field_of_difference(rows_of(places, rows), known, unit);
  if (!field) return Eigen::VectorXd::Constant(to.rows(), values.maxCoeff());
  return field->positions(as_rows(to)).col(0).cwiseMax(0);
}

/// Whether a resolution asks for more than twice the triangles that the rim's edges do.
bool is_finer(const Rim& rim, const PlaneFillOptions& options) {
  return options.resolution && 2 * *options.resolution > rim.points.rows() && options.through.empty() &&
         options.planes.rows() == 0;
}

/// Of triangles as fine as the rim, by the few.
MostTriangles max_triangles_on(const Attempt& few, double edge) {
  const double area = area_of(few.made.points, few.made.triangles), asked = area / (area_of_triangle * edge * edge);
  return {static_cast<std::size_t>(std::min(more_triangles * asked, 1e9)), more_area * area};
}

/// Other triangles on the same surface. False where they will not do.
bool refine(const Rim& rim, std::optional<int> resolution, Attempt& result) {
  const Index r = rim.points.rows();
  const PlanePoints places = result.made.uv;
  const MostTriangles most = result.few && !resolution ? max_triangles_on(result, rim.edge) : MostTriangles();
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(places.rows());
  if (result.second) spread.tail(places.rows() - r) = spread_of_models(result);
  result.made = triangulated(polygon_of(rim, result.rim_uv), rim.through, resolution, result, most);
  if (result.made.unfinished || !result.made.points.allFinite() || !stay(result.made.points, rim)) return false;
  result.on_field = result.made.points;
  const PlanePoints inside = result.made.uv.bottomRows(result.made.uv.rows() - r);
  if (result.second) result.spread = carried(spread, places, std::max(rim.edge, 1e-300), inside);
  result.second.reset();
  return !result.made.doubles_edges || rim.doubles_edges;
}

/// Moves vertices of folded edges, and flips edges, until none is folded, or no more than of the rim's own; returns how many are.
Index unfolded(const Rim& rim, Attempt& result) {
  const Index folds = folded_edges(result.made.points, result.made.triangles, rim.beyond);
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

/// Whether folds cannot be mended, or it crosses itself. Where few triangles on a field are so, many are: of 22 such fields of long rims all.
bool stays_folded(const Rim& rim, Attempt looked_at) {
  return unfolded(rim, looked_at) > max_folds(rim, looked_at) || crosses(rim, looked_at);
}

/// The disc, or one of the rings that the second model needs.
Disc with_two_rings(const Mesh& mesh, const Connectivity& continued, const std::vector<std::vector<Index>>& loops,
                    const Disc& disc) {
  return disc.rings < 2 ? disc_around(mesh, continued, loops, 0, 2) : disc;
}

/// Orders of a second model, and whether it keeps the planes next to the rim.
struct Bends {
  std::vector<int> orders;
  bool keep_planes = true;
};

/// Whether an attempt, its folds mended, does no more harm than its rim.
bool serves(const Rim& rim, Attempt& result) {
  return unfolded(rim, result) <= max_folds(rim, result) &&
         folded_edges(result.made.points, result.made.triangles, {}) <= rim.folds_of_plain && !crosses(rim, result);
}

/// The second model alone, if the field folds. If the noise of a mesh is a third of an edge, the field passes the vertices of the
/// rim so far off that its triangles fold back over the mesh. So may those that keep the planes next to the rim, which are noise.
/// False, and as it was, where this folds more than the rim too.
bool second_alone(const Disc& disc, const Rim& rim, Attempt& result) {
  if (disc.triangles.empty() || result.made.points.rows() == disc.rim || result.met) return false;
  std::array<std::optional<SecondModels>, 2> of_result;  // that need not keep the planes next to the rim, and that do
  for (const auto& [orders, keep_planes] : {Bends{{2, 3}}, {{2}}, {{2, 3}, false}, {{2}, false}, {{1}}}) {
    Attempt alone = result;
    std::optional<SecondModels>& models = of_result[keep_planes];
    if (!models) models.emplace(alone.made.points, alone.made.triangles, disc, keep_planes);
    std::optional<SecondModel> second = models->by(orders);
    for (int round = 0; round < 2; ++round) {  // the second by angles of triangles that do not fold
      if (round > 0) second = second_model(alone.made.points, alone.made.triangles, disc, orders, keep_planes);
      if (!second || !take_second(rim, *second, 1, alone)) break;
      if (!serves(rim, alone)) continue;
      result = std::move(alone);
      return true;
    }
  }
  return false;
}

/// The same with the few triangles of long rims' layouts, and a surface through their vertices: many triangles take minutes to bend, and
/// those on a field that folds over itself are no good.
bool few_alone(const Disc& disc, const Rim& rim, std::optional<int> resolution, Attempt& result) {
  Attempt few = result;
  few.surface = few.field;
  few.second.reset();
  if (few.met || !refine(rim, edges_in_layouts, few) || !second_alone(disc, rim, few)) return false;
  few.surface = through_vertices(few.made.uv, few.made.points, disc.rim, rim.edge);
  if (!few.surface) return false;
  few.few = true;
  if (!refine(rim, resolution, few) || !serves(rim, few)) return false;
  result = std::move(few);
  return true;
}

/// Places one edge inside the rim.
PlanePoints inside_rim(const Attempt& result, const Rim& rim) {
  const Index r = rim.points.rows(), step = (r + slopes - 1) / slopes;
  std::vector<Index> rows;
  for (Index k = 0; k < r; k += step) rows.push_back(k);
  PlanePoints inside = rows_of(result.rim_uv, rows);
  const Eigen::RowVector2d middle = result.rim_uv.colwise().mean();
  for (Index k = 0; k < inside.rows(); ++k) {
    const Eigen::RowVector2d way = middle - inside.row(k);
    inside.row(k) += way * std::min(1.0, rim.edge / std::max(way.norm(), 1e-300));
  }
  return inside;
}

/// What the fill errs beyond what it errs next to the rim, the layout hands on to it.
Eigen::VectorXd with_layout_errors(Eigen::VectorXd deviation, double near_rim, double fed_back) {
  const double least = near_rim * near_rim, times = 1 / ((1 - fed_back) * (1 - fed_back));
  for (double& d : deviation)
    if (d > near_rim) d = std::sqrt(least + times * (d * d - least));
  return deviation;
}

PlaneFill completed(const Attempt& result, const Rim& rim, const Disc& disc) {
  PlaneFill fill;
  const Index r = disc.rim, added = result.made.points.rows() - r;
  fill.surface = result.surface;
  fill.field = result.field;
  fill.rim_uv = result.rim_uv;
  fill.vertices = result.made.points.bottomRows(added);
  fill.uv = result.made.uv.bottomRows(added);
  fill.normals = result.surface->normals(as_rows(fill.uv));
  fill.triangles = result.made.triangles;
  const PlanePoints inside = inside_rim(result, rim);
  PlanePoints places(added + inside.rows() + result.met_uv.rows(), 2);
  places << fill.uv, inside, result.met_uv;
  Points directions(places.rows(), 3);
  directions << fill.normals, result.field->normals(as_rows(inside)), result.surface->normals(as_rows(result.met_uv));
  Eigen::VectorXd deviation = result.field->deviation(places, directions);
  if (result.met) {
    const Eigen::VectorXd at_met = deviation.tail(result.met_uv.rows());
    deviation.conservativeResize(added + inside.rows());
    deviation = result.met->deviation_left(places.topRows(deviation.rows()), deviation, at_met);
  }
  const double near_rim = deviation.tail(inside.rows()).norm() / std::sqrt(static_cast<double>(inside.rows()));
  fill.deviation = with_layout_errors(deviation.head(added), near_rim, result.fed_back);
  const Eigen::VectorXd spread = result.second ? spread_of_models(result) : result.spread;
  if (spread.size() > 0) fill.deviation = (fill.deviation.cwiseAbs2() + spread).cwiseSqrt();
  fill.fed_back = result.fed_back;
  fill.surroundings_error = std::atan(near_rim / std::max(rim.edge, 1e-300)) * 180 / std::numbers::pi;
  fill.folds = folded_edges(result.made.points, fill.triangles, rim.beyond);
  fill.rim_folds = rim.own_folds + static_cast<Index>(rim.flipped.size());
  fill.rings = disc.rings;
  fill.doubles_edges = result.made.doubles_edges;
  return fill;
}

/// Triangles without a surface: the rim's own, or those that join its edges to its middle. The latter are used if only they leave
/// no fold between them and no crossing, and do not fold more over the faces beyond. They are also used if they fold less where
/// the rim's own cross.
PlaneFill plain(const Rim& rim, bool are_first) {
  PlaneFill fill;
  fill.triangles = rim.rough;
  fill.folds = rim.own_folds;
  fill.rim_folds = rim.own_folds + static_cast<Index>(rim.flipped.size());
  fill.doubles_edges = rim.doubles_edges;
  const bool crossed = crosses_itself(rim.points, rim.rough);
  const bool serves = (are_first || fill.folds == 0) && folded_edges(rim.points, rim.rough, {}) == 0 && !crossed;
  if (serves || !rim.surroundings.islands.empty()) return fill;
  const Index r = rim.points.rows();
  Points points(r + 1, 3);
  points << rim.points, rim.points.colwise().mean();
  Triangles fan;
  for (Index k = 0; k < r; ++k) fan.push_back({k, (k + 1) % r, r});
  const Index folds = folded_edges(points, fan, rim.beyond);
  if (folded_edges(points, fan, {}) > 0 || crosses_itself(points, fan) || (folds > fill.folds && !crossed)) return fill;
  fill.vertices = points.bottomRows(1);
  fill.folds = folds;
  fill.triangles = std::move(fan);
  fill.doubles_edges = false;
  return fill;
}

/// The rim and the new vertices of a plain fill.
Points points_of(const Rim& rim, const PlaneFill& fill) {
  Points points(rim.points.rows() + fill.vertices.rows(), 3);
  points << rim.points, fill.vertices;
  return points;
}

/// By the change of the area, and the change before it.
double fed_back(double before, double now, double change) {
  return std::min(std::abs(now - before) / std::max(std::abs(change), 1e-300), max_fed_back);
}

/// Tries until the layout with the fill in it is that of the try before, or more would not help.
std::optional<Attempt> attempts(const Disc& disc, const Rim& rim, const std::vector<Index>& samples, const FieldOptions& fields,
                                const PlaneFillOptions& options) {
  std::optional<Attempt> result;
  double area = rim.area, change = 0;
  const bool is_long = disc.rim > long_rim && !options.resolution;
  PlaneFillOptions in_layouts = options;
  if (is_long) in_layouts.resolution = edges_in_layouts;
  for (int round = 0; round < layouts; ++round) {
    std::optional<Attempt> next = attempt(disc, rim, samples, fields, in_layouts, result ? &*result : nullptr);
    if (!next || !stay(next->made.points, rim)) break;
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

/// Of a rim alone: least bending and two that are smoother. On faces between walls, planes to saddles, the mixture that the likelihood makes
/// of them is 2 to 20 times nearer than least bending.
const std::vector<double> of_rim_alone = {2, 2.5, 3.5};

/// A noisy surface without details, from more of it: the layout is that of the try before, with its fill. Whether that changed the result.
bool look_farther(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops, const Rim& rim,
                  const FieldOptions& fields, const PlaneFillOptions& options, Disc& disc, Attempt& result) {
  const auto between = [&](double low, double x, double high) { return low * rim.edge < x && x < high * rim.edge; };
  if (!between(min_noise, result.field->noise(), too_rough) || !between(-1, result.left_by_reference, detail)) return false;
  Disc wide = disc_to_sample(mesh, around, loops, noisy_reach_share * rim.diameter, max_rings);
  if (wide.rings <= disc.rings) return false;
  std::optional<Attempt> next = attempt(wide, rim, spread_samples(wide, rim.edge), fields, options, &result);
  if (!next || !between(-1, next->left_by_reference, detail) || !stay(next->made.points, rim)) return false;
  next->fed_back = result.fed_back;
  next->few |= result.few;
  result = std::move(*next);
  disc = std::move(wide);
  return true;
}

/// A strongly curved surface without noise, from more samples: the layout is that of the try before, with its fill. Not where it meets points
/// inside, which curve it and of which the samples know nothing, nor where it would fold more. Whether that changed the result.
bool look_closer(const Disc& disc, const Rim& rim, const FieldOptions& fields, const PlaneFillOptions& options, Attempt& result) {
  if (result.fed_back == 0 || disc.rim > long_rim || result.met) return false;
  if (!(result.field->noise() < min_noise * rim.edge)) return false;
  const auto folds = [&](const Attempt& each) { return folded_edges(each.made.points, each.made.triangles, rim.beyond); };
  std::optional<Attempt> next = attempt(disc, rim, spread_samples(disc, rim.edge, more_where_clear), fields, options, &result);
  if (!next || !stay(next->made.points, rim) || folds(*next) > folds(result)) return false;
  next->fed_back = result.fed_back;
  next->few |= result.few;
  result = std::move(*next);
  return true;
}

/// A way to fill, the likeliest first.
struct Way {
  double reach;
  int rings;
  std::vector<double> orders;
  std::optional<Message> why;
};

/// Of the ways the likeliest that will do, else `best`, the plain triangles.
PlaneFill likeliest(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops,
                    const PlaneFillOptions& options, const Rim& rim, PlaneFill best) {
  const std::array<Way, 4> ways = {
      Way{reach_share, max_rings, FieldOptions().orders, {}}, Way{0, 2, {2, 3}, Message{Code::two_rings_followed}},
      Way{0, 1, {2}, Message{Code::one_ring_followed}}, Way{0, 0, of_rim_alone, Message{Code::rim_alone_followed}}};
  const Connectivity& continued = options.continued ? *options.continued : around;
  const bool finer = is_finer(rim, options);  // the surface is that of triangles like the rim's, which bend in far less time
  PlaneFillOptions coarse = options;
  if (finer) coarse.resolution.reset();
  bool is_known = false;  // whether the next way would do what was done already: several may see the rim alone
  for (const Way& way : ways) {
    if (is_known || (way.rings == 0 && best.surface)) break;
    Disc disc = disc_to_sample(mesh, continued, loops, way.reach * rim.diameter, way.rings);
    if (disc.triangles.empty() && way.rings > 0 && !options.continued) continue;
    const bool sees_rim_alone = disc.triangles.empty();
    is_known = sees_rim_alone;
    const std::vector<Index> samples = spread_samples(disc, rim.edge);
    FieldOptions fields;
    fields.orders = sees_rim_alone ? of_rim_alone : way.orders;
    fields.unit = std::max(rim.edge, 1e-300);
    std::optional<Attempt> result = attempts(disc, rim, samples, fields, coarse);
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
    const Index folds = folded_edges(result->made.points, result->made.triangles, rim.beyond);
    const Index left = unfolded(rim, *result);
    const bool is_long = disc.rim > long_rim;  // bending its thousands of triangles takes longer than all the rest
    // Where the faces beyond fold the rim itself, the triangles of the fill need not fold among themselves.
    const bool folds_inside = left > 0 && folded_edges(result->made.points, result->made.triangles, {}) > rim.folds_of_plain;
    const Index most = max_folds(rim, *result);
    const bool fails = is_hopeless || left > most || folds_inside || crosses(rim, *result);
    const bool prefers_second = !is_long && mostly_details(details_in(*result)) && (fails || way.reach == 0);
    bool bends_least = false;
    if (prefers_second || (fails && !is_long)) {
      Attempt alone = before ? *before : *result;
      const Disc rings = with_two_rings(mesh, continued, loops, disc);
      const bool few = alone.few || disc.rim * alone.made.points.rows() > max_bent;
      bends_least = few ? few_alone(rings, rim, options.resolution, alone) : second_alone(rings, rim, alone);
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

/// Of a long rim, and its surroundings, edges shorter than so many of a circle of the hole's diameter are collapsed. Caps of a sphere
/// with rims of 500 to 5,000 edges, 45 to 80 degrees wide, are farther off with 160, and with 240 the field takes the layout's errors for
/// noise now and then. But where the surroundings are narrow so many more that there are three rows of triangles: of caps and waves with
/// rims of 4,000 edges, 40 rings of faces wide, the fills were 2 to 30 times farther off.
constexpr double edges_of_circle = 200, max_edges_of_circle = 350, min_rows = 3;
/// Surroundings that reach less far than this share of such an edge say too little then: of those caps with 5,000 edges, of which ten of
/// them are seen, one is four times farther off than seen from above.
constexpr double min_width = 0.75;
/// Below this share of such an edge there is no noise to average: then the field meets its samples. Fitted to more than it can meet caps of
/// a ball are up to 180 times farther off.
constexpr double met_noise = 1e-3;
/// Of a field fitted to more: with 600 and 200 caps and waves are as far off, with 100 some are farther.
constexpr Index max_centers = 300;

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
PlanePoints between_known(const Rim& rim, const std::vector<Index>& known, const PlanePoints& places) {
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
std::optional<PlaneFill> on_field(const Disc& disc, const Rim& rim, const PlaneFillOptions& options,
                                  const std::shared_ptr<const PolyharmonicSpline>& field, const PlanePoints& rim_uv,
                                  double fed_back) {
  Attempt result;
  result.surface = result.field = field;
  result.fed_back = fed_back;
  result.rim_uv = rim_uv;
  const PlanePolygon polygon = polygon_of(rim, result.rim_uv);
  if (polygon.triangles.empty()) return {};
  result.made = remesh(polygon, options.resolution, *result.surface);
  if (!result.made.points.allFinite() || !stay(result.made.points, rim)) return {};
  if (result.made.doubles_edges && !rim.doubles_edges) return {};
  result.on_field = result.made.points;
  const Index folds = folded_edges(result.made.points, result.made.triangles, rim.beyond), left = unfolded(rim, result);
  if (left > max_folds(rim, result) || crosses(rim, result)) return {};
  PlaneFill fill = completed(result, rim, disc);
  if (left < folds) fill.plainer = Message{Code::triangles_off_surface};
  return fill;
}

/// A long rim by way of a coarser one's fill: thousands of triangles lay out slowly. By the places of the vertices on that the field is one
/// through more of them, or where there is noise one fitted to thousands. Nothing where that is no surface of all the surroundings, or
/// triangles on it will not do.
std::optional<PlaneFill> on_coarser_rim(const Mesh& mesh, const Connectivity& around,
                                        const std::vector<std::vector<Index>>& loops, const PlaneFillOptions& options,
                                        const Rim& rim) {
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
  const PlaneFill from = fill_over_plane(coarse, Connectivity(coarse), hole.loops);
  if (!from.field || from.plainer) return {};
  const PlanePoints rim_uv = closest_points(*from.surface, rim.points, between_known(rim, hole.rows, from.rim_uv));
  const bool is_met = from.field->noise() < met_noise * length;
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

}  // namespace

Index folds_of_rim(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops) {
  const Rim rim = rim_of(mesh, around, loops);
  const Index flipped = static_cast<Index>(rim.flipped.size());
  return folded_edges(rim.points, min_weight_triangulation(rim.points, rim.surroundings).triangles, rim.beyond) + flipped;
}

PlaneFill fill_over_plane(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops,
                          const PlaneFillOptions& options) {
  Rim rim = rim_of(mesh, around, loops);
  rim.through = options.through;
  rim.of_hole = options.size;
  rim.surroundings.joined.insert(rim.surroundings.joined.end(), options.joined.begin(), options.joined.end());
  const RoughFill rough = min_weight_triangulation(rim.points, rim.surroundings);
  rim.rough = rough.triangles;
  rim.folds = rim.own_folds = folded_edges(rim.points, rim.rough, rim.beyond);
  if (!rough.crossing.empty()) rim.folds = std::min(rim.folds, folded_edges(rim.points, rough.crossing, rim.beyond));
  rim.doubles_edges = rough.doubles_edges;
  PlaneFill best = plain(rim, rough.crossing.empty());
  const Points plain_points = points_of(rim, best);
  rim.folds_of_plain = folded_edges(plain_points, best.triangles, {});
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
  for (const Triangles* triangles : {&rough.crossing, &rough.triangles}) {
    if (fill.surface || triangles->empty()) continue;
    rim.rough = *triangles;
    rim.area = area_of(rim.points, rim.rough);
    fill = likeliest(mesh, around, loops, options, rim, best);
  }
  if (coarse && (!fill.surface || coarse->folds <= fill.folds)) return std::move(*coarse);
  if (fill.surface || !crosses_itself(plain_points, best.triangles)) return fill;
  rim.may_cross = true;
  return likeliest(mesh, around, loops, options, rim, best);
}

}  // namespace tripatch
