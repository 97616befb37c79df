#include "tripatch/boundary/smoothed.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "tripatch/math/linear.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// The polynomial that has f's value and first kept - 1 derivatives at both ends.
class Ends {
public:
  Ends(const PiecewisePolynomial& f, int kept) : coefficients_(2 * kept, 3) {
    if (kept == 0) return;
    Eigen::MatrixXd conditions(2 * kept, 2 * kept), given(2 * kept, 3);
    for (int end = 0; end < 2; ++end)
      for (int order = 0; order < kept; ++order) {
        for (int k = 0; k < 2 * kept; ++k) {
          const std::array<double, 3> at_one = {1.0, double(k), 0.5 * k * (k - 1)};  // derivatives of t^k over the factorials
          conditions(end * kept + order, k) = end == 0 ? double(k == order) : at_one[order];
        }
        given.row(end * kept + order) = (order == 0 ? f(end) : f.derivative_at(end, order)) / (order == 2 ? 2 : 1);
      }
    coefficients_ = least_squares(conditions, given);
  }

  Eigen::RowVector3d operator()(double t) const {
    Eigen::RowVector3d p = Eigen::RowVector3d::Zero();
    for (Index k = coefficients_.rows() - 1; k >= 0; --k) p = t * p + coefficients_.row(k);
    return p;
  }

private:
  Eigen::MatrixXd coefficients_;  // of powers of t
};

/// Polynomial of t by least squares with given ends.
struct FittedPolynomial {
  int degree, kept;
  const Ends& ends;
  Eigen::MatrixXd coefficients;
  double residual;  // largest, at the values

  FittedPolynomial(const Eigen::VectorXd& t, const Eigen::MatrixXd& values, int of_degree, int of_kept, const Ends& given)
      : degree(of_degree), kept(of_kept), ends(given) {
    const Index n = t.size();
    Eigen::MatrixXd basis(n, degree + 1), rest = values;
    for (Index k = 0; k < n; ++k) {
      basis.row(k) = chebyshev(t[k]);
      rest.row(k) -= ends(t[k]);
    }
    coefficients = least_squares(basis, rest);
    residual = (basis * coefficients - rest).rowwise().norm().maxCoeff();
  }

  Eigen::RowVectorXd chebyshev(double t) const {
    Eigen::RowVectorXd row(degree + 1);
    const double x = 2 * t - 1;
    row[0] = 1;
    if (degree > 0) row[1] = x;
    for (int d = 2; d <= degree; ++d) row[d] = 2 * x * row[d - 1] - row[d - 2];
    return row * std::pow(4 * t * (1 - t), kept);
  }

  PiecewisePolynomial field() const {
    return PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          for (std::size_t k = 0; k < t.size(); ++k) {
            const Eigen::RowVector3d v = chebyshev(t[k]) * coefficients + ends(t[k]);
            std::copy_n(v.data(), 3, out.begin() + static_cast<Index>(3 * k));
          }
        },
        3, 0, degree + 2 * kept, 0);  // it is one: a single piece, whatever rounding leaves
  }
};

constexpr std::size_t few = count::octet;  ///< values of a side that say too little of what is noise: it stays as it is
constexpr double too_far = share::tenth;   ///< of the field's scale: the best polynomial does not follow it, it stays as it is
constexpr double near_the_best = factor::clear;  ///< times the residual of the highest degree: a lower one is as good
constexpr double near_enough = 2e-5;             ///< of the field's scale: a residual that no seam shows, of about 1e-3 degrees

/// The polynomial of least degree that is nearly as near as that of the highest, or the field itself where that is not near or
/// where it has few pieces. `rim`: the parameters of the mesh vertices; `kept`: how much of the ends, see Ends.
PiecewisePolynomial smoothed(const PiecewisePolynomial& f, const std::vector<double>& rim, int kept) {
  if (f.empty() || rim.size() <= few) return f;
  const Eigen::Map<const Eigen::VectorXd> t(rim.data(), static_cast<Index>(rim.size()));
  Eigen::MatrixXd values(t.size(), 3);
  for (Index k = 0; k < t.size(); ++k) values.row(k) = f(t[k]);
  double scale = 0;
  for (Index k = 0; k < t.size(); ++k)
    for (Index end : {Index(0), t.size() - 1})  // from both: a side is walked either way
      scale = std::max(scale, (values.row(k) - values.row(end)).norm() + (kept == 3 ? 0 : values.row(k).norm()));
  const Ends ends(f, kept);
  const int most = static_cast<int>(std::clamp<Index>((t.size() - 1) / 2 - kept, 4, 16));
  const double best = FittedPolynomial(t, values, most, kept, ends).residual;
  if (best > too_far * scale) return f;
  for (int degree = std::min(6, most);; degree += 2) {
    const FittedPolynomial polynomial(t, values, std::min(degree, most), kept, ends);
    if (polynomial.residual <= std::max(near_the_best * best, near_enough * scale) || degree >= most) return polynomial.field();
  }
}

}  // namespace

Sides smoothed(const Sides& sides) {
  Sides out = sides;
  const bool any = std::any_of(sides.begin(), sides.end(), [](const Side& side) { return side.rim.size() > few; });
  parallel_for(0, 9, any ? 3 : 9, [&](Index from, Index to) {
    for (Index k = from; k < to; ++k) {
      Side& side = out[k / 3];
      if (k % 3 == 0)
        side.c = smoothed(side.c, side.rim, 3);  // what the patch's second derivatives at the corners are made of stays
      else if (k % 3 == 1)
        side.r = smoothed(side.r, side.rim, 2);
      else
        side.q = smoothed(side.q, side.rim, 0);
    }
  });
  return out;
}

}  // namespace tripatch
