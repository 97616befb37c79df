#include "tripatch/boundary/nurbs_surface.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "tripatch/math/jet.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

using Homogeneous = Eigen::RowVector4d;

int degree_of(const std::vector<double>& knots, Index count, const char* axis) {
  const std::string name = std::string("knots_") + axis;
  const Index degree = static_cast<Index>(knots.size()) - count - 1;
  if (count < 2)
    throw CodedArgument(Code::out_of_range, {{"name", std::string("points in ") + axis}, {"least", 2}, {"value", count}});
  const Index max_degree = std::min<Index>(count - 1, max_rectangle_degree);
  if (degree < 1 || degree > max_degree)
    throw CodedArgument(
        Code::out_of_range,
        {{"name", "len(" + name + ")"}, {"from", count + 2}, {"to", count + 1 + max_degree}, {"value", knots.size()}});
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (!std::isfinite(knots[k])) throw CodedArgument(Code::not_finite, {{"name", name + "[" + std::to_string(k) + "]"}});
    if (k > 0 && knots[k] < knots[k - 1]) throw CodedArgument(Code::knots_decrease, {{"name", name}, {"place", k}});
  }
  const auto repeats = [&](Index k) {
    return CodedArgument(Code::knots_repeat, {{"name", name}, {"knot", k}, {"degree", degree}});
  };
  if (!(knots[count] > knots[degree])) throw repeats(degree);
  for (Index k = degree + 1; k + degree < count; ++k)
    if (knots[k] == knots[k + degree] && knots[k] > knots[degree] && knots[k] < knots[count]) throw repeats(k);
  return static_cast<int>(degree);
}

/// Homogeneous Taylor coefficients to those of the point: A = w P, solved order by order. Univariate.
void divide(std::vector<Homogeneous>& a) {
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t j = 1; j <= k; ++j) a[k].head<3>() -= a[j][3] * a[k - j].head<3>();
    a[k].head<3>() /= a[0][3];
  }
}

}  // namespace

NurbsSurface::NurbsSurface(Points points, Index count_u, Index count_v, std::vector<double> weights, std::vector<double> knots_u,
                           std::vector<double> knots_v) {
  if (points.rows() != count_u * count_v) throw InvalidArgument("a NURBS surface needs count_u x count_v points");
  if (weights.empty()) weights.assign(points.rows(), 1.0);
  if (static_cast<Index>(weights.size()) != points.rows())
    throw InvalidArgument("there must be a weight for each of the " + std::to_string(points.rows()) + " points, not " +
                          std::to_string(weights.size()));
  axis_[0] = {std::move(knots_u), count_u, 0};
  axis_[1] = {std::move(knots_v), count_v, 0};
  axis_[0].degree = degree_of(axis_[0].knots, count_u, "u");
  axis_[1].degree = degree_of(axis_[1].knots, count_v, "v");
  homogeneous_.resize(points.rows(), 4);
  for (Index k = 0; k < points.rows(); ++k) {
    const std::string at = "[" + std::to_string(k / count_v) + ", " + std::to_string(k % count_v) + "]";
    if (!points.row(k).allFinite()) throw CodedArgument(Code::not_finite, {{"name", "points" + at}});
    if (!std::isfinite(weights[k])) throw CodedArgument(Code::not_finite, {{"name", "weights" + at}});
    if (!(weights[k] > 0))
      throw CodedArgument(Code::out_of_range, {{"name", "weights" + at}, {"above", 0}, {"value", weights[k]}});
    if (weights[k] != weights[0]) rational_ = true;
  }
  for (Index k = 0; k < points.rows(); ++k) {
    const double w = weights[k] / weights[0];  // equal weights become exactly 1
    homogeneous_.row(k) << w * points.row(k), w;
  }
}

Index NurbsSurface::Axis::span(double u) const {
  const auto after = std::upper_bound(knots.begin() + degree, knots.begin() + count, u);
  Index s = (after - knots.begin()) - 1;
  while (s > degree && knots[s] == knots[s + 1]) --s;  // at the end of the domain
  return std::max<Index>(s, degree);
}

