#include "tripatch/constructions/quintic.h"

#include <Eigen/Dense>
#include <numbers>

#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/vertex_ray.h"

namespace tripatch {
namespace {

constexpr int degree = 5, net_size = (degree + 1) * (degree + 2) / 2, samples = count::dozen;

Index net_row(int j, int k) { return Index(j + k) * (j + k + 1) / 2 + k; }
Index net_row(const std::array<int, 3>& at) { return net_row(at[1], at[2]); }

/// Row of the m-th point, from corner i + 1 to corner i + 2, of the row of the net with index `depth` at corner i.
Index row_of_side(int i, int depth, int m) {
  std::array<int, 3> at;
  at[i] = depth;
  at[(i + 1) % 3] = degree - depth - m;
  at[(i + 2) % 3] = m;
  return net_row(at);
}

double bernstein(int n, int m, double t) {
  double value = 1;
  for (int k = 1; k <= m; ++k) value *= t * (n - m + k) / k;
  for (int k = 0; k < n - m; ++k) value *= 1 - t;
  return value;
}

/// The fits do not depend on the data: their matrices, once.
struct Fit {
  Eigen::VectorXd t, root_weight;
  Eigen::MatrixXd middle;  ///< (2, samples): the two middle points of a curve from weighted positions
  Eigen::MatrixXd inside;  ///< (6, 3 samples): the six inner points from weighted slopes of the three sides
  std::array<Index, 6> inner_row;

  Fit() {
    t.resize(samples);
    root_weight.resize(samples);
    for (int g = 0; g < samples; ++g) {  // Chebyshev points: denser towards the corners
      const double angle = std::numbers::pi * (g + 0.5) / samples;
      t[g] = 0.5 * (1 - std::cos(angle));
      root_weight[g] = std::sqrt(std::sin(angle));
    }
    Eigen::MatrixXd curve(samples, 2);
    for (int g = 0; g < samples; ++g)
      for (int m = 0; m < 2; ++m) curve(g, m) = root_weight[g] * bernstein(5, 2 + m, t[g]);
    middle = least_squares(curve, Eigen::MatrixXd::Identity(samples, samples));

    int count = 0;
    for (int a = 1; a <= 3; ++a)
      for (int c = 1; a + c <= 4; ++c) inner_row[count++] = net_row({a, c, degree - a - c});
    Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(3 * samples, 6);
    for (int i = 0; i < 3; ++i)
      for (int m = 1; m <= 3; ++m)
        for (int unknown = 0; unknown < 6; ++unknown)
          if (inner_row[unknown] == row_of_side(i, 1, m))
            for (int g = 0; g < samples; ++g) slopes(i * samples + g, unknown) = -5 * root_weight[g] * bernstein(4, m, t[g]);
    inside = least_squares(slopes, Eigen::MatrixXd::Identity(3 * samples, 3 * samples));
  }
};

const Fit& fit() {
  static const Fit once;
  return once;
}

/// Derivative of the quintic in the direction -delta_i along side i, in Bernstein form (degree 4).
std::array<Vec3, 5> slope_of_net(const Points& net, int i) {
  std::array<Vec3, 5> slope;
  for (int m = 0; m < 5; ++m)
    slope[m] = 5 * (0.5 * (net.row(row_of_side(i, 0, m)) + net.row(row_of_side(i, 0, m + 1))) - net.row(row_of_side(i, 1, m)));
  return slope;
}

class Quintic final : public JetSurface<Quintic> {
public:
  Quintic(const Boundary& boundary, const Points& net) : rays_(rays(residual(boundary, net))) {
    for (int i = 0; i < 3; ++i) corner_[i] = boundary.ribbons[(i + 2) % 3].c(0);
    const std::array<double, 3> center = {1.0 / 3, 1.0 / 3, 1.0 / 3};
    const Barycentric<degree> b(center.data());
    JetPoint<degree> sum;
    for (int i = 0; i <= degree; ++i)
      for (int j = 0; i + j <= degree; ++j) {
        Jet<degree> term(1.0);
        int count = 0;
        const std::array<int, 3> power = {i, j, degree - i - j};
        for (int x = 0; x < 3; ++x)
          for (int n = 1; n <= power[x]; ++n) term *= b[x] * (static_cast<double>(++count) / n);
        sum += term * JetPoint<degree>(Vec3(net.row(net_row(power))));
      }
    for (int n = 0; n < net_size; ++n)
      for (int x = 0; x < 3; ++x) monomials_[n][x] = sum.x[x].c[n];
  }

