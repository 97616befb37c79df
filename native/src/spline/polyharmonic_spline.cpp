#include "tripatch/spline/polyharmonic_spline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "tripatch/math/decompositions.h"
#include "tripatch/math/dense_kernels.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/spline/contrasts.h"

namespace tripatch {

/// Those that tell the order of a surface.
struct DecidingSamples {
  DecidingSamples(Index count, double length) : places(count, 2), samples(count, 3), unit(length) {}

  PlanePoints places;  ///< normalised
  Points samples;      ///< by the origin and in units
  double unit;
  std::map<double, Likelihood> known;  ///< of the orders asked for
};

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// So many samples decide on order and nugget: the time grows with their cube, and more changed the choice in none of some hundred
/// holes that were tried.
constexpr Index deciding_samples = count::cubic;
/// Nuggets that are tried, over the mean eigenvalue of the kernel: decades, from rounding to a field that is all noise.
constexpr double lowest_nugget = -14, highest_nugget = 4, nugget_step = 0.5;
/// A nugget up to here is rounding: the samples are met.
constexpr double exact_nugget = -12.5;
/// Logarithms of likelihoods are divided by this share of the number of samples before orders are averaged: neighboring samples of
/// a real surface tell much the same. Measured on 37 known surfaces with noise and 35 holes of scanned and modelled meshes.
constexpr double tempering = share::tenth;
/// Surroundings whose noise is this share of an edge, or more, are not sampled finely enough to tell how they continue: the lowest two
/// orders, which overshoot least, are taken instead of the likeliest. Noise of 0.02 edges has to stay below it: at 0.03 fills of known
/// surfaces with it are 6% farther and their deviations too large, from 0.036 to 0.05 real ones are the same.
constexpr double rough_noise = noise::rough;
/// Standard deviations of so many points at once: 20 ms, and 4 MB for each of a few matrices.
constexpr Index points_at_once = count::portion;
/// The true surface may be smoother than this one by so many orders. On 126 known surfaces without noise 72% of the vertices are within one
/// deviation with two, 77% with one; a third makes no difference.
constexpr int smoother = count::pair;
/// Orders with less than this share are left out of the average.
constexpr double min_share = share::trace;

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

std::vector<OrderFound> orders_found(const DecidingSamples& deciding, const std::vector<double>& orders, MatrixXd& room) {
  const PlanePoints& points = deciding.places;
  const Index n = points.rows();
  const PlaneDistances apart(points, points);
  std::vector<OrderFound> found;
  for (double order : orders) {
    if (order != orders.front() && free_polynomials(order) > n / 3) continue;
    if (free_polynomials(order) >= n) continue;
    found.push_back({order, Contrasts(points, apart, order), {}});
    const auto known = deciding.known.find(order);
    found.back().likelihood =
        known != deciding.known.end() ? known->second : likelihood_of(found.back().contrasts, deciding.samples, room);
  }
  if (found.empty()) found.push_back({2, Contrasts(points, apart, 2), {0, 0, 0, 0}});  // a handful of samples: a plane
  return found;
}

double most_likely(const std::vector<OrderFound>& found) {
  double most = -std::numeric_limits<double>::infinity();
  for (const OrderFound& each : found) most = std::max(most, each.likelihood.logarithm);
  return most;
}

/// How likely each order is.
std::vector<double> shares_of(const std::vector<OrderFound>& found, Index samples) {
  const double most = most_likely(found), temperature = tempering * static_cast<double>(samples);
  std::vector<double> shares;
  double sum = 0;
  for (const OrderFound& each : found) shares.push_back(std::exp((each.likelihood.logarithm - most) / temperature));
  for (const double share : shares) sum += share;
  for (double& share : shares) share /= sum;
  return shares;
}

/// roughness: so much of the lowest two orders instead of the likeliest.
void take_lowest(double roughness, std::vector<double>& shares) {
  const std::size_t low = std::min<std::size_t>(2, shares.size());
  for (std::size_t k = 0; k < shares.size(); ++k)
    shares[k] = (1 - roughness) * shares[k] + (k < low ? roughness / static_cast<double>(low) : 0);
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
  const OrthonormalColumns polynomials = orthonormal_columns(free_monomials(places, part.order), false);
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

/// A field of one order through, or near, the samples that decide.
class FieldOfOrder {
public:
  FieldOfOrder(const Contrasts& contrasts, PolyharmonicSpline::Part part, const Points& samples)
      : part_(std::move(part)), basis_(contrasts.basis), triangle_(contrasts.triangle) {
    fit(part_, contrasts, samples, lower_);
    among_ = basis_.transpose() * contrasts.along;
    among_.diagonal().array() += part_.used_nugget;
    taken_.resize(2 * contrasts.q, basis_.rows());
    taken_ << basis_.transpose(), contrasts.of(contrasts.along).transpose();
  }
  double order() const { return part_.order; }
  double share() const { return part_.share; }

  struct At {
    VectorXd heights, variance;  ///< along directions
  };
  /// apart: distances of the points from the samples' places.
  At at(const PlanePoints& points, const PlaneDistances& apart, const Points& directions) const {
    const MatrixXd free = free_monomials(points, part_.order), kernel = polyharmonic_kernel(part_.order, apart);
    const MatrixXd values = product(kernel, part_.weights) + free * part_.polynomial;
    // the polynomial through the samples that is nearest, and the contrast of a point with it
    MatrixXd shares(free.rows(), 2 * free.cols());
    auto within = shares.leftCols(free.cols()), own = shares.rightCols(free.cols());
    within = product(kernel, basis_);
    own = triangle_.transpose().triangularView<Eigen::Lower>().solve(free.transpose()).transpose();
    const VectorXd nearest = own.cwiseProduct(own * among_ - 2 * within).rowwise().sum();
    const MatrixXd contrast = kernel - product(shares, taken_);
    RowMajor known = contrast.transpose();
    solve_lower_triangular(lower_, known);
    return {values.cwiseProduct(directions).rowwise().sum(),
            part_.variance * (nearest - known.colwise().squaredNorm().transpose()).cwiseMax(0)};
  }

private:
  PolyharmonicSpline::Part part_;
  MatrixXd basis_, triangle_;  // as those of the contrasts
  MatrixXd lower_;             // as Contrasts::factor makes it
  MatrixXd among_;             // the kernel with noise, of the basis
  MatrixXd taken_;             // the basis, and contrasts of the kernel with it, by rows
};

/// Of each order that the true surface may have, with its share: those of a spline, and smoother ones.
std::vector<FieldOfOrder> possible_fields(const DecidingSamples& deciding, const std::vector<PolyharmonicSpline::Part>& parts,
                                          double roughness) {
  std::set<double> own;
  for (const PolyharmonicSpline::Part& part : parts) own.insert(part.order);
  std::set<double> orders = own;
  for (int more = 1; more <= smoother; ++more)
    if (const double order = *own.rbegin() + more; !deciding.known.contains(order)) orders.insert(order);  // else it is unlikely
  MatrixXd room;
  const std::vector<OrderFound> found = orders_found(deciding, {orders.begin(), orders.end()}, room);
  std::vector<double> shares = shares_of(found, deciding.places.rows());
  take_lowest(roughness, shares);
  std::vector<FieldOfOrder> fields;
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto& [order, contrasts, likelihood] = found[k];
    if (shares[k] < min_share && !own.contains(order)) continue;
    PolyharmonicSpline::Part part;
    part.order = order;
    part.share = shares[k];
    part.nugget = likelihood.nugget;
    part.variance = likelihood.variance;
    fields.emplace_back(contrasts, std::move(part), deciding.samples);
  }
  return fields;
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
  auto deciding = std::make_shared<DecidingSamples>(few, options.unit);
  for (Index k = 0; k < few; ++k) {
    deciding->places.row(k) = points_.row(k * centers / few);
    deciding->samples.row(k) = local.row(k * centers / few) / options.unit;
  }
  MatrixXd room;
  const std::vector<OrderFound> found = orders_found(*deciding, options.orders, room);
  for (const OrderFound& each : found) deciding->known[each.order] = each.likelihood;
  deciding_ = deciding;
  likelihood_ = most_likely(found);
  if (!std::isfinite(likelihood_)) throw InvalidArgument("the points of a field lie on a line");
  const std::vector<double> shares = shares_of(found, few);
  for (const auto& [order, contrasts, likelihood] : found) {
    Part part;
    part.order = order;
    part.share = shares[parts_.size()];
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
  double noise = 0, sum = 0;
  std::vector<double> shares;
  for (const Part& part : parts_) {
    noise += part.share * std::sqrt(part.nugget * part.variance);
    shares.push_back(part.share);
  }
  roughness_ = 1 - 1 / (1 + std::pow(noise / (rough_noise * unit), 4));
  take_lowest(roughness_, shares);
  for (std::size_t k = 0; k < parts_.size(); ++k) parts_[k].share = shares[k];
  std::erase_if(parts_, [](const Part& part) { return part.share < min_share; });
  for (const Part& part : parts_) sum += part.share;
  for (Part& part : parts_) {
    part.share /= sum;
    noise_ += part.share * std::sqrt(part.nugget * part.variance);
    mean_order_ += part.share * part.order;
  }
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

VectorXd PolyharmonicSpline::deviation(const PlanePoints& points, const Points& directions) const {
  if (points.rows() == 0) return {};  // Eigen solves for no columns at a null pointer
  const std::vector<FieldOfOrder> fields = possible_fields(*deciding_, parts_, roughness_);
  const PlanePoints at = normalised(points);
  VectorXd variance = VectorXd::Zero(at.rows());
  for (Index first = 0; first < at.rows(); first += points_at_once) {
    check_interruption();
    const Index count = std::min(points_at_once, at.rows() - first);
    const PlanePoints some = at.middleRows(first, count);
    const PlaneDistances apart(some, deciding_->places);
    VectorXd surface = VectorXd::Zero(count);  // this one, by the same samples as the others
    std::vector<FieldOfOrder::At> found;
    for (const FieldOfOrder& field : fields) {
      found.push_back(field.at(some, apart, directions.middleRows(first, count)));
      const auto own = std::ranges::find(parts_, field.order(), &Part::order);
      if (own != parts_.end()) surface += own->share * found.back().heights;
    }
    for (std::size_t k = 0; k < fields.size(); ++k)
      variance.segment(first, count) += fields[k].share() * (found[k].variance + (found[k].heights - surface).cwiseAbs2());
  }
  return deciding_->unit * variance.cwiseSqrt();
}

}  // namespace tripatch
