// What surfaces made of three curves alone have in common.
#pragma once

#include <utility>

#include "tripatch/boundary/side.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// A JetSurface of three curves: curve i runs along side i, from corner i + 1 to corner i + 2.
template <class Derived>
class CurveSurface : public JetSurface<Derived> {
public:
  /// Throws a Refusal where curves do not meet.
  explicit CurveSurface(std::array<PiecewisePolynomial, 3> curves) : curves_(std::move(curves)) {
    check_curves(curves_);
    for (int i = 0; i < 3; ++i) corner_[i] = curves_[(i + 2) % 3](0);
  }

  Vec3 corner(int i) const override { return corner_[i]; }

protected:
  std::array<PiecewisePolynomial, 3> curves_;
  std::array<Vec3, 3> corner_;
};

}  // namespace tripatch