  Vec3 corner(int i) const override { return corner_[i]; }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p = basic(b);
    const std::array<Jet<N>, 3> w = side_weights(b);
    for (int i = 0; i < 3; ++i) p += w[i] * rays_[i].at(b);
    return p;
  }

private:
  static std::array<VertexRay, 3> rays(const Boundary& boundary) {
    return {VertexRay(boundary, 0, RayDegree::cubic), VertexRay(boundary, 1, RayDegree::cubic),
            VertexRay(boundary, 2, RayDegree::cubic)};
  }

  /// The boundary data that the quintic misses.
  static Boundary residual(const Boundary& boundary, const Points& net) {
    Boundary rest = boundary;
    for (int i = 0; i < 3; ++i) {
      std::array<double, 18> curve;
      for (int m = 0; m <= 5; ++m) Vec3::Map(&curve[3 * m]) = net.row(row_of_side(i, 0, m));
      const std::array<Vec3, 5> slope = slope_of_net(net, i);
      std::array<double, 15> across;
      for (int m = 0; m < 5; ++m) Vec3::Map(&across[3 * m]) = slope[m];
      rest.ribbons[i].c = boundary.ribbons[i].c - PiecewisePolynomial::bezier(curve, 3);
      rest.ribbons[i].d = boundary.ribbons[i].d - PiecewisePolynomial::bezier(across, 3);
    }
    return rest;
  }

  /// The quintic's Taylor series at b from that at the centroid.
  template <int N>
  JetPoint<N> basic(const Barycentric<N>& b) const {
    std::array<double, degree + 1> x = {1}, y = {1};
    for (int k = 1; k <= degree; ++k) {
      x[k] = x[k - 1] * (b[0].value() - 1.0 / 3);
      y[k] = y[k - 1] * (b[1].value() - 1.0 / 3);
    }
    static constexpr int binomial[6][6] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}, {1, 4, 6, 4, 1}, {1, 5, 10, 10, 5, 1}};
    JetPoint<N> p;
    for (int d = 0; d <= N; ++d)
      for (int q = 0; q <= d; ++q)
        for (int i = d - q; i <= degree; ++i)
          for (int j = q; i + j <= degree; ++j) {
            const double f = binomial[i][d - q] * binomial[j][q] * x[i - (d - q)] * y[j - q];
            for (int n = 0; n < 3; ++n) p.x[n].c[jet_index(d - q, q)] += f * monomials_[jet_index(i, j)][n];
          }
    return p;
  }

  std::array<VertexRay, 3> rays_;
  std::array<Vec3, net_size> monomials_;
  std::array<Vec3, 3> corner_;
};

}  // namespace

Points quintic_net(const Boundary& boundary) {
  const Fit& f = fit();
  Points net = Points::Zero(net_size, 3);
  for (int i = 0; i < 3; ++i) {
    const PiecewisePolynomial& c = boundary.ribbons[i].c;
    std::array<Vec3, 6> p;
    p[0] = c(0);
    p[5] = c(1);
    p[1] = p[0] + c.derivative_at(0) / 5;
    p[4] = p[5] - c.derivative_at(1) / 5;
    Eigen::MatrixXd rest(samples, 3);
    for (int g = 0; g < samples; ++g) {
      Vec3 v = c(f.t[g]);
      for (int m : {0, 1, 4, 5}) v -= bernstein(5, m, f.t[g]) * p[m];
      rest.row(g) = f.root_weight[g] * v;
    }
    const Eigen::MatrixXd middle = f.middle * rest;
    p[2] = middle.row(0);
    p[3] = middle.row(1);
    for (int m = 0; m <= 5; ++m) net.row(row_of_side(i, 0, m)) = p[m];
  }
  Eigen::MatrixXd rest(3 * samples, 3);
  for (int i = 0; i < 3; ++i) {
    const std::array<Vec3, 5> slope = slope_of_net(net, i);  // the inner points still zero
    for (int g = 0; g < samples; ++g) {
      Vec3 v = boundary.ribbons[i].d(f.t[g]);
      for (int m = 0; m < 5; ++m) v -= bernstein(4, m, f.t[g]) * slope[m];
      rest.row(i * samples + g) = f.root_weight[g] * v;
    }
  }
  const Eigen::MatrixXd inside = f.inside * rest;
  for (int k = 0; k < 6; ++k) net.row(f.inner_row[k]) = inside.row(k);
  return net;
}

SurfacePtr quintic(const Boundary& boundary) { return std::make_shared<Quintic>(boundary, quintic_net(boundary)); }

}  // namespace tripatch
