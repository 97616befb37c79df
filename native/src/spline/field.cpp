#include "tripatch/spline/field.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/math/interruption.h"

namespace tripatch {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// So many samples decide on order and nugget: the time grows with their cube, and more changed the choice in none of some hundred
/// holes that were tried.
constexpr Index deciding_samples = 160;
/// Nuggets that are tried, over the mean eigenvalue of the kernel: decades, from rounding to a field that is all noise.
constexpr double lowest_nugget = -14, highest_nugget = 4, nugget_step = 0.5;
/// A nugget up to here is rounding: the samples are met.
constexpr double exact_nugget = -12.5;
/// Logarithms of likelihoods are divided by this share of the number of samples before orders are averaged: neighboring samples of
/// a real surface tell much the same. Measured on 37 known surfaces with noise and 35 holes of scanned and modelled meshes.
constexpr double tempering = 0.1;
/// Surroundings whose noise is this share of an edge, or more, are not sampled finely enough to tell how they go on: the lowest two
/// orders, which run on least, are taken instead of the likeliest. Measured as above: noise of 0.02 edges stays below it.
constexpr double rough_noise = 0.03;
/// Orders with less than this share are left out of the average.
constexpr double least_share = 0.02;
/// Distance from a sample, in normalised coordinates, at which derivatives are taken that have no limit there.
constexpr double least_distance = 1e-7;

int polynomials(int order) { return order * (order + 1) / 2; }

/// Monomials of degree below the order at points, n x q.
MatrixXd monomials(const PlanePoints& c, int order) {
  MatrixXd out(c.rows(), polynomials(order));
  int column = 0;
  for (int i = 0; i < order; ++i)
    for (int j = 0; i + j < order; ++j, ++column)
      for (Index k = 0; k < c.rows(); ++k) out(k, column) = std::pow(c(k, 0), i) * std::pow(c(k, 1), j);
  return out;
}

/// Their derivatives by one of the coordinates.
MatrixXd monomial_slopes(const PlanePoints& c, int order, int axis) {
  MatrixXd out(c.rows(), polynomials(order));
  int column = 0;
  for (int i = 0; i < order; ++i)
    for (int j = 0; i + j < order; ++j, ++column) {
      const int degree = axis == 0 ? i : j, other = axis == 0 ? j : i;
      for (Index k = 0; k < c.rows(); ++k)
        out(k, column) = degree > 0 ? degree * std::pow(c(k, axis), degree - 1) * std::pow(c(k, 1 - axis), other) : 0;
    }
  return out;
}

/// Kernel of squared distances: (-1)^m s^(m-1) log(s) / 2, with the limit 0 at 0.
void apply_kernel(int order, Eigen::Ref<MatrixXd> s) {
  const double sign = order % 2 == 0 ? 0.5 : -0.5;
  const auto power = [&](const auto& x) -> Eigen::ArrayXXd {
    Eigen::ArrayXXd p = x;
    for (int k = 2; k < order; ++k) p *= x;
    return p;
  };
  const Eigen::ArrayXXd x = s.array();
  s = sign * power(x) * x.max(std::numeric_limits<double>::min()).log();
}

MatrixXd squared_distances(const PlanePoints& a, const PlanePoints& b) {
  MatrixXd s(a.rows(), b.rows());
  for (Index j = 0; j < b.rows(); ++j) s.col(j) = (a.col(0).array() - b(j, 0)).square() + (a.col(1).array() - b(j, 1)).square();
  return s;
}

/// The kernel among samples, seen through contrasts: combinations of samples in which polynomials cancel.
struct Contrasts {
  Contrasts(const PlanePoints& c, int order) : qr(monomials(c, order)), q(polynomials(order)), kernel(squared_distances(c, c)) {
    apply_kernel(order, kernel);
    MatrixXd turned = kernel;
    turned.applyOnTheLeft(qr.householderQ().adjoint());
    turned.applyOnTheRight(qr.householderQ());
    inner = turned.bottomRightCorner(c.rows() - q, c.rows() - q);
  }
  MatrixXd of(const MatrixXd& samples) const {
    MatrixXd z = samples;
    z.applyOnTheLeft(qr.householderQ().adjoint());
    return z.bottomRows(samples.rows() - q);
  }
  /// Combinations of samples from combinations of contrasts.
  MatrixXd back(const MatrixXd& z) const {
    MatrixXd full = MatrixXd::Zero(z.rows() + q, z.cols());
    full.bottomRows(z.rows()) = z;
    full.applyOnTheLeft(qr.householderQ());
    return full;
  }

