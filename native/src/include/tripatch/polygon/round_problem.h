// The unknowns of a round hole, and its energies as functions of them.
#pragma once

#include <optional>
#include <vector>

#include "tripatch/fairing/energy_problem.h"
#include "tripatch/fairing/fairing_space.h"
#include "tripatch/polygon/round.h"
#include "tripatch/polygon/space.h"

namespace tripatch {

/// Fourier's sums of values f(t) round the rim, t from 0 to 1, up to this order.
template <class F>
Harmonic fourier(const F& f, int order) {
  const int samples = 4 * order + 8;
  std::vector<Vec2> circle;
  for (int s = 0; s < samples; ++s) circle.push_back(on_circle(static_cast<double>(s) / samples));
  Harmonic out = Harmonic::Zero(2 * order + 1, 3);
  for (int s = 0; s < samples; ++s) {
    const Vec3 value = f(static_cast<double>(s) / samples) / samples;
    out.row(0) += value;
    for (int k = 1; k <= order; ++k) {
      const Vec2& wave = circle[static_cast<std::size_t>(k * s % samples)];
      out.row(2 * k - 1) += 2 * wave[0] * value;
      out.row(2 * k) += 2 * wave[1] * value;
    }
  }
  return out;
}

/// Slopes at the rim grow by no more than this. Near the end of a tube caps have ever less energy the longer they are, for a cylinder is a
/// quadric too: without a bound descent left the valley of caps about as high as wide, up to 1,900 diameters high. Caps of revolution
/// are found in another way (revolved.h).
constexpr double max_slope = 5;

/// A patch of `side` that keeps G1 to it, and what is asked of it besides. The derivative along the radius at the rim is alpha r + beta c'.
struct RoundBase {
  Side side;
  std::vector<Harmonic> terms;      ///< of the patch
  double alpha = 1;                 ///< r of `side` is a unit vector
  double size = 0;                  ///< of the hole, scene units
  bool slopes_free = true;          ///< alpha and beta are
  bool position_only = false;       ///< the derivative along the radius is free in all directions
  bool curvature = false;           ///< is followed by least squares
  std::vector<InnerPoint> through;  ///< met by `terms`: what is added vanishes there
};

/// Nodes over the disc: Gauss's along the radius, equal angles; the functions (1 - r^2)^2 times the polynomials of a degree.
struct RoundSpace : NodeBasis {
  RoundSpace(int degree, int slopes, int nodes);

  Points uv;
  std::vector<PiecewisePolynomial> waves;  ///< 1, cos, sin, ... of 2 pi t: what alpha and beta may gain
  std::vector<double> t;                   ///< where curvature is compared
  SideBasis along;

private:
  RoundSpace(PolygonQuadrature quadrature, int degree, int slopes);
};

/// Made once for each set of numbers and kept.
const RoundSpace& round_space(int degree, int slopes, int nodes);

/// First and second derivative along the radius at the rim.
Across along_radius(const Surface& patch, double t);

/// Coefficients of those functions, one a row, as terms of a surface.
std::vector<Harmonic> round_terms(const Points& coefficients, int degree);

class RoundProblem final : public EnergyProblem {
public:
  RoundProblem(const RoundBase& base, const FairingOptions& options, int nodes);

  Eigen::MatrixXd held() const override { return held_; }
  const CurvatureFollowing& following() const override { return *following_; }
  double reach(const Eigen::VectorXd& x) const override;
  bool meets_planes() const { return !of_.position_only; }
  /// What x adds to the terms of `base`, of which the one that this is about may have fewer waves. axis: only what leaves a surface of
  /// revolution about it one.
  std::vector<Harmonic> correction(const Eigen::VectorXd& x, const RoundBase& base,
                                   const std::optional<Eigen::Matrix3d>& axis) const;

private:
  RoundProblem(const RoundBase& base, const FairingOptions& options, const RoundSpace& space);
  std::vector<PiecewisePolynomial> directions_of(const Side& side) const;
  CurvatureFollowing followed() const;

  const RoundSpace& space_;
  const RoundBase& of_;
  std::array<double, 2> scale_ = {0, 0};  // of r and c'; 0: alpha and beta are held
  std::optional<CurvatureFollowing> following_;
  Eigen::MatrixXd held_;
};

/// The terms with what they lack at the points: least-norm polynomials that change neither rim nor slopes.
std::vector<Harmonic> terms_through(std::vector<Harmonic> terms, const std::vector<InnerPoint>& points, double size);

/// What is no part of a surface of revolution is taken away. frame: radial directions at t = 0 and t = 1/4, and the axis.
void of_revolution(std::vector<Harmonic>& terms, const Eigen::Matrix3d& frame);

/// a + b, term by term.
std::vector<Harmonic> sum_of(std::vector<Harmonic> a, const std::vector<Harmonic>& b);

}  // namespace tripatch
