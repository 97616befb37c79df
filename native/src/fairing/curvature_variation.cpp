#include "tripatch/fairing/curvature_variation.h"

#include <Eigen/Dense>
#include <array>
#include <cmath>

namespace tripatch {
namespace {

const double root3 = std::sqrt(3.0);

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

/// What is left of (c, 0) after the best theta, in four orthonormal directions.
class Rest {
public:
  Eigen::Vector2d theta;
  Eigen::Vector4d value;
  Rest(const Derivatives& d, const Eigen::Vector4d& c, double flat) {
    Eigen::Matrix<double, 6, 2> m;
    m.topRows<4>() = explained(d(2, 2), d(3, 2), d(4, 2));
    m.bottomRows<2>() = std::sqrt(flat) * Eigen::Matrix2d::Identity();
    Vec6 right = Vec6::Zero();
    right.head<4>() = c;
    // Householder's reflections, written out: Eigen's QR of this size takes the compiler twenty seconds.
    for (int k = 0; k < 2; ++k) {
      Vec6& w = mirror_[k];
      w = m.col(k);
      w.head(k).setZero();
      w[k] += std::copysign(w.norm(), w[k]);
      w.normalize();
      for (int j = k; j < 2; ++j) reflect(k, m.col(j));
      reflect(k, right);
    }
    value = right.tail<4>();
    theta[1] = right[1] / m(1, 1);
    theta[0] = (right[0] - m(0, 1) * theta[1]) / m(0, 0);
  }

  /// 6 x 4.
  Eigen::Matrix<double, 6, 4> directions() const {
    Eigen::Matrix<double, 6, 4> all = Eigen::Matrix<double, 6, 4>::Zero();
    all.bottomRows<4>().setIdentity();
    for (int k = 1; k >= 0; --k)
      for (int j = 0; j < 4; ++j) reflect(k, all.col(j));
    return all;
  }

private:
  template <class Column>
  void reflect(int k, Column&& v) const {
    v -= 2 * mirror_[k].dot(v) * mirror_[k];
  }

  std::array<Vec6, 2> mirror_;
};

// First variation in the frame, where P_i = e_i, g_ij = delta_ij, Gamma^l_ij = P_ij . e_l, h_ij = P_ij . n:
//   d h_ij = dP_ij . n - Gamma^l_ij dP_l . n,   d Gamma^l_ij = dP_ij . e_l - Gamma^m_ij dP_m . e_l + h_ij dP_l . n,
// and the frame itself turns by -1/2 dg.
// Rows are over first and second derivatives; of the third only the normal parts matter.
using Row = Eigen::Matrix<double, 1, 15>;
using Rows = Eigen::Matrix<double, 4, 15, Eigen::RowMajor>;

int at(int derivative, int x) { return 3 * derivative + x; }

/// row -= factor / 2 dg_ij
template <class AnyRow>
void subtract_half_metric(AnyRow&& row, double factor, int i, int j) {
  row[at(i, j)] -= 0.5 * factor;
  row[at(j, i)] -= 0.5 * factor;
}

/// The rows of h_ij and Gamma^l_ij, by i + j, before the frame turns.
struct FormRows {
  std::array<Row, 3> h;
  std::array<std::array<Row, 3>, 2> gamma;

  explicit FormRows(const Derivatives& d) {
    for (int s = 0; s < 3; ++s) {
      h[s].setZero();
      h[s][at(2 + s, 2)] = 1;
      for (int l = 0; l < 2; ++l) h[s][at(l, 2)] -= d(2 + s, l);
      for (int l = 0; l < 2; ++l) {
        Row& row = gamma[l][s];
        row.setZero();
        row[at(2 + s, l)] = 1;
        for (int m = 0; m < 2; ++m) row[at(m, l)] -= d(2 + s, m);
        row[at(l, 2)] += d(2 + s, 2);
      }
    }
  }

  /// Those of h in the turning frame.
  std::array<Row, 3> turned(const Derivatives& d) const {
    std::array<Row, 3> out = h;
    for (int i = 0; i < 2; ++i)
      for (int j = i; j < 2; ++j)
        for (int l = 0; l < 2; ++l) {
          subtract_half_metric(out[i + j], d(second(l, j), 2), i, l);
          subtract_half_metric(out[i + j], d(second(i, l), 2), j, l);
        }
    return out;
  }
};

/// Those of the four components of the variation, `plain` their values without multiplicity.
Rows variation_rows(const Derivatives& d, const FormRows& form, const std::array<double, 4>& plain) {
  Rows rows;
  for (int m = 0; m < 4; ++m) {
    const auto [i, j, k] = component[m];
    Row r = Row::Zero();
    for (int l = 0; l < 2; ++l) {
      r[at(l, 2)] -= d(third(i, j, k), l);
      for (const auto& [a, b, e] : {std::array{i, j, k}, std::array{i, k, j}, std::array{j, k, i}})
        r -= d(second(l, e), 2) * form.gamma[l][a + b] + d(second(a, b), l) * form.h[l + e];
    }
    for (int l = 0; l < 2; ++l) {
      subtract_half_metric(r, plain[l + j + k], i, l);
      subtract_half_metric(r, plain[l + i + k], j, l);
      subtract_half_metric(r, plain[l + i + j], k, l);
    }
    rows.row(m) = multiplicity[m] * r;
  }
  return rows;
}

/// What is left of them when sym(h theta) is taken away, theta held.
Rows rest_rows(const Rows& all, const std::array<Row, 3>& h, const Eigen::Vector2d& theta) {
  Rows rows = all;
  const double t1 = theta[0], t2 = theta[1];
  rows.row(0) -= t1 * h[0];
  rows.row(1) -= (2 * t1 * h[1] + t2 * h[0]) / root3;
  rows.row(2) -= (t1 * h[2] + 2 * t2 * h[1]) / root3;
  rows.row(3) -= t2 * h[2];
  return rows;
}

}  // namespace

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
  r.quadric = Rest(frame.d, r.variation, flat).value;
  return r;
}

CurvatureVariationRows curvature_variation_rows(const Derivatives& given, double flat) {
  const LocalFrame frame(given);
  const Derivatives& d = frame.d;
  Eigen::Vector4d c;
  std::array<double, 4> plain;
  for (int m = 0; m < 4; ++m) {
    plain[m] = variation(d, component[m][0], component[m][1], component[m][2]);
    c[m] = multiplicity[m] * plain[m];
  }
  const FormRows form(d);
  const Rows c_rows = variation_rows(d, form, plain);
  const Rest rest(d, c, flat);
  const Eigen::Matrix<double, 4, 4> project = rest.directions().topRows<4>().transpose();

  CurvatureVariationRows out;
  const double s = std::sqrt(frame.area);
  out.value << s * c, s * (project * c);
  Eigen::Matrix<double, 8, 15, Eigen::RowMajor> local;
  local.topRows<4>() = s * c_rows;
  local.bottomRows<4>() = s * project.lazyProduct(rest_rows(c_rows, form.turned(d), rest.theta));
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

}  // namespace tripatch