  Eigen::HouseholderQR<MatrixXd> qr;
  Index q;
  MatrixXd kernel, inner;
};

struct Likelihood {
  double logarithm = -std::numeric_limits<double>::infinity();
  double decade = 0;    // of the nugget
  double nugget = 0;    // over the kernel's unit
  double variance = 0;  // of the kernel's unit
};

/// The restricted likelihood of one order at its best nugget: samples vary in one direction, across the surface. The contrasts'
/// kernel is made tridiagonal once, after which a nugget costs no more than its samples.
Likelihood likelihood_of(const Contrasts& contrasts, const MatrixXd& samples) {
  const Eigen::Tridiagonalization<MatrixXd> decomposed(contrasts.inner);
  const VectorXd diagonal = decomposed.diagonal(), beside = decomposed.subDiagonal();
  MatrixXd z = contrasts.of(samples);
  z.applyOnTheLeft(decomposed.matrixQ().adjoint());
  const Index n = z.rows();
  const double unit = diagonal.mean();
  Likelihood best;
  for (double decade = lowest_nugget; decade <= highest_nugget; decade += nugget_step) {
    const double nugget = std::pow(10.0, decade) * unit;
    double pivot = diagonal[0] + nugget, logarithms = std::log(pivot);
    Eigen::RowVectorXd y = z.row(0);
    double squares = y.squaredNorm() / pivot;
    bool definite = pivot > 0;
    for (Index k = 1; k < n && definite; ++k) {
      const double l = beside[k - 1] / pivot;
      y = z.row(k) - l * y;
      pivot = diagonal[k] + nugget - l * beside[k - 1];
      definite = pivot > 0;
      logarithms += std::log(pivot);
      squares += y.squaredNorm() / pivot;
    }
    if (!definite) continue;
    const double variance = std::max(squares / static_cast<double>(n), 1e-300);
    const double logarithm = -0.5 * static_cast<double>(n) * std::log(variance) - 0.5 * logarithms;
    if (logarithm > best.logarithm) best = {logarithm, decade, nugget, variance};
  }
  return best;
}

}  // namespace

Field::Field(const PlanePoints& points, const Points& samples, const FieldOptions& options) {
  const Index n = points.rows();
  if (n < 4 || samples.rows() != n) throw InvalidArgument("a field needs four samples or more, one at each point");
  if (!points.allFinite() || !samples.allFinite()) throw InvalidArgument("points and samples of a field must be finite");
  middle_ = points.colwise().mean();
  size_ = (points.rowwise() - middle_).cwiseAbs().maxCoeff();
  if (!(size_ > 0)) throw InvalidArgument("the points of a field are all one");
  points_ = normalised(points);
  origin_ = samples.colwise().mean();
  const Points local = samples.rowwise() - origin_;
  const Index few = std::min(n, deciding_samples);
  few_.resize(few, 2);
  Points values(few, 3);
  for (Index k = 0; k < few; ++k) {
    few_.row(k) = points_.row(k * n / few);
    values.row(k) = local.row(k * n / few);
  }
  choose(few_, values, options);
  for (Part& part : parts_) fit(part, local);
}

PlanePoints Field::normalised(const PlanePoints& points) const { return (points.rowwise() - middle_) / size_; }

