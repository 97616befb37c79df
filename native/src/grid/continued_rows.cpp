#include "tripatch/grid/continued_rows.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tripatch/grid/mixed_differences.h"
#include "tripatch/math/decompositions.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

/// What is unknown along an axis: places between two that are known.
struct Span {
  Index low, high;
  Index unknown() const { return high - low - 1; }
};

/// Places from which differences of an order reach what is unknown, as far as they are known; the matrix of these differences.
struct Differences {
  Index first = 0, last = 0;
  Eigen::MatrixXd of;  ///< (differences, places)
  /// Of the unknown places alone.
  Eigen::MatrixXd unknown(const Span& span) const { return of.middleCols(span.low + 1 - first, span.unknown()); }
};

Differences differences(int order, const Span& span, Index first, Index last) {
  Differences d;
  d.first = std::max(first, span.low + 1 - order);
  d.last = std::min(last, span.high - 1 + order);
  const Index places = d.last - d.first + 1;
  d.of = Eigen::MatrixXd::Zero(std::max<Index>(places - order, 0), places);
  for (Index k = 0; k < d.of.rows(); ++k)
    for (int j = 0; j <= order; ++j) d.of(k, k + j) = difference_weights[order - 1][j];
  return d;
}

/// x with the least |a x + b|, from the columns of a, which has full rank.
Eigen::MatrixXd least_squares(const OrthonormalColumns& columns, const Eigen::MatrixXd& b) {
  return -columns.triangle.triangularView<Eigen::Upper>().solve(columns.basis.transpose() * b);
}

/// Points of what is unknown in u and v, one coordinate a matrix (unknown in u, in v); empty where that is not determined. Mixed
/// differences of all are d p e', so that they are least where d does the one and e the other.
std::array<Eigen::MatrixXd, 3> solved(const PointsRef& vertices, const QuadRows& rows, int order, const Span& u, const Span& v) {
  const Differences d = differences(order, u, rows.first(0), rows.last(0)),
                    e = differences(order, v, rows.first(1), rows.last(1));
  if (d.of.rows() < u.unknown() || e.of.rows() < v.unknown()) return {};
  const OrthonormalColumns du = orthonormal_columns(d.unknown(u), false), ev = orthonormal_columns(e.unknown(v), false);
  std::array<Eigen::MatrixXd, 3> inside;
  for (int x = 0; x < 3; ++x) {
    Eigen::MatrixXd known = Eigen::MatrixXd::Zero(d.last - d.first + 1, e.last - e.first + 1);
    for (Index i = d.first; i <= d.last; ++i)
      for (Index j = e.first; j <= e.last; ++j) {
        const bool is_unknown = u.low < i && i < u.high && v.low < j && j < v.high;
        if (!is_unknown) known(i - d.first, j - e.first) = vertices(rows.at(i, j), x);
      }
    const Eigen::MatrixXd half = least_squares(du, d.of * known * e.of.transpose());
    inside[x] = -least_squares(ev, half.transpose()).transpose();
  }
  return inside;
}

/// Root mean square distance by which a side of the rim is missed where it is unknown too, as of the middle of the block; none where
/// nothing tells.
std::optional<double> missed_of_side(const PointsRef& vertices, const QuadRows& rows, int order, int side) {
  Span u{0, rows.n()}, v{0, rows.m()};
  Index& grown = side == 0 ? u.low : side == 1 ? u.high : side == 2 ? v.low : v.high;
  const Index place = grown;
  grown += side % 2 == 0 ? -1 : 1;
  const bool across_u = side < 2;
  const Index count = (across_u ? rows.m() : rows.n()) - 1, across = across_u ? rows.n() : rows.m();
  if (count < 1 || rows.beyond()[side] == 0) return {};
  const std::array<Eigen::MatrixXd, 3> inside = solved(vertices, rows, order, u, v);
  if (inside[0].size() == 0) return INFINITY;
  double sum = 0;
  for (Index k = 1; k <= count; ++k)
    for (int x = 0; x < 3; ++x) {
      const Index i = across_u ? place : k, j = across_u ? k : place;
      sum += std::pow(inside[x](i - u.low - 1, j - v.low - 1) - vertices(rows.at(i, j), x), 2);
    }
  return std::sqrt(sum / static_cast<double>(count)) * middle_over_first(static_cast<double>(across));
}

/// The median over the sides: across one of them a bevel may run that tells nothing of the block.
double missed(const PointsRef& vertices, const QuadRows& rows, int order) {
  std::vector<double> sides;
  for (int side = 0; side < 4; ++side)
    if (const std::optional<double> own = missed_of_side(vertices, rows, order, side)) sides.push_back(*own);
  if (sides.empty()) return 0;
  std::sort(sides.begin(), sides.end());
  const std::size_t count = sides.size();
  return 0.5 * (sides[(count - 1) / 2] + sides[count / 2]);
}

}  // namespace

/// Of L steps x^2 (L - x)^2 is (L / 2)^4 in the middle, and about L^2 after the first: the square of so much of L.
constexpr double middle_share = share::quarter;

double middle_over_first(double across) { return std::pow(middle_share * across, 2); }

ContinuedRows continued_rows(const PointsRef& vertices, const QuadRows& rows) {
  ContinuedRows best{{}, 1, missed(vertices, rows, 1)};
  for (int order = 2; order <= max_difference_order; ++order) {
    const double own = missed(vertices, rows, order);
    if (clearly_less(own, best.missed)) best.missed = own, best.order = order;
  }
  const Index n = rows.n() - 1, m = rows.m() - 1;
  best.inside.resize(n * m, 3);
  if (n * m == 0) return best;
  const std::array<Eigen::MatrixXd, 3> inside = solved(vertices, rows, best.order, {0, rows.n()}, {0, rows.m()});
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < m; ++j)
      for (int x = 0; x < 3; ++x) best.inside(i * m + j, x) = inside[x](i, j);
  return best;
}

}  // namespace tripatch
