#include "tripatch/polygon/round_problem.h"

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>

#include "tripatch/fairing/fairing_problem.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/places.h"
#include "tripatch/math/quadrature.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/patch/through.h"

namespace tripatch {
namespace {

constexpr int round_orthonormal_nodes = count::octet;  ///< with 5 and with 16 an uneven rim's fill is the same to 1e-9

/// (1 - r^2)^2 times (1 - r^2)^j Re z^k and Im z^k, by rising degree 2 j + k.
template <int N>
std::vector<Jet<N>> round_basis(const Jet<N>& u, const Jet<N>& v, int degree) {
  std::vector<Jet<N>> re = {Jet<N>(1.0)}, im = {Jet<N>(0.0)};
  for (int k = 1; k <= degree; ++k) {
    re.push_back(re[k - 1] * u - im[k - 1] * v);
    im.push_back(re[k - 1] * v + im[k - 1] * u);
  }
  const Jet<N> w = 1.0 - (u * u + v * v);
  std::vector<Jet<N>> power = {w * w};
  for (int j = 1; 2 * j <= degree; ++j) power.push_back(power.back() * w);
  std::vector<Jet<N>> basis;
  for (int d = 0; d <= degree; ++d)
    for (int k = d; k >= 0; k -= 2) {
      basis.push_back(power[(d - k) / 2] * re[k]);
      if (k > 0) basis.push_back(power[(d - k) / 2] * im[k]);
    }
  return basis;
}

PolygonQuadrature disc_quadrature(int nodes) {
  const auto [x, w] = gauss(nodes);
  const int angles = 4 * nodes;
  PolygonQuadrature out;
  out.uv = Points::Zero(static_cast<Index>(nodes) * angles, 3);
  Index row = 0;
  for (int a = 0; a < nodes; ++a)
    for (int k = 0; k < angles; ++k) {
      out.uv.row(row++).head<2>() = x[a] * on_circle((k + 0.5) / angles);
      out.weights.push_back(w[a] * x[a] * 2 * std::numbers::pi / angles);
    }
  return out;
}

NodeDerivatives disc_derivatives(const Points& uv, int degree) {
  NodeDerivatives all(uv.rows());
  for (Index k = 0; k < uv.rows(); ++k)
    all.add(round_basis(Jet<3>::linear(uv(k, 0), 1, 0), Jet<3>::linear(uv(k, 1), 0, 1), degree));
  return all;
}

Eigen::MatrixXd disc_orthonormal(int degree) {
  const PolygonQuadrature quadrature = disc_quadrature(round_orthonormal_nodes);
  return orthonormal_functions(quadrature.weights, disc_derivatives(quadrature.uv, degree));
}

/// 1, cos, sin, ... of 2 pi t.
std::vector<PiecewisePolynomial> waves_of(int count) {
  std::vector<PiecewisePolynomial> out;
  for (int m = 0; m < count; ++m) {
    const int k = (m + 1) / 2;
    const auto wave = [&](std::span<const double> t, std::span<double> values) {
      for (std::size_t i = 0; i < t.size(); ++i) values[i] = on_circle(k * t[i])[m % 2 == 1 ? 0 : k == 0 ? 0 : 1];
    };
    out.push_back(PiecewisePolynomial::fit(wave, 1));
  }
  return out;
}

double value_of(const PiecewisePolynomial& scalar, double t) {
  double value = 0;
  scalar.taylor(t, 0, &value);
  return value;
}

/// The terms H_1 and H_2 of what adds `direction` times `wave` to the derivative along the radius at the rim, and nothing to the
/// second one. For -1/2 (1 - r^2) H the second one is H + 2 H', for (1 - r^2)^2 H it is 8 H.
std::array<Harmonic, 2> slope_terms(const PiecewisePolynomial& wave, const PiecewisePolynomial& direction, Index rows) {
  const Harmonic field =
      fourier([&](double t) { return Vec3(value_of(wave, t) * direction(t)); }, static_cast<int>(rows - 1) / 2);
  std::array<Harmonic, 2> terms = {-0.5 * field, -1.0 / 8 * field};
  for (Index k = 1; 2 * k < rows; ++k) terms[1].middleRows(2 * k - 1, 2) *= 1.0 + 2.0 * static_cast<double>(k);
  return terms;
}

Index condition_count(const std::vector<InnerPoint>& points) {
  Index count = 0;
  for (const InnerPoint& p : points) count += p.normal ? 5 : 3;
  return count;
}

/// Position at the points, and the derivatives along their normals.
Eigen::VectorXd conditions_on(const Surface& surface, const std::vector<InnerPoint>& points) {
  Eigen::VectorXd out(condition_count(points));
  Index row = 0;
  for (const InnerPoint& p : points) {
    const std::array<double, 3> at = {p.uv[0], p.uv[1], 0};
    std::array<double, 9> jets;
    surface.evaluate(at.data(), 1, 1, jets.data());
    for (int x = 0; x < 3; ++x) out[row++] = jets[x];
    for (int k = 1; p.normal && k <= 2; ++k) out[row++] = p.normal->dot(Vec3::Map(&jets[3 * k]));
  }
  return out;
}

/// The same of functions (combinations of round_basis), by x, y and z.
Eigen::MatrixXd conditions_on_functions(const std::vector<InnerPoint>& points, int degree, const Eigen::MatrixXd& combination) {
  const Index count = combination.cols();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(condition_count(points), 3 * count);
  Index row = 0;
  for (const InnerPoint& p : points) {
    const std::vector<Jet<1>> basis = round_basis(Jet<1>::linear(p.uv[0], 1, 0), Jet<1>::linear(p.uv[1], 0, 1), degree);
    Eigen::MatrixXd values(3, static_cast<Index>(basis.size()));
    for (std::size_t c = 0; c < basis.size(); ++c)
      for (int k = 0; k < 3; ++k) values(k, static_cast<Index>(c)) = basis[c].c[k];
    values = (values * combination).eval();
    for (int x = 0; x < 3; ++x) out.row(row++).segment(x * count, count) = values.row(0);
    for (int k = 1; p.normal && k <= 2; ++k, ++row)
      for (int x = 0; x < 3; ++x) out.row(row).segment(x * count, count) = (*p.normal)[x] * values.row(k);
  }
  return out;
}

}  // namespace

std::vector<Harmonic> terms_through(std::vector<Harmonic> terms, const std::vector<InnerPoint>& points, double size) {
  if (points.empty()) return terms;
  const Index conditions = condition_count(points);
  int degree = 0;
  while (3 * polynomials_to(degree) < 2 * conditions) ++degree;
  const Index count = polynomials_to(degree);
  const Eigen::MatrixXd rows = conditions_on_functions(points, degree, Eigen::MatrixXd::Identity(count, count));
  Eigen::VectorXd wanted(conditions);
  Index row = 0;
  for (const InnerPoint& p : points) {
    for (int x = 0; x < 3; ++x) wanted[row++] = p.point[x];
    for (int k = 1; p.normal && k <= 2; ++k) wanted[row++] = 0;
  }
  for (int round = 0; round < 2; ++round) {  // a second time for the last digits
    const Eigen::MatrixXd lacking = wanted - conditions_on(RoundSurface(terms), points), x = least_squares(rows, lacking);
    const Eigen::MatrixXd met = rows * x;
    if (!x.allFinite() || (met - lacking).norm() > tolerance::same * size) throw CodedRefusal(Code::points_in_one_place);
    Points coefficients(count, 3);
    for (int c = 0; c < 3; ++c) coefficients.col(c) = x.col(0).segment(c * count, count);
    terms = sum_of(std::move(terms), round_terms(coefficients, degree));
  }
  return terms;
}

Across along_radius(const Surface& patch, double t) {
  const Vec2 p = on_circle(t);
  const std::array<double, 3> at = {p[0], p[1], 0};
  std::array<double, 18> jets;
  patch.evaluate(at.data(), 1, 2, jets.data());
  const auto d = [&](int which) { return Vec3(Vec3::Map(&jets[3 * which])); };
  return {p[0] * d(1) + p[1] * d(2), 2 * (p[0] * p[0] * d(3) + p[0] * p[1] * d(4) + p[1] * p[1] * d(5))};
}

RoundSpace::RoundSpace(int degree, int slopes, int nodes) : RoundSpace(disc_quadrature(nodes), degree, slopes) {}

RoundSpace::RoundSpace(PolygonQuadrature quadrature, int degree, int slopes)
    : NodeBasis(std::move(quadrature.weights), disc_derivatives(quadrature.uv, degree), disc_orthonormal(degree)),
      uv(std::move(quadrature.uv)),
      waves(waves_of(slopes)),
      along(waves) {
  const Index count = combination.cols();
  // all places alike: as points in the middle of a side, for how much each counts
  Eigen::MatrixXd second(SideBasis::points, count);
  for (int k = 0; k < SideBasis::points; ++k) {
    t.push_back((k + 0.5) / SideBasis::points);
    along.t[k] = 0.5;
    for (std::size_t m = 0; m < waves.size(); ++m) along.slope(k, static_cast<Index>(m)) = value_of(waves[m], t[k]);
    const Vec2 p = on_circle(t[k]);
    const std::vector<Jet<2>> basis = round_basis(Jet<2>::linear(p[0], p[0], 0), Jet<2>::linear(p[1], p[1], 0), degree);
    for (Index c = 0; c < count; ++c) second(k, c) = 2 * basis[c].c[jet_index(2, 0)];
  }
  along.second.push_back(second * combination);
}

const RoundSpace& round_space(int degree, int slopes, int nodes) {
  static std::mutex mutex;
  static std::map<std::array<int, 3>, std::unique_ptr<RoundSpace>> all;
  const std::lock_guard<std::mutex> lock(mutex);
  std::unique_ptr<RoundSpace>& one = all[{degree, slopes, nodes}];
  if (!one) one = std::make_unique<RoundSpace>(degree, slopes, nodes);
  return *one;
}

RoundProblem::RoundProblem(const RoundBase& base, const FairingOptions& options, int nodes)
    : RoundProblem(base, options, round_space(options.degree, options.slopes, nodes)) {}

RoundProblem::RoundProblem(const RoundBase& base, const FairingOptions& options, const RoundSpace& space)
    : EnergyProblem(space, plane_derivatives(RoundSurface(base.terms), space.uv), options, base.size, space.combination.cols()),
      space_(space),
      of_(base) {
  if (base.slopes_free && !base.position_only) scale_ = {base.size, scale_to(base.size, base.side.c.derivative())};
  const std::vector<PiecewisePolynomial> directions = directions_of(base.side);
  fields_ = options.slopes * static_cast<Index>(directions.size());
  basis_.setZero(27 * space_.uv.rows(), fields_);
  held_.setZero(condition_count(base.through), count());
  Index field = 0;
  for (const PiecewisePolynomial& direction : directions)
    for (const PiecewisePolynomial& wave : space_.waves) {
      const std::array<Harmonic, 2> term = slope_terms(wave, direction, base.terms[1].rows());
      const std::vector<Derivatives> all = plane_derivatives(RoundSurface({Harmonic::Zero(1, 3), term[0], term[1]}), space_.uv);
      for (std::size_t k = 0; k < all.size(); ++k)
        basis_.block<27, 1>(27 * static_cast<Index>(k), field) = Eigen::Map<const Eigen::Matrix<double, 27, 1>>(all[k].data());
      held_.col(scalars() + field) = conditions_on(RoundSurface({Harmonic::Zero(1, 3), term[0], term[1]}), base.through);
      ++field;
    }
  following_.emplace(followed());
  if (!base.through.empty())
    held_.leftCols(scalars()) = size_ * conditions_on_functions(base.through, options.degree, space.combination);
}

std::vector<PiecewisePolynomial> RoundProblem::directions_of(const Side& side) const {
  return slope_directions(side, scale_, of_.position_only, size_);
}

CurvatureFollowing RoundProblem::followed() const {
  std::vector<FollowedSide> all;
  if (of_.curvature && !of_.side.q.empty() && scale_[0] > 0) {
    const RoundSurface patch(of_.terms);
    std::vector<Across> across;
    for (double t : space_.t) across.push_back(along_radius(patch, t));
    const PiecewisePolynomial alpha = PiecewisePolynomial::linear(of_.alpha, of_.alpha), beta = PiecewisePolynomial::linear(0, 0);
    FollowedSide side = followed_side(of_.side, 0, alpha, beta, space_.t, across);
    side.skew.fill(0);
    side.first = scalars();
    side.scale = scale_;
    all.push_back(side);
  }
  return {space_.along, std::move(all), 1, size_, options_.curvature_jump};
}

double RoundProblem::reach(const Eigen::VectorXd& x) const {
  double most = std::numeric_limits<double>::infinity();
  if (scale_[0] == 0) return most;
  for (const double t : evenly(64)) {
    double change = 0;
    for (int m = 0; m < options_.slopes; ++m) change += scale_[0] * x[scalars() + m] * value_of(space_.waves[m], t);
    if (!(change >= 0)) most = std::min(most, -(1 - min_alpha_kept) * of_.alpha / change);
    if (change > 0) most = std::min(most, (max_slope - 1) * of_.alpha / change);
  }
  return most;
}

std::vector<Harmonic> RoundProblem::correction(const Eigen::VectorXd& x, const RoundBase& base,
                                               const std::optional<Eigen::Matrix3d>& axis) const {
  Points a(interior_, 3);
  for (int c = 0; c < 3; ++c) a.col(c) = size_ * (space_.combination * x.segment(c * interior_, interior_));
  std::vector<Harmonic> terms = round_terms(a, options_.degree);
  if (axis) of_revolution(terms, *axis);
  Index field = scalars();
  const Index rows = base.terms[1].rows();
  std::vector<Harmonic> slopes = {Harmonic::Zero(1, 3), Harmonic::Zero(rows, 3), Harmonic::Zero(rows, 3)};
  for (const PiecewisePolynomial& direction : directions_of(base.side))
    for (const PiecewisePolynomial& wave : space_.waves) {
      const std::array<Harmonic, 2> own = slope_terms(wave, direction, slopes[1].rows());
      const bool counts = !axis || &wave == space_.waves.data();
      for (int j = 0; counts && j < 2; ++j) slopes[1 + j] += x[field] * own[j];
      ++field;
    }
  return sum_of(std::move(terms), slopes);
}

}  // namespace tripatch