void Field::choose(const PlanePoints& few, const Points& samples, const FieldOptions& options) {
  const Index n = few.rows();
  const MatrixXd y = samples / options.unit;
  std::vector<Likelihood> found;
  std::vector<int> orders;
  for (int order : options.orders) {
    if (order != options.orders.front() && polynomials(order) > n / 3) continue;
    if (polynomials(order) >= n) continue;
    orders.push_back(order);
    found.push_back(likelihood_of(Contrasts(few, order), y));
  }
  if (orders.empty()) {  // a handful of samples: a plane
    orders = {2};
    found = {{0, 0, 0, 0}};
  }
  double most = -std::numeric_limits<double>::infinity(), sum = 0;
  for (const Likelihood& l : found) most = std::max(most, l.logarithm);
  if (!std::isfinite(most)) throw InvalidArgument("the points of a field lie on a line");
  likelihood_ = most;
  const double temperature = tempering * static_cast<double>(n);
  for (std::size_t k = 0; k < found.size(); ++k) {
    Part part;
    part.order = orders[k];
    part.share = std::exp((found[k].logarithm - most) / temperature);
    part.nugget = found[k].decade <= exact_nugget ? 0 : found[k].nugget;
    part.variance = found[k].variance * options.unit * options.unit;
    sum += part.share;
    parts_.push_back(std::move(part));
  }
  for (Part& part : parts_) part.share /= sum;
  hedge(options.unit);
  for (Part& part : parts_) {
    noise_ += part.share * std::sqrt(part.nugget * part.variance);
    mean_order_ += part.share * part.order;
  }
}

void Field::hedge(double unit) {
  double noise = 0, sum = 0;
  for (const Part& part : parts_) noise += part.share * std::sqrt(part.nugget * part.variance);
  const double smooth = 1 / (1 + std::pow(noise / (rough_noise * unit), 4));
  const Index low = std::min<Index>(2, static_cast<Index>(parts_.size()));
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    parts_[k].share *= smooth;
    if (static_cast<Index>(k) < low) parts_[k].share += (1 - smooth) / static_cast<double>(low);
  }
  std::erase_if(parts_, [](const Part& part) { return part.share < least_share; });
  for (const Part& part : parts_) sum += part.share;
  for (Part& part : parts_) part.share /= sum;
}

void Field::fit(Part& part, const Points& samples) const {
  const Contrasts contrasts(points_, part.order);
  MatrixXd inner = contrasts.inner;
  const double unit = inner.diagonal().mean();
  const MatrixXd z = contrasts.of(samples);
  MatrixXd solved;
  for (double nugget = std::max(part.nugget, std::pow(10.0, lowest_nugget) * unit);; nugget *= 10) {
    inner.diagonal() = contrasts.inner.diagonal().array() + nugget;
    const Eigen::LLT<MatrixXd> factor(inner);
    if (factor.info() != Eigen::Success && nugget < unit) continue;
    solved = factor.solve(z);
    part.weights = contrasts.back(solved);
    MatrixXd rest = samples - contrasts.kernel * part.weights - nugget * part.weights;
    rest.applyOnTheLeft(contrasts.qr.householderQ().adjoint());
    part.polynomial = contrasts.qr.matrixQR()
                          .topLeftCorner(contrasts.q, contrasts.q)
                          .triangularView<Eigen::Upper>()
                          .solve(rest.topRows(contrasts.q));
    return;
  }
}

void Field::values(const Part& part, const double* rows, Index n, double* out) const {
  constexpr Index block = 64;  // points: their distances from some hundred samples stay in the cache
  for (Index from = 0; from < n; from += block) {
    check_interruption();
    const Index count = std::min(block, n - from);
    PlanePoints at(count, 2);
    for (Index k = 0; k < count; ++k)
      at.row(k) = (Eigen::RowVector2d(rows[3 * (from + k)], rows[3 * (from + k) + 1]) - middle_) / size_;
    MatrixXd kernel = squared_distances(at, points_);
    apply_kernel(part.order, kernel);
    Eigen::Map<Points>(out + 3 * from, count, 3) +=
        part.share * (kernel * part.weights + monomials(at, part.order) * part.polynomial);
  }
}

