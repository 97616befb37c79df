#include "tripatch/math/piecewise_polynomial.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>

#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// Rewrites sum_k a_k u^k (vectors of `dimension`) as a polynomial of u - shift, in place.
void taylor_shift(double* a, int degree, int dimension, double shift) {
  if (shift == 0) return;
  for (int i = 0; i < degree; ++i)
    for (int k = degree - 1; k >= i; --k)
      for (int x = 0; x < dimension; ++x) a[k * dimension + x] += shift * a[(k + 1) * dimension + x];
}

/// Horner for the value and, in the same sweep, for the derivatives over k!; three components, known order: all in registers.
template <int Order>
void horner(const double* a, int degree, double u, double* out) {
  double sum[Order + 1][3] = {};
  for (int k = degree; k >= 0; --k) {
    for (int j = Order; j > 0; --j)
      for (int x = 0; x < 3; ++x) sum[j][x] = sum[j][x] * u + sum[j - 1][x];
    for (int x = 0; x < 3; ++x) sum[0][x] = sum[0][x] * u + a[3 * k + x];
  }
  for (int j = 0; j <= Order; ++j)
    for (int x = 0; x < 3; ++x) out[3 * j + x] = sum[j][x];
}

std::vector<double> merged(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> all(a.size() + b.size()), out = {0.0};
  std::merge(a.begin(), a.end(), b.begin(), b.end(), all.begin());
  out.reserve(all.size());
  for (double t : all)
    if (t > out.back() + tolerance::rounding && t < 1 - tolerance::rounding) out.push_back(t);
  out.push_back(1.0);
  return out;
}

/// Chebyshev points of one piece and the matrix from values there to monomials about its middle (u from -1 to 1).
struct Interpolation {
  Eigen::VectorXd nodes;
  Eigen::MatrixXd to_monomials;

  explicit Interpolation(int n) : nodes(n) {
    Eigen::MatrixXd vandermonde(n, n);
    for (int i = 0; i < n; ++i) {
      nodes[i] = std::cos(std::numbers::pi * (2 * i + 1) / (2.0 * n));
      for (int k = 0; k < n; ++k) vandermonde(i, k) = std::pow(nodes[i], k);
    }
    to_monomials = least_squares(vandermonde, Eigen::MatrixXd::Identity(n, n));
  }
};

/// The one of n points, made once.
const Interpolation& interpolation(int n) {
  static std::mutex mutex;
  static std::map<int, Interpolation> made;
  const std::lock_guard lock(mutex);
  return made.try_emplace(n, n).first->second;
}

}  // namespace

PiecewisePolynomial::Places::Places(std::vector<double> given) : breaks(std::move(given)) {
  if (breaks.size() < 2) return;
  const Index n = static_cast<Index>(breaks.size()) - 1;
  lookup.assign(n == 1 ? 1 : 2 * n, 0);
  Index p = 0;
  for (std::size_t k = 0; k < lookup.size(); ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(lookup.size());
    while (p + 1 < n && breaks[p + 1] <= t) ++p;
    lookup[k] = static_cast<std::int32_t>(p);
  }
}

Index PiecewisePolynomial::Places::piece(double t) const {
  const Index n = static_cast<Index>(breaks.size()) - 1;
  if (n == 1 || !(t > 0)) return 0;
  if (t >= 1) return n - 1;
  Index p = lookup[static_cast<std::size_t>(t * static_cast<double>(lookup.size()))];
  while (p + 1 < n && t >= breaks[p + 1]) ++p;
  return p;
}

PiecewisePolynomial::PiecewisePolynomial() {
  static const PiecewisePolynomial empty(std::make_shared<const Places>(std::vector<double>()), {}, 0, 0);
  *this = empty;
}

PiecewisePolynomial::PiecewisePolynomial(std::shared_ptr<const Places> places, std::vector<double> coefficients, int degree,
                                         int dimension)
    : places_(std::move(places)),
      degree_(degree),
      dimension_(dimension),
      coefficients_(std::make_shared<const std::vector<double>>(std::move(coefficients))) {}

