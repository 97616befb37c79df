#include "tripatch/spline/minimize_bending.h"

#include <Eigen/Geometry>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "tripatch/math/decompositions.h"
#include "tripatch/math/dense_kernels.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// The largest cotangent, of half a degree: triangles whose area says more are taken for that much thicker, all three of their angles, so
/// that the energy of each is positive. Areas of vertices are no less than this share of the mean triangle's. Else they come of triangles
/// that are all but an edge.
constexpr double steepest = factor::extreme;
/// Areas of vertices where a fill meets its surroundings, over those of the fill's triangles alone: the planes of these surroundings are
/// those of single triangles. With 1 cages that end at wide bevels continue as those leave, with 2 at narrow ones; 1.3 to 2 leave 60 rough
/// holes equally near to what was there, with 3 they are 2% farther.
constexpr double softness_of_planes = 1.5;

}  // namespace

Laplacian cotangent_laplacian(const Points& points, const std::vector<std::array<Index, 3>>& triangles) {
  std::vector<Eigen::Triplet<double>> weights;
  Laplacian out{Sparse(points.rows(), points.rows()), Eigen::VectorXd::Zero(points.rows())};
  for (const std::array<Index, 3>& t : triangles) {
    const Vec3 p[3] = {points.row(t[0]), points.row(t[1]), points.row(t[2])};
    const double twice = (p[1] - p[0]).cross(p[2] - p[0]).norm();
    const double longest = std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()});
    const double thick = std::max({twice, longest / steepest, tolerance::tiny});
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      const double cotangent = u.dot(v) / thick / 2;
      const int a = static_cast<int>(t[(k + 1) % 3]), b = static_cast<int>(t[(k + 2) % 3]);
      weights.insert(weights.end(), {{a, b, -cotangent}, {b, a, -cotangent}, {a, a, cotangent}, {b, b, cotangent}});
      out.areas[t[k]] += twice / 6;
    }
  }
  out.stiffness.setFromTriplets(weights.begin(), weights.end());
  return out;
}

namespace {

/// Columns that are solved for at once where all of them would take too much room.
constexpr Index at_once = count::dozens;

/// Least energies of increasing orders, of the same free vertices. With the Laplacian S, positive on its diagonal, and the areas
/// A the energies are x' S x, w' w / A of w = S x, and v' S v of v = w / A. Matrices of the higher two have the condition of S
/// squared and cubed, beyond all digits where triangles are thin. But w of the free vertices (f) may be anything: it says x, and
/// with it w of those next to them (b), which are held, w_b = B w_f + e with B = S_bf / S_ff. There w takes from the triangles
/// around only the planes in which these continue across the rim, as for a clamped plate. With their own bend, which no fill
/// changes, 334 fills of holes cut by booleans are 6% farther from what was there, 60 of rough ones 3%. So what is left has an
/// unknown or two for each of those vertices (multipliers m of those equations, and v_b), and S_ff alone is factored.
class Bending {
public:
  Bending(const Points& points, const std::vector<std::array<Index, 3>>& triangles,
          const std::vector<std::array<Index, 3>>& around, Index first, Index count)
      : first_(first), count_(count), areas_(points.rows()) {
    const Laplacian own = cotangent_laplacian(points, triangles), beyond = cotangent_laplacian(points, around);
    const Sparse stiffness = own.stiffness + beyond.stiffness;
    const double mean = std::max((own.areas + beyond.areas).sum(), tolerance::tiny) /
                        static_cast<double>(std::max<std::size_t>(triangles.size() + around.size(), 1));
    const auto over_mean = [&](const Eigen::VectorXd& areas) { return (areas / mean).cwiseMax(tolerance::slight).eval(); };
    areas_ = over_mean(own.areas + beyond.areas);
    beside_ = held_beside(stiffness);
    free_ = areas_.segment(first, count);
    held_ = over_mean((beyond.areas.array() > 0).select(softness_of_planes * own.areas, own.areas))(beside_);
    factor(stiffness.block(first, first, count, count));
    take_blocks(stiffness);
    Points held = points;
    held.middleRows(first, count).setZero();
    known_ = stiffness * held;
    const Points clamped = own.stiffness * held - turned_outward(points, triangles, around);
    known_(beside_, Eigen::all) = clamped(beside_, Eigen::all);
    if (solver_.info() != Eigen::Success) return;
    from_held_ = solved(known_.middleRows(first, count));
    regular_ = from_held_.allFinite();
  }

