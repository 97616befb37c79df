#include "tripatch/fairing/energy.h"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

namespace tripatch {
namespace {

const double root3 = std::sqrt(3.0);

/// Gauss-Legendre nodes and weights on [0, 1] by Newton's method on the Legendre polynomial.
void gauss(int n, std::vector<double>& x, std::vector<double>& w) {
  x.resize(n);
  w.resize(n);
  for (int k = 0; k < n; ++k) {
    double z = std::cos(std::numbers::pi * (k + 0.75) / (n + 0.5)), slope = 1;
    for (int it = 0; it < 100; ++it) {
      double p = 1, q = 0;
      for (int j = 0; j < n; ++j) {
        const double r = q;
        q = p;
        p = ((2 * j + 1) * z * q - j * r) / (j + 1);
      }
      slope = n * (z * p - q) / (z * z - 1);
      const double step = p / slope;
      z -= step;
      if (std::abs(step) < 1e-15) break;
    }
    x[k] = 0.5 * (1 - z);
    w[k] = 1 / ((1 - z * z) * slope * slope);
  }
}

/// Derivatives in (x, y) from Taylor coefficients in (b0, b1): db0 = dx - dy / sqrt 3, db1 = 2 dy / sqrt 3.
Eigen::Matrix<double, 9, 9> chart_change() {
  Eigen::Matrix<double, 9, 9> m = Eigen::Matrix<double, 9, 9>::Zero();
  const Jet<3> b0 = Jet<3>::linear(0, 1, -1 / root3), b1 = Jet<3>::linear(0, 0, 2 / root3);
  const std::array<double, 4> factorial = {1, 1, 2, 6};
  for (int d = 1; d <= 3; ++d)
    for (int j = 0; j <= d; ++j) {
      Jet<3> term(1.0);
      for (int k = 0; k < d - j; ++k) term *= b0;
      for (int k = 0; k < j; ++k) term *= b1;
      for (int k = 0; k <= d; ++k)
        m(jet_index(d - k, k) - 1, jet_index(d - j, j) - 1) = term.c[jet_index(d - k, k)] * factorial[d - k] * factorial[k];
    }
  return m;
}

/// The point seen in its own frame: parameters and space turned so that P_1 = e1, P_2 = e2, n = e3. Derivatives of one order there are
/// made of those of the same order.
struct LocalFrame {
  double area;
  Eigen::Matrix3d space;  // rows e1, e2, n
  Eigen::Matrix2d first;  // of the parameters, by order
  Eigen::Matrix3d second;
  Eigen::Matrix4d third;
  Derivatives d;  // in the frame