PiecewisePolynomial::PiecewisePolynomial(std::vector<double> breaks, int degree, int dimension, std::vector<double> coefficients)
    : PiecewisePolynomial(std::make_shared<const Places>(std::move(breaks)), std::move(coefficients), degree, dimension) {
  if (empty() || coefficients_->size() != static_cast<std::size_t>(pieces() * (degree_ + 1) * dimension_))
    throw InvalidArgument("a piecewise polynomial needs (degree + 1) coefficients for each piece");
}

PiecewisePolynomial PiecewisePolynomial::constant(std::span<const double> value) {
  return {{0.0, 1.0}, 0, static_cast<int>(value.size()), {value.begin(), value.end()}};
}

PiecewisePolynomial PiecewisePolynomial::bezier(std::span<const double> net, int dimension) {
  const int n = static_cast<int>(net.size()) / dimension - 1;
  if (n < 0 || net.size() % dimension != 0) throw InvalidArgument("a Bezier curve needs at least one control point");
  // Monomials about the middle lose digits quickly with the degree and the width of the piece: high degrees are split.
  const int pieces = n <= 6 ? 1 : n <= 12 ? 4 : 8;
  std::vector<double> breaks(pieces + 1), coefficients;
  for (int p = 0; p <= pieces; ++p) breaks[p] = static_cast<double>(p) / pieces;
  std::vector<double> binomial(n + 1, 1.0);
  for (int k = 1; k <= n; ++k) binomial[k] = binomial[k - 1] * (n - k + 1) / k;
  for (int p = 0; p < pieces; ++p) {
    // k-th Taylor coefficient at the middle: binomial(n, k) times the de Casteljau value of the k-th differences
    const double m = 0.5 * (breaks[p] + breaks[p + 1]);
    std::vector<double> d(net.begin(), net.end());
    for (int k = 0; k <= n; ++k) {
      std::vector<double> w(d.begin(), d.begin() + (n - k + 1) * dimension);
      for (int level = n - k; level > 0; --level)
        for (int i = 0; i < level * dimension; ++i) w[i] = (1 - m) * w[i] + m * w[i + dimension];
      for (int x = 0; x < dimension; ++x) coefficients.push_back(binomial[k] * w[x]);
      for (int i = 0; i < (n - k) * dimension; ++i) d[i] = d[i + dimension] - d[i];
    }
  }
  return {breaks, n, dimension, coefficients};
}

PiecewisePolynomial PiecewisePolynomial::hermite(std::span<const double> parameters, std::span<const double> values,
                                                 std::span<const double> derivatives, int dimension) {
  const Index n = static_cast<Index>(parameters.size()) - 1;
  if (n < 1 || values.size() != parameters.size() * dimension || derivatives.size() != values.size())
    throw InvalidArgument("Hermite pieces need a value and a derivative at each of two or more parameters");
  std::vector<double> coefficients(n * 4 * dimension);
  for (Index p = 0; p < n; ++p) {
    const double h = parameters[p + 1] - parameters[p];
    for (int x = 0; x < dimension; ++x) {
      const double a = values[p * dimension + x], b = values[(p + 1) * dimension + x];
      const double da = derivatives[p * dimension + x], db = derivatives[(p + 1) * dimension + x];
      double* c = &coefficients[p * 4 * dimension + x];
      // about the middle: u from -h/2 to h/2
      c[0] = 0.5 * (a + b) + h / 8 * (da - db);
      c[dimension] = 1.5 * (b - a) / h - 0.25 * (da + db);
      c[2 * dimension] = 0.5 * (db - da) / h;
      c[3 * dimension] = (da + db - 2 * (b - a) / h) / (h * h);
    }
  }
  return {{parameters.begin(), parameters.end()}, 3, dimension, coefficients};
}

