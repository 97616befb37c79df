#include "tripatch/spline/completed_fill.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tripatch/math/thresholds.h"
#include "tripatch/spline/averaged_models.h"

namespace tripatch {
namespace {

/// Places at the rim where the slope's deviation is looked at: it is a mean over them, which is only told.
constexpr Index slopes = count::dozens;

/// Places one edge inside the rim.
PlanePoints inside_rim(const Attempt& result, const PlaneRim& rim) {
  const Index r = rim.points.rows(), step = (r + slopes - 1) / slopes;
  std::vector<Index> rows;
  for (Index k = 0; k < r; k += step) rows.push_back(k);
  PlanePoints inside = result.rim_uv(rows, Eigen::all);
  const Eigen::RowVector2d middle = result.rim_uv.colwise().mean();
  for (Index k = 0; k < inside.rows(); ++k) {
    const Eigen::RowVector2d way = middle - inside.row(k);
    inside.row(k) += way * std::min(1.0, rim.edge / std::max(way.norm(), tolerance::tiny));
  }
  return inside;
}

}  // namespace

PlaneFill completed(const Attempt& result, const PlaneRim& rim, const Disc& disc) {
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
  fill.deviation = deviation.head(added) / (1 - result.fed_back);  // the layout hands errors of the fill on to it
  const Eigen::VectorXd spread = result.second ? spread_of_models(result) : result.spread;
  if (spread.size() > 0) fill.deviation = (fill.deviation.cwiseAbs2() + spread).cwiseSqrt();
  fill.fed_back = result.fed_back;
  fill.surroundings_error = std::atan(near_rim / std::max(rim.edge, tolerance::tiny)) * 180 / std::numbers::pi;
  fill.folds = count_folded_edges(result.made.points, fill.triangles, rim.beyond);
  fill.rim_folds = rim.own_folds + static_cast<Index>(rim.flipped.size());
  fill.rings = disc.rings;
  fill.doubles_edges = result.made.doubles_edges;
  return fill;
}

}  // namespace tripatch