void Field::values_and_slopes(const Part& part, const double* rows, Index n, double* out) const {
  constexpr Index block = 64;
  const int m = part.order;
  const double sign = m % 2 == 0 ? 0.5 : -0.5;
  for (Index from = 0; from < n; from += block) {
    check_interruption();
    const Index count = std::min(block, n - from);
    PlanePoints at(count, 2);
    for (Index k = 0; k < count; ++k)
      at.row(k) = (Eigen::RowVector2d(rows[3 * (from + k)], rows[3 * (from + k) + 1]) - middle_) / size_;
    const Eigen::ArrayXXd s = squared_distances(at, points_).array().max(least_distance * least_distance);
    const Eigen::ArrayXXd logarithm = s.log();
    Eigen::ArrayXXd power = Eigen::ArrayXXd::Constant(s.rows(), s.cols(), sign);  // of s^(m - 2)
    for (int k = 2; k < m; ++k) power *= s;
    const MatrixXd kernel = (power * s * logarithm).matrix();
    const Eigen::ArrayXXd slope = 2 / size_ * power * ((m - 1) * logarithm + 1);  // by half of the squared distance
    const MatrixXd by_u =
        (slope * (at.col(0).replicate(1, s.cols()) - points_.col(0).transpose().replicate(count, 1)).array()).matrix();
    const MatrixXd by_v =
        (slope * (at.col(1).replicate(1, s.cols()) - points_.col(1).transpose().replicate(count, 1)).array()).matrix();
    const Points p = kernel * part.weights + monomials(at, m) * part.polynomial;
    const Points u = by_u * part.weights + monomial_slopes(at, m, 0) / size_ * part.polynomial;
    const Points v = by_v * part.weights + monomial_slopes(at, m, 1) / size_ * part.polynomial;
    for (Index k = 0; k < count; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        double* to = out + 9 * (from + k) + axis;
        to[0] += part.share * p(k, axis);
        to[3] += part.share * u(k, axis);
        to[6] += part.share * v(k, axis);
      }
  }
}

template <int N>
void Field::jets(const Part& part, const double* rows, Index n, double* out) const {
  const int m = part.order;
  const double sign = m % 2 == 0 ? 0.5 : -0.5, step = 1 / size_;
  for (Index k = 0; k < n; ++k) {
    const Eigen::RowVector2d at = (Eigen::RowVector2d(rows[3 * k], rows[3 * k + 1]) - middle_) / size_;
    JetPoint<N> sum;
    for (Index i = 0; i < points_.rows(); ++i) {
      double x = at[0] - points_(i, 0), y = at[1] - points_(i, 1);
      if (std::abs(x) + std::abs(y) < least_distance) x = least_distance;
      const Jet<N> u = Jet<N>::linear(x, step, 0), v = Jet<N>::linear(y, 0, step), s = u * u + v * v;
      std::array<double, N + 1> logarithm{}, power{};  // Taylor coefficients at s of log and of the power
      const double s0 = s.value();
      logarithm[0] = std::log(s0);
      power[0] = std::pow(s0, m - 1);
      for (int d = 1; d <= N; ++d) {
        logarithm[d] = (d % 2 == 1 ? 1.0 : -1.0) / (d * std::pow(s0, d));
        power[d] = power[d - 1] * (m - d) / (d * s0);
      }
      std::array<double, N + 1> kernel{};
      for (int d = 0; d <= N; ++d)
        for (int e = 0; e <= d; ++e) kernel[d] += sign * power[e] * logarithm[d - e];
      const Jet<N> value = compose<N>(kernel.data(), 1, s);
      for (int axis = 0; axis < 3; ++axis) sum.x[axis] += part.weights(i, axis) * value;
    }
    const Jet<N> u = Jet<N>::linear(at[0], step, 0), v = Jet<N>::linear(at[1], 0, step);
    int row = 0;
    Jet<N> ui(1.0);
    for (int i = 0; i < m; ++i, ui = ui * u) {
      Jet<N> term = ui;
      for (int j = 0; i + j < m; ++j, ++row, term = term * v)
        for (int axis = 0; axis < 3; ++axis) sum.x[axis] += part.polynomial(row, axis) * term;
    }
    for (int c = 0; c < Jet<N>::size; ++c)
      for (int axis = 0; axis < 3; ++axis) *out++ += part.share * sum.x[axis].c[c];
  }
}