  std::optional<Points> least(int order) {
    if (!regular_) return {};
    Points out = -from_held_;
    if (order > 1 && !beside_.empty()) out += solved(free_.asDiagonal() * (order == 2 ? min_second() : min_third()));
    if (!out.allFinite()) return {};
    return out;
  }

private:
  bool is_free(Index v) const { return v >= first_ && v < first_ + count_; }

  /// Of vertices where the fill's triangles meet those around: the sum of half of the edges there, each as long as it is and turned outward
  /// in the plane of the triangle beyond. Of a flat fill in a flat mesh it is the fill's S x.
  Points turned_outward(const Points& points, const std::vector<std::array<Index, 3>>& triangles,
                        const std::vector<std::array<Index, 3>>& around) const {
    std::set<std::pair<Index, Index>> beyond;  // directed as the triangles around have them
    for (const std::array<Index, 3>& t : triangles)
      for (int k = 0; k < 3; ++k)
        if (const Index a = t[k], b = t[(k + 1) % 3]; !is_free(a) && !is_free(b)) beyond.emplace(b, a);
    Points out = Points::Zero(points.rows(), 3);
    for (const std::array<Index, 3>& t : around)
      for (int k = 0; k < 3; ++k) {
        const Index a = t[k], b = t[(k + 1) % 3];
        if (!beyond.contains({a, b})) continue;
        const Vec3 edge = points.row(b) - points.row(a), to = points.row(t[(k + 2) % 3]) - points.row(a);
        const Vec3 normal = edge.cross(to).stableNormalized();
        for (Index v : {a, b}) out.row(v) += normal.cross(edge) / 2;
      }
    return out;
  }

  std::vector<Index> held_beside(const Sparse& stiffness) const {
    std::vector<char> is_beside(static_cast<std::size_t>(stiffness.rows()), 0);
    for (Index column = first_; column < first_ + count_; ++column)
      for (Sparse::InnerIterator entry(stiffness, column); entry; ++entry)
        if (!is_free(entry.row())) is_beside[static_cast<std::size_t>(entry.row())] = 1;
    std::vector<Index> beside;
    for (std::size_t v = 0; v < is_beside.size(); ++v)
      if (is_beside[v]) beside.push_back(static_cast<Index>(v));
    return beside;
  }

  void factor(const Sparse& own) {
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> back;  // from the order of elimination
    Eigen::AMDOrdering<int>()(own.selfadjointView<Eigen::Lower>(), back);
    turn_ = back.inverse();
    Sparse turned(count_, count_);
    turned.selfadjointView<Eigen::Upper>() = own.selfadjointView<Eigen::Lower>().twistedBy(turn_);
    solver_.compute(turned);
  }

  /// S of those next to by the free ones (transposed) and among themselves.
  void take_blocks(const Sparse& stiffness) {
    const Index n = static_cast<Index>(beside_.size());
    std::vector<Index> row(static_cast<std::size_t>(stiffness.rows()), -1);
    for (Index k = 0; k < n; ++k) row[static_cast<std::size_t>(beside_[k])] = k;
    to_free_.resize(count_, n);
    among_ = Eigen::MatrixXd::Zero(n, n);
    beyond_.resize(n, stiffness.rows());
    std::vector<Eigen::Triplet<double>> to_free, beyond;
    for (Index k = 0; k < n; ++k)
      for (Sparse::InnerIterator entry(stiffness, beside_[k]); entry; ++entry) {
        const Index other = row[static_cast<std::size_t>(entry.row())];
        if (is_free(entry.row()))
          to_free.emplace_back(static_cast<int>(entry.row() - first_), static_cast<int>(k), entry.value());
        else if (other >= 0)
          among_(other, k) = entry.value();
        else
          beyond.emplace_back(static_cast<int>(k), static_cast<int>(entry.row()), entry.value());
      }
    to_free_.setFromTriplets(to_free.begin(), to_free.end());
    beyond_.setFromTriplets(beyond.begin(), beyond.end());
  }

