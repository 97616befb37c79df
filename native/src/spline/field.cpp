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

using Eigen::ArrayXXd;
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
/// orders, which run on least, are taken instead of the likeliest. Noise of 0.02 edges has to stay below it: at 0.03 fills of known
/// surfaces with it are 6% farther and their deviations too large, from 0.036 to 0.05 real ones are the same.
constexpr double rough_noise = 0.04;
/// Standard deviations are those of so many samples at most: the time grows with their square.
constexpr Index deviation_samples = 120;
/// Where one order is left its own deviation knows nothing of the others: this share of the distance to the surface of the next lower
/// order is an error too. On 35 known surfaces without noise 94% of the vertices were within two deviations without it, where a hill
/// lies in the hole 18%; with it 99.6%, and 100%.
constexpr double order_error = 0.5;
/// Orders with less than this share are left out of the average.
constexpr double least_share = 0.02;
/// Distance from a sample, in normalised coordinates, at which derivatives are taken that have no limit there.
constexpr double least_distance = 1e-7;
/// Points whose distances from some hundred samples stay in the cache.
constexpr Index block = 64;

/// r^(2m-2), with a logarithm where the exponent is even; free polynomials up to degree m - 1 rounded down.
int exponent(double order) { return static_cast<int>(std::lround(2 * order - 2)); }
int degree(double order) { return static_cast<int>(std::floor(order - 1 + 1e-9)); }
int polynomials(double order) { return (degree(order) + 1) * (degree(order) + 2) / 2; }
double sign_of(int e) { return (e % 2 == 0 ? (e / 2 + 1) : (e + 1) / 2) % 2 == 0 ? 1 : -1; }

/// Monomials up to the order's degree at points, n x q; their derivatives by one of the coordinates.
MatrixXd monomials(const PlanePoints& c, double order, int axis = -1) {
  const int d = degree(order);
  MatrixXd u = MatrixXd::Ones(c.rows(), d + 1), v = u;
  for (int k = 1; k <= d; ++k) {
    u.col(k) = u.col(k - 1).cwiseProduct(c.col(0));
    v.col(k) = v.col(k - 1).cwiseProduct(c.col(1));
  }
  if (axis >= 0) {
    MatrixXd& along = axis == 0 ? u : v;
    for (int k = d; k > 0; --k) along.col(k) = k * along.col(k - 1);
    along.col(0).setZero();
  }
  MatrixXd out(c.rows(), polynomials(order));
  int column = 0;
  for (int i = 0; i <= d; ++i)
    for (int j = 0; i + j <= d; ++j, ++column) out.col(column) = u.col(i).cwiseProduct(v.col(j));
  return out;
}

ArrayXXd power(const ArrayXXd& x, int exponent) {
  ArrayXXd p = ArrayXXd::Ones(x.rows(), x.cols());
  for (int k = 0; k < exponent; ++k) p *= x;
  return p;
}

/// Of squared distances, with the limit 0 at 0.
MatrixXd kernel_of(double order, const MatrixXd& squared) {
  const int e = exponent(order);
  const ArrayXXd s = squared.array();
  if (e % 2 == 1) return (sign_of(e) * power(s, e / 2) * s.sqrt()).matrix();
  return (0.5 * sign_of(e) * power(s, e / 2) * s.max(std::numeric_limits<double>::min()).log()).matrix();
}

/// Twice its derivative by the squared distance: its gradient over the way from the sample.
MatrixXd kernel_slope(double order, const MatrixXd& squared) {
  const int e = exponent(order);
  const ArrayXXd s = squared.array().max(least_distance * least_distance);
  if (e % 2 == 1)
    return (e == 1 ? ArrayXXd(sign_of(e) / s.sqrt()) : ArrayXXd(e * sign_of(e) * power(s, e / 2 - 1) * s.sqrt())).matrix();
  return (sign_of(e) * power(s, e / 2 - 1) * (e / 2 * s.log() + 1)).matrix();
}

MatrixXd squared_distances(const PlanePoints& a, const PlanePoints& b) {
  MatrixXd s(a.rows(), b.rows());
  for (Index j = 0; j < b.rows(); ++j) s.col(j) = (a.col(0).array() - b(j, 0)).square() + (a.col(1).array() - b(j, 1)).square();
  return s;
}

