#include "tripatch/spline/polyharmonic_spline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "tripatch/math/decompositions.h"
#include "tripatch/math/dense_kernels.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/tolerances.h"

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
/// Surroundings whose noise is this share of an edge, or more, are not sampled finely enough to tell how they continue: the lowest two
/// orders, which overshoot least, are taken instead of the likeliest. Noise of 0.02 edges has to stay below it: at 0.03 fills of known
/// surfaces with it are 6% farther and their deviations too large, from 0.036 to 0.05 real ones are the same.
constexpr double rough_noise = 0.04;
/// Standard deviations are those of so many samples at most: the time grows with their square.
constexpr Index deviation_samples = 120;
/// And of so many points at once: 20 ms, and 4 MB for each of a few matrices.
constexpr Index points_at_once = 4096;
/// Where one order is left its own deviation knows nothing of the others: this share of the distance to the surface of the next lower
/// order is an error too. On 35 known surfaces without noise 94% of the vertices were within two deviations without it, where a hill
/// lies in the hole 18%; with it 99.6%, and 100%.
constexpr double order_error = 0.5;
/// Orders with less than this share are left out of the average.
constexpr double min_share = 0.02;

/// Monomials up to the order's degree at points, n x q.
MatrixXd monomials(const PlanePoints& c, double order) {
  const int d = free_degree_of(order);
  MatrixXd u = MatrixXd::Ones(c.rows(), d + 1), v = u;
  for (int k = 1; k <= d; ++k) {
    u.col(k) = u.col(k - 1).cwiseProduct(c.col(0));
    v.col(k) = v.col(k - 1).cwiseProduct(c.col(1));
  }
  MatrixXd out(c.rows(), free_polynomials(order));
  int column = 0;
  for (int i = 0; i <= d; ++i)
    for (int j = 0; i + j <= d; ++j, ++column) out.col(column) = u.col(i).cwiseProduct(v.col(j));
  return out;
}

/// a b for a symmetric a (n, n), all of which is there, and b (n, k).
MatrixXd symmetric_times(const MatrixXd& a, const MatrixXd& b) {
  constexpr Index four = 4;
  const Index n = a.rows(), k = b.cols(), padded = (k + four - 1) / four * four;
  MatrixXd from = MatrixXd::Zero(n, padded), out(n, padded);
  from.leftCols(k) = b;
  for (Index j = 0; j < padded; j += four) multiply_four(from.col(j).data(), n, a.data(), n, out.col(j).data(), n);
  return out.leftCols(k);
}

/// The kernel among samples, seen through contrasts: combinations of samples in which polynomials cancel. Polynomials themselves
/// are given the kernel's mean variance in it, so that it is definite, and stay apart from contrasts.
struct Contrasts {
  /// apart: distances among the samples' places c.
  Contrasts(const PlanePoints& c, const PlaneDistances& apart, double order)
      : q(free_polynomials(order)), inner(polyharmonic_kernel(order, apart)) {
    OrthonormalColumns polynomials = orthonormal_columns(monomials(c, order), false);
    basis = std::move(polynomials.basis);
    triangle = std::move(polynomials.triangle);
    along = symmetric_times(inner, basis);
    MatrixXd turned = along;
    const MatrixXd within = basis.transpose() * turned;
    const double trace = inner.trace() - 2 * within.trace() + within.trace();
    unit = trace / static_cast<double>(c.rows() - q);
    turned -= 0.5 * basis * (within + unit * MatrixXd::Identity(q, q));
    take_from_inner(turned);
  }
  /// Without their polynomial part.
  MatrixXd of(const MatrixXd& samples) const { return samples - basis * (basis.transpose() * samples); }
  /// The lower Cholesky factor of what is among contrasts with noise; false where it is not definite.
  bool factor(double nugget, MatrixXd& lower) const {
    lower = MatrixXd(inner);  // its own memory first: where there is none, lower must not be left without
    lower.diagonal().array() += nugget;
    return factor_cholesky(lower);
  }
  /// The weights of the kernel with samples.
  MatrixXd weights(const MatrixXd& lower, const MatrixXd& samples) const {
    MatrixXd x = of(samples);
    lower.triangularView<Eigen::Lower>().solveInPlace(x);
    lower.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
    return of(x);
  }
  /// The polynomial next to the weights.
  MatrixXd polynomial(const MatrixXd& weights, const MatrixXd& samples) const {
    return triangle.triangularView<Eigen::Upper>().solve(basis.transpose() * samples - along.transpose() * weights);
  }

