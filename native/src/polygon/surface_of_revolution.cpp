#include "tripatch/polygon/surface_of_revolution.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tripatch/fairing/curvature_following.h"
#include "tripatch/fairing/descent.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/fairing_problem.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/quadrature.h"
#include "tripatch/math/smoothstep.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/math/tolerant_compare.h"

namespace tripatch {
namespace {

/// Caps of spheres, 20 to 85 degrees wide, are the same to 1e-9 of the radius with half as many and with twice as many.
constexpr int profile_nodes = count::dozens;
/// Unknowns of the profile next to the slope at the rim: a choice.
constexpr int height_terms = 4, radius_terms = 3, profile_unknowns = 1 + height_terms + radius_terms;
constexpr double first_counts = 1;  ///< with 0 heights of funnels' caps are left to the bound on slopes
/// Below the first of these ratios (see quadrics_count) quadrics do not count, above the second they do.
constexpr double no_blunt_quadric = 0.05, blunt_quadric = 0.15;
/// What a mesh does not know of the curvature counts as this share of it at most, or spheres would do for cones; or as that share of the
/// meridian's own, of which a cone has none. Of blunt quadrics with rims of 12 and 16 edges caps come up to ten times as near so.
constexpr double max_unknown = 0.05, max_unknown_of_bend = 0.2;
/// Of the jump that sides of other patches are followed to: a rim is all that is known here, and its curvature is met. With the whole of it a
/// shallow cap is a sphere's, which has no variation at all, and funnels' caps below -35 degrees jump from one valley to another.
constexpr double jump_share = 0.3;
constexpr double difference_step = 1e-5;  ///< of unknowns, over the radius: residuals are smooth, and exact to 1e-10 so
/// Of descent, which ends before where no energy is left or gained: on spheres after 30.
constexpr int max_profile_steps = 100;

using Monomials = std::vector<double>;

/// rho^odd (1 - rho^2)^k.
Monomials bubble(int k, int odd) {
  Monomials out = {1};
  for (int j = 0; j < k; ++j) {
    out.resize(out.size() + 2, 0);
    for (std::size_t n = out.size(); n-- > 2;) out[n] -= out[n - 2];
  }
  if (odd) out.insert(out.begin(), 0);
  return out;
}

double derivative_at(const Monomials& p, int order, double rho) {
  double sum = 0;
  for (int n = static_cast<int>(p.size()) - 1; n >= order; --n) {
    double factor = p[n];
    for (int j = 0; j < order; ++j) factor *= n - j;
    sum = sum * rho + factor;
  }
  return sum;
}

/// Radius and height over the rim's radius, and what is wanted of them.
class Profile {
public:
  Profile(const RoundBase& base, const Eigen::Matrix3d& frame, Fairing energy, double curvature_jump)
      : radius_(base.terms[0].row(1).dot(frame.col(0))), slope_(fourier([&](double t) { return base.side.r(t); }, 1)) {
    const auto [x, w] = gauss(profile_nodes);
    rho_.assign(x.begin(), x.end());
    rho_.push_back(1);
    weight_.assign(w.begin(), w.end());
    diameter_ = base.size / radius_;
    const double across_radius = -0.5 * base.alpha * slope_.row(1).dot(frame.col(0)) / radius_,
                 across_height = -0.5 * base.alpha * slope_.row(0).dot(frame.col(2)) / radius_;
    add(0, 0, bubble(0, 1), 1);
    add(0, 0, bubble(1, 1), base.terms[1].row(1).dot(frame.col(0)) / radius_);
    add(1, 0, bubble(1, 0), base.terms[1].row(0).dot(frame.col(2)) / radius_);
    add(0, 1, bubble(1, 1), across_radius);
    add(1, 1, bubble(1, 0), across_height);
    for (int j = 0; j < radius_terms; ++j) add(0, 2 + j, bubble(2 + j, 1), 1);
    for (int j = 0; j < height_terms; ++j) add(1, 2 + radius_terms + j, bubble(2 + j, 0), 1);
    want_curvature(base, frame, curvature_jump);
    if (energy == Fairing::minimum_variation) quadric_counts_ = 0;
  }

  /// What is to be small, as sums of squares, and the logarithm that descends.
  struct Value {
    std::array<Eigen::VectorXd, 5> parts;  // variation, rest of a quadric, jump at the rim, third and first derivatives
    std::array<double, 5> squares = {};
    double share = 0;  // of the quadric energy in the logarithm's derivative
    double energy = 0, log = std::numeric_limits<double>::infinity();
  };

  Value at(const Eigen::VectorXd& y) const;
  Eigen::VectorXd step(const Eigen::VectorXd& y, const Value& v, double damping) const;
  /// The terms that are added, in scene units.
  std::vector<Harmonic> terms(const Eigen::VectorXd& y, const RoundBase& base, const Eigen::Matrix3d& frame) const;

private:
  Index row(int function, int derivative, std::size_t node) const {
    return static_cast<Index>((4 * function + derivative) * rho_.size() + node);
  }
  void add(int function, int column, const Monomials& p, double factor) {
    if (map_.size() == 0) map_.setZero(static_cast<Index>(8 * rho_.size()), 1 + profile_unknowns);
    for (int d = 0; d < 4; ++d)
      for (std::size_t k = 0; k < rho_.size(); ++k) map_(row(function, d, k), column) += factor * derivative_at(p, d, rho_[k]);
  }
  void want_curvature(const RoundBase& base, const Eigen::Matrix3d& frame, double curvature_jump);
  void weigh(Value& v) const;

