#include "tripatch/grid/rows_surface.h"

#include <algorithm>

#include "tripatch/math/piecewise_polynomial.h"

namespace tripatch {
namespace {

std::vector<double> from_0_to_1(const std::vector<double>& t) {
  std::vector<double> out;
  for (double each : t) out.push_back((each - t.front()) / (t.back() - t.front()));
  return out;
}

/// Cubic polynomials through rows of values at t, of each piece the coefficients of powers from its middle: out[(piece * 4 + power) *
/// dimension + x].
std::vector<double> cubics(const std::vector<double>& t, const std::vector<double>& values, int dimension) {
  const PiecewisePolynomial spline = PiecewisePolynomial::spline(from_0_to_1(t), values, dimension);
  const double length = t.back() - t.front();
  std::vector<double> out((t.size() - 1) * 4 * dimension);
  for (std::size_t p = 0; p + 1 < t.size(); ++p) {
    double* const own = out.data() + p * 4 * dimension;
    spline.taylor((0.5 * (t[p] + t[p + 1]) - t.front()) / length, 3, own);
    double scale = 1;
    for (int k = 0; k < 4; ++k, scale /= length)
      for (int x = 0; x < dimension; ++x) own[k * dimension + x] *= scale;
  }
  return out;
}

Index piece_at(const std::vector<double>& t, double at) {
  const Index k = std::upper_bound(t.begin(), t.end(), at) - t.begin() - 1;
  return std::clamp<Index>(k, 0, static_cast<Index>(t.size()) - 2);
}

}  // namespace

RowsSurface::RowsSurface(std::vector<double> u, std::vector<double> v, const Points& points)
    : u_(std::move(u)), v_(std::move(v)), pieces_((u_.size() - 1) * (v_.size() - 1)) {
  const std::size_t n = u_.size(), m = v_.size();
  const int across = static_cast<int>(3 * m);
  const std::vector<double> along_u = cubics(u_, {points.data(), points.data() + points.size()}, across);
  for (std::size_t p = 0; p + 1 < n; ++p)
    for (std::size_t a = 0; a < 4; ++a) {
      const double* const row = along_u.data() + (p * 4 + a) * across;
      const std::vector<double> along_v = cubics(v_, {row, row + across}, 3);
      for (std::size_t q = 0; q + 1 < m; ++q)
        for (std::size_t b = 0; b < 4; ++b) pieces_[p * (m - 1) + q][4 * a + b] = Vec3::Map(along_v.data() + (q * 4 + b) * 3);
    }
}

void RowsSurface::evaluate(const double* b, Index n, int order, double* out) const {
  constexpr std::array<std::array<double, 4>, 4> choose = {
      {{1, 1, 1, 1}, {0, 1, 2, 3}, {0, 0, 1, 3}, {0, 0, 0, 1}}};  // j out of i
  for (Index k = 0; k < n; ++k, b += 3) {
    const Index i = piece_at(u_, b[0]), j = piece_at(v_, b[1]);
    const double x = b[0] - 0.5 * (u_[i] + u_[i + 1]), y = b[1] - 0.5 * (v_[j] + v_[j + 1]);
    const Piece& own = piece(i, j);
    const std::array<double, 4> xs = {1, x, x * x, x * x * x}, ys = {1, y, y * y, y * y * y};
    for (int d = 0; d <= order; ++d)
      for (int dv = 0; dv <= d; ++dv, out += 3) {
        const int du = d - dv;
        Vec3 sum = Vec3::Zero();
        for (int a = du; a < 4; ++a)
          for (int c = dv; c < 4; ++c) sum += choose[du][a] * xs[a - du] * choose[dv][c] * ys[c - dv] * own[4 * a + c];
        Vec3::Map(out) = sum;
      }
  }
}

}  // namespace tripatch
