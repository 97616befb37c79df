#include "tripatch/spline/averaged_models.h"

#include <algorithm>
#include <numeric>

#include "tripatch/math/thresholds.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

/// Below this share of the second model it is not worth its time: half and twice of it change 8 of 84 fills, all together by less than 1%.
constexpr double min_share_of_second = share::tenth;
/// A field that somewhere is this many diameters of the hole from the triangles that bend least, though there are details that no polynomial
/// explains, has overshot, as at the end of a fillet: between the bevels of cylinders it made funnels. Not one whose noise is this share
/// of an edge: that knows little and runs nowhere. Of 500 holes in 25 meshes made by Blender's tools, and the same cut into triangles, 8
/// are so far off; the triangles that bend least are 2.5 to 16 times nearer on three of them and a third farther at worst. From 0.13
/// on it is the same; with all noises some are 4 times farther.
constexpr double far_from_least_bent = share::fifth, little_noise = share::fifth;
/// The field that carries the difference over all of the hole: its order, and of how many points at most it is made; of half as many
/// 7 of 84 fills change, by 0.1% together.
constexpr double order_of_difference = 2.5;
constexpr Index points_of_difference = count::block;

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
  fields.unit = std::max(unit, tolerance::tiny);
  try {
    return std::make_shared<PolyharmonicSpline>(places, difference, fields);
  } catch (const InvalidArgument&) {
    return {};
  }
}

}  // namespace

bool take_second(const PlaneRim& rim, const SecondModel& second, double share, Attempt& result) {
  const Index all = result.made.points.rows(), added = second.vertices.rows();
  const std::vector<Index> rows = rows_of_difference(all);
  Points other = result.made.points;
  other.bottomRows(added) = second.vertices;
  const PlanePoints places = PlanePoints(result.made.uv(rows, Eigen::all));
  Points known = result.on_field(rows, Eigen::all);
  const Index of_rim = std::ranges::lower_bound(rows, all - added) - rows.begin();
  known.topRows(of_rim) = result.field->positions(as_rows(places.topRows(of_rim)));
  const Points difference = share * (other(rows, Eigen::all) - known);
  const SurfacePtr change = field_of_difference(places, difference, rim.edge);
  if (!change) return false;
  Points points = result.made.points;
  points.bottomRows(added) =
      result.on_field.bottomRows(added) + change->positions(as_rows(PlanePoints(result.made.uv.bottomRows(added))));
  if (!points.allFinite() || !stays_near(points, rim)) return false;
  result.surface = sum(result.field, change);
  result.made.points = std::move(points);
  result.second = second;
  result.share_of_second = share;
  return true;
}

void average_models(const Disc& disc, const PlaneRim& rim, Attempt& result) {
  const double share = share_of_second({result.field->noise() / std::max(rim.edge, tolerance::tiny), result.field->roughness(),
                                        details_in(result), result.field->mean_order(), result.fed_back > 0});
  const Index r = disc.rim, added = result.made.points.rows() - r;
  if (share < min_share_of_second || added == 0 || r > long_rim || disc.triangles.empty() || result.met) return;
  const auto folds_of = [&](const Attempt& each) {
    return count_folded_edges(each.made.points, each.made.triangles, rim.beyond);
  };
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

void hold_back(const Disc& disc, const PlaneRim& rim, Attempt& result) {
  const Index r = disc.rim, added = result.made.points.rows() - r;
  if (added == 0 || r > long_rim || disc.triangles.empty() || result.met) return;
  if (!(result.left_by_reference > detail * rim.edge) || result.field->noise() > little_noise * rim.edge) return;
  const std::optional<SecondModel> least = second_model(result.made.points, result.made.triangles, disc, {2});
  if (!least) return;
  const double farthest_apart = (least->vertices - result.on_field.bottomRows(added)).rowwise().norm().maxCoeff();
  if (!(farthest_apart > far_from_least_bent * rim.diameter)) return;
  Attempt held = result;
  if (!take_second(rim, *least, 1, held)) return;
  const Index folds = count_folded_edges(held.made.points, held.made.triangles, rim.beyond);
  if (folds <= max_folds(rim, held) || folds <= count_folded_edges(result.made.points, result.made.triangles, rim.beyond))
    result = std::move(held);
}

Eigen::VectorXd spread_of_models(const Attempt& result) {
  const Index added = result.second->vertices.rows();
  const Points normals = result.surface->normals(as_rows(PlanePoints(result.made.uv.bottomRows(added))));
  const double share = std::min(result.share_of_second, max_of_second);
  const Points way = result.second->vertices - result.on_field.bottomRows(added);
  const Eigen::VectorXd between = way.cwiseProduct(normals).rowwise().sum();
  const Eigen::VectorXd apart = result.second->apart.cwiseProduct(normals).rowwise().sum();
  return share * (1 - share) * between.cwiseAbs2() + share * apart.cwiseAbs2();
}

Eigen::VectorXd carried(const Eigen::VectorXd& values, const PlanePoints& places, double unit, const PlanePoints& to) {
  const std::vector<Index> rows = rows_of_difference(places.rows());
  Points known = Points::Zero(static_cast<Index>(rows.size()), 3);
  known.col(0) = values(rows);
  const SurfacePtr field = field_of_difference(places(rows, Eigen::all), known, unit);
  if (!field) return Eigen::VectorXd::Constant(to.rows(), values.maxCoeff());
  return field->positions(as_rows(to)).col(0).cwiseMax(0);
}

SurfacePtr through_vertices(const PlanePoints& uv, const Points& points, Index rim, double unit) {
  const Index step = (uv.rows() - rim) / std::max<Index>(max_samples - rim, 1) + 1;
  std::vector<Index> rows(static_cast<std::size_t>(rim));
  std::iota(rows.begin(), rows.end(), Index{0});
  for (Index k = rim; k < uv.rows(); k += step) rows.push_back(k);
  return field_of_difference(uv(rows, Eigen::all), points(rows, Eigen::all), unit);
}

}  // namespace tripatch
