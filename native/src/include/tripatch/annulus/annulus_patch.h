// A patch between two closed boundaries: ribs run from one to the other, and leave each of them within its tangent planes.
//
// The rib at u is a quintic in v. Its ends, their derivatives and second derivatives are those of a circular arc wherever an arc meets both
// planes: a quarter circle between a plate and a boss, an arc of a torus across the gap of a pipe. Else they are those of the ellipse that the
// two tangents touch.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/choices.h"
#include "tripatch/math/plane.h"
#include "tripatch/patch/surface.h"
#include "tripatch/report/report.h"

namespace tripatch {

/// Name of the method.
constexpr const char* annulus_method = "annulus";

/// Over the ring between the unit circle, where v = 0, and the circle of radius `inner`, where v = 1; u is the angle over 2 pi. Rows of
/// evaluate are (x, y, not read), derivatives are by (x, y).
class AnnulusSurface final : public Surface {
public:
  /// ribs: by u, position and first and second derivative by v at v = 0, then those at v = 1.
  AnnulusSurface(const PiecewisePolynomial& ribs, double inner) : ribs_(ribs), inner_(inner) {}
  void evaluate(const double* b, Index n, int order, double* out) const override;
  Vec2 place(double u, double v) const;

private:
  template <int N>
  void evaluate_order(const double* b, Index n, double* out) const;

  PiecewisePolynomial ribs_;
  double inner_;
};

struct AnnulusOptions {
  std::array<SideContinuity, 2> continuity = {SideContinuity::automatic, SideContinuity::automatic};
  std::array<double, 2> bulge = {1, 1};
};

struct AnnulusPatch {
  std::shared_ptr<const AnnulusSurface> patch;
  PiecewisePolynomial match;  ///< scalar, by u: parameter of the second side plus u; the second side runs against the first
  double rib_length = 0;      ///< the mean, scene units
  double rib_turn = 0;        ///< the mean over the ribs of the angle between their ends, degrees
  std::array<double, 2> seam_angle_max = {0, 0}, seam_angle_rms = {0, 0};  ///< degrees
  std::array<SeamContinuity, 2> continuity = {};

  /// u where the rib ends at a parameter of the second side.
  double u_of_second(double t) const;
};

/// The same as a surface by itself.
class OverAnnulus final : public Surface {
public:
  explicit OverAnnulus(AnnulusPatch made) : made_(std::move(made)) {}
  void evaluate(const double* b, Index n, int order, double* out) const override { made_.patch->evaluate(b, n, order, out); }
  const AnnulusPatch& made() const { return made_; }
  /// Places of parameters on a side.
  PlanePoints on_side(int side, const std::vector<double>& t) const;

private:
  AnnulusPatch made_;
};

/// Both sides are closed and run in the direction of new faces, each as the boundary of its own hole. Throws a Refusal where the two face
/// opposite ways.
AnnulusPatch annulus_patch(const Side& first, const Side& second, const AnnulusOptions& options = {});

}  // namespace tripatch
