#include "tripatch/cage/cage_fair.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "tripatch/fairing/curvature_variation.h"
#include "tripatch/math/damping.h"
#include "tripatch/math/decompositions.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Squared weight, over the hole's size squared, that keeps what shall not move where it is; that of the energies is about 1 (0 with
/// 1e8).
constexpr double pinned_over = tolerance::solved;
/// Rounds in which the weights of the logarithms, one over their values where the step leads, settle; 6e-4 with two, 4e-4 with six.
constexpr int weight_rounds = count::few;

double power_derivative(double t, int power, int order) {
  double r = 1;
  for (int k = 0; k < order; ++k) r *= power - k;
  return order > power ? 0 : r * std::pow(t, power - order);
}

/// The nine derivatives at `places` of the polynomial with the given monomials through values at `samples`.
Weights derivative_weights(const std::vector<std::array<double, 2>>& samples, const std::vector<std::array<int, 2>>& monomials,
                           const std::vector<std::array<double, 2>>& places) {
  constexpr std::array<std::array<int, 2>, 9> orders = {{{1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}, {3, 0}, {2, 1}, {1, 2}, {0, 3}}};
  const Index n = static_cast<Index>(samples.size());
  Eigen::MatrixXd values(n, n), wanted(9 * static_cast<Index>(places.size()), n);
  const auto fill = [&](Eigen::MatrixXd& m, Index row, const std::array<double, 2>& at, const std::array<int, 2>& order) {
    for (std::size_t k = 0; k < monomials.size(); ++k)
      m(row, static_cast<Index>(k)) =
          power_derivative(at[0], monomials[k][0], order[0]) * power_derivative(at[1], monomials[k][1], order[1]);
  };
  for (Index k = 0; k < n; ++k) fill(values, k, samples[k], {0, 0});
  for (std::size_t p = 0; p < places.size(); ++p)
    for (std::size_t d = 0; d < 9; ++d) fill(wanted, static_cast<Index>(9 * p + d), places[p], orders[d]);
  const Eigen::MatrixXd weights = wanted * SquareSystem(values).inverse();
  return weights;
}

Weights quad_weights() {
  std::vector<std::array<double, 2>> samples, places;
  std::vector<std::array<int, 2>> monomials;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      samples.push_back({(i + 0.5) / 4, (j + 0.5) / 4});
      monomials.push_back({i, j});
    }
  for (int u : {1, 3})
    for (int v : {1, 3}) places.push_back({u / 4.0, v / 4.0});
  return derivative_weights(samples, monomials, places);
}

Weights triangle_weights() {
  std::vector<std::array<double, 2>> samples;
  std::vector<std::array<int, 2>> monomials;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; i + j < 4; ++j) {
      samples.push_back({(i + 1.0 / 3) / 4, (j + 1.0 / 3) / 4});
      monomials.push_back({i, j});
    }
  return derivative_weights(samples, monomials, {{1.0 / 6, 1.0 / 6}, {2.0 / 3, 1.0 / 6}, {1.0 / 6, 2.0 / 3}});
}

/// Energy at positions of the free vertices; with `model` also Gauss-Newton's sum of squares about them, y the movement there.
double variation(const CageSystem& system, const FairHole& hole, const Points& free, const Eigen::VectorXd& y,
                 CageSystem::Term* model) {
  double sum = 0;
  for (const FaceShape& face : hole.inside) {
    check_interruption();
    const Points all = face.derivatives.at(free);
    const Index columns = static_cast<Index>(face.derivatives.slots.size());
    const Index places = all.rows() / 9;
    Weights jacobian(4 * places, 3 * columns);
    Eigen::VectorXd value(4 * places);
    for (Index p = 0; p < places; ++p) {
      const Derivatives d = all.middleRows<9>(9 * p);
      const double w = hole.size * std::sqrt(face.area);
      if (!model) {
        const CurvatureVariation v = curvature_variation(d, flat_curvature(hole.size));
        sum += w * w * v.area * v.variation.squaredNorm();
        continue;
      }
      const CurvatureVariationRows rows = curvature_variation_rows(d, flat_curvature(hole.size));
      value.segment<4>(4 * p) = w * rows.value.head<4>();
      const auto weights = face.derivatives.weights.middleRows<9>(9 * p);
      for (int x = 0; x < 3; ++x) {
        Eigen::Matrix<double, 4, 9> part;
        for (int k = 0; k < 9; ++k) part.col(k) = w * rows.derivative.col(3 * k + x).head<4>();
        const Weights product = part * weights;
        for (Index c = 0; c < columns; ++c) jacobian.col(3 * c + x).segment<4>(4 * p) = product.col(c);
      }
    }
    if (!model) continue;
    sum += value.squaredNorm();
    Eigen::VectorXd here(3 * columns);
    for (Index c = 0; c < columns; ++c) here.segment<3>(3 * c) = y.segment<3>(3 * face.derivatives.slots[c]);
    system.add(*model, face.derivatives.slots, jacobian, value - jacobian * here);
  }
  return sum;
}

}  // namespace