  Index q;
  MatrixXd inner;            // the kernel, of which contrasts see the lower half
  MatrixXd basis, triangle;  // of the polynomials at the samples: orthonormal, and the monomials by it
  MatrixXd along;            // the kernel times the basis
  double unit = 0;           // mean eigenvalue of the kernel among contrasts

private:
  /// The basis times `turned` by columns of samples, and that the other way round; above the diagonal stays what was there, or less.
  void take_from_inner(const MatrixXd& turned) {
    constexpr Index four = 4;
    const Index n = inner.rows();
    MatrixXd left(n, 2 * q), taken(n, four), across(2 * q, four);
    left << basis, turned;
    for (Index from = 0; from < n; from += four) {
      const Index own = std::min(four, n - from);
      across.setZero();
      across.topLeftCorner(q, own) = turned.middleRows(from, own).transpose();
      across.bottomLeftCorner(q, own) = basis.middleRows(from, own).transpose();
      multiply_four(across.data(), 2 * q, left.data(), n, taken.data(), n);
      for (Index k = 0; k < own; ++k) inner.col(from + k).tail(n - from) -= taken.col(k).tail(n - from);
    }
  }
};

struct Likelihood {
  double logarithm = -std::numeric_limits<double>::infinity();
  double decade = 0;    // of the nugget
  double nugget = 0;    // over the kernel's unit
  double variance = 0;  // of the kernel's unit
};

/// The logarithm of so many pivots is taken at once: between a nugget of rounding and one that is all noise they are numbers.
constexpr Index logarithm_of = 4;

/// Nuggets looked at at once: a quotient takes many times as long as until the next one can begin.
constexpr int nuggets_at_once = 4;
using Nuggets = Eigen::Array<double, nuggets_at_once, 1>;

/// The restricted likelihood of one order at its best nugget: samples vary in one direction, across the surface. The contrasts'
/// kernel is made tridiagonal once, after which a nugget costs no more than its samples. room: for that, kept from order to order.
Likelihood likelihood_of(const Contrasts& contrasts, const MatrixXd& samples, MatrixXd& room) {
  constexpr int tried = 1 + static_cast<int>((highest_nugget - lowest_nugget) / nugget_step);
  MatrixXd turned = contrasts.of(samples);
  room = contrasts.inner;
  const auto [diagonal, beside] = tridiagonalize(room, turned);
  const Index n = turned.rows(), free = n - contrasts.q;
  Likelihood best;
  for (int first = 0; first < tried; first += nuggets_at_once) {
    const Nuggets decade = lowest_nugget + nugget_step * (first + Nuggets::LinSpaced(0, nuggets_at_once - 1));
    const Nuggets nugget = decade.unaryExpr([](double d) { return std::pow(10, d); }) * contrasts.unit;
    const auto logarithm = [](double x) { return std::log(x); };
    Nuggets pivot = diagonal[0] + nugget, pivots = pivot, y[3];
    Nuggets logarithms = -static_cast<double>(contrasts.q) * (contrasts.unit + nugget).unaryExpr(logarithm);
    for (int axis = 0; axis < 3; ++axis) y[axis].setConstant(turned(0, axis));
    const auto square = [&]() -> Nuggets { return y[0] * y[0] + y[1] * y[1] + y[2] * y[2]; };
    Nuggets squares = square() / pivot, least = pivot;
    for (Index k = 1; k < n; ++k) {
      const Nuggets l = beside[k - 1] / pivot;
      for (int axis = 0; axis < 3; ++axis) y[axis] = turned(k, axis) - l * y[axis];
      pivot = diagonal[k] + nugget - l * beside[k - 1];
      least = least.min(pivot);
      pivots *= pivot;
      if (k % logarithm_of == 0) {
        logarithms += pivots.unaryExpr(logarithm);
        pivots.setOnes();
      }
      squares += square() / pivot;
    }
    logarithms += pivots.unaryExpr(logarithm);
    for (int k = 0; k < nuggets_at_once && first + k < tried; ++k) {
      if (!(least[k] > 0)) continue;
      const double variance = std::max(squares[k] / static_cast<double>(free), tolerance::tiny);
      const double found = -0.5 * static_cast<double>(free) * std::log(variance) - 0.5 * logarithms[k];
      if (found > best.logarithm) best = {found, decade[k], nugget[k], variance};
    }
  }
  return best;
}

