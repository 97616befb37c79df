#include "tripatch/fairing/fairing_problem.h"

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "tripatch/math/linear.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/places.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// So many are worth a thread: each takes a microsecond.
constexpr Index nodes_a_thread = count::many_places;

}  // namespace

double scale_to(double size, const PiecewisePolynomial& field) {
  double length = 0;
  for (const double t : evenly(16)) length += field(t).norm() / 17;
  return length > 0 ? size / length : 0;
}

std::vector<PiecewisePolynomial> slope_directions(const Side& side, const std::array<double, 2>& scale, bool position_only,
                                                  double size) {
  std::vector<PiecewisePolynomial> directions;
  if (position_only) {
    for (int x = 0; x < 3; ++x) {
      const Vec3 unit = size * Vec3::Unit(x);
      directions.push_back(PiecewisePolynomial::constant({unit.data(), 3}));
    }
  } else if (scale[0] != 0) {
    directions = {scale[0] * side.r, scale[1] * side.c.derivative()};
  }
  return directions;
}

double alpha_reach(const PiecewisePolynomial& alpha, const PiecewisePolynomial& added) {
  double most = std::numeric_limits<double>::infinity();
  for (int k = 1; k < 32; ++k) {
    const double t = static_cast<double>(k) / 32;
    double before, change;
    alpha.taylor(t, 0, &before);
    added.taylor(t, 0, &change);
    if (!(change >= 0)) most = std::min(most, -(1 - min_alpha_kept) * before / change);
  }
  return most;
}

FairingProblem::FairingProblem(const FairingBase& base, const FairingOptions& options, int nodes)
    : FairingProblem(base, options, fairing_space(options.degree, options.second_cross, options.slopes, nodes)) {}

FairingProblem::FairingProblem(const FairingBase& base, const FairingOptions& options, const FairingSpace& shared)
    : EnergyProblem(shared, cartesian_derivatives(*base.patch, shared.quadrature.b), options, base.boundary.size,
                    shared.normal[3].rows()),
      shared_(shared),
      sides_(base.sides),
      boundary_(base.boundary) {
  unknowns_.size = boundary_.size;
  unknowns_.interior = interior_;
  unknowns_.slopes = options.slopes;
  for (int i = 0; i < 3; ++i) {
    unknowns_.first[i] = unknowns_.slopes_count;
    unknowns_.slopes_count += options.slopes * static_cast<Index>(take_directions(i));
  }
  fields_ = unknowns_.slopes_count;
  following_.emplace(followed(base));
  const Index n = static_cast<Index>(base_.size());
  basis_.resize(27 * n, unknowns_.slopes_count);
  parallel_for(0, n, nodes_a_thread, [&](Index from, Index to) {
    for (Index k = from; k < to; ++k) add_slopes(k);
  });
}

/// The slopes of these sides are carried by slope_kernel: it grows by 2 (1/2 - t) their own slope across.
CurvatureFollowing FairingProblem::followed(const FairingBase& base) const {
  const SideBasis& along = shared_.along;
  std::vector<FollowedSide> all;
  for (int i = 0; i < 3; ++i) {
    if (!options_.curvature[i] || sides_[i].q.empty() || unknowns_.scale[i][0] == 0) continue;
    const Ribbon& ribbon = boundary_.ribbons[i];
    FollowedSide side =
        followed_side(sides_[i], i, ribbon.alpha, ribbon.beta, along.t, derivatives_across(*base.patch, i, along.t));
    for (int k = 0; k < SideBasis::points; ++k) side.skew[k] = 2 * (0.5 - along.t[k]);
    side.first = scalars() + unknowns_.first[i];
    side.scale = unknowns_.scale[i];
    all.push_back(side);
  }
  return {along, std::move(all), 3, size_, options_.curvature_jump};
}

Eigen::MatrixXd FairingProblem::held() const {
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(options_.center ? 3 : 0, count());
  if (!options_.center) return rows;
  for (int x = 0; x < 3; ++x) rows.row(x).segment(x * unknowns_.interior, unknowns_.interior) = unknowns_.size * shared_.center;
  for (int i = 0; i < 3; ++i)
    for (std::size_t f = 0; f < directions_[i].size(); ++f)
      rows.middleCols(scalars() + unknowns_.first[i] + f * options_.slopes, options_.slopes) =
          directions_[i][f](0.5) * shared_.center_slope;
  return rows;
}