FaceShape face_shape(const Sums& positions, bool triangle) {
  static const Weights quad = quad_weights(), three = triangle_weights();
  const Weights& weights = triangle ? three : quad;
  return {{positions.slots, weights * positions.weights, weights * positions.rest}, triangle ? 1.0 / 6 : 0.25};
}

void add_third_derivatives(const CageSystem& system, const FairHole& hole, const Points& free, double weight,
                           CageSystem::Term& term) {
  for (const FaceShape& face : hole.even) {
    check_interruption();
    const Points now = face.derivatives.at(free);
    for (Index row = 0; row < now.rows(); ++row) {
      const Index d = row % 9;
      if (d < 5) continue;
      const double w = weight * face.area * (d == 6 || d == 7 ? 3 : 1);
      system.add(term, face.derivatives, row, w * Eigen::Matrix3d::Identity(), now.row(row));
    }
  }
}

Points fair_cage(CageSystem& system, const Points& start, std::vector<FairHole>& holes, const CageSystem::Term& held,
                 const std::vector<int>& fixed, const FairCageOptions& options) {
  const std::size_t count = holes.size();
  const auto at = [&](const Eigen::VectorXd& y) { return Points(start + Eigen::Map<const Points>(y.data(), start.rows(), 3)); };

  std::vector<CageSystem::Term> third(count, system.zero());
  CageSystem::Term pins = system.zero();
  for (int slot : fixed) {
    const Sums vertex = {{slot}, Weights::Ones(1, 1), Points::Zero(1, 3)};
    system.add(pins, vertex, 0, Eigen::Matrix3d::Identity() / (pinned_over * holes[0].size * holes[0].size), Vec3::Zero());
  }
  CageSystem::Term sum = pins;
  for (std::size_t h = 0; h < count; ++h) {
    add_third_derivatives(system, holes[h], start, 1 / (holes[h].size * holes[h].size), third[h]);
    system.add(sum, 1, third[h]);
  }
  Eigen::VectorXd y = system.step(sum, Eigen::VectorXd::Zero(start.size()), anchor);

  struct Value {
    double merit = 0;
    std::vector<double> variation, third;
  };
  const auto measure = [&](const Eigen::VectorXd& x) {
    Value value;
    const Points free = at(x);
    for (std::size_t h = 0; h < count; ++h) {
      value.variation.push_back(variation(system, holes[h], free, x, nullptr));
      value.third.push_back(third[h](x));
      if (holes[h].inside.empty()) continue;
      value.merit +=
          std::log(value.variation[h] + tolerance::solved) + options.parameters * std::log(value.third[h] + tolerance::solved);
    }
    value.merit += held(x);
    if (!std::isfinite(value.merit)) value.merit = std::numeric_limits<double>::infinity();
    return value;
  };
  Value value = measure(y);
  for (std::size_t h = 0; h < count; ++h) holes[h].before = holes[h].after = value.variation[h];
  if (!std::isfinite(value.merit)) return at(y);

  double damping = tolerance::same;
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    check_interruption();
    std::vector<CageSystem::Term> model(count, system.zero());
    const Points free = at(y);
    for (std::size_t h = 0; h < count; ++h) variation(system, holes[h], free, y, &model[h]);
    double gain = 0;
    for (int attempt = 0; attempt < dampings_tried && gain == 0; ++attempt) {
      Eigen::VectorXd next = y;
      for (int round = 0; round < weight_rounds; ++round) {  // a logarithm's weight is one over its value where the step leads
        sum = held;
        system.add(sum, 1, pins);
        for (std::size_t h = 0; h < count; ++h) {
          if (holes[h].inside.empty()) continue;
          system.add(sum, 1 / (std::max(model[h](next), tolerance::slight * value.variation[h]) + tolerance::solved), model[h]);
          system.add(sum, options.parameters / (std::max(third[h](next), 0.0) + tolerance::solved), third[h]);
        }
        next = y + system.step(sum, y, damping);
      }
      Value there = next.allFinite() ? measure(next) : Value{std::numeric_limits<double>::infinity(), {}, {}};
      if (there.merit < value.merit) {
        gain = value.merit - there.merit;
        y = next;
        value = std::move(there);
        damping = std::max(damping / damping_by, anchor);
      } else {
        damping *= damping_by;
      }
    }
    if (gain < options.enough) break;
  }
  for (std::size_t h = 0; h < count; ++h) holes[h].after = value.variation[h];
  return at(y);
}

}  // namespace tripatch