  double radius_, diameter_ = 0;
  Harmonic slope_;
  std::vector<double> rho_, weight_;  // of the nodes; the last of rho is the rim
  Eigen::MatrixXd map_;               // of the values: of the base, then by unknown
  double bend_ = 0, tolerated_ = 0;   // along the meridian at the rim; 0: not followed
  double quadric_counts_ = 0;
};

/// The two curvatures, and their derivatives by the meridian's length; length of the derivative by rho.
struct Bend {
  double length, meridian, parallel, meridian_slope, parallel_slope;
};

Bend bend_of(const std::array<double, 4>& r, const std::array<double, 4>& z) {
  Bend b;
  const double v = b.length = Vec2(r[1], z[1]).stableNorm(), turn = r[1] * z[2] - z[1] * r[2],
               v1 = (r[1] * r[2] + z[1] * z[2]) / v;
  b.meridian = turn / (v * v * v);
  b.meridian_slope = ((r[1] * z[3] - z[1] * r[3]) - 3 * turn * v1 / v) / (v * v * v * v);
  b.parallel = z[1] / (v * r[0]);
  b.parallel_slope = (z[2] - z[1] * v1 / v - z[1] * r[1] / r[0]) / (v * v * r[0]);
  return b;
}

void Profile::want_curvature(const RoundBase& base, const Eigen::Matrix3d& frame, double curvature_jump) {
  if (!base.curvature || base.side.q.empty()) return;
  const Harmonic bend = fourier([&](double t) { return upright_bend(base.side, t); }, 8);
  const Vec2 outward(slope_.row(1).dot(frame.col(0)), slope_.row(0).dot(frame.col(2)));
  const Vec2 normal = Vec2(-outward[1], outward[0]).normalized();
  bend_ = radius_ * normal.dot(Vec2(bend.row(1).dot(frame.col(0)), bend.row(0).dot(frame.col(2))));
  const double parallel = -normal[0], squares = bend_ * bend_ + parallel * parallel + flat_curvature(diameter_);
  const double unknown = tolerated_deviations * base.side.curvature_error * radius_;
  const double most = std::max(max_unknown * std::sqrt(squares), max_unknown_of_bend * std::abs(bend_));
  tolerated_ = Vec2(jump_share * curvature_jump * std::sqrt(squares), std::min(unknown, most)).stableNorm();
  const double sure = std::copysign(std::max(std::abs(bend_) - base.side.curvature_error * radius_, 0.0), bend_);
  quadric_counts_ = quadrics_count(sure * parallel / squares);
}

Profile::Value Profile::at(const Eigen::VectorXd& y) const {
  Value v;
  const double change = 1 + y[0];
  if (!at_least(change, min_alpha_kept) || !at_least(max_slope, change)) return v;
  const Eigen::VectorXd all = map_.col(0) + map_.rightCols(profile_unknowns) * y;
  const Index nodes = static_cast<Index>(weight_.size());
  v.parts = {Eigen::VectorXd(2 * nodes), Eigen::VectorXd(3 * nodes), Eigen::VectorXd::Zero(1), Eigen::VectorXd(2 * nodes),
             Eigen::VectorXd(3 * nodes)};
  const double flat = flat_curvature(diameter_), root3 = std::numbers::sqrt3;
  for (Index k = 0; k <= nodes; ++k) {
    std::array<double, 4> r, z;
    for (int d = 0; d < 4; ++d) r[d] = all[row(0, d, k)], z[d] = all[row(1, d, k)];
    if (!(r[0] > 0)) return v;
    const Bend b = bend_of(r, z);
    if (k == nodes) {
      if (tolerated_ > 0) v.parts[2][0] = (b.meridian - bend_) / tolerated_;
      continue;
    }
    const double area = diameter_ * std::sqrt(2 * std::numbers::pi * weight_[k] * r[0] * b.length),
                 plane = std::sqrt(weight_[k] * rho_[k]);
    const Vec2 variation(b.meridian_slope, root3 * b.parallel_slope), explained(b.meridian, b.parallel / root3);
    const double theta = variation.dot(explained) / (explained.squaredNorm() + flat);
    v.parts[0].segment<2>(2 * k) = area * variation;
    v.parts[1].segment<3>(3 * k) << area * (variation - theta * explained), area * std::sqrt(flat) * theta;
    v.parts[3].segment<2>(2 * k) << plane * r[3], plane * z[3];
    v.parts[4].segment<3>(3 * k) << plane * r[1], plane * z[1], plane * r[0] / rho_[k];
  }
  for (int p = 0; p < 5; ++p) v.squares[p] = v.parts[p].squaredNorm();
  weigh(v);
  return v;
}

void Profile::weigh(Value& v) const {
  const double ratio = quadric_counts_ * quadric_ratio * v.squares[0] / std::max(v.squares[1], tolerance::tiny);
  v.share = 1 - 1 / (1 + std::pow(ratio, 4));
  v.energy = v.squares[0] / std::pow(1 + std::pow(ratio, 4), 0.25);
  v.log = std::log(std::max(v.energy, tolerance::tiny)) +
          parameterization_counts * std::log(std::max(v.squares[3], tolerance::tiny)) +
          first_counts * std::log(std::max(v.squares[4], tolerance::tiny)) + v.squares[2];
}

/// Gauss-Newton's, the logarithms' parts weighed by their values where the step leads, as Merit::step.
Eigen::VectorXd Profile::step(const Eigen::VectorXd& y, const Value& v, double damping) const {
  std::array<Eigen::MatrixXd, 5> slopes;
  for (int p = 0; p < 5; ++p) slopes[p].setZero(v.parts[p].size(), profile_unknowns);
  for (Index k = 0; k < profile_unknowns; ++k) {
    Eigen::VectorXd off = Eigen::VectorXd::Zero(profile_unknowns);
    off[k] = difference_step;
    const Value up = at(y + off), down = at(y - off);
    if (up.parts[0].size() == 0 || down.parts[0].size() == 0 || !std::isfinite(up.log) || !std::isfinite(down.log)) continue;
    for (int p = 0; p < 5; ++p) slopes[p].col(k) = (up.parts[p] - down.parts[p]) / (2 * difference_step);
  }
  Eigen::VectorXd change = Eigen::VectorXd::Zero(profile_unknowns);
  for (int round = 0; round < 4; ++round) {
    Value there = v;
    for (int p : {0, 1, 3, 4})
      there.squares[p] =
          std::max({(v.parts[p] + slopes[p] * change).squaredNorm(), tolerance::slight * v.squares[p], tolerance::tiny});
    weigh(there);
    const std::array<double, 5> weight = {(1 - there.share) / there.squares[0], there.share / there.squares[1], 1,
                                          parameterization_counts / there.squares[3], first_counts / there.squares[4]};
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(profile_unknowns, profile_unknowns);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(profile_unknowns);
    for (int p = 0; p < 5; ++p) {
      const Eigen::MatrixXd squares = slopes[p].transpose() * slopes[p];
      const Eigen::VectorXd down = slopes[p].transpose() * v.parts[p];
      normal += weight[p] * squares;
      gradient += weight[p] * down;
    }
    normal.diagonal() += damping * normal.diagonal() + tolerance::fit * normal.trace() * Eigen::VectorXd::Ones(profile_unknowns);
    change = constrained_quadratic_minimum(normal, gradient, Eigen::MatrixXd(0, profile_unknowns));
    if (!change.allFinite()) break;
  }
  return change;
}

std::vector<Harmonic> Profile::terms(const Eigen::VectorXd& y, const RoundBase& base, const Eigen::Matrix3d& frame) const {
  const int waves = static_cast<int>(base.terms[1].rows() - 1) / 2;
  std::vector<Harmonic> out = {Harmonic::Zero(1, 3),
                               -0.5 * base.alpha * y[0] * fourier([&](double t) { return base.side.r(t); }, waves)};
  for (int j = 0; j < std::max(radius_terms, height_terms); ++j) {
    Harmonic term = Harmonic::Zero(3, 3);
    if (j < height_terms) term.row(0) = radius_ * y[1 + radius_terms + j] * frame.col(2);
    for (int x = 0; x < 2 && j < radius_terms; ++x) term.row(1 + x) = radius_ * y[1 + j] * frame.col(x);
    out.push_back(term);
  }
  return out;
}

}  // namespace

double quadrics_count(double ratio) { return smoothstep((ratio - no_blunt_quadric) / (blunt_quadric - no_blunt_quadric)); }

std::optional<std::vector<Harmonic>> fairest_of_revolution(const RoundBase& base, const Eigen::Matrix3d& frame, Fairing energy,
                                                           double curvature_jump) {
  const Profile profile(base, frame, energy, curvature_jump);
  Eigen::VectorXd y = Eigen::VectorXd::Zero(profile_unknowns);
  Profile::Value value = profile.at(y);
  if (!std::isfinite(value.log)) return {};
  double damping = tolerance::slight;
  for (int step = 0; step < max_profile_steps && value.energy > tolerance::rounding; ++step) {
    double gain = 0;
    for (int attempt = 0; attempt < 10 && gain == 0; ++attempt) {
      const Eigen::VectorXd change = profile.step(y, value, damping);
      const Profile::Value next = change.allFinite() ? profile.at(y + change) : Profile::Value();
      if (next.log < value.log) {
        gain = value.log - next.log;
        y += change;
        value = next;
        damping = std::max(damping / 10, tolerance::solved);
      } else {
        damping *= 10;
      }
    }
    if (gain < tolerance::solved) break;
  }
  return sum_of(base.terms, profile.terms(y, base, frame));
}

}  // namespace tripatch