  /// S_ff^-1, of many columns at once: Eigen's takes them one by one.
  Eigen::MatrixXd solved(const Eigen::MatrixXd& right) const {
    RowMajor x = turn_ * right;
    const Sparse& lower = solver_.matrixL().nestedExpression();
    for (Index k = 0; k < count_; ++k)
      for (Sparse::InnerIterator entry(lower, k); entry; ++entry)
        if (entry.row() > k) x.row(entry.row()) -= entry.value() * x.row(k);
    x = solver_.vectorD().cwiseInverse().asDiagonal() * x;
    for (Index k = count_; k-- > 0;)
      for (Sparse::InnerIterator entry(lower, k); entry; ++entry)
        if (entry.row() > k) x.row(k) -= entry.value() * x.row(entry.row());
    return turn_.transpose() * x;
  }

  /// B f(A_f B') for a symmetric f.
  template <class F>
  Eigen::MatrixXd between_held(const F& f) const {
    const Index n = transfer_.cols();
    Eigen::MatrixXd out(n, n);
    for (Index k = 0; k < n; k += at_once) {
      const Index some = std::min(at_once, n - k);
      out.block(k, k, n - k, some) =
          transfer_.rightCols(n - k).transpose() * f(free_.asDiagonal() * transfer_.middleCols(k, some));
    }
    return out.selfadjointView<Eigen::Lower>();
  }

  /// B', A_b + B A_f B', and e.
  void take_transfer() {
    if (transfer_.size() > 0) return;
    transfer_.resize(count_, to_free_.cols());
    for (Index k = 0; k < transfer_.cols(); k += at_once) {
      const Index some = std::min(at_once, transfer_.cols() - k);
      transfer_.middleCols(k, some) = solved(Eigen::MatrixXd(to_free_.middleCols(k, some)));
    }
    second_ = between_held([](const Eigen::MatrixXd& weighed) { return weighed; });
    second_.diagonal() += held_;
    of_held_ = known_(beside_, Eigen::all) - transfer_.transpose() * known_.middleRows(first_, count_);
  }

  /// v of the free vertices: (A_b + B A_f B') m = e, v_f = -B' m.
  Eigen::MatrixXd min_second() {
    take_transfer();
    return -(transfer_ * SquareSystem(second_).solve(of_held_));
  }

  /// The same where v' S v is least: v_f = B' -> S_ff^-1 A_f B' m - B' v_b.
  Eigen::MatrixXd min_third() {
    take_transfer();
    const Index n = to_free_.cols();
    const Eigen::MatrixXd third =
        between_held([&](const Eigen::MatrixXd& weighed) -> Eigen::MatrixXd { return free_.asDiagonal() * solved(weighed); });
    Eigen::MatrixXd system(2 * n, 2 * n), right(2 * n, 3);
    system << -third, second_, second_, among_ - Eigen::MatrixXd(to_free_.transpose() * transfer_);
    right << of_held_, -(beyond_ * (areas_.cwiseInverse().asDiagonal() * known_));
    const Eigen::MatrixXd found = SquareSystem(system).solve(right);
    return solved(free_.asDiagonal() * (transfer_ * found.topRows(n))) - transfer_ * found.bottomRows(n);
  }