  explicit LocalFrame(const Derivatives& given) {
    const Vec3 p1 = given.row(0), p2 = given.row(1), cross = p1.cross(p2);
    area = cross.norm();
    const double length = p1.norm();
    const Vec3 e1 = p1 / length, n = cross / area, e2 = n.cross(e1);
    space << e1.transpose(), e2.transpose(), n.transpose();
    const double g = area / length, f = p2.dot(e1);
    const double a = 1 / length, p = -f / (length * g), q = 1 / g;  // e1 = a d/dx, e2 = p d/dx + q d/dy
    first << a, 0, p, q;
    second << a * a, 0, 0, a * p, a * q, 0, p * p, 2 * p * q, q * q;
    third << a * a * a, 0, 0, 0, a * a * p, a * a * q, 0, 0, a * p * p, 2 * a * p * q, a * q * q, 0, p * p * p, 3 * p * p * q,
        3 * p * q * q, q * q * q;
    const Eigen::Matrix<double, 9, 3, Eigen::RowMajor> turned = given.lazyProduct(space.transpose());
    d.topRows<2>() = first.lazyProduct(turned.topRows<2>());
    d.middleRows<3>(2) = second.lazyProduct(turned.middleRows<3>(2));
    d.bottomRows<4>() = third.lazyProduct(turned.bottomRows<4>());
  }
};

int second(int i, int j) { return 2 + i + j; }
int third(int i, int j, int k) { return 5 + i + j + k; }
const std::array<double, 4> multiplicity = {1, root3, root3, 1};
const std::array<std::array<int, 3>, 4> component = {{{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 1, 1}}};

/// The covariant derivative of h in the frame: n . P_ijk - sym(Gamma^l_ij h_lk).
double variation(const Derivatives& d, int i, int j, int k) {
  double c = d(third(i, j, k), 2);
  for (int l = 0; l < 2; ++l)
    c -= d(second(i, j), l) * d(second(l, k), 2) + d(second(i, k), l) * d(second(l, j), 2) +
         d(second(j, k), l) * d(second(l, i), 2);
  return c;
}

/// sym(h theta), its four weighted components, as a matrix on theta.
Eigen::Matrix<double, 4, 2> explained(double h11, double h12, double h22) {
  Eigen::Matrix<double, 4, 2> a;
  a << h11, 0, 2 * h12 / root3, h11 / root3, h22 / root3, 2 * h12 / root3, 0, h22;
  return a;
}

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// What is left of (c, 0) after the best theta, in four orthonormal directions: `rest` is 6 x 4.
struct Rest {
  Eigen::Matrix<double, 6, 4> directions;
  Eigen::Vector2d theta;
  Rest(const Derivatives& d, const Eigen::Vector4d& c, double flat) {
    Eigen::Matrix<double, 6, 2> m;
    m.topRows<4>() = explained(d(2, 2), d(3, 2), d(4, 2));
    m.bottomRows<2>() = std::sqrt(flat) * Eigen::Matrix2d::Identity();
    Vec6 right = Vec6::Zero();
    right.head<4>() = c;
    // Householder's reflections, written out: Eigen's QR of this size takes the compiler twenty seconds.
    std::array<Vec6, 2> mirror;
    const auto reflect = [&](int k, auto&& v) { v -= 2 * mirror[k].dot(v) * mirror[k]; };
    for (int k = 0; k < 2; ++k) {
      Vec6& w = mirror[k];
      w = m.col(k);
      w.head(k).setZero();
      w[k] += std::copysign(w.norm(), w[k]);
      w.normalize();
      for (int j = 0; j < 2; ++j) reflect(k, m.col(j));
      reflect(k, right);
    }
    theta[1] = right[1] / m(1, 1);
    theta[0] = (right[0] - m(0, 1) * theta[1]) / m(0, 0);
    directions.setZero();
    directions.bottomRows<4>().setIdentity();
    for (int k = 1; k >= 0; --k)
      for (int j = 0; j < 4; ++j) reflect(k, directions.col(j));
  }
};

}  // namespace

Quadrature corner_quadrature(int n) {
  std::vector<double> x, w;
  gauss(n, x, w);
  Quadrature result;
  result.b.resize(6 * n * n, 3);
  const double area = root3 / 4 / 6;  // of one of the six
  Index row = 0;
  for (int i = 0; i < 3; ++i)
    for (int side = 1; side < 3; ++side) {
      const Eigen::RowVector3d vertex = Eigen::RowVector3d::Unit(i),
                               middle = 0.5 * (vertex + Eigen::RowVector3d::Unit((i + side) % 3)),
                               centre = Eigen::RowVector3d::Constant(1.0 / 3);
      for (int a = 0; a < n; ++a)
        for (int c = 0; c < n; ++c) {
          const Eigen::RowVector3d b = vertex + x[a] * ((1 - x[c]) * (middle - vertex) + x[c] * (centre - vertex));
          result.b.row(row++) = b;
          result.weights.push_back(w[a] * w[c] * x[a] * 2 * area * 27 / 8 * (1 - b[0]) * (1 - b[1]) * (1 - b[2]));
        }
    }
  return result;
}

std::vector<Derivatives> cartesian_derivatives(const Surface& surface, const Points& b) {
  static const Eigen::Matrix<double, 9, 9> change = chart_change();
  Eigen::Matrix<double, Eigen::Dynamic, 30, Eigen::RowMajor> jets(b.rows(), 30);
  surface.evaluate(b.data(), b.rows(), 3, jets.data());
  std::vector<Derivatives> out(b.rows());
  for (Index k = 0; k < b.rows(); ++k) out[k].noalias() = change * Eigen::Map<const Derivatives>(jets.row(k).data() + 3);
  return out;
}

CurvatureVariation curvature_variation(const Derivatives& given, double flat) {
  const LocalFrame frame(given);
  CurvatureVariation r;
  r.area = frame.area;
  for (int c = 0; c < 4; ++c)
    r.variation[c] = multiplicity[c] * variation(frame.d, component[c][0], component[c][1], component[c][2]);
  r.quadric = Rest(frame.d, r.variation, flat).directions.topRows<4>().transpose() * r.variation;
  return r;
}

CurvatureVariationRows curvature_variation_rows(const Derivatives& given, double flat) {
  // First variation in the frame, where P_i = e_i, g_ij = delta_ij, Gamma^l_ij = P_ij . e_l, h_ij = P_ij . n:
  //   d h_ij = dP_ij . n - Gamma^l_ij dP_l . n,   d Gamma^l_ij = dP_ij . e_l - Gamma^m_ij dP_m . e_l + h_ij dP_l . n,
  // and the frame itself turns by -1/2 dg.
  // Rows are over first and second derivatives; of the third only the normal parts matter.
  using Row = Eigen::Matrix<double, 1, 15>;
  using Rows = Eigen::Matrix<double, 4, 15, Eigen::RowMajor>;
  const LocalFrame frame(given);
  const Derivatives& d = frame.d;
  const auto at = [](int derivative, int x) { return 3 * derivative + x; };

  std::array<Row, 3> h_row;
  std::array<std::array<Row, 3>, 2> gamma_row;
  for (int s = 0; s < 3; ++s) {
    Row& h = h_row[s];
    h.setZero();
    h[at(2 + s, 2)] = 1;
    for (int l = 0; l < 2; ++l) h[at(l, 2)] -= d(2 + s, l);
    for (int l = 0; l < 2; ++l) {
      Row& gamma = gamma_row[l][s];
      gamma.setZero();
      gamma[at(2 + s, l)] = 1;
      for (int m = 0; m < 2; ++m) gamma[at(m, l)] -= d(2 + s, m);
      gamma[at(l, 2)] += d(2 + s, 2);
    }
  }
  const auto subtract_half_metric = [&](auto&& row, double factor, int i, int j) {  // factor / 2 dg_ij
    row[at(i, j)] -= 0.5 * factor;
    row[at(j, i)] -= 0.5 * factor;
  };

  Eigen::Vector4d c;
  std::array<double, 4> plain;
  for (int m = 0; m < 4; ++m) {
    plain[m] = variation(d, component[m][0], component[m][1], component[m][2]);
    c[m] = multiplicity[m] * plain[m];
  }
  Rows c_rows;
  for (int m = 0; m < 4; ++m) {
    const auto [i, j, k] = component[m];
    Row r = Row::Zero();
    for (int l = 0; l < 2; ++l) {
      r[at(l, 2)] -= d(third(i, j, k), l);
      for (const auto& [a, b, e] : {std::array{i, j, k}, std::array{i, k, j}, std::array{j, k, i}})
        r -= d(second(l, e), 2) * gamma_row[l][a + b] + d(second(a, b), l) * h_row[l + e];
    }
    for (int l = 0; l < 2; ++l) {
      subtract_half_metric(r, plain[l + j + k], i, l);
      subtract_half_metric(r, plain[l + i + k], j, l);
      subtract_half_metric(r, plain[l + i + j], k, l);
    }
    c_rows.row(m) = multiplicity[m] * r;
  }
  // h in the turning frame
  std::array<Row, 3> h_frame = h_row;
  for (int i = 0; i < 2; ++i)
    for (int j = i; j < 2; ++j)
      for (int l = 0; l < 2; ++l) {
        subtract_half_metric(h_frame[i + j], d(second(l, j), 2), i, l);
        subtract_half_metric(h_frame[i + j], d(second(i, l), 2), j, l);
      }

  const Rest rest(d, c, flat);
  const Eigen::Matrix<double, 4, 4> project = rest.directions.topRows<4>().transpose();
  Rows rest_rows = c_rows;
  const double t1 = rest.theta[0], t2 = rest.theta[1];
  rest_rows.row(0) -= t1 * h_frame[0];
  rest_rows.row(1) -= (2 * t1 * h_frame[1] + t2 * h_frame[0]) / root3;
  rest_rows.row(2) -= (t1 * h_frame[2] + 2 * t2 * h_frame[1]) / root3;
  rest_rows.row(3) -= t2 * h_frame[2];

  CurvatureVariationRows out;
  const double s = std::sqrt(frame.area);
  out.value << s * c, s * (project * c);
  Eigen::Matrix<double, 8, 15, Eigen::RowMajor> local;
  local.topRows<4>() = s * c_rows;
  local.bottomRows<4>() = s * project.lazyProduct(rest_rows);
  for (int l = 0; l < 2; ++l) local.col(at(l, l)) += 0.5 * out.value;  // of the area element
  Eigen::Matrix<double, 8, 4> thirds;                                  // of n . P_111, P_112, P_122, P_222
  thirds.setZero();
  for (int m = 0; m < 4; ++m) {
    thirds(m, m) = s * multiplicity[m];
    thirds.col(m).tail<4>() = s * multiplicity[m] * project.col(m);
  }
  // back to the parameters and the space that were given
  const Eigen::Matrix<double, 8, 4> normal = thirds.lazyProduct(frame.third);
  for (int m = 0; m < 8; ++m) {
    const Eigen::Map<const Eigen::Matrix<double, 5, 3, Eigen::RowMajor>> in(local.row(m).data());
    Eigen::Map<Derivatives> derivative(out.derivative.row(m).data());
    derivative.topRows<2>() = frame.first.transpose().lazyProduct(in.topRows<2>().lazyProduct(frame.space).eval());
    derivative.middleRows<3>(2) = frame.second.transpose().lazyProduct(in.bottomRows<3>().lazyProduct(frame.space).eval());
    derivative.bottomRows<4>() = normal.row(m).transpose().lazyProduct(frame.space.row(2));
  }
  return out;
}

double softly_smaller(double variation, double quadric) {
  const double ratio = quadric_ratio * variation / quadric;
  return variation / std::pow(1 + std::pow(ratio, 4), 0.25);
}

double energy(const Surface& surface, const std::string& name, double size, int nodes_per_direction) {
  const Quadrature quadrature = corner_quadrature(nodes_per_direction);
  const std::vector<Derivatives> all = cartesian_derivatives(surface, quadrature.b);
  if (name == "thin_plate" || name == "third_derivative") {
    double sum = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Derivatives& d = all[k];
      sum += quadrature.weights[k] *
             (name == "thin_plate"
                  ? d.row(2).squaredNorm() + 2 * d.row(3).squaredNorm() + d.row(4).squaredNorm()
                  : d.row(5).squaredNorm() + 3 * d.row(6).squaredNorm() + 3 * d.row(7).squaredNorm() + d.row(8).squaredNorm());
    }
    return sum;
  }
  double variation = 0, quadric = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const CurvatureVariation v = curvature_variation(all[k], flat_curvature(size));
    const double w = quadrature.weights[k] * size * size * v.area;
    variation += w * v.variation.squaredNorm();
    quadric += w * v.quadric.squaredNorm();
  }
  if (name == "minimum_variation") return variation;
  if (name == "quadric_variation") return quadric;
  if (name == "auto") return softly_smaller(variation, quadric);
  throw InvalidArgument("No energy is called '" + name +
                        "'; there are: thin_plate, third_derivative, minimum_variation, quadric_variation, auto");
}

double size_of(const Surface& surface) {
  constexpr int steps = 16;
  Points b(3 * steps, 3);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < steps; ++k) {
      b(steps * i + k, i) = 1 - static_cast<double>(k) / steps;
      b(steps * i + k, (i + 1) % 3) = static_cast<double>(k) / steps;
      b(steps * i + k, (i + 2) % 3) = 0;
    }
  const Points p = surface.positions(b);
  double size = 0;
  for (Index k = 0; k < p.rows(); ++k) size = std::max(size, (p.rowwise() - p.row(k)).rowwise().norm().maxCoeff());
  return size;
}

}  // namespace tripatch