/// The kernel among samples, seen through contrasts: combinations of samples in which polynomials cancel. Polynomials themselves
/// are given the kernel's mean variance in it, so that it is definite, and stay apart from contrasts.
struct Contrasts {
  Contrasts(const PlanePoints& c, const MatrixXd& squared, double order)
      : q(polynomials(order)), kernel(kernel_of(order, squared)) {
    const Eigen::HouseholderQR<MatrixXd> qr(monomials(c, order));
    basis = qr.householderQ() * MatrixXd::Identity(c.rows(), q);
    triangle = qr.matrixQR().topLeftCorner(q, q).triangularView<Eigen::Upper>();
    MatrixXd turned = kernel * basis;
    const MatrixXd within = basis.transpose() * turned;
    const double trace = kernel.trace() - 2 * within.trace() + within.trace();
    unit = trace / static_cast<double>(c.rows() - q);
    turned -= 0.5 * basis * (within + unit * MatrixXd::Identity(q, q));
    inner = kernel;
    inner.triangularView<Eigen::Lower>() -= basis * turned.transpose();
    inner.triangularView<Eigen::Lower>() -= turned * basis.transpose();
  }
  /// Without their polynomial part.
  MatrixXd of(const MatrixXd& samples) const { return samples - basis * (basis.transpose() * samples); }
  Eigen::LLT<MatrixXd> factor(double nugget) const {
    MatrixXd sum = inner;
    sum.diagonal().array() += nugget;
    return Eigen::LLT<MatrixXd>(sum);
  }