/// The kernel of one order and the likelihood of the samples by which orders are chosen.
struct OrderFound {
  double order;
  Contrasts contrasts;
  Likelihood likelihood;
};

std::vector<OrderFound> orders_found(const PlanePoints& points, const MatrixXd& samples, const std::vector<double>& orders,
                                     MatrixXd& room) {
  const Index n = points.rows();
  const PlaneDistances apart(points, points);
  std::vector<OrderFound> found;
  for (double order : orders) {
    if (order != orders.front() && free_polynomials(order) > n / 3) continue;
    if (free_polynomials(order) >= n) continue;
    found.push_back({order, Contrasts(points, apart, order), {}});
    found.back().likelihood = likelihood_of(found.back().contrasts, samples, room);
  }
  if (found.empty()) found.push_back({2, Contrasts(points, apart, 2), {0, 0, 0, 0}});  // a handful of samples: a plane
  return found;
}

/// The directions in which points about 0 are spread most and least, in columns: their monomials are distinguished in a narrow strip too,
/// whose two coordinates are nearly the same where it lies aslant.
Eigen::Matrix2d along_and_across(const PlanePoints& points) {
  const Eigen::Matrix2d spread = points.transpose() * points;
  const double turn = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  Eigen::Matrix2d axes;
  axes << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
  return axes;
}

void fit(PolyharmonicSpline::Part& part, const Contrasts& contrasts, const Points& samples, MatrixXd& lower) {
  double& nugget = part.used_nugget = std::max(part.nugget, std::pow(10, lowest_nugget) * contrasts.unit);
  while (!contrasts.factor(nugget, lower) && nugget < contrasts.unit) nugget *= 10;
  part.weights = contrasts.weights(lower, samples);
  part.polynomial = contrasts.polynomial(part.weights, samples);
}

/// The same for samples at more places than there are centers, whose contrasts are given: of the surfaces with kernels around these the
/// likeliest. That the root of the kernel among centers comes first keeps the system's condition that of the kernel.
void fit_all(PolyharmonicSpline::Part& part, const Contrasts& contrasts, const PlanePoints& centers, const PlanePoints& places,
             const Points& samples, MatrixXd& lower) {
  const Index n = places.rows(), m = centers.rows();
  const double rounding = std::pow(10, lowest_nugget) * contrasts.unit;
  double root_nugget = rounding;
  while (!contrasts.factor(root_nugget, lower) && root_nugget < contrasts.unit) root_nugget *= 10;
  const MatrixXd kernel = polyharmonic_kernel(part.order, PlaneDistances(centers, places));
  RowMajor known = contrasts.of(kernel);
  solve_lower_triangular(lower, known);
  const OrthonormalColumns polynomials = orthonormal_columns(monomials(places, part.order), false);
  const MatrixXd& basis = polynomials.basis;
  RowMajor rows(n, m + 3);
  rows << known.transpose(), samples;
  const MatrixXd within = basis.transpose() * rows;
  rows.noalias() -= basis * within;
  RowMajor gram = RowMajor::Zero(m + 3, m + 3);
  add_gram(rows, gram);
  const MatrixXd all = symmetric_of_lower(gram, m + 3);
  double& nugget = part.used_nugget = std::max(part.nugget, rounding);
  MatrixXd factor;
  const auto definite = [&] {
    factor = all.topLeftCorner(m, m);
    factor.diagonal().array() += nugget;
    return factor_cholesky(factor);
  };
  while (!definite() && nugget < contrasts.unit) nugget *= 10;
  MatrixXd x = all.topRightCorner(m, 3);
  factor.triangularView<Eigen::Lower>().solveInPlace(x);
  factor.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
  lower.triangularView<Eigen::Lower>().transpose().solveInPlace(x);
  part.weights = contrasts.of(x);
  part.polynomial = polynomials.triangle.triangularView<Eigen::Upper>().solve(basis.transpose() *
                                                                              (samples - kernel.transpose() * part.weights));
}

}  // namespace

