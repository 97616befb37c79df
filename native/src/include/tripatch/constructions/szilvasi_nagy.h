// Coons-type blends of three surfaces over one triangle, with shape parameters. Szilvasi-Nagy and Szabo 2006: Definition 1 (position)
// and Definition 2 (position and first derivatives). Definition 2 interpolates only with these two corrections:
//   f = 1/2 [G_0 + G_1 + G_2 - q] - s,
//   G_i = mu_{i+2} r_{i+2} + (1 - mu_{i+2}) r_{i+1}               right on sides i + 1 and i + 2, not on side i
//   q(b) = sum_i W_i(b) G_i(foot_i(b))                            what the sum of the three has too much on the sides
//   s(b) = 1/2 sum_i b_i W_i(b) (dG_i / d delta_i)(foot_i(b))     and its first derivatives; 0 in Definition 1
#pragma once

#include <vector>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/constructions/blend.h"

namespace tripatch {

struct SzilvasiNagyOptions {
  int continuity = 1;                             ///< 0: Definition 1; 1: Definition 2
  std::array<double, 3> shape = {0.5, 0.5, 0.5};  ///< lambda_i in (0, 1)
  bool optimal = false;  ///< lambda of the least thin-plate energy (eq. 5; as printed: at nine points) instead
  int quadrature = 16;   ///< corner_quadrature(n) of that energy
  /// The formulas as printed: feet (0, v, 1 - v), (u, 0, 1 - u), (u, 1 - u, 0), so the result depends on the numbering. In
  /// Definition 2 q is twice as large, so it does not interpolate, and partial derivatives in u, v, w are those of homogeneous forms
  /// (of a Bezier triangle its own, else of degree 0), so the result does not move along with its surfaces.
  bool as_printed = false;
};

class SzilvasiNagy final : public VertexSafeSurface {
public:
  /// Surface i carries side i. Throws InvalidArgument where corners differ or lambda is outside (0, 1).
  SzilvasiNagy(const std::array<SurfacePtr, 3>& surfaces, const SzilvasiNagyOptions& options = {});

  struct Step {
    std::array<double, 3> shape;
    double energy;
  };
  const std::array<double, 3>& shape() const { return shape_; }
  /// The optimizer's path, from the given lambda through the start that a scan chose to the optimum; empty where lambda is given.
  /// The optimum is kept within [1e-3, 1 - 1e-3].
  const std::vector<Step>& path() const { return path_; }

  /// mu_i = (1 - lambda_i) b_{i+2}^2 / (lambda_i b_i^2 + (1 - lambda_i) b_{i+2}^2), 1 on side i, 0 on side i + 2; 1 at corner i + 1.
  std::array<double, 3> mu(const double* b) const;
  /// The auxiliary curve g_i over side i: G_i there, at n parameters from corner i + 1 to corner i + 2.
  Points auxiliary_curve(int i, const std::vector<double>& t) const;
  /// The correction term q.
  Points correction(const PointsRef& b) const;
  /// The correction term s (zero in Definition 1).
  Points slope_correction(const PointsRef& b) const;

private:
  Vec3 corner(int i) const override { return corner_[i]; }
  /// Order 0 to 4 in Definition 1, 0 to 3 in Definition 2, which needs one more from its surfaces.
  void evaluate_regular(const double* b, Index n, int order, double* out) const override;
  void optimize(int quadrature);

  std::array<SurfacePtr, 3> surfaces_;
  std::array<Vec3, 3> corner_;
  int continuity_;
  bool as_printed_;
  std::array<double, 3> shape_;
  std::vector<Step> path_;
};

/// Three surfaces made from the sides of a hole, for SzilvasiNagy: surface i = (2 D_i + T) / 3. D_i are the cubic rays from
/// corner i to side i (Nielson's). T is the side-weight blend of the linear continuations of all three sides (continuity 0: of
/// their positions). All three carry the sides' data; T makes up for what the blend overshoots, so that cubics are reproduced.
std::array<SurfacePtr, 3> hole_surfaces(const Boundary& boundary, int continuity);

}  // namespace tripatch
