#include "tripatch/spline/least_bent.h"

#include <Eigen/Geometry>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace tripatch {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Cotangents of angles below half a degree, and areas below this share of the mean, come of triangles that are all but an edge.
constexpr double steepest = 100, least_area = 1e-3;

/// Weights of the edges and areas of the vertices of some triangles.
struct Measures {
  std::vector<Eigen::Triplet<double>> weights;  // entries of the Laplacian, positive on its diagonal
  Eigen::VectorXd areas;
};

Measures measured(const Points& points, const std::vector<std::array<Index, 3>>& triangles) {
  Measures out;
  out.areas = Eigen::VectorXd::Zero(points.rows());
  double sum = 0;
  for (const std::array<Index, 3>& t : triangles) {
    const Vec3 p[3] = {points.row(t[0]), points.row(t[1]), points.row(t[2])};
    const double twice = (p[1] - p[0]).cross(p[2] - p[0]).norm();
    sum += twice / 2;
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      const double cotangent = std::clamp(u.dot(v) / std::max(twice, 1e-300), -steepest, steepest) / 2;
      const int a = static_cast<int>(t[(k + 1) % 3]), b = static_cast<int>(t[(k + 2) % 3]);
      out.weights.insert(out.weights.end(), {{a, b, -cotangent}, {b, a, -cotangent}, {a, a, cotangent}, {b, b, cotangent}});
      out.areas[t[k]] += twice / 6;
    }
  }
  out.areas = out.areas.cwiseMax(least_area * sum / static_cast<double>(std::max<std::size_t>(triangles.size(), 1)));
  return out;
}

using Upper = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Upper, Eigen::NaturalOrdering<int>>;

/// Energies of increasing orders, each made of the one before, of the same free vertices.
class Bending {
public:
  Bending(const Points& points, const std::vector<std::array<Index, 3>>& triangles, Index first, Index count)
      : points_(points), first_(first), count_(count), stiffness_(points.rows(), points.rows()) {
    const Measures measures = measured(points, triangles);
    stiffness_.setFromTriplets(measures.weights.begin(), measures.weights.end());
    inverse_ = measures.areas.cwiseInverse();
    energy_ = stiffness_.middleRows(first, count);  // the rows of the free ones
  }

  /// Not lower than the order before.
  std::optional<Points> least(int order) {
    for (; order_ < order; ++order_) energy_ = SparseRows(energy_ * inverse_.asDiagonal()) * stiffness_;
    std::vector<Eigen::Triplet<double>> entries;  // of the lower half
    Points right = Points::Zero(count_, 3);
    for (int row = 0; row < count_; ++row)
      for (SparseRows::InnerIterator entry(energy_, row); entry; ++entry) {
        const Index column = entry.col() - first_;
        if (column < 0 || column >= count_)
          right.row(row) -= entry.value() * points_.row(entry.col());
        else if (column <= row)
          entries.emplace_back(row, static_cast<int>(column), entry.value());
      }
    Eigen::SparseMatrix<double> lower(count_, count_), turned(count_, count_);
    lower.setFromTriplets(entries.begin(), entries.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> back;  // from the order of elimination
    Eigen::AMDOrdering<int>()(lower.selfadjointView<Eigen::Lower>(), back);
    const Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> turn(back.inverse());
    turned.selfadjointView<Eigen::Upper>() = lower.selfadjointView<Eigen::Lower>().twistedBy(turn);
    const Upper solver(turned);
    if (solver.info() != Eigen::Success) return {};
    Points out = back * solver.solve(Points(turn * right));
    if (!out.allFinite()) return {};
    return out;
  }

private:
  const Points& points_;
  Index first_, count_;
  SparseRows stiffness_, energy_;
  Eigen::VectorXd inverse_;  // of the vertices' areas
  int order_ = 1;
};

/// Of the higher of two orders: it runs on farther, and errs more where it errs. Twice as much leaves 84 holes of scanned and modelled
/// meshes 1.7% farther from what was there, half 0.6% nearer.
constexpr double share_of_last = 0.25;
/// Of the second model where surroundings are rough and have details: with all of `most_of_second` 216 holes of 25 meshes are 1.5% farther,
/// with none 1%.
constexpr double share_where_rough = 0.45;
/// Of an edge: where so much reads as noise, half of `most_of_second`. No scan has that much noise; it is details finer than edges. On
/// those meshes fills of rims with a sixth of an edge or more are 4 to 30% nearer with the second model alone than without.
constexpr double far_rough = 0.15, steepness_of_far = 4;
/// Of the second model, where there is little noise, but the likeliest order is lower than that of any known surface with noise up to 2%
/// of an edge (3.6). Chosen on 50 such holes.
constexpr double share_where_creased = 0.25, order_where_creased = 3.5, steepness_of_order = 24;
/// Of it where details are faint: noise of about this share of an edge. A fifth of it leaves 33 such holes 3% nearer; surfaces that are
/// strongly curved, without noise, or under noise of 2% of an edge must have none.
constexpr double share_where_faint = 0.25, half_faint = 0.005, beyond_faint = 0.012, steepness_of_faint = 8;

/// See mostly_details. Of 72 holes in meshes of animals under noise of a tenth to a third of an edge a quarter to twice of it changes two or
/// fewer; with four times as much five are 8% farther in the mean, without it seven 16%.
constexpr double least_of_details = 0.2;

}  // namespace

std::optional<Points> least_bent(const Points& points, const std::vector<std::array<Index, 3>>& triangles, Index first,
                                 Index count, int order) {
  return Bending(points, triangles, first, count).least(order);
}

double share_of_details(double noise, double left_by_reference) {
  const double share = noise / std::max(left_by_reference, 1e-300);
  return std::pow(1 - std::min(std::pow(share, 4), 1.0), 2);
}

bool mostly_details(double share) { return share > least_of_details; }

double share_of_second(const FieldFindings& s) {
  const double creased = 1 / (1 + std::pow(s.mean_order / order_where_creased, steepness_of_order));
  const double faint = s.noise / (s.noise + half_faint) / (1 + std::pow(s.noise / beyond_faint, steepness_of_faint));
  const double far = 1 / (1 + std::pow(far_rough / s.noise, steepness_of_far));
  double share = share_where_rough * s.roughness * s.details + share_where_creased * (1 - s.roughness) * creased;
  if (!s.strongly_curved) share = std::max(share, share_where_faint * faint * s.details);
  return share + (most_of_second - share) * far;
}

std::optional<SecondModel> second_model(const Points& points, const std::vector<std::array<Index, 3>>& triangles,
                                        const Disc& disc, const std::vector<int>& orders) {
  const Index r = disc.rim, made = points.rows();
  Points all(made + disc.points.rows() - r, 3);
  all << points, disc.points.bottomRows(disc.points.rows() - r);
  std::vector<std::array<Index, 3>> both = triangles;
  for (std::array<Index, 3> t : disc.triangles) {
    for (Index& v : t)
      if (v >= r) v += made - r;
    both.push_back(t);
  }
  std::vector<Points> found;
  Bending bending(all, both, r, made - r);
  for (int order : orders)
    if (const std::optional<Points> each = bending.least(order)) found.push_back(*each);
  if (found.empty()) return {};
  const Points way = found.back() - found.front();
  SecondModel model{found.front() + share_of_last * way, std::sqrt(share_of_last * (1 - share_of_last)) * way};
  return model;
}

}  // namespace tripatch
