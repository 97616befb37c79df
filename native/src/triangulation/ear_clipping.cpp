#include "tripatch/triangulation/ear_clipping.h"

#include <algorithm>
#include <cmath>

#include "tripatch/math/tolerances.h"
#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

using Place = Eigen::RowVector2d;

/// Twice the area of a triangle; 0 where only rounding makes one.
double turn(const Place& a, const Place& b, const Place& c) {
  const Place u = b - a, v = c - a;
  const double area = u[0] * v[1] - u[1] * v[0];
  return std::abs(area) > tie * u.norm() * v.norm() ? area : 0;
}

/// Vertices by the cells of a grid over the polygon, about two to a cell.
class Grid {
public:
  explicit Grid(const PlanePoints& p) : low_(p.colwise().minCoeff()) {
    const Place size = Place(p.colwise().maxCoeff()) - low_;
    side_ = std::max(size.maxCoeff(), tolerance::tiny) / std::max(1.0, std::sqrt(static_cast<double>(p.rows())));
    wide_ = static_cast<Index>(size[0] / side_) + 1;
    high_ = static_cast<Index>(size[1] / side_) + 1;
    cells_.resize(wide_ * high_);
    for (Index k = 0; k < p.rows(); ++k) cells_[cell(p(k, 0), 0) + wide_ * cell(p(k, 1), 1)].push_back(k);
  }
  /// Whether one of the vertices in the box of a triangle is what is asked for.
  template <class Asked>
  bool any(const Place& a, const Place& b, const Place& c, const Asked& asked) const {
    const Place low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    for (Index j = cell(low[1], 1); j <= cell(high[1], 1); ++j)
      for (Index i = cell(low[0], 0); i <= cell(high[0], 0); ++i)
        for (Index k : cells_[i + wide_ * j])
          if (asked(k)) return true;
    return false;
  }

private:
  Index cell(double x, int axis) const {
    return std::clamp<Index>(static_cast<Index>((x - low_[axis]) / side_), 0, (axis == 0 ? wide_ : high_) - 1);
  }
  Place low_;
  double side_ = 1;
  Index wide_ = 1, high_ = 1;
  std::vector<std::vector<Index>> cells_;
};

}  // namespace

std::vector<std::array<Index, 3>> cut_ears(const PlanePoints& polygon, bool bridged) {
  const Index n = polygon.rows();
  std::vector<std::array<Index, 3>> triangles;
  if (n < 3 || !polygon.allFinite()) return triangles;
  const Grid grid(polygon);
  std::vector<Index> next(n), before(n);
  std::vector<char> gone(n, 0);
  for (Index k = 0; k < n; ++k) next[k] = (k + 1) % n, before[k] = (k + n - 1) % n;
  const auto at = [&](Index k) -> Place { return polygon.row(k); };
  const auto is_ear = [&](Index k) {
    const Index p = before[k], q = next[k];
    const Place a = at(p), b = at(k), c = at(q);
    if (!(turn(a, b, c) > 0)) return false;
    return !grid.any(a, b, c, [&](Index v) {
      if (gone[v] || v == p || v == k || v == q) return false;
      const Place x = at(v);
      if (bridged && (x == a || x == b || x == c)) return false;
      return turn(a, b, x) >= 0 && turn(b, c, x) >= 0 && turn(c, a, x) >= 0;
    });
  };
  Index left = n, misses = 0;
  for (Index k = 0; left > 3;) {
    if (is_ear(k)) {
      triangles.push_back({before[k], k, next[k]});
      next[before[k]] = next[k];
      before[next[k]] = before[k];
      gone[k] = 1;
      --left;
      misses = 0;
      k = next[next[k]];  // every other one first: ears of a round rim do not all end in one vertex
    } else {
      if (++misses > left) return {};
      k = next[k];
    }
  }
  Index k = 0;
  while (gone[k]) ++k;
  if (!(turn(at(before[k]), at(k), at(next[k])) > 0)) return {};
  triangles.push_back({before[k], k, next[k]});
  return triangles;
}

}  // namespace tripatch