  Index first_, count_;
  Eigen::VectorXd areas_, free_, held_;                                 // of all vertices, the free ones and those next to them
  std::vector<Index> beside_;                                           // held, and joined to free ones
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> turn_;  // to the order of elimination
  Eigen::SimplicialLDLT<Sparse, Eigen::Upper, Eigen::NaturalOrdering<int>> solver_;
  bool regular_ = false;
  Sparse to_free_;  // S of the free ones by those next to
  Eigen::MatrixXd among_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> beyond_;  // S of those next to by all that is farther off
  Points known_, from_held_;                             // S x of what is held, and what it makes of the free ones
  Eigen::MatrixXd transfer_, second_, of_held_;
};

/// Of the higher of two orders: it overshoots farther, and errs more where it errs. Twice as much leaves 84 holes of scanned and modelled
/// meshes 1.7% farther from what was there, half 0.6% nearer.
constexpr double share_of_last = share::quarter;
/// Of the second model where surroundings are rough and have details: with all of `max_of_second` 216 holes of 25 meshes are 1.5% farther,
/// with none 1%.
constexpr double share_where_rough = 0.45;
/// Of an edge: where so much reads as noise, half of `max_of_second`. No scan has that much noise; it is details finer than edges. On
/// those meshes fills of rims with a sixth of an edge or more are 4 to 30% nearer with the second model alone than without.
constexpr double far_rough = 0.15, steepness_of_far = factor::large;
/// Of the second model, where there is little noise, but the likeliest order is lower than that of any known surface with noise up to 2%
/// of an edge (3.6). Chosen on 50 such holes.
constexpr double share_where_creased = share::quarter, order_where_creased = 3.5, steepness_of_order = 24;
/// Of it where details are faint: noise of about this share of an edge. A fifth of it leaves 33 such holes 3% nearer; surfaces that are
/// strongly curved, without noise, or under noise of 2% of an edge must have none.
constexpr double share_where_faint = share::quarter, half_faint = 0.005, beyond_faint = 0.012, steepness_of_faint = 8;

/// See mostly_details. Of 72 holes in meshes of animals under noise of a tenth to a third of an edge a quarter to twice of it changes two or
/// fewer; with four times as much five are 8% farther in the mean, without it seven 16%.
constexpr double min_of_details = share::fifth;

}  // namespace

std::optional<Points> minimize_bending(const Points& points, const std::vector<std::array<Index, 3>>& triangles,
                                       const std::vector<std::array<Index, 3>>& around, Index first, Index count, int order) {
  return Bending(points, triangles, around, first, count).least(order);
}

double share_of_details(double noise, double left_by_reference) {
  const double share = noise / std::max(left_by_reference, tolerance::tiny);
  return std::pow(1 - std::min(std::pow(share, 4), 1.0), 2);
}

bool mostly_details(double share) { return share > min_of_details; }

double share_of_second(const FieldFindings& s) {
  const double creased = 1 / (1 + std::pow(s.mean_order / order_where_creased, steepness_of_order));
  const double faint = s.noise / (s.noise + half_faint) / (1 + std::pow(s.noise / beyond_faint, steepness_of_faint));
  const double far = 1 / (1 + std::pow(far_rough / s.noise, steepness_of_far));
  double share = share_where_rough * s.roughness * s.details + share_where_creased * (1 - s.roughness) * creased;
  if (!s.strongly_curved) share = std::max(share, share_where_faint * faint * s.details);
  return share + (max_of_second - share) * far;
}

struct SecondModels::Own : Bending {
  using Bending::Bending;
};

SecondModels::SecondModels(const Points& points, const std::vector<std::array<Index, 3>>& triangles, const Disc& disc,
                           bool keep_planes) {
  const Index r = disc.rim, made = points.rows();
  Points all(made + disc.points.rows() - r, 3);
  all << points, disc.points.bottomRows(disc.points.rows() - r);
  std::vector<std::array<Index, 3>> around = disc.triangles;
  for (std::array<Index, 3>& t : around)
    for (Index& v : t)
      if (v >= r) v += made - r;
  std::vector<std::array<Index, 3>> own = triangles;
  if (!keep_planes) {
    own.insert(own.end(), around.begin(), around.end());
    around.clear();
  }
  own_ = std::make_unique<Own>(all, own, around, r, made - r);
}

SecondModels::SecondModels(SecondModels&&) noexcept = default;
SecondModels::~SecondModels() = default;

std::optional<SecondModel> SecondModels::by(const std::vector<int>& orders) {
  std::vector<Points> found;
  for (int order : orders)
    if (const std::optional<Points> each = own_->least(order)) found.push_back(*each);
  if (found.empty()) return {};
  const Points way = found.back() - found.front();
  SecondModel model{found.front() + share_of_last * way, std::sqrt(share_of_last * (1 - share_of_last)) * way};
  return model;
}

std::optional<SecondModel> second_model(const Points& points, const std::vector<std::array<Index, 3>>& triangles,
                                        const Disc& disc, const std::vector<int>& orders, bool keep_planes) {
  return SecondModels(points, triangles, disc, keep_planes).by(orders);
}

}  // namespace tripatch