namespace {

/// PiecewisePolynomial::spline, with the dimension where it is known beforehand.
template <int Known>
PiecewisePolynomial spline_of(std::span<const double> t, std::span<const double> values, int dimension,
                              std::span<const double> start, std::span<const double> end) {
  const Index n = static_cast<Index>(t.size());
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Known, Eigen::RowMajor>;
  using Row = Eigen::Matrix<double, 1, Known>;
  const Eigen::Map<const Matrix> y(values.data(), n, dimension);
  Matrix m(n, dimension);  // derivatives at the knots
  // tridiagonal system lower_k m_{k-1} + diagonal_k m_k + upper_k m_{k+1} = m_k's right side
  std::vector<double> lower(n, 0), diagonal(n, 1), upper(n, 0);
  Matrix slopes(n - 1, dimension);
  for (Index k = 0; k + 1 < n; ++k) slopes.row(k) = (y.row(k + 1) - y.row(k)) / (t[k + 1] - t[k]);
  const auto slope = [&](Index k) { return slopes.row(k); };
  if (n == 2 && start.empty() && end.empty()) {
    m.row(0) = m.row(1) = slope(0);
  } else if (n == 3 && start.empty() && end.empty()) {
    const double h0 = t[1] - t[0], h1 = t[2] - t[1];
    const Row s = (slope(1) - slope(0)) / (h0 + h1);
    m.row(0) = slope(0) - h0 * s;
    m.row(1) = slope(0) + h0 * s;
    m.row(2) = slope(1) + h1 * s;
  } else {
    for (Index k = 1; k + 1 < n; ++k) {
      const double a = t[k] - t[k - 1], b = t[k + 1] - t[k];
      lower[k] = b;
      diagonal[k] = 2 * (a + b);
      upper[k] = a;
      m.row(k) = 3 * (b * slope(k - 1) + a * slope(k));
    }
    const auto given = [&](std::span<const double> d) { return Eigen::Map<const Row>(d.data(), dimension); };
    if (!start.empty()) {
      m.row(0) = given(start);
    } else if (n == 2) {  // one end given: the parabola
      diagonal[0] = upper[0] = 1;
      m.row(0) = 2 * slope(0);
    } else {
      const double a = t[1] - t[0], b = t[2] - t[1];
      diagonal[0] = b;
      upper[0] = a + b;
      m.row(0) = ((a + 2 * (a + b)) * b * slope(0) + a * a * slope(1)) / (a + b);
    }
    if (!end.empty()) {
      m.row(n - 1) = given(end);
    } else if (n == 2) {
      diagonal[1] = lower[1] = 1;
      m.row(1) = 2 * slope(0);
    } else {
      const double a = t[n - 1] - t[n - 2], b = t[n - 2] - t[n - 3];
      diagonal[n - 1] = b;
      lower[n - 1] = a + b;
      m.row(n - 1) = ((a + 2 * (a + b)) * b * slope(n - 2) + a * a * slope(n - 3)) / (a + b);
    }
    for (Index k = 1; k < n; ++k) {
      const double f = lower[k] / diagonal[k - 1];
      diagonal[k] -= f * upper[k - 1];
      m.row(k) -= f * m.row(k - 1);
    }
    m.row(n - 1) /= diagonal[n - 1];
    for (Index k = n - 2; k >= 0; --k) m.row(k) = (m.row(k) - upper[k] * m.row(k + 1)) / diagonal[k];
  }
  return PiecewisePolynomial::hermite(t, values, {m.data(), static_cast<std::size_t>(m.size())}, dimension);
}

}  // namespace

PiecewisePolynomial PiecewisePolynomial::spline(std::span<const double> t, std::span<const double> values, int dimension,
                                                std::span<const double> start, std::span<const double> end) {
  if (t.size() < 2 || values.size() != t.size() * dimension) throw InvalidArgument("a spline needs two or more values");
  return dimension == 3 ? spline_of<3>(t, values, 3, start, end) : spline_of<Eigen::Dynamic>(t, values, dimension, start, end);
}