PolyharmonicSpline::PolyharmonicSpline(const PlanePoints& points, const Points& samples, const FieldOptions& options) {
  const Index n = points.rows();
  if (n < 4 || samples.rows() != n) throw InvalidArgument("a field needs four samples or more, one at each point");
  if (!points.allFinite() || !samples.allFinite()) throw InvalidArgument("points and samples of a field must be finite");
  middle_ = points.colwise().mean();
  size_ = (points.rowwise() - middle_).cwiseAbs().maxCoeff();
  if (!(size_ > 0)) throw InvalidArgument("the points of a field are all one");
  axes_ = along_and_across((points.rowwise() - middle_) / size_);
  const PlanePoints all = normalised(points);
  const Index centers = std::min(n, options.centers);
  points_ = all.topRows(centers);
  origin_ = samples.colwise().mean();
  const Points local = samples.rowwise() - origin_;
  const Index few = std::min(centers, deciding_samples);
  PlanePoints at(few, 2);
  Points values(few, 3);
  for (Index k = 0; k < few; ++k) {
    at.row(k) = points_.row(k * centers / few);
    values.row(k) = local.row(k * centers / few);
  }
  MatrixXd room;
  const std::vector<OrderFound> found = orders_found(at, values / options.unit, options.orders, room);
  double most = -std::numeric_limits<double>::infinity();
  for (const OrderFound& each : found) most = std::max(most, each.likelihood.logarithm);
  if (!std::isfinite(most)) throw InvalidArgument("the points of a field lie on a line");
  likelihood_ = most;
  const double temperature = tempering * static_cast<double>(few);
  for (const auto& [order, contrasts, likelihood] : found) {
    Part part;
    part.order = order;
    part.share = std::exp((likelihood.logarithm - most) / temperature);
    part.nugget = likelihood.decade <= exact_nugget ? 0 : likelihood.nugget;
    part.variance = likelihood.variance * options.unit * options.unit;
    parts_.push_back(std::move(part));
  }
  weigh(options.unit);
  std::optional<PlaneDistances> apart;
  if (few < centers) apart.emplace(points_, points_);
  sum_.emplace(points_);
  std::optional<Contrasts> among_all;
  for (Part& part : parts_) {
    const auto known = std::find_if(found.begin(), found.end(), [&](const OrderFound& each) { return each.order == part.order; });
    const Contrasts& contrasts = apart ? among_all.emplace(points_, *apart, part.order) : known->contrasts;
    if (centers < n)
      fit_all(part, contrasts, points_, all, local, room);
    else
      fit(part, contrasts, local, room);
    sum_->add(part.order, part.share, part.weights, part.polynomial);
  }
}

PlanePoints PolyharmonicSpline::normalised(const PlanePoints& points) const {
  return ((points.rowwise() - middle_) / size_) * axes_;
}

void PolyharmonicSpline::weigh(double unit) {
  double sum = 0;
  for (const Part& part : parts_) sum += part.share;
  for (Part& part : parts_) part.share /= sum;
  hedge(unit);
  for (Part& part : parts_) {
    noise_ += part.share * std::sqrt(part.nugget * part.variance);
    mean_order_ += part.share * part.order;
  }
}