  Index q;
  MatrixXd kernel, inner;    // inner: the lower half
  MatrixXd basis, triangle;  // of the polynomials at the samples: orthonormal, and the monomials by it
  double unit = 0;           // mean eigenvalue of the kernel among contrasts
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
  const Index n = z.rows(), free = n - contrasts.q;
  Likelihood best;
  for (double decade = lowest_nugget; decade <= highest_nugget; decade += nugget_step) {
    const double nugget = std::pow(10.0, decade) * contrasts.unit;
    double pivot = diagonal[0] + nugget;
    double logarithms = std::log(pivot) - static_cast<double>(contrasts.q) * std::log(contrasts.unit + nugget);
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
    const double variance = std::max(squares / static_cast<double>(free), 1e-300);
    const double logarithm = -0.5 * static_cast<double>(free) * std::log(variance) - 0.5 * logarithms;
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
  PlanePoints at(few, 2);
  Points values(few, 3);
  for (Index k = 0; k < few; ++k) {
    at.row(k) = points_.row(k * n / few);
    values.row(k) = local.row(k * n / few);
  }
  choose(at, values, options);
  const MatrixXd squared = squared_distances(points_, points_);
  for (Part& part : parts_) fit(part, squared, local);
}

PlanePoints Field::normalised(const PlanePoints& points) const { return (points.rowwise() - middle_) / size_; }

void Field::choose(const PlanePoints& few, const Points& samples, const FieldOptions& options) {
  const Index n = few.rows();
  const MatrixXd y = samples / options.unit, squared = squared_distances(few, few);
  std::vector<Likelihood> found;
  std::vector<double> orders;
  for (double order : options.orders) {
    if (order != options.orders.front() && polynomials(order) > n / 3) continue;
    if (polynomials(order) >= n) continue;
    orders.push_back(order);
    found.push_back(likelihood_of(Contrasts(few, squared, order), y));
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
  roughness_ = 1 - smooth;
  const Index low = std::min<Index>(2, static_cast<Index>(parts_.size()));
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    parts_[k].share *= smooth;
    if (static_cast<Index>(k) < low) parts_[k].share += (1 - smooth) / static_cast<double>(low);
  }
  std::erase_if(parts_, [](const Part& part) { return part.share < least_share; });
  for (const Part& part : parts_) sum += part.share;
  for (Part& part : parts_) part.share /= sum;
}

void Field::fit(Part& part, const MatrixXd& squared, const Points& samples) const {
  const Contrasts contrasts(points_, squared, part.order);
  const MatrixXd z = contrasts.of(samples);
  double& nugget = part.used_nugget = std::max(part.nugget, std::pow(10.0, lowest_nugget) * contrasts.unit);
  Eigen::LLT<MatrixXd> factor = contrasts.factor(nugget);
  while (factor.info() != Eigen::Success && nugget < contrasts.unit) factor = contrasts.factor(nugget *= 10);
  part.weights = contrasts.of(factor.solve(z));
  part.polynomial = contrasts.triangle.triangularView<Eigen::Upper>().solve(contrasts.basis.transpose() *
                                                                            (samples - contrasts.kernel * part.weights));
}

void Field::evaluate_block(const PlanePoints& at, int order, double* out) const {
  const Index count = at.rows();
  const MatrixXd squared = squared_distances(at, points_);
  for (const Part& part : parts_) {
    const Points p = kernel_of(part.order, squared) * part.weights + monomials(at, part.order) * part.polynomial;
    const Index stride = order == 0 ? 3 : 9;
    for (Index k = 0; k < count; ++k)
      for (int axis = 0; axis < 3; ++axis) out[stride * k + axis] += part.share * p(k, axis);
    if (order == 0) continue;
    const MatrixXd slope = kernel_slope(part.order, squared);
    const Points sum = slope * part.weights;
    for (int by = 0; by < 2; ++by) {
      // the way from each sample to each point, times the slope: the point's part and the sample's part apart
      const Points from = slope * points_.col(by).asDiagonal() * part.weights;
      Points d = monomials(at, part.order, by) * part.polynomial - from;
      d += at.col(by).asDiagonal() * sum;
      for (Index k = 0; k < count; ++k)
        for (int axis = 0; axis < 3; ++axis) out[9 * k + 3 * (by + 1) + axis] += part.share / size_ * d(k, axis);
    }
  }
}

template <int N>
void Field::jets(const Part& part, const double* rows, Index n, double* out) const {
  const int e = exponent(part.order);
  const double sign = e % 2 == 0 ? 0.5 * sign_of(e) : sign_of(e), half = 0.5 * e, step = 1 / size_;
  for (Index k = 0; k < n; ++k) {
    const Eigen::RowVector2d at = (Eigen::RowVector2d(rows[3 * k], rows[3 * k + 1]) - middle_) / size_;
    JetPoint<N> sum;
    for (Index i = 0; i < points_.rows(); ++i) {
      double x = at[0] - points_(i, 0), y = at[1] - points_(i, 1);
      if (std::abs(x) + std::abs(y) < least_distance) x = least_distance;
      const Jet<N> u = Jet<N>::linear(x, step, 0), v = Jet<N>::linear(y, 0, step), s = u * u + v * v;
      std::array<double, N + 1> logarithm{}, power{}, kernel{};  // Taylor coefficients at s
      const double s0 = s.value();
      logarithm[0] = std::log(s0);
      power[0] = std::pow(s0, half);
      for (int d = 1; d <= N; ++d) {
        logarithm[d] = (d % 2 == 1 ? 1.0 : -1.0) / (d * std::pow(s0, d));
        power[d] = power[d - 1] * (half + 1 - d) / (d * s0);
      }
      for (int d = 0; d <= N; ++d) {
        if (e % 2 == 1) kernel[d] = sign * power[d];
        for (int c = 0; c <= d && e % 2 == 0; ++c) kernel[d] += sign * power[c] * logarithm[d - c];
      }
      const Jet<N> value = compose<N>(kernel.data(), 1, s);
      for (int axis = 0; axis < 3; ++axis) sum.x[axis] += part.weights(i, axis) * value;
    }
    const Jet<N> u = Jet<N>::linear(at[0], step, 0), v = Jet<N>::linear(at[1], 0, step);
    int row = 0;
    Jet<N> ui(1.0);
    for (int i = 0; i <= degree(part.order); ++i, ui = ui * u) {
      Jet<N> term = ui;
      for (int j = 0; i + j <= degree(part.order); ++j, ++row, term = term * v)
        for (int axis = 0; axis < 3; ++axis) sum.x[axis] += part.polynomial(row, axis) * term;
    }
    for (int c = 0; c < Jet<N>::size; ++c)
      for (int axis = 0; axis < 3; ++axis) *out++ += part.share * sum.x[axis].c[c];
  }
}

void Field::evaluate(const double* b, Index n, int order, double* out) const {
  std::fill_n(out, n * jet_size(std::clamp(order, 0, max_order)) * 3, 0.0);
  const Index stride = jet_size(order) * 3;
  if (order < 2) {
    for (Index from = 0; from < n; from += block) {
      check_interruption();
      const Index count = std::min(block, n - from);
      PlanePoints at(count, 2);
      for (Index k = 0; k < count; ++k) at.row(k) << b[3 * (from + k)], b[3 * (from + k) + 1];
      evaluate_block(normalised(at), order, out + stride * from);
    }
  } else {
    for (const Part& part : parts_)
      with_order<2, max_order>(order, [&](auto constant) { jets<constant.value>(part, b, n, out); });
  }
  for (Index k = 0; k < n; ++k)
    for (int axis = 0; axis < 3; ++axis) out[k * stride + axis] += origin_[axis];
}

VectorXd Field::deviation(const PlanePoints& points, const Points& directions) const {
  const PlanePoints at = normalised(points);
  const Index n = points_.rows(), few = std::min(n, deviation_samples);
  PlanePoints some(few, 2);
  for (Index k = 0; k < few; ++k) some.row(k) = points_.row(k * n / few);
  VectorXd variance = VectorXd::Zero(points.rows());
  MatrixXd each(points.rows(), static_cast<Index>(parts_.size()));
  const MatrixXd squared = squared_distances(some, some), apart = squared_distances(some, at);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Part& part = parts_[p];
    const Contrasts contrasts(some, squared, part.order);
    const Eigen::LLT<MatrixXd> factor = contrasts.factor(part.used_nugget);
    const MatrixXd free = monomials(at, part.order), kernel = kernel_of(part.order, apart);
    // the polynomial through the samples that is nearest, and the contrast of a point with it
    const MatrixXd nearest =
        contrasts.basis * contrasts.triangle.transpose().triangularView<Eigen::Lower>().solve(free.transpose());
    const MatrixXd among = contrasts.kernel * nearest + part.used_nugget * nearest;
    const VectorXd own = nearest.cwiseProduct(among - 2 * kernel).colwise().sum().transpose();
    const MatrixXd known = factor.matrixL().solve(contrasts.of(kernel - among));
    const VectorXd left = (own - known.colwise().squaredNorm().transpose()).cwiseMax(0);
    variance += part.share * part.variance * left;
    for (Index k = 0; k < at.rows(); k += block) {
      check_interruption();
      const Index count = std::min(block, at.rows() - k);
      const Points position = kernel_of(part.order, squared_distances(at.middleRows(k, count), points_)) * part.weights +
                              free.middleRows(k, count) * part.polynomial;
      each.col(static_cast<Index>(p)).segment(k, count) = position.cwiseProduct(directions.middleRows(k, count)).rowwise().sum();
    }
  }
  VectorXd mean = VectorXd::Zero(at.rows());
  for (std::size_t p = 0; p < parts_.size(); ++p) mean += parts_[p].share * each.col(static_cast<Index>(p));
  for (std::size_t p = 0; p < parts_.size(); ++p)
    variance += parts_[p].share * (each.col(static_cast<Index>(p)) - mean).cwiseAbs2();
  const auto main =
      std::max_element(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.share < b.share; });
  const Points other = by_another_order(*main, some, at);
  if (other.rows() > 0) {
    const VectorXd apart_from = other.cwiseProduct(directions).rowwise().sum() - each.col(main - parts_.begin());
    variance += (order_error * apart_from).cwiseAbs2();
  }
  return variance.cwiseSqrt();
}

Points Field::by_another_order(const Part& part, const PlanePoints& some, const PlanePoints& at) const {
  const double order = part.order > 2.5 ? std::max(2.5, part.order - 2) : 3.5;
  if (polynomials(order) >= some.rows()) return Points(0, 3);
  const Points samples =
      kernel_of(part.order, squared_distances(some, points_)) * part.weights + monomials(some, part.order) * part.polynomial;
  const Contrasts contrasts(some, squared_distances(some, some), order);
  const Eigen::LLT<MatrixXd> factor = contrasts.factor(std::pow(10.0, lowest_nugget + 1) * contrasts.unit);
  if (factor.info() != Eigen::Success) return Points(0, 3);
  const MatrixXd weights = contrasts.of(factor.solve(contrasts.of(samples)));
  const MatrixXd polynomial = contrasts.triangle.triangularView<Eigen::Upper>().solve(contrasts.basis.transpose() *
                                                                                      (samples - contrasts.kernel * weights));
  return kernel_of(order, squared_distances(at, some)) * weights + monomials(at, order) * polynomial;
}

}  // namespace tripatch