PiecewisePolynomial PiecewisePolynomial::fit(const std::function<void(std::span<const double>, std::span<double>)>& f,
                                             int dimension, double tolerance, int degree, int max_depth) {
  const int n = degree + 1;
  const auto& [nodes, to_monomials] = interpolation(n);
  std::vector<double> checks = {-1, 1};  // and places unlike the nodes
  for (int k = 1; k < count::dozen; ++k) checks.push_back(std::sin(k));

  struct Piece {
    double a, b;
    int depth;
  };
  std::vector<Piece> open = {{0, 1, 0}};
  std::vector<std::pair<double, std::vector<double>>> done;  // start, coefficients
  double scale = 0;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  while (!open.empty()) {
    const std::size_t per = nodes.size() + checks.size();
    std::vector<double> t, values(open.size() * per * dimension);
    for (const Piece& p : open) {
      const double m = 0.5 * (p.a + p.b), h = 0.5 * (p.b - p.a);
      for (double u : nodes) t.push_back(m + h * u);
      for (double u : checks) t.push_back(u == -1 ? p.a : u == 1 ? p.b : m + h * u);
    }
    f(t, values);
    for (double v : values) {
      if (!std::isfinite(v)) throw CodedRefusal(Code::numbers_overflow);
      scale = std::max(scale, std::abs(v));
    }
    std::vector<Piece> next;
    for (std::size_t p = 0; p < open.size(); ++p) {
      const Eigen::Map<const Matrix> at_nodes(&values[p * per * dimension], n, dimension);
      const Eigen::Map<const Matrix> at_checks(&values[(p * per + n) * dimension], static_cast<Index>(checks.size()), dimension);
      Matrix a = to_monomials * at_nodes;
      double error = 0;
      for (std::size_t i = 0; i < checks.size(); ++i) {
        Eigen::RowVectorXd v = a.row(n - 1);
        for (int k = n - 2; k >= 0; --k) v = v * checks[i] + a.row(k);
        error = std::max(error, (v - at_checks.row(static_cast<Index>(i))).cwiseAbs().maxCoeff());
      }
      const auto [from, to, depth] = open[p];
      if (error <= tolerance * scale || depth >= max_depth) {
        const double h = 0.5 * (to - from);
        for (int k = 0; k < n; ++k) a.row(k) /= std::pow(h, k);
        done.emplace_back(from, std::vector<double>(a.data(), a.data() + a.size()));
      } else {
        next.push_back({from, 0.5 * (from + to), depth + 1});
        next.push_back({0.5 * (from + to), to, depth + 1});
      }
    }
    open = std::move(next);
  }
  std::sort(done.begin(), done.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<double> breaks, coefficients;
  for (const auto& [start, a] : done) {
    breaks.push_back(start);
    coefficients.insert(coefficients.end(), a.begin(), a.end());
  }
  breaks.push_back(1.0);
  return {breaks, degree, dimension, coefficients};
}

PiecewisePolynomial PiecewisePolynomial::joined(const std::vector<PiecewisePolynomial>& parts, std::vector<double> shares) {
  if (parts.empty()) throw InvalidArgument("nothing to join");
  if (shares.empty()) shares.assign(parts.size(), 1 / static_cast<double>(parts.size()));
  int degree = 0;
  for (const PiecewisePolynomial& part : parts) degree = std::max(degree, part.degree_);
  std::vector<double> breaks = {0}, coefficients;
  double start = 0;
  for (std::size_t k = 0; k < parts.size(); start += shares[k++]) {
    const PiecewisePolynomial part = parts[k].refined({}, degree);
    for (Index p = 1; p <= part.pieces(); ++p) breaks.push_back(start + shares[k] * part.breaks()[p]);
    for (Index p = 0; p < part.pieces(); ++p) {
      double scale = 1;
      for (int power = 0; power <= degree; ++power, scale /= shares[k])
        for (int x = 0; x < part.dimension_; ++x)
          coefficients.push_back(scale * part.coefficients()[(p * (degree + 1) + power) * part.dimension_ + x]);
    }
  }
  breaks.back() = 1;
  return {breaks, degree, parts[0].dimension_, coefficients};
}

void PiecewisePolynomial::taylor(double t, int order, double* out) const {
  const Index p = places_->piece(t);
  const double u = t - places_->middle(p);
  const double* a = &(*coefficients_)[p * (degree_ + 1) * dimension_];
  if (dimension_ == 3) {
    switch (order) {
      case 0: return horner<0>(a, degree_, u, out);
      case 1: return horner<1>(a, degree_, u, out);
      case 2: return horner<2>(a, degree_, u, out);
      case 3: return horner<3>(a, degree_, u, out);
      default: break;
    }
  }
  for (int i = 0; i < (order + 1) * dimension_; ++i) out[i] = 0;
  for (int k = degree_; k >= 0; --k) {
    for (int j = std::min(order, degree_ - k); j > 0; --j)
      for (int x = 0; x < dimension_; ++x) out[j * dimension_ + x] = out[j * dimension_ + x] * u + out[(j - 1) * dimension_ + x];
    for (int x = 0; x < dimension_; ++x) out[x] = out[x] * u + a[k * dimension_ + x];
  }
}

Vec3 PiecewisePolynomial::operator()(double t) const {
  Vec3 v;
  taylor(t, 0, v.data());
  return v;
}

Vec3 PiecewisePolynomial::derivative_at(double t, int order) const {
  constexpr int highest = 8;
  std::array<double, 3 * (highest + 1)> v;
  if (order < 0 || order > highest) throw InvalidArgument("derivatives of a side must be from 0 to 8");
  taylor(t, order, v.data());
  double factorial = 1;
  for (int k = 2; k <= order; ++k) factorial *= k;
  return factorial * Eigen::Map<const Vec3>(&v[3 * order]);
}

PiecewisePolynomial PiecewisePolynomial::derivative() const {
  const int degree = std::max(degree_ - 1, 0);
  std::vector<double> coefficients(pieces() * (degree + 1) * dimension_, 0.0);
  for (Index p = 0; p < pieces(); ++p)
    for (int k = 1; k <= degree_; ++k)
      for (int x = 0; x < dimension_; ++x)
        coefficients[(p * (degree + 1) + k - 1) * dimension_ + x] =
            k * (*coefficients_)[(p * (degree_ + 1) + k) * dimension_ + x];
  return {places_, std::move(coefficients), degree, dimension_};
}

PiecewisePolynomial PiecewisePolynomial::reversed() const {
  const Index n = pieces();
  std::vector<double> breaks(n + 1), coefficients(coefficients_->size());
  for (Index p = 0; p <= n; ++p) breaks[p] = p == 0 ? 0 : p == n ? 1 : 1 - places_->breaks[n - p];
  for (Index p = 0; p < n; ++p)
    for (int k = 0; k <= degree_; ++k)
      for (int x = 0; x < dimension_; ++x)
        coefficients[(p * (degree_ + 1) + k) * dimension_ + x] =
            (k % 2 ? -1 : 1) * (*coefficients_)[((n - 1 - p) * (degree_ + 1) + k) * dimension_ + x];
  return {std::move(breaks), degree_, dimension_, std::move(coefficients)};
}

PiecewisePolynomial PiecewisePolynomial::part(double t0, double t1) const {
  std::vector<double> inner;
  for (double t : breaks())
    if (t > t0 && t < t1) inner.push_back((t - t0) / (t1 - t0));
  const std::vector<double> breaks = merged(inner, {});
  std::vector<double> coefficients;
  for (std::size_t p = 0; p + 1 < breaks.size(); ++p) {
    const double m = t0 + (t1 - t0) * 0.5 * (breaks[p] + breaks[p + 1]);
    std::vector<double> a((degree_ + 1) * dimension_);
    taylor(m, degree_, a.data());
    double scale = 1;
    for (int k = 0; k <= degree_; ++k, scale *= t1 - t0)
      for (int x = 0; x < dimension_; ++x) a[k * dimension_ + x] *= scale;
    coefficients.insert(coefficients.end(), a.begin(), a.end());
  }
  return {breaks, degree_, dimension_, coefficients};
}

PiecewisePolynomial PiecewisePolynomial::refined(const std::vector<double>& more_breaks, int degree) const {
  const std::vector<double> all = merged(breaks(), more_breaks);
  return on(all == breaks() ? places_ : std::make_shared<const Places>(all), std::max(degree, degree_));
}

PiecewisePolynomial PiecewisePolynomial::on(const std::shared_ptr<const Places>& places, int degree) const {
  if (degree == degree_ && places == places_) return *this;
  const Index n = static_cast<Index>(places->breaks.size()) - 1;
  std::vector<double> coefficients(n * (degree + 1) * dimension_, 0.0);
  for (Index p = 0; p < n; ++p) {
    const double m = places->middle(p);
    const Index old = places_->piece(m);
    double* a = &coefficients[p * (degree + 1) * dimension_];
    std::copy_n(&(*coefficients_)[old * (degree_ + 1) * dimension_], (degree_ + 1) * dimension_, a);
    taylor_shift(a, degree_, dimension_, m - places_->middle(old));
  }
  return {places, std::move(coefficients), degree, dimension_};
}

std::shared_ptr<const PiecewisePolynomial::Places> PiecewisePolynomial::common_places(const PiecewisePolynomial& o) const {
  if (places_ == o.places_ || breaks() == o.breaks()) return places_;
  std::vector<double> all = merged(breaks(), o.breaks());
  return all == breaks() ? places_ : all == o.breaks() ? o.places_ : std::make_shared<const Places>(std::move(all));
}

PiecewisePolynomial operator+(const PiecewisePolynomial& a, const PiecewisePolynomial& b) {
  const auto places = a.common_places(b);
  const int degree = std::max(a.degree_, b.degree_);
  const PiecewisePolynomial r = a.on(places, degree), s = b.on(places, degree);
  std::vector<double> sum = *r.coefficients_;
  for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += (*s.coefficients_)[k];
  return {places, std::move(sum), degree, r.dimension_};
}

PiecewisePolynomial operator-(const PiecewisePolynomial& a, const PiecewisePolynomial& b) { return a + (-1.0) * b; }

PiecewisePolynomial operator*(double s, const PiecewisePolynomial& a) {
  std::vector<double> coefficients = *a.coefficients_;
  for (double& c : coefficients) c *= s;
  return {a.places_, std::move(coefficients), a.degree_, a.dimension_};
}

PiecewisePolynomial operator*(const PiecewisePolynomial& scalar, const PiecewisePolynomial& field) {
  const auto places = field.common_places(scalar);
  const PiecewisePolynomial s = scalar.on(places, scalar.degree_), f = field.on(places, field.degree_);
  const int degree = s.degree_ + f.degree_, dimension = f.dimension_, row = (f.degree_ + 1) * dimension;
  std::vector<double> coefficients(f.pieces() * (degree + 1) * dimension, 0.0);
  for (Index p = 0; p < f.pieces(); ++p)
    for (int i = 0; i <= s.degree_; ++i) {
      const double by = (*s.coefficients_)[p * (s.degree_ + 1) + i];
      const double* const from = &(*f.coefficients_)[p * row];
      double* const to = &coefficients[(p * (degree + 1) + i) * dimension];
      for (int k = 0; k < row; ++k) to[k] += by * from[k];
    }
  return {places, std::move(coefficients), degree, dimension};
}

PiecewisePolynomial PiecewisePolynomial::linear(double a, double b) {
  const std::array<double, 2> net = {a, b};
  return bezier(net, 1);
}

bool PiecewisePolynomial::is_finite() const {
  return std::ranges::all_of(*coefficients_, [](double c) { return std::isfinite(c); });
}

double arc_length(const PiecewisePolynomial& curve) {
  constexpr int steps = 32;
  double length = 0;
  Vec3 last = curve(0);
  for (int k = 1; k <= steps; ++k) {
    const Vec3 p = curve(static_cast<double>(k) / steps);
    length += (p - last).norm();
    last = p;
  }
  return length;
}

}  // namespace tripatch
