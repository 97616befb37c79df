#include "tripatch/boundary/bezier_rectangle.h"

#include <algorithm>
#include <string>
#include <utility>

#include "tripatch/math/jet.h"

namespace tripatch {
namespace {

/// Taylor coefficients at t, up to `order`, of the Bezier curve whose points (of `width` numbers, 3 for one point) lie in w, from
/// the differences of de Casteljau's triangle. w is used up; out: (order + 1) x width.
void de_casteljau(double* w, int degree, Index width, double t, int order, double* out) {
  const int m = std::min(order, degree);
  std::fill(out, out + (order + 1) * width, 0.0);
  for (int level = degree; level > m; --level)
    for (Index k = 0; k < level * width; ++k) w[k] = (1 - t) * w[k] + t * w[k + width];
  for (int k = m; k >= 0; --k) {  // w holds k + 1 points, blossoms of degree - k times t
    double binomial = 1;
    for (int j = 0; j < k; ++j) binomial = binomial * (degree - j) / (j + 1);
    double sign = k % 2 ? -1 : 1;
    for (int j = 0; j <= k; ++j, sign = -sign) {
      for (Index x = 0; x < width; ++x) out[k * width + x] += sign * binomial * w[j * width + x];
      binomial = binomial * (k - j) / (j + 1);
    }
    for (Index x = 0; x < k * width; ++x) w[x] = (1 - t) * w[x] + t * w[x + width];
  }
}

}  // namespace

BezierRectangle::BezierRectangle(Points net, int degree_u, int degree_v)
    : degree_u_(degree_u), degree_v_(degree_v), net_(std::move(net)) {
  for (int degree : {degree_u, degree_v})
    if (degree < 1 || degree > max_rectangle_degree)
      throw CodedArgument(Code::out_of_range, {{"name", "degree"}, {"from", 1}, {"to", max_rectangle_degree}, {"value", degree}});
  if (net_.rows() != Index(degree_u + 1) * (degree_v + 1))
    throw InvalidArgument("A Bezier rectangle of degrees " + std::to_string(degree_u) + " and " + std::to_string(degree_v) +
                          " has " + std::to_string((degree_u + 1) * (degree_v + 1)) + " points, not " +
                          std::to_string(net_.rows()));
  for (Index k = 0; k < net_.rows(); ++k)
    if (!net_.row(k).allFinite())
      throw CodedArgument(Code::not_finite, {{"name", "net[" + std::to_string(k / (degree_v + 1)) + ", " +
                                                          std::to_string(k % (degree_v + 1)) + "]"}});
}

void BezierRectangle::evaluate(const double* uv, Index n, int order, double* out) const {
  if (order < 0 || order > 4) throw InvalidArgument("derivatives must be from 0 to 4");
  const Index width = 3 * (degree_v_ + 1);
  std::vector<double> work, curves((order + 1) * width), part(3 * (order + 1));
  for (Index p = 0; p < n; ++p, out += 3 * jet_size(order)) {
    work.assign(net_.data(), net_.data() + net_.size());
    de_casteljau(work.data(), degree_u_, width, uv[2 * p], order, curves.data());
    for (int i = 0; i <= order; ++i) {
      de_casteljau(&curves[i * width], degree_v_, 3, uv[2 * p + 1], order - i, part.data());
      for (int j = 0; i + j <= order; ++j) std::copy_n(&part[3 * j], 3, out + 3 * jet_index(i, j));
    }
  }
}

Side BezierRectangle::side(int edge, bool reversed) const {
  if (edge < 0 || edge > 3) throw CodedArgument(Code::out_of_range, {{"name", "edge"}, {"from", 0}, {"to", 3}, {"value", edge}});
  const bool along_u = edge % 2 == 0;
  const int along = along_u ? degree_u_ : degree_v_, across = along_u ? degree_v_ : degree_u_;
  // Point k along the edge, `deep` rows inside.
  const auto point = [&](int k, int deep) -> Eigen::RowVector3d {
    switch (edge) {
      case 0: return net_.row(row(k, deep));
      case 1: return net_.row(row(degree_u_ - deep, k));
      case 2: return net_.row(row(degree_u_ - k, degree_v_ - deep));
      default: return net_.row(row(deep, degree_v_ - k));
    }
  };
  Points c(along + 1, 3), r(along + 1, 3), q = Points::Zero(along + 1, 3);
  for (int k = 0; k <= along; ++k) {
    c.row(k) = point(k, 0);
    r.row(k) = across * (point(k, 1) - point(k, 0));
    if (across > 1) q.row(k) = across * (across - 1) * (point(k, 2) - 2 * point(k, 1) + point(k, 0));
  }
  const auto bezier = [](const Points& p) {
    return PiecewisePolynomial::bezier({p.data(), static_cast<std::size_t>(p.size())}, 3);
  };
  return checked_edge({bezier(c), bezier(r), bezier(q)}, edge, reversed);
}

}  // namespace tripatch
