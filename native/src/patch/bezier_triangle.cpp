#include "tripatch/patch/bezier_triangle.h"

#include <algorithm>
#include <string>
#include <utility>

#include "tripatch/boundary/rectangle_surface.h"

namespace tripatch {
namespace {

/// One step on a net of degree `degree` in place: every point becomes x0 P_(i+1,j,k) + x1 P_(i,j+1,k) + x2 P_(i,j,k+1). With x
/// a point that is de Casteljau's step, with x a direction the difference that a derivative needs.
void step(double* w, int degree, const double* x) {
  for (int r = 0; r < degree; ++r)
    for (int k = 0; k <= r; ++k) {
      double* p = w + 3 * (r * (r + 1) / 2 + k);
      const double* q = w + 3 * ((r + 1) * (r + 2) / 2 + k);
      for (int a = 0; a < 3; ++a) p[a] = x[0] * p[a] + x[1] * q[a] + x[2] * q[a + 3];
    }
}

}  // namespace

BezierTriangle::BezierTriangle(Points net) : net_(std::move(net)) {
  while (degree_ <= max_degree && net_size(degree_) < net_.rows()) ++degree_;
  if (degree_ > max_degree) throw CodedArgument(Code::out_of_range, {{"name", "degree"}, {"from", 0}, {"to", max_degree}});
  if (net_size(degree_) != net_.rows()) throw CodedArgument(Code::wrong_net, {{"count", net_.rows()}});
  for (Index k = 0; k < net_.rows(); ++k)
    if (!net_.row(k).allFinite()) throw CodedArgument(Code::not_finite, {{"name", "net[" + std::to_string(k) + "]"}});
}

void BezierTriangle::evaluate(const double* b, Index n, int order, double* out) const {
  if (order < 0 || order > max_order) throw InvalidArgument("derivatives must be from 0 to 4");
  const int m = std::min(order, degree_);
  const double d0[3] = {1, 0, -1}, d1[3] = {0, 1, -1};
  std::vector<double> work(net_.size());
  double part[3 * jet_size(max_order)];
  for (Index p = 0; p < n; ++p, out += 3 * jet_size(order)) {
    std::copy(net_.data(), net_.data() + net_.size(), work.begin());
    for (int level = degree_; level > m; --level) step(work.data(), level, b + 3 * p);
    std::fill(out, out + 3 * jet_size(order), 0.0);
    // The coefficient of db0^i db1^j is n! / (i! j! (n-i-j)!) times the blossom of n-i-j times b, i times d0, j times d1.
    for (int s = m; s >= 0; --s) {
      double factor = 1;  // n! / (s! (n - s)!), then times s! / (i! j!)
      for (int k = 0; k < s; ++k) factor = factor * (degree_ - k) / (k + 1);
      for (int j = 0; j <= s; ++j) {
        std::copy(work.data(), work.data() + 3 * jet_size(s), part);
        for (int k = s; k > 0; --k) step(part, k, k > j ? d0 : d1);
        for (int a = 0; a < 3; ++a) out[3 * jet_index(s - j, j) + a] = factor * part[a];
        factor = factor * (s - j) / (j + 1);
      }
      if (s > 0) step(work.data(), s, b + 3 * p);
    }
  }
}

BezierTriangle BezierTriangle::elevated() const {
  const int n = degree_ + 1;
  Points net(net_size(n), 3);
  for (int i = 0; i <= n; ++i)
    for (int k = 0; i + k <= n; ++k) {
      const int j = n - i - k;
      Vec3 p = Vec3::Zero();
      if (i > 0) p += i * net_.row(row(i - 1, j, k)).transpose();
      if (j > 0) p += j * net_.row(row(i, j - 1, k)).transpose();
      if (k > 0) p += k * net_.row(row(i, j, k - 1)).transpose();
      net.row(row(i, j, k)) = p / n;
    }
  return BezierTriangle(std::move(net));
}

BezierTriangle BezierTriangle::derivative(const Vec3& direction) const {
  if (degree_ == 0) return BezierTriangle(Points(Points::Zero(1, 3)));
  Points net = net_;
  step(net.data(), degree_, direction.data());
  return BezierTriangle(Points(degree_ * net.topRows(net_size(degree_ - 1))));
}

Points BezierTriangle::side(int i) const {
  Points curve(degree_ + 1, 3);
  for (int k = 0; k <= degree_; ++k) curve.row(k) = net_.row(side_row(degree_, i, k));
  return curve;
}

Index side_row(int degree, int i, int k) {
  int e[3] = {0, 0, 0};
  e[(i + 1) % 3] = degree - k;
  e[(i + 2) % 3] = k;
  return BezierTriangle::row(e[0], e[1], e[2]);
}

Points elevated_curve(const Points& curve) {
  const Index n = curve.rows();  // the new degree
  Points out(n + 1, 3);
  out.row(0) = curve.row(0);
  out.row(n) = curve.row(n - 1);
  for (Index k = 1; k < n; ++k) {
    const double s = static_cast<double>(k) / static_cast<double>(n);
    out.row(k) = s * curve.row(k - 1) + (1 - s) * curve.row(k);
  }
  return out;
}

Side side_of(const BezierTriangle& triangle, int i, bool reversed) {
  if (i < 0 || i > 2) throw CodedArgument(Code::out_of_range, {{"name", "edge"}, {"from", 0}, {"to", 2}, {"value", i}});
  Vec3 inward = Vec3::Constant(-0.5);
  inward[i] = 1;
  const BezierTriangle r = triangle.derivative(inward), q = r.derivative(inward);
  const auto along = [&](const BezierTriangle& s) {
    const Points curve = s.side(i);
    return PiecewisePolynomial::bezier({curve.data(), static_cast<std::size_t>(curve.size())}, 3);
  };
  return checked_edge({along(triangle), along(r), along(q)}, i, reversed);
}

}  // namespace tripatch
