#include "tripatch/creases/hinged_surface.h"

#include <algorithm>
#include <array>
#include <limits>

#include "tripatch/math/tolerances.h"

namespace tripatch {
namespace {

/// Negative inside.
double signed_distance(const PlanePoints& polygon, const Eigen::RowVector2d& point) {
  double least = std::numeric_limits<double>::infinity();
  bool inside = false;
  const Index n = polygon.rows();
  for (Index k = 0; k < n; ++k) {
    const Eigen::RowVector2d a = polygon.row(k), b = polygon.row((k + 1) % n), e = b - a, p = point - a;
    const double t = std::clamp(p.dot(e) / std::max(e.squaredNorm(), tolerance::tiny), 0.0, 1.0);
    least = std::min(least, (p - t * e).norm());
    if ((a[1] > point[1]) != (b[1] > point[1]) && p[0] < e[0] * p[1] / e[1]) inside = !inside;
  }
  return inside ? -least : least;
}

/// Taylor coefficients of one degree by (u, v) as those by (x, y), where (u, v) = (c x + s y, c y - s x): a turn.
void turn_coefficients(int degree, double c, double s, double* coefficients) {
  std::array<std::array<double, 3>, max_order + 1> sum{};
  for (int j = 0; j <= degree; ++j) {  // the term u^(degree - j) v^j
    std::array<double, max_order + 2> term{};
    term[0] = 1;  // of x^(m - k) y^k at place k
    for (int m = 0; m < degree; ++m) {
      const double x = m < degree - j ? c : -s, y = m < degree - j ? s : c;
      for (int k = m + 1; k > 0; --k) term[k] = x * term[k] + y * term[k - 1];
      term[0] *= x;
    }
    for (int k = 0; k <= degree; ++k)
      for (int axis = 0; axis < 3; ++axis) sum[k][axis] += term[k] * coefficients[3 * j + axis];
  }
  for (int k = 0; k <= degree; ++k) std::copy(sum[k].begin(), sum[k].end(), coefficients + 3 * k);
}

}  // namespace

std::size_t HingedSurface::part_of(const Eigen::RowVector2d& point) const {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    const double distance = signed_distance(parts_[k].motion.of(parts_[k].polygon), point);
    if (distance < least) least = distance, best = k;
  }
  return best;
}

void HingedSurface::evaluate(const double* b, Index n, int order, double* out) const {
  const Index stride = 3 * jet_size(order);
  std::vector<std::vector<Index>> rows(parts_.size());
  for (Index k = 0; k < n; ++k) rows[part_of(Eigen::RowVector2d(b[3 * k], b[3 * k + 1]))].push_back(k);
  for (std::size_t part = 0; part < parts_.size(); ++part) {
    const Index count = static_cast<Index>(rows[part].size());
    if (count == 0) continue;
    PlanePoints at(count, 2);
    for (Index k = 0; k < count; ++k) at.row(k) << b[3 * rows[part][k]], b[3 * rows[part][k] + 1];
    Points own = Points::Zero(count, 3);
    own.leftCols(2) = parts_[part].motion.back(at);
    std::vector<double> jets(static_cast<std::size_t>(count * stride));
    parts_[part].surface->evaluate(own.data(), count, order, jets.data());
    const double c = parts_[part].motion.turn(0, 0), s = parts_[part].motion.turn(1, 0);
    for (Index k = 0; k < count; ++k) {
      double* jet = &jets[static_cast<std::size_t>(k * stride)];
      for (int degree = 1; degree <= order; ++degree) turn_coefficients(degree, c, s, jet + 3 * jet_size(degree - 1));
      std::copy_n(jet, stride, out + rows[part][k] * stride);
    }
  }
}

}  // namespace tripatch
