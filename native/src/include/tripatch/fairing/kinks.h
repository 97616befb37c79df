// Kinks inside sides. If the limit surface of a cage has an extraordinary vertex on the rim, or a crease that runs into it, the side
// turns at once. The constructions take c' and r along rays from the opposite corner, so they would tear there. So the patch is made
// of sides that are rounded at their kinks. In a strip next to the rim it gets back what they lack:
//   P + phi(b_i / depth) (e(t) + b_i g(t)),  t at foot_i(b),  e = c - rounded c,  g = what takes dP/d(delta_i) into the true planes,
// with phi = 1, phi' = phi'' = 0 at the side. Position and G1 are those of the sides as they are.
#pragma once

#include <array>
#include <vector>

#include "tripatch/boundary/side.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// Parameters inside a side where c' or r jumps, by more than a thousandth of their length.
std::vector<double> kinks_of(const Side& side);
/// Degrees between the planes before and behind a kink.
double planes_apart(const Side& side, double kink);

class Kinks {
public:
  explicit Kinks(const Sides& sides);

  bool on(int side) const { return !kinks_[side].empty(); }
  /// kinks_of each side.
  std::array<std::vector<double>, 3> parameters() const;
  bool empty() const { return kinks_[0].empty() && kinks_[1].empty() && kinks_[2].empty(); }
  const Sides& sides() const { return sides_; }
  /// The sides, each kink replaced by quintics of c, r and q that reach half the way to the next kink or end.
  const Sides& rounded() const { return rounded_; }
  /// A patch of the rounded sides as one of the sides. tangent: sides to which it keeps the tangent planes.
  SurfacePtr restored(const SurfacePtr& patch, const std::array<bool, 3>& tangent) const;

private:
  struct Kink {
    double t, reach;  ///< rounded from t - reach to t + reach
  };

  Sides sides_, rounded_;
  std::array<std::vector<Kink>, 3> kinks_;
};

}  // namespace tripatch
