#include "tripatch/fairing/fairing_problem.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/fairing/energy.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/parallel.h"

namespace tripatch {
namespace {

/// Where alpha falls below this part of what it was, the patch is about to turn back over its side.
constexpr double least_alpha = 0.1;

}  // namespace

double scale_to(double size, const PiecewisePolynomial& field) {
  double length = 0;
  for (int k = 0; k <= 16; ++k) length += field(k / 16.0).norm() / 17;
  return length > 0 ? size / length : 0;
}

double alpha_reach(const Boundary& boundary, int i, const PiecewisePolynomial& added) {
  double most = std::numeric_limits<double>::infinity();
  for (int k = 1; k < 32; ++k) {
    double before, change;
    boundary.ribbons[i].alpha.taylor(k / 32.0, 0, &before);
    added.taylor(k / 32.0, 0, &change);
    if (!(change >= 0)) most = std::min(most, -(1 - least_alpha) * before / change);
  }
  return most;
}

FairingProblem::FairingProblem(const FairingBase& base, const FairingOptions& options, int nodes)
    : shared_(fairing_space(options.degree, options.second_cross, options.slopes, nodes)),
      base_(cartesian_derivatives(*base.patch, shared_.quadrature.b)),
      sides_(base.sides),
      boundary_(base.boundary),
      options_(options) {
  unknowns_.size = boundary_.size;
  unknowns_.interior = shared_.normal[3].rows();
  unknowns_.slopes = options.slopes;
  for (int i = 0; i < 3; ++i) {
    unknowns_.first[i] = unknowns_.slopes_count;
    unknowns_.slopes_count += options.slopes * static_cast<Index>(take_directions(i));
  }
  following_.emplace(shared_, unknowns_, base, options);
  const Index n = static_cast<Index>(base_.size());
  basis_.setZero(27 * n, unknowns_.slopes_count);
  for (Index k = 0; k < n; ++k) add_slopes(k);
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

/// Of the patch, at the nodes [from, to).
std::vector<Derivatives> FairingProblem::derivatives(Index from, Index to, const Eigen::VectorXd& x) const {
  std::vector<Derivatives> d(base_.begin() + from, base_.begin() + to);
  const Index n = to - from;
  Eigen::Map<Eigen::VectorXd> all(d[0].data(), 27 * n);
  const Eigen::VectorXd scalars = unknowns_.size * x.head(3 * unknowns_.interior);
  add_product(shared_.interior.row(9 * from).data(), 9 * n, unknowns_.interior, scalars.data(), d[0].data());
  all.noalias() += basis_.middleRows(27 * from, 27 * n) * x.tail(unknowns_.slopes_count);
  return d;
}

Quadratic FairingProblem::quadratic(int order) const {
  const int rows = order + 1, first = FairingSpace::first_of(order);
  const Index n = static_cast<Index>(base_.size());
  const Eigen::MatrixXd &inner = shared_.rows[order], &inner_normal = shared_.normal[order];
  Quadratic q;
  q.normal.setZero(count(), count());
  q.gradient.setZero(count());
  Eigen::MatrixXd slope(rows * n, unknowns_.slopes_count);
  Eigen::VectorXd value(rows * n);
  for (int c = 0; c < 3; ++c) {
    for (Index k = 0; k < n; ++k) {
      const double w = std::sqrt(shared_.quadrature.weights[k]) / unknowns_.size;
      for (int d = 0; d < rows; ++d) {
        const double f = w * FairingSpace::factor(order, d);
        slope.row(rows * k + d) = f * basis_.row(27 * k + 3 * (first + d) + c);
        value[rows * k + d] = f * base_[k](first + d, c);
      }
    }
    const Index at = c * unknowns_.interior;
    q.normal.block(at, at, unknowns_.interior, unknowns_.interior) = inner_normal;
    q.normal.block(at, scalars(), unknowns_.interior, unknowns_.slopes_count).noalias() = inner.transpose() * slope;
    q.normal.bottomRightCorner(unknowns_.slopes_count, unknowns_.slopes_count).noalias() += slope.transpose() * slope;
    q.gradient.segment(at, unknowns_.interior).noalias() = inner.transpose() * value;
    q.gradient.tail(unknowns_.slopes_count).noalias() += slope.transpose() * value;
    q.constant += value.squaredNorm();
  }
  q.normal.bottomLeftCorner(unknowns_.slopes_count, scalars()) =
      q.normal.topRightCorner(scalars(), unknowns_.slopes_count).transpose();
  return q;
}

std::pair<double, double> FairingProblem::variation(const Eigen::VectorXd& x) const {
  double variation = 0, quadric = 0;
  const std::vector<Derivatives> d = derivatives(0, static_cast<Index>(base_.size()), x);
  for (std::size_t k = 0; k < d.size(); ++k) {
    const CurvatureVariation v = curvature_variation(d[k], flat_curvature(unknowns_.size));
    const double w = shared_.quadrature.weights[k] * unknowns_.size * unknowns_.size * v.area;
    variation += w * v.variation.squaredNorm();
    quadric += w * v.quadric.squaredNorm();
  }
  return {variation, quadric};
}

std::array<Quadratic, 2> FairingProblem::linearized(const Eigen::VectorXd& x, const std::array<bool, 2>& wanted) const {
  // in blocks of nodes, always the same, so that sums do not depend on the number of cores
  constexpr Index block = 96;
  const Index n = static_cast<Index>(base_.size()), blocks = (n + block - 1) / block;
  std::vector<std::array<Quadratic, 2>> parts(blocks);
  parallel_for(0, blocks, 2, [&](Index from, Index to) {
    for (Index at = from; at < to; ++at) parts[at] = linearized(x, wanted, at * block, std::min(n, (at + 1) * block));
  });
  std::array<Quadratic, 2> model = std::move(parts[0]);
  for (Index at = 1; at < blocks; ++at)
    for (int which = 0; which < 2; ++which)
      if (wanted[which]) model[which] += parts[at][which];
  return model;
}

/// The same of some of the nodes.
std::array<Quadratic, 2> FairingProblem::linearized(const Eigen::VectorXd& x, const std::array<bool, 2>& wanted, Index from,
                                                    Index to) const {
  constexpr Index block = 12;  // nodes: their rows stay in the cache
  std::array<Quadratic, 2> model;
  std::array<RowMajor, 2> jacobian, normal;
  std::array<Eigen::VectorXd, 2> value;
  for (int which = 0; which < 2; ++which) {
    if (!wanted[which]) continue;
    normal[which].setZero(count(), count());
    model[which].gradient.setZero(count());
  }
  for (Index start = from; start < to; start += block) {
    const Index n = std::min(block, to - start);
    for (int which = 0; which < 2; ++which) {
      if (!wanted[which]) continue;
      jacobian[which].resize(4 * n, count());
      value[which].resize(4 * n);
    }
    const std::vector<Derivatives> d = derivatives(start, start + n, x);
    for (Index k = start; k < start + n; ++k) {
      const CurvatureVariationRows v = curvature_variation_rows(d[k - start], flat_curvature(unknowns_.size));
      const double w = std::sqrt(shared_.quadrature.weights[k]) * unknowns_.size;
      const Index row = 4 * (k - start);
      for (int which = 0; which < 2; ++which) {
        if (!wanted[which]) continue;
        value[which].segment<4>(row) = w * v.value.segment<4>(4 * which);
        const Eigen::Matrix<double, 4, 27, Eigen::RowMajor> rows = w * v.derivative.middleRows<4>(4 * which);
        double* const out = jacobian[which].row(row).data();
        for (int c = 0; c < 3; ++c) {
          Eigen::Matrix<double, 4, 9, Eigen::RowMajor> part;
          for (int d = 0; d < 9; ++d) part.col(d) = unknowns_.size * rows.col(3 * d + c);
          multiply_four(part.data(), 9, shared_.interior.row(9 * k).data(), unknowns_.interior, out + c * unknowns_.interior,
                        count());
        }
        multiply_four(rows.data(), 27, basis_.row(27 * k).data(), unknowns_.slopes_count, out + scalars(), count());
      }
    }
    for (int which = 0; which < 2; ++which) {
      if (!wanted[which]) continue;
      add_gram(jacobian[which], normal[which]);
      model[which].gradient.noalias() += jacobian[which].transpose() * value[which];
      model[which].constant += value[which].squaredNorm();
    }
  }
  for (int which = 0; which < 2; ++which)
    if (wanted[which]) model[which].normal = normal[which].selfadjointView<Eigen::Lower>();
  return model;
}

double FairingProblem::reach(const Eigen::VectorXd& x) const {
  double most = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    if (unknowns_.scale[i][0] == 0) continue;
    most = std::min(most, alpha_reach(boundary_, i, unknowns_.scale[i][0] * combination(x, i, 0)));
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
  return tripatch::correction(std::move(slopes), options_.degree, options_.second_cross, a);
}

/// The derivatives, at a node, of what the free slopes add.
void FairingProblem::add_slopes(Index node) {
  for (int i = 0; i < 3; ++i)
    for (std::size_t f = 0; f < directions_[i].size(); ++f) {
      const FairingSpace::Slope& slope = shared_.slope[node][i];
      Eigen::Matrix<double, 4, 3, Eigen::RowMajor> series;  // of the direction
      directions_[i][f].taylor(slope.t, 3, series.data());
      for (int m = 0; m < options_.slopes; ++m) {
        const Derivatives d = slope.rows.middleRows<9>(9 * m).lazyProduct(series);
        basis_.block<27, 1>(27 * node, unknowns_.first[i] + f * options_.slopes + m) =
            Eigen::Map<const Eigen::Matrix<double, 27, 1>>(d.data());
      }
    }
}

/// What the derivative across side i may gain, each times the functions of t: r and c', or, where the side asks for its position
/// only, any direction; nothing where it is held.
std::vector<PiecewisePolynomial> FairingProblem::directions_of(const Side& side, int i) const {
  std::vector<PiecewisePolynomial> directions;
  if (options_.position_only[i]) {
    for (int x = 0; x < 3; ++x) {
      const Vec3 unit = unknowns_.size * Vec3::Unit(x);
      directions.push_back(PiecewisePolynomial::constant({unit.data(), 3}));
    }
  } else if (unknowns_.scale[i][0] > 0) {
    directions = {unknowns_.scale[i][0] * side.r, unknowns_.scale[i][1] * side.c.derivative()};
  }
  return directions;
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
