#include "tripatch/constructions/shape_search.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tripatch/math/decompositions.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// What is sought is x = log(lambda / (1 - lambda)), so that lambda stays between 0 and 1.
using Vector3 = Eigen::Vector3d;
double to_lambda(double x) { return 1 / (1 + std::exp(-x)); }
const double bound = std::log((1 - tolerance::slight) / tolerance::slight);

constexpr int scan_nodes = 9;  // in each direction, the middle one lambda = 1/2
double scan_node(int k) { return share::nearly_all * bound * (2.0 * k / (scan_nodes - 1) - 1); }

/// The energies at all combinations of nodes: from all inner products between terms there.
class Scan {
public:
  explicit Scan(const ShapeEnergy& energy) {
    Eigen::MatrixXd all(energy.stacked(0, 0.5).size(), 3 * scan_nodes);
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < scan_nodes; ++k) all.col(i * scan_nodes + k) = energy.stacked(i, to_lambda(scan_node(k)));
    gram_ = all.transpose() * all;
  }

  /// Below this the energy differs by rounding only.
  double tiny() const { return tolerance::rounding * gram_.diagonal().maxCoeff(); }

  /// The four lowest of the local minima; the middle alone where the energy is flat (the three surfaces agree): nothing to choose.
  std::vector<Vector3> starts() const {
    constexpr int n = scan_nodes, m = n / 2;
    constexpr std::size_t most = count::several;  // descents
    std::vector<std::pair<double, std::array<int, 3>>> lowest;
    for (int a = 0; a < n; ++a)
      for (int b = 0; b < n; ++b)
        for (int c = 0; c < n; ++c)
          if (is_lowest({a, b, c})) lowest.push_back({at({a, b, c}), {a, b, c}});
    std::sort(lowest.begin(), lowest.end(), [](const auto& p, const auto& q) { return p.first < q.first; });
    if (lowest.size() > most) lowest.resize(most);
    if (at({m, m, m}) - lowest[0].first <= tiny()) lowest = {{at({m, m, m}), {m, m, m}}};
    std::vector<Vector3> out;
    for (const auto& [energy, k] : lowest) out.emplace_back(scan_node(k[0]), scan_node(k[1]), scan_node(k[2]));
    return out;
  }

private:
  double at(const std::array<int, 3>& k) const {
    const std::array<int, 3> column = {k[0], scan_nodes + k[1], 2 * scan_nodes + k[2]};
    double sum = 0;
    for (int p : column)
      for (int q : column) sum += gram_(p, q);
    return sum;
  }

  bool is_lowest(const std::array<int, 3>& k) const {
    const double here = at(k);
    for (int da = -1; da <= 1; ++da)
      for (int db = -1; db <= 1; ++db)
        for (int dc = -1; dc <= 1; ++dc) {
          const std::array<int, 3> near = {k[0] + da, k[1] + db, k[2] + dc};
          const auto [least, most] = std::minmax_element(near.begin(), near.end());
          if (*least >= 0 && *most < scan_nodes && !(here <= at(near))) return false;
        }
    return true;
  }

  Eigen::MatrixXd gram_;
};

Eigen::VectorXd total(const ShapeEnergy& energy, const Vector3& x) {
  return energy.stacked(0, to_lambda(x[0])) + energy.stacked(1, to_lambda(x[1])) + energy.stacked(2, to_lambda(x[2]));
}

SzilvasiNagy::Step step_of(const Vector3& x, double energy) {
  return {{to_lambda(x[0]), to_lambda(x[1]), to_lambda(x[2])}, energy};
}

/// Newton's direction at x, where the stacked terms are f; zero where x is a minimum. Where the energy pushes against a bound, x is held.
Vector3 newton_direction(const ShapeEnergy& energy, const Vector3& x, const Eigen::VectorXd& f) {
  constexpr double longest = 2;  // in x, where the model is still near
  Vector3 gradient;
  Eigen::Matrix3d hessian;
  std::array<Eigen::VectorXd, 3> slope;
  for (int i = 0; i < 3; ++i) {
    const double lambda = to_lambda(x[i]), d = lambda * (1 - lambda);
    slope[i] = d * energy.stacked(i, lambda, 1);
    gradient[i] = 2 * f.dot(slope[i]);
    hessian(i, i) = 2 * d * d * f.dot(energy.stacked(i, lambda, 2)) + (1 - 2 * lambda) * gradient[i];
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) hessian(i, j) = (i == j ? hessian(i, i) : 0) + 2 * slope[i].dot(slope[j]);
  for (int i = 0; i < 3; ++i) {
    if (!(x[i] >= bound && gradient[i] < 0) && !(x[i] <= -bound && gradient[i] > 0)) continue;
    gradient[i] = 0;
    hessian.row(i).setZero();
    hessian.col(i).setZero();
    hessian(i, i) = 1;
  }
  if (gradient.norm() <= tolerance::solved * f.squaredNorm()) return Vector3::Zero();
  const PrincipalAxes axes = principal_axes(hessian);
  const Vector3 curvature = axes.values.cwiseAbs().cwiseMax(tolerance::solved * axes.values.cwiseAbs().maxCoeff());
  const Eigen::Matrix3d scaled = axes.vectors * curvature.cwiseInverse().asDiagonal(),
                        inverse = scaled * axes.vectors.transpose();
  Vector3 direction = -(inverse * gradient);
  if (direction.norm() > longest) direction *= longest / direction.norm();
  return direction;
}

/// Newton's method, kept inside the bounds.
std::vector<SzilvasiNagy::Step> descend(const ShapeEnergy& energy, Vector3 x, double tiny) {
  constexpr int steps = count::halvings;  // at most
  Eigen::VectorXd f = total(energy, x);
  double e = f.squaredNorm();
  std::vector<SzilvasiNagy::Step> path = {step_of(x, e)};
  for (int iteration = 0; iteration < steps && e > tiny; ++iteration) {
    const Vector3 direction = newton_direction(energy, x, f);
    if (direction.isZero(0)) break;
    bool better = false;
    for (double length = 1; length > tolerance::same; length *= 0.5) {
      const Vector3 next = (x + length * direction).cwiseMax(-bound).cwiseMin(bound);
      Eigen::VectorXd f_next = total(energy, next);
      const double e_next = f_next.squaredNorm();
      if (!(e_next < e)) continue;
      better = e - e_next > tolerance::fit * e;
      x = next;
      f = std::move(f_next);
      e = e_next;
      path.push_back(step_of(x, e));
      break;
    }
    if (!better) break;
  }
  return path;
}

}  // namespace

std::vector<SzilvasiNagy::Step> min_energy(const ShapeEnergy& energy, const std::array<double, 3>& given) {
  const Scan scan(energy);
  std::vector<SzilvasiNagy::Step> best;
  for (const Vector3& start : scan.starts()) {
    std::vector<SzilvasiNagy::Step> path = descend(energy, start, scan.tiny());
    if (best.empty() || path.back().energy < best.back().energy) best = std::move(path);
  }
  Vector3 first;
  for (int i = 0; i < 3; ++i) first[i] = std::log(given[i] / (1 - given[i]));
  best.insert(best.begin(), {given, total(energy, first).squaredNorm()});
  return best;
}

}  // namespace tripatch