void Field::evaluate(const double* b, Index n, int order, double* out) const {
  std::fill_n(out, n * jet_size(std::clamp(order, 0, max_order)) * 3, 0.0);
  for (const Part& part : parts_) {
    if (order == 0) {
      values(part, b, n, out);
    } else if (order == 1) {
      values_and_slopes(part, b, n, out);
    } else {
      with_order<2, max_order>(order, [&](auto constant) { jets<constant.value>(part, b, n, out); });
    }
  }
  const Index stride = jet_size(order) * 3;
  for (Index k = 0; k < n; ++k)
    for (int axis = 0; axis < 3; ++axis) out[k * stride + axis] += origin_[axis];
}

VectorXd Field::deviation(const PlanePoints& points, const Points& directions) const {
  const PlanePoints at = normalised(points);
  VectorXd variance = VectorXd::Zero(points.rows());
  Points rows = Points::Zero(points.rows(), 3);
  rows.leftCols(2) = points;
  MatrixXd each(points.rows(), static_cast<Index>(parts_.size()));
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Part& part = parts_[p];
    const Contrasts contrasts(few_, part.order);
    const double nugget = std::max(part.nugget, std::pow(10.0, lowest_nugget) * contrasts.inner.diagonal().mean());
    MatrixXd inner = contrasts.inner;
    inner.diagonal().array() += nugget;
    const Eigen::LLT<MatrixXd> factor(inner);
    // the polynomial through the samples that is nearest, and the contrast of a point with it
    MatrixXd nearest = MatrixXd::Zero(few_.rows(), at.rows());
    nearest.topRows(contrasts.q) = contrasts.qr.matrixQR()
                                       .topLeftCorner(contrasts.q, contrasts.q)
                                       .transpose()
                                       .triangularView<Eigen::Lower>()
                                       .solve(monomials(at, part.order).transpose());
    nearest.applyOnTheLeft(contrasts.qr.householderQ());
    MatrixXd kernel = squared_distances(few_, at);
    apply_kernel(part.order, kernel);
    const MatrixXd among = contrasts.kernel * nearest + nugget * nearest;
    const VectorXd own = nearest.cwiseProduct(among - 2 * kernel).colwise().sum().transpose();
    const MatrixXd known = factor.matrixL().solve(contrasts.of(kernel - among));
    const VectorXd left = (own - known.colwise().squaredNorm().transpose()).cwiseMax(0);
    variance += part.share * part.variance * left;
    Points position = Points::Zero(at.rows(), 3);
    values(part, rows.data(), at.rows(), position.data());
    each.col(static_cast<Index>(p)) = position.cwiseProduct(directions).rowwise().sum() / part.share;
  }
  VectorXd mean = VectorXd::Zero(at.rows());
  for (std::size_t p = 0; p < parts_.size(); ++p) mean += parts_[p].share * each.col(static_cast<Index>(p));
  for (std::size_t p = 0; p < parts_.size(); ++p)
    variance += parts_[p].share * (each.col(static_cast<Index>(p)) - mean).cwiseAbs2();
  return variance.cwiseSqrt();
}

}  // namespace tripatch