void NurbsSurface::Axis::basis(Index s, double u, int order, double* out) const {
  // Cox-de Boor, each number a Taylor series in u (Piegl and Tiller, eq. 2.5); function r of the current degree starts at
  // knot s - d + r.
  const int size = order + 1;
  std::fill(out, out + (degree + 1) * size, 0.0);
  out[0] = 1;
  std::vector<double> next((degree + 1) * size);
  for (int d = 1; d <= degree; ++d) {
    std::fill(next.begin(), next.end(), 0.0);
    for (int r = 0; r < d; ++r) {  // a function of degree d - 1 feeds its own and the one before it
      const double left = knots[s - d + 1 + r], right = knots[s + 1 + r], h = 1 / (right - left);
      const double* f = out + r * size;
      double *rising = &next[(r + 1) * size], *falling = &next[r * size];
      for (int k = 0; k < size; ++k) {
        rising[k] += (u - left) * h * f[k];
        falling[k] += (right - u) * h * f[k];
        if (k > 0) {
          rising[k] += h * f[k - 1];
          falling[k] -= h * f[k - 1];
        }
      }
    }
    std::copy(next.begin(), next.end(), out);
  }
}

std::vector<double> NurbsSurface::Axis::breaks() const {
  std::vector<double> b(knots.begin() + degree, knots.begin() + count + 1);
  b.erase(std::unique(b.begin(), b.end()), b.end());
  return b;
}

std::array<double, 4> NurbsSurface::domain() const { return {axis_[0].from(), axis_[0].to(), axis_[1].from(), axis_[1].to()}; }

void NurbsSurface::evaluate(const double* uv, Index n, int order, double* out) const {
  if (order < 0 || order > 4) throw InvalidArgument("derivatives must be from 0 to 4");
  const auto& [au, av] = axis_;
  std::vector<double> bu((au.degree + 1) * (order + 1)), bv((av.degree + 1) * (order + 1));
  for (Index p = 0; p < n; ++p, out += 3 * jet_size(order)) {
    const Index su = au.span(uv[2 * p]), sv = av.span(uv[2 * p + 1]);
    au.basis(su, uv[2 * p], order, bu.data());
    av.basis(sv, uv[2 * p + 1], order, bv.data());
    std::array<Homogeneous, jet_size(4)> a;
    a.fill(Homogeneous::Zero());
    for (int r = 0; r <= au.degree; ++r) {
      std::array<Homogeneous, 5> row;  // along v
      row.fill(Homogeneous::Zero());
      for (int c = 0; c <= av.degree; ++c) {
        const Homogeneous point = homogeneous_.row((su - au.degree + r) * av.count + sv - av.degree + c);
        for (int j = 0; j <= order; ++j) row[j] += bv[c * (order + 1) + j] * point;
      }
      for (int i = 0; i <= order; ++i)
        for (int j = 0; i + j <= order; ++j) a[jet_index(i, j)] += bu[r * (order + 1) + i] * row[j];
    }
    for (int d = 0; d <= order; ++d)  // A = w P
      for (int j = 0; j <= d; ++j) {
        const int i = d - j;
        Eigen::Map<Eigen::RowVector3d> here(out + 3 * jet_index(i, j));
        here = a[jet_index(i, j)].head<3>();
        for (int k = 0; k <= i; ++k)
          for (int l = 0; l <= j; ++l)
            if (k + l > 0) here -= a[jet_index(k, l)][3] * Eigen::Map<Eigen::RowVector3d>(out + 3 * jet_index(i - k, j - l));
        here /= a[0][3];
      }
  }
}

/// An edge of a surface: the homogeneous curve of the edge and its first two derivatives across, as control points.
struct NurbsSurface::Edge {
  const Axis& along;
  std::array<Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>, 3> curve;
  std::array<double, 3> factor;  ///< of position, r into the surface, second derivative

  double from() const { return along.from(); }
  double length() const { return along.to() - along.from(); }

  /// Taylor coefficients along the edge of the k-th derivative across, divided by k!, homogeneous.
  std::array<std::vector<Homogeneous>, 3> series(double u, Index span, int order) const {
    std::vector<double> basis((along.degree + 1) * (order + 1));
    along.basis(span, u, order, basis.data());
    std::array<std::vector<Homogeneous>, 3> a;
    for (int k = 0; k < 3; ++k) {
      a[k].assign(order + 1, Homogeneous::Zero());
      for (int r = 0; r <= along.degree; ++r)
        for (int i = 0; i <= order; ++i) a[k][i] += basis[r * (order + 1) + i] * curve[k].row(span - along.degree + r);
    }
    return a;
  }

