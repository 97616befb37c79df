// Continuity of curvature along the sides. A patch that keeps G1 to a side lets the second derivative across it go; G2 asks that its
// part along the normal be what the surroundings' second fundamental form says:
//   n . P_dd = II(d, d),  d = alpha r + beta c' the patch's derivative across,  II from n . q, n . r' and n . c''.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/side_weights.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// The side weights with cubes for squares: 1 + O(b_i^3) at side i, O(b_j^3) at the others, so that what they multiply reaches the
/// second derivatives there and nowhere else. b must not be a vertex.
template <int N>
std::array<Jet<N>, 3> cubic_side_weights(const Barycentric<N>& b) {
  int i = 0;
  for (int k = 1; k < 3; ++k)
    if (b[k].value() > b[i].value()) i = k;
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  const Jet<N> rho = b[j] + b[k];
  const Jet<N> t = b[k] / rho, s = b[j] / rho;
  const Jet<N> ttt = t * square(t), sss = s * square(s), bbb = b[i] * square(b[i]);
  const Jet<N> wi = rho * square(rho) * ttt * sss, wj = bbb * ttt, wk = bbb * sss;
  const Jet<N> inverse = reciprocal(wi + wj + wk);
  std::array<Jet<N>, 3> w;
  w[i] = wi * inverse;
  w[j] = wj * inverse;
  w[k] = wk * inverse;
  return w;
}

/// First and second derivative of a surface in the direction -delta_i at points of side i.
struct Across {
  Vec3 first, second;
};
/// At the parameters t of side i; with order 1 the second stay undefined.
std::vector<Across> derivatives_across(const Surface& patch, int i, std::span<const double> t, int order = 2);

/// The surroundings' second fundamental form at a point of a side, and the frame it is in.
struct SideForm {
  Vec3 n;             ///< unit normal r x c'
  Vec3 r, dc;         ///< r and c'
  double rr, rc, cc;  ///< II(r, r), II(r, c'), II(c', c')
  /// II(v, v) of a tangent vector.
  double operator()(const Vec3& v) const;
  /// The squared length of v's part at a right angle to the side.
  double across(const Vec3& v) const;
  /// Frobenius norm squared: the sum of the squared principal curvatures.
  double squared_norm() const;
};
SideForm side_form(const Side& side, double t);

/// r at a right angle to the side, of unit length.
Vec3 upright_across(const Side& side, double t);
/// The normal curvature of the surroundings along that, along the normal.
Vec3 upright_bend(const Side& side, double t);

/// What the second derivative across a side lacks, along the normal, for the curvature to be continuous there.
Vec3 lacking_curvature(const Side& side, double t, const Across& across);

/// A vector function of a side's t (of parameters and three values each) in pieces between the rim's vertices, where the curvature of
/// splines and of limit surfaces has kinks.
template <class F>
PiecewisePolynomial fit_between_vertices(const Side& side, double tolerance, const F& values) {
  const std::vector<double> whole = {0, 1}, &knots = side.rim.empty() ? whole : side.rim;
  std::vector<PiecewisePolynomial> parts;
  std::vector<double> shares;
  for (std::size_t p = 0; p + 1 < knots.size(); ++p) {
    const double from = knots[p], length = knots[p + 1] - from;
    const auto part = [&](std::span<const double> t, std::span<double> out) {
      std::vector<double> at;
      for (double u : t) at.push_back(from + u * length);
      values(std::span<const double>(at), out);
    };
    parts.push_back(PiecewisePolynomial::fit(part, 3, tolerance, 9, 7));
    shares.push_back(length);
  }
  return PiecewisePolynomial::joined(parts, shares);
}

/// At each corner the distance between the forms of its two sides over the larger of their norms; infinite where a side has no q.
/// 0 where the sides continue one surface, about 1 where fillets meet.
std::array<double, 3> curvature_mismatch(const Sides& sides);

/// To half of the curvature: a mesh knows it no better at corners.
constexpr double curvatures_agree = share::half;

/// The sides that have a q and agree with their neighbors at both corners.
std::array<bool, 3> curvature_agrees(const Sides& sides);

/// `patch`, which keeps G1 to the sides marked, plus what makes it meet their curvature: 1/2 b_i^2 (cubic side weight) times what the
/// second derivative across lacks, along the normal. Position, tangent planes and the other sides' curvature stay as they are.
SurfacePtr meet_curvature(const SurfacePtr& patch, const Sides& sides, const std::array<bool, 3>& wanted);

}  // namespace tripatch
