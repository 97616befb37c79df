// A patch with a round rim: one closed side, no corners. The domain is the unit disc, and every surface over it is
//
//   P = sum_j (1 - u^2 - v^2)^j H_j(u, v),    H_j harmonic polynomials
//
// (Almansi). H_0 is the curve of the rim, H_1 the derivative across it, H_2 the second one. All of them together are the polynomials,
// which rotations of the disc keep. So nothing shows where the side begins, and between surroundings of revolution lies a surface of
// revolution.
#pragma once

#include <vector>

#include "tripatch/polygon/patch.h"

namespace tripatch {

/// A harmonic polynomial with values in space: rows are the constant, then those of Re z^k and Im z^k, k = 1, 2, ...
using Harmonic = Points;

/// Rows of evaluate are (u, v, not read), derivatives are by (u, v).
class RoundSurface final : public Surface {
public:
  explicit RoundSurface(std::vector<Harmonic> terms) : terms_(std::move(terms)) {}
  void evaluate(const double* b, Index n, int order, double* out) const override;
  const std::vector<Harmonic>& terms() const { return terms_; }

private:
  std::vector<Harmonic> terms_;
};

/// Where t of the side is: (cos 2 pi t, sin 2 pi t).
Vec2 on_circle(double t);

/// Its values round the circle, t from 0 to 1.
PiecewisePolynomial around_circle(const Harmonic& waves);

struct RoundPatch : Faired {
  std::shared_ptr<const RoundSurface> patch;
  Side side;  ///< what is met: the side that was given, without waves that are shorter than the rim's edges
  SeamContinuity continuity = SeamContinuity::unknown;
  double seam_angle_max = 0, seam_angle_rms = 0;  ///< degrees
  bool of_revolution = false;                     ///< the surroundings are, and so is the patch
};

/// side: closed, its end being its beginning, and smooth there: else a Refusal. order: of the waves round the rim that are kept. Of the
/// options those by side have one value; inner points are not taken.
RoundPatch round_patch(const Side& side, const PolygonPatchOptions& options = {}, int order = 48);
/// Whether the surrounding surface is of revolution, and with that the patch.
bool is_of_revolution(const Side& side, const PolygonPatchOptions& options, int order);

/// The same patch with the parameters of its side counted from another place of it.
RoundPatch begun_at(RoundPatch made, double t);

/// An energy of a surface over the disc, as energy() for a triangle.
double round_energy(const Surface& surface, Fairing of);

}  // namespace tripatch