  /// Position and derivatives across where all weights are equal: exact.
  std::array<PiecewisePolynomial, 3> polynomials() const {
    // Monomials about the middle lose digits with the degree and the width of a piece: high degrees are split.
    const int split = along.degree <= 6 ? 1 : along.degree <= 12 ? 4 : 8;
    const std::vector<double> knots = along.breaks();
    std::vector<double> breaks = {0};
    std::array<std::vector<double>, 3> coefficients;
    for (std::size_t p = 0; p + 1 < knots.size(); ++p)
      for (int q = 0; q < split; ++q) {
        const double h = (knots[p + 1] - knots[p]) / split, u = knots[p] + (q + 0.5) * h;
        breaks.push_back(p + 2 == knots.size() && q + 1 == split ? 1.0 : (knots[p] + (q + 1) * h - from()) / length());
        const auto a = series(u, along.span(u), along.degree);
        for (int k = 0; k < 3; ++k) {
          double scale = factor[k];
          for (int i = 0; i <= along.degree; ++i, scale *= length())
            for (int x = 0; x < 3; ++x) coefficients[k].push_back(scale * a[k][i][x]);
        }
      }
    std::array<PiecewisePolynomial, 3> fields;
    for (int k = 0; k < 3; ++k) fields[k] = PiecewisePolynomial(breaks, along.degree, 3, coefficients[k]);
    return fields;
  }

  /// The k-th of them from fits between the knots, A = w P.
  PiecewisePolynomial fitted(int k) const {
    constexpr int degree = count::degree;
    const std::vector<double> knots = along.breaks();
    std::vector<double> breaks = {0}, coefficients;
    for (std::size_t p = 0; p + 1 < knots.size(); ++p) {
      const double h = knots[p + 1] - knots[p];
      const Index span = along.span(knots[p] + 0.5 * h);
      const PiecewisePolynomial part = PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> out) {
            for (std::size_t m = 0; m < t.size(); ++m) {
              const auto a = series(knots[p] + t[m] * h, span, 0);
              std::vector<Homogeneous> across_series = {a[0][0], a[1][0], a[2][0]};
              divide(across_series);
              for (int x = 0; x < 3; ++x) out[3 * m + x] = factor[k] * across_series[k][x];
            }
          },
          3, tolerance::fit, degree);
      for (Index piece = 0; piece < part.pieces(); ++piece) {
        const double a = part.breaks()[piece], b = part.breaks()[piece + 1];
        breaks.push_back(p + 2 == knots.size() && piece + 1 == part.pieces() ? 1.0 : (knots[p] + b * h - from()) / length());
        std::array<double, 3 * (degree + 1)> local;
        part.taylor(0.5 * (a + b), degree, local.data());
        double scale = 1;
        for (int i = 0; i <= degree; ++i, scale *= length() / h)
          for (int x = 0; x < 3; ++x) coefficients.push_back(scale * local[3 * i + x]);
      }
    }
    return {breaks, degree, 3, coefficients};
  }
};

Side NurbsSurface::side(int edge, bool reversed) const {
  if (edge < 0 || edge > 3) throw InvalidArgument("A rectangle has edges 0 to 3, not " + std::to_string(edge));
  const bool along_u = edge % 2 == 0, at_end = edge == 1 || edge == 2, backwards = edge >= 2;
  const Axis &along = axis_[along_u ? 0 : 1], &across = axis_[along_u ? 1 : 0];
  const double place = at_end ? across.to() : across.from(), inward = at_end ? -1 : 1;
  Edge on = {along, {}, {1, inward, 2}};
  const Index s = across.span(place);
  std::vector<double> b((across.degree + 1) * 3);
  across.basis(s, place, 2, b.data());
  for (int k = 0; k < 3; ++k) {
    on.curve[k].setZero(along.count, 4);
    for (Index i = 0; i < along.count; ++i)
      for (int r = 0; r <= across.degree; ++r) {
        const Index j = s - across.degree + r;
        on.curve[k].row(i) += b[r * 3 + k] * homogeneous_.row(along_u ? i * across.count + j : j * along.count + i);
      }
  }
  const auto fields = rational_ ? std::array{on.fitted(0), on.fitted(1), on.fitted(2)} : on.polynomials();
  return checked_edge({fields[0], fields[1], fields[2]}, edge, reversed != backwards);
}

}  // namespace tripatch
