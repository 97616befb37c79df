#include "tripatch/spline/field_around.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Gauss-Newton's, to feet on a surface: they move by this share of its domain at most.
constexpr double longest_step_to_feet = share::trace;
/// Vertices that a field is fitted to next to its centers: the time grows with their number, noise is averaged over them.
constexpr Index max_fitted = count::portion;

/// Where the tangent planes at the rim have vertices.
PlanePoints on_tangent_planes(const Disc& disc, const std::vector<Index>& rows, const Surface& surface,
                              const PlanePoints& rim_uv) {
  std::vector<double> jets(static_cast<std::size_t>(9 * rim_uv.rows()));
  surface.evaluate(as_rows(rim_uv).data(), rim_uv.rows(), 1, jets.data());
  PlanePoints uv(static_cast<Index>(rows.size()), 2);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Index from = disc.nearest[static_cast<std::size_t>(rows[k])];
    uv.row(static_cast<Index>(k)).setConstant(std::numeric_limits<double>::quiet_NaN());
    if (from < 0) continue;
    const double* jet = &jets[static_cast<std::size_t>(9 * from)];
    const Vec3 way = Vec3(disc.points.row(rows[k])) - Vec3::Map(jet);
    uv.row(static_cast<Index>(k)) = rim_uv.row(from) + in_frame(Vec3::Map(jet + 3), Vec3::Map(jet + 6), way).transpose();
  }
  return uv;
}

}  // namespace

PlanePoints closest_points(const Surface& surface, const Points& points, PlanePoints uv) {
  const double longest = longest_step_to_feet * (uv.colwise().maxCoeff() - uv.colwise().minCoeff()).maxCoeff();
  std::vector<double> jets(static_cast<std::size_t>(9 * uv.rows()));
  double most = longest;
  for (int step = 0; step < tolerance::newton_steps && most > tolerance::solved * longest; ++step) {
    surface.evaluate(as_rows(uv).data(), uv.rows(), 1, jets.data());
    most = 0;
    for (Index k = 0; k < uv.rows(); ++k) {
      const double* jet = &jets[static_cast<std::size_t>(9 * k)];
      Vec2 way = in_frame(Vec3::Map(jet + 3), Vec3::Map(jet + 6), Vec3(points.row(k)) - Vec3::Map(jet));
      if (!way.allFinite()) continue;
      way *= std::min(1.0, longest / std::max(way.norm(), tolerance::tiny));
      uv.row(k) += way;
      most = std::max(most, way.norm());
    }
  }
  return uv;
}

std::vector<Index> fitted_rows(const Disc& disc, const std::vector<Index>& centers) {
  const Index n = disc.points.rows(), more = std::min(n, max_fitted);
  std::vector<char> taken(static_cast<std::size_t>(n), 0);
  std::vector<Index> rows = centers;
  for (Index k : rows) taken[static_cast<std::size_t>(k)] = 1;
  for (Index i = 0; i < more; ++i)
    if (!std::exchange(taken[static_cast<std::size_t>(i * n / more)], 1)) rows.push_back(i * n / more);
  return rows;
}

PlanePoints places_on(const Surface& surface, const PlanePoints& rim_uv, const Disc& disc, const std::vector<Index>& rows) {
  const PlanePoints first = on_tangent_planes(disc, rows, surface, rim_uv);
  return first.allFinite() ? closest_points(surface, disc.points(rows, Eigen::all), first) : first;
}

std::shared_ptr<const PolyharmonicSpline> field_through(const Points& points, const PlanePoints& uv, Index centers, double edge) {
  if (!uv.allFinite()) return {};
  FieldOptions fields;
  fields.unit = std::max(edge, tolerance::tiny);
  fields.centers = centers;
  try {
    return std::make_shared<PolyharmonicSpline>(uv, points, fields);
  } catch (const InvalidArgument&) {  // places on a line
    return {};
  }
}

}  // namespace tripatch