Eigen::VectorXd FairingProblem::raised(const FairingProblem& lower, const Eigen::VectorXd& x) const {
  if (lower.options_.degree == options_.degree) return x;
  Eigen::VectorXd out(count());
  out.tail(unknowns_.slopes_count) = x.tail(unknowns_.slopes_count);
  const Points a = lower.shared_.combination * Eigen::Map<const Eigen::MatrixXd>(x.data(), lower.unknowns_.interior, 3);
  BezierTriangle inside(a.topRows(BezierTriangle::net_size(lower.options_.degree)));
  while (inside.degree() < options_.degree) inside = inside.elevated();
  Eigen::MatrixXd all(unknowns_.interior, 3);
  all << inside.net(), a.bottomRows(3 * options_.second_cross);
  Eigen::Map<Eigen::MatrixXd>(out.data(), unknowns_.interior, 3) = solve_upper_triangular(shared_.combination, all);
  return out;
}

double FairingProblem::reach(const Eigen::VectorXd& x) const {
  double most = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (unknowns_.scale[i][0] == 0) continue;
    most = std::min(most, alpha_reach(boundary_.ribbons[i].alpha, unknowns_.scale[i][0] * combination(x, i, 0)));
  }
  return most;
}

SurfacePtr FairingProblem::correction(const Eigen::VectorXd& x, const Sides& sides) const {
  std::array<PiecewisePolynomial, 3> slopes;
  for (int i = 0; i < 3; ++i) {
    const std::array<double, 3> none = {0, 0, 0};
    slopes[i] = PiecewisePolynomial::constant(none);
    const std::vector<PiecewisePolynomial> directions = directions_of(sides[i], i);
    for (std::size_t f = 0; f < directions.size(); ++f) slopes[i] = slopes[i] + combination(x, i, f) * directions[f];
  }
  Points a(unknowns_.interior, 3);
  for (int c = 0; c < 3; ++c)
    a.col(c) = unknowns_.size * (shared_.combination * x.segment(c * unknowns_.interior, unknowns_.interior));
  return tripatch::correction(slopes, options_.degree, options_.second_cross, a);
}

/// The derivatives, at a node, of what the free slopes add.
void FairingProblem::add_slopes(Index node) {
  const int slopes = options_.slopes;
  RowMajor made(4, 9 * slopes);  // a row a component, the last unused
  for (int i = 0; i < 3; ++i)
    for (std::size_t f = 0; f < directions_[i].size(); ++f) {
      const FairingSpace::Slope& slope = shared_.slope[node][i];
      Eigen::Matrix<double, 3, 4> series;  // of the direction, an order a column
      directions_[i][f].taylor(slope.t, 3, series.data());
      Eigen::Matrix<double, 4, 4, Eigen::RowMajor> components = Eigen::Matrix4d::Zero();
      components.topRows<3>() = series;
      multiply_four(components.data(), 4, slope.rows.data(), made.cols(), made.data(), made.cols());
      const Index at = unknowns_.first[i] + static_cast<Index>(f) * slopes;
      double* to = basis_.data() + 27 * node * fields_ + at;
      for (int d = 0; d < 9; ++d)
        for (int x = 0; x < 3; ++x, to += fields_) {
          const double* const from = made.data() + x * made.cols() + d * slopes;
          if (slopes == usual_slopes)
            std::copy_n(from, usual_slopes, to);  // a number that is known when this is compiled
          else
            std::copy_n(from, slopes, to);
        }
    }
}

std::vector<PiecewisePolynomial> FairingProblem::directions_of(const Side& side, int i) const {
  return slope_directions(side, unknowns_.scale[i], options_.position_only[i], unknowns_.size);
}

std::size_t FairingProblem::take_directions(int i) {
  if (options_.slopes_free[i] && !options_.position_only[i] && !sides_[i].r.empty())
    unknowns_.scale[i] = {scale_to(unknowns_.size, sides_[i].r), scale_to(unknowns_.size, sides_[i].c.derivative())};
  directions_[i] = directions_of(sides_[i], i);
  return directions_[i].size();
}

PiecewisePolynomial FairingProblem::combination(const Eigen::VectorXd& x, int i, std::size_t direction) const {
  const std::size_t m = options_.slopes;
  return slope_function({&x[scalars() + unknowns_.first[i] + static_cast<Index>(direction * m)], m});
}

}  // namespace tripatch