void PolyharmonicSpline::hedge(double unit) {
  double noise = 0, sum = 0;
  for (const Part& part : parts_) noise += part.share * std::sqrt(part.nugget * part.variance);
  const double smooth = 1 / (1 + std::pow(noise / (rough_noise * unit), 4));
  roughness_ = 1 - smooth;
  const Index low = std::min<Index>(2, static_cast<Index>(parts_.size()));
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    parts_[k].share *= smooth;
    if (static_cast<Index>(k) < low) parts_[k].share += (1 - smooth) / static_cast<double>(low);
  }
  std::erase_if(parts_, [](const Part& part) { return part.share < min_share; });
  for (const Part& part : parts_) sum += part.share;
  for (Part& part : parts_) part.share /= sum;
}

template <int N>
void PolyharmonicSpline::jets(const Part& part, const double* rows, Index n, double* out) const {
  const int e = polyharmonic_exponent(part.order);
  const double sign = polyharmonic_factor(e), half = 0.5 * e, step = 1 / size_;
  for (Index k = 0; k < n; ++k) {
    const Eigen::RowVector2d at = normalised(PlanePoints(Eigen::RowVector2d(rows[3 * k], rows[3 * k + 1])));
    JetPoint<N> sum;
    const auto along = [&](double x) { return Jet<N>::linear(x, step * axes_(0, 0), step * axes_(1, 0)); };
    const auto across = [&](double y) { return Jet<N>::linear(y, step * axes_(0, 1), step * axes_(1, 1)); };
    for (Index i = 0; i < points_.rows(); ++i) {
      double x = at[0] - points_(i, 0), y = at[1] - points_(i, 1);
      if (std::abs(x) + std::abs(y) < tolerance::same) x = tolerance::same;
      const Jet<N> u = along(x), v = across(y), s = u * u + v * v;
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
    const Jet<N> u = along(at[0]), v = across(at[1]);
    int row = 0;
    Jet<N> ui(1.0);
    for (int i = 0; i <= free_degree_of(part.order); ++i, ui = ui * u) {
      Jet<N> term = ui;
      for (int j = 0; i + j <= free_degree_of(part.order); ++j, ++row, term = term * v)
        for (int axis = 0; axis < 3; ++axis) sum.x[axis] += part.polynomial(row, axis) * term;
    }
    for (int c = 0; c < Jet<N>::size; ++c)
      for (int axis = 0; axis < 3; ++axis) *out++ += part.share * sum.x[axis].c[c];
  }
}

/// Derivatives by normalised coordinates to those by (u, v).
void PolyharmonicSpline::turn_back(int order, double* jet) const {
  const Eigen::Matrix2d by = axes_ / size_;  // normalised coordinates (columns) by u and v (rows)
  if (order > 0) {
    const Vec3 p = Vec3::Map(jet + 3), q = Vec3::Map(jet + 6);
    for (int k = 0; k < 2; ++k) Vec3::Map(jet + 3 + 3 * k) = by(k, 0) * p + by(k, 1) * q;
  }
  if (order > 1) {
    const Vec3 pp = Vec3::Map(jet + 9), pq = Vec3::Map(jet + 12), qq = Vec3::Map(jet + 15);
    const auto second = [&](int i, int k) {
      return Vec3(by(i, 0) * by(k, 0) * pp + (by(i, 0) * by(k, 1) + by(i, 1) * by(k, 0)) / 2 * pq + by(i, 1) * by(k, 1) * qq);
    };
    Vec3::Map(jet + 9) = second(0, 0);
    Vec3::Map(jet + 12) = 2 * second(0, 1);
    Vec3::Map(jet + 15) = second(1, 1);
  }
}

void PolyharmonicSpline::evaluate(const double* b, Index n, int order, double* out) const {
  const Index stride = jet_size(order) * 3;
  constexpr int by_sum = 2;
  if (order <= by_sum) {
    sum_->evaluate(normalised(Eigen::Map<const Points>(b, n, 3).leftCols<2>()), order, out);
    for (Index k = 0; k < n; ++k) turn_back(order, out + stride * k);
  } else {
    std::fill_n(out, n * stride, 0.0);
    for (const Part& part : parts_)
      with_order<by_sum + 1, max_order>(order, [&](auto constant) { jets<constant.value>(part, b, n, out); });
  }
  for (Index k = 0; k < n; ++k)
    for (int axis = 0; axis < 3; ++axis) out[k * stride + axis] += origin_[axis];
}

PolyharmonicSum PolyharmonicSpline::alone(const Part& part) const {
  PolyharmonicSum sum(points_);
  sum.add(part.order, 1, part.weights, part.polynomial);
  return sum;
}

VectorXd PolyharmonicSpline::deviation(const PlanePoints& points, const Points& directions) const {
  if (points.rows() == 0) return {};  // Eigen solves for no columns at a null pointer
  if (points.rows() > points_at_once) {
    VectorXd all(points.rows());
    for (Index k = 0; k < all.size(); k += points_at_once) {
      check_interruption();
      const Index count = std::min(points_at_once, all.size() - k);
      all.segment(k, count) = deviation(points.middleRows(k, count), directions.middleRows(k, count));
    }
    return all;
  }
  const PlanePoints at = normalised(points);
  const Index n = points_.rows(), few = std::min(n, deviation_samples);
  PlanePoints some(few, 2);
  for (Index k = 0; k < few; ++k) some.row(k) = points_.row(k * n / few);
  VectorXd variance = VectorXd::Zero(points.rows());
  MatrixXd each(points.rows(), static_cast<Index>(parts_.size()));
  const PlaneDistances among_some(some, some), from_some(some, at);
  MatrixXd lower;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const Part& part = parts_[p];
    const Contrasts contrasts(some, among_some, part.order);
    contrasts.factor(part.used_nugget, lower);
    const MatrixXd free = monomials(at, part.order), kernel = polyharmonic_kernel(part.order, from_some);
    // the polynomial through the samples that is nearest, and the contrast of a point with it
    const MatrixXd own_share = contrasts.triangle.transpose().triangularView<Eigen::Lower>().solve(free.transpose());
    const MatrixXd nearest = contrasts.basis * own_share;
    const MatrixXd among = (contrasts.along + part.used_nugget * contrasts.basis) * own_share;
    const VectorXd own = nearest.cwiseProduct(among - 2 * kernel).colwise().sum().transpose();
    RowMajor known = contrasts.of(kernel - among);
    solve_lower_triangular(lower, known);
    const VectorXd left = (own - known.colwise().squaredNorm().transpose()).cwiseMax(0);
    variance += part.share * part.variance * left;
    each.col(static_cast<Index>(p)) = alone(part).values(at).cwiseProduct(directions).rowwise().sum();
  }
  VectorXd mean = VectorXd::Zero(at.rows());
  for (std::size_t p = 0; p < parts_.size(); ++p) mean += parts_[p].share * each.col(static_cast<Index>(p));
  for (std::size_t p = 0; p < parts_.size(); ++p)
    variance += parts_[p].share * (each.col(static_cast<Index>(p)) - mean).cwiseAbs2();
  const auto main =
      std::max_element(parts_.begin(), parts_.end(), [](const Part& a, const Part& b) { return a.share < b.share; });
  const Points other = by_another_order(*main, some, among_some, at);
  if (other.rows() > 0) {
    const VectorXd apart_from = other.cwiseProduct(directions).rowwise().sum() - each.col(main - parts_.begin());
    variance += (order_error * apart_from).cwiseAbs2();
  }
  return variance.cwiseSqrt();
}

Points PolyharmonicSpline::by_another_order(const Part& part, const PlanePoints& some, const PlaneDistances& among_some,
                                            const PlanePoints& at) const {
  const double order = part.order > 2.5 ? std::max(2.5, part.order - 2) : 3.5;
  if (free_polynomials(order) >= some.rows()) return Points(0, 3);
  const Points samples = alone(part).values(some);
  const Contrasts contrasts(some, among_some, order);
  MatrixXd lower;
  if (!contrasts.factor(std::pow(10, lowest_nugget + 1) * contrasts.unit, lower)) return Points(0, 3);
  const MatrixXd weights = contrasts.weights(lower, samples);
  PolyharmonicSum other(some);
  other.add(order, 1, weights, contrasts.polynomial(weights, samples));
  return other.values(at);
}

}  // namespace tripatch
