// The fairest patch among those that meet the surroundings just as well. A patch that keeps G1 keeps it with these changes.
//   - the interior term (27 b0 b1 b2)^2 sum_K a_K B_K(b) added,
//   - the second derivative across each side changed, by 1/2 b_i^2 (cubic side weight) times a polynomial of t, and
//   - the slopes alpha(t), beta(t) of each side changed between the corners (on a side that is met in position only: all of the
//     derivative across it).
// All are linear. The coefficients minimize a fairness energy, with the center held where that is asked.
#pragma once

#include <array>
#include <optional>

#include "tripatch/boundary/ribbon.h"
#include "tripatch/choices.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

constexpr int usual_slopes = count::several;

struct FairingOptions {
  /// thin_plate, third_derivative: quadratic, one linear solve. minimum_variation, quadric_variation, automatic (see energy.h):
  /// geometric, by damped Gauss-Newton from the third-derivative solution.
  Fairing energy = Fairing::automatic;
  int degree = 4;       ///< of the interior term's polynomial
  int high_degree = 8;  ///< the same for the last steps, two of them, where a geometric energy stays above `rich`
  double rich = 1;      ///< and what is that: a surface with features of its own
  /// The energy of such a surface has many valleys: it is gone down from several places, and the deepest is taken.
  bool many_starts = false;
  int second_cross = 4;                                  ///< coefficients of the second cross derivative of each side
  int slopes = usual_slopes;                             ///< coefficients of each of alpha and beta on each side
  int nodes = 8;                                         ///< of the quadrature, per direction
  int rough_nodes = 5;                                   ///< of the one that Gauss-Newton begins with
  int iterations = 8;                                    ///< of Gauss-Newton with that, at most; one or two follow with `nodes`
  std::array<bool, 3> slopes_free = {true, true, true};  ///< false: alpha and beta of that side stay as they are
  /// Sides whose tangent planes are not asked for: the derivative across is free in all directions.
  std::array<bool, 3> position_only = {false, false, false};
  /// Pulls the patch tight: the energy gains `tension` times the integral of w |DP|^2 (that of first derivatives), in the energy's
  /// own unit times (2 pi)^4, thin_plate (2 pi)^2: at 1 it weighs what the energy does for a wave as long as the hole.
  double tension = 0;
  std::optional<Vec3> center;  ///< where the patch is to have its point b = (1/3, 1/3, 1/3), scene units
  /// Sides whose curvature (Side::q) the patch follows by least squares: a jump of normal curvature of `curvature_jump`, relative
  /// to the sides' curvature, rms, and of three times Side::curvature_error, costs as much as an energy that grows by a factor e.
  std::array<bool, 3> curvature = {false, false, false};
  std::array<bool, 3> automatic = {false, false, false};  ///< the same, where curvature_agrees
  double curvature_jump = 0.025;
};

/// Throws InvalidArgument where there is tension without a fairing, or the center is given in two ways.
void check_shape_options(bool faired, double tension, bool center, double center_offset);

/// A patch of `boundary` that keeps G1 to `sides`.
struct FairingBase {
  Sides sides;
  Boundary boundary;
  SurfacePtr patch;
};

struct FairResult {
  SurfacePtr patch;
  Fairing energy = Fairing::automatic;  ///< that was minimized
  double before = 0;                    ///< its value for the patch that was given
  double after = 0;
  int iterations = 0;
  std::optional<Index> folds;  ///< of `patch`, where they had to be counted
  /// The energies tell nothing here: `patch` is the one that was given, without folds if that was possible.
  bool gave_up = false;
  Messages warnings;
};

/// `measured` is what energies are measured on: the same as `base`, but made from smoothed sides (see smoothed), because third
/// derivatives of splines through mesh vertices are mostly noise. What makes it fair is added to `base`, which meets the sides as they
/// are. The result has no higher energy and no more folds (without `folds` they are not counted); if nothing better is found, it is
/// the patch of `base` itself (with its center where it is asked for).
FairResult fair(const FairingBase& base, const FairingBase& measured, const FairingOptions& options = {},
                const FoldCounter* folds = nullptr);

}  // namespace tripatch
