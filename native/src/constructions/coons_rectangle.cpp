#include "tripatch/constructions/coons_rectangle.h"

#include <Eigen/Dense>
#include <cmath>

#include "tripatch/constructions/coons_bezier.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// Inner products of the Bernstein polynomials of a degree over [0, 1].
Eigen::MatrixXd univariate_gram(int n) {
  const auto binomial = [](int a, int b) { return std::exp(std::lgamma(a + 1) - std::lgamma(b + 1) - std::lgamma(a - b + 1)); };
  Eigen::MatrixXd gram(n + 1, n + 1);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) gram(i, j) = binomial(n, i) * binomial(n, j) / binomial(2 * n, i + j) / (2 * n + 1);
  return gram;
}

}  // namespace

BezierRectangle coons_rectangle(const BezierRectangle& boundary) {
  const int m = boundary.degree_u(), n = boundary.degree_v();
  Points net = boundary.net();
  const auto p = [&](int i, int j) { return net.row(boundary.row(i, j)); };
  for (int i = 1; i < m; ++i)
    for (int j = 1; j < n; ++j) {
      const double u = static_cast<double>(i) / m, v = static_cast<double>(j) / n;
      net.row(boundary.row(i, j)) = (1 - u) * p(0, j) + u * p(m, j) + (1 - v) * p(i, 0) + v * p(i, n) -
                                    (1 - u) * ((1 - v) * p(0, 0) + v * p(0, n)) - u * ((1 - v) * p(m, 0) + v * p(m, n));
    }
  return {net, m, n};
}

BezierRectangle permanence_rectangle(const BezierRectangle& boundary, double alpha) {
  if (!std::isfinite(alpha)) throw CodedArgument(Code::not_finite, {{"name", "alpha"}});
  const int m = boundary.degree_u(), n = boundary.degree_v();
  const double beta = 0.25 - alpha;
  const Index unknowns = Index(m - 1) * (n - 1);
  if (unknowns == 0) return boundary;
  Eigen::MatrixXd system = Eigen::MatrixXd::Identity(unknowns, unknowns), right = Eigen::MatrixXd::Zero(unknowns, 3);
  const auto unknown = [&](int i, int j) { return Index(i - 1) * (n - 1) + j - 1; };
  for (int i = 1; i < m; ++i)
    for (int j = 1; j < n; ++j)
      for (int di = -1; di <= 1; ++di)
        for (int dj = -1; dj <= 1; ++dj) {
          if (di == 0 && dj == 0) continue;
          const double weight = di != 0 && dj != 0 ? alpha : beta;
          const int a = i + di, b = j + dj;
          if (a > 0 && a < m && b > 0 && b < n) {
            system(unknown(i, j), unknown(a, b)) -= weight;
          } else {
            right.row(unknown(i, j)) += weight * boundary.net().row(boundary.row(a, b));
          }
        }
  const auto [inside, rank] = minimum_norm_least_squares(system, right, tolerance::rounding);
  if (rank < unknowns) throw CodedRefusal(Code::permanence_singular, {{"m", m}, {"n", n}, {"alpha", alpha}});
  Points net = boundary.net();
  for (int i = 1; i < m; ++i)
    for (int j = 1; j < n; ++j) net.row(boundary.row(i, j)) = inside.row(unknown(i, j));
  return {net, m, n};
}

double coons_energy(const BezierRectangle& surface) {
  const int m = surface.degree_u(), n = surface.degree_v();
  const Eigen::MatrixXd gu = univariate_gram(m - 1), gv = univariate_gram(n - 1);
  double energy = 0;
  for (int x = 0; x < 3; ++x) {
    Eigen::MatrixXd d(m, n);  // net of x_uv
    const auto p = [&](int i, int j) { return surface.net()(surface.row(i, j), x); };
    for (int i = 0; i < m; ++i)
      for (int j = 0; j < n; ++j) d(i, j) = m * n * (p(i + 1, j + 1) - p(i + 1, j) - p(i, j + 1) + p(i, j));
    const Eigen::MatrixXd half = d.transpose() * gu, form = half * d;
    energy += (form * gv).trace();
  }
  return energy;
}

}  // namespace tripatch
