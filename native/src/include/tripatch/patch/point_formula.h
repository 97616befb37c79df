// Positions and normals of side-vertex patches and of what a fairing adds to them, all by one formula: nothing is stored between positions,
// derivatives and normals, and what is added to the slopes of cubic rays costs nothing.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <mutex>

#include "tripatch/math/piecewise_polynomial.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// The formula's numbers. Those of a sum of surfaces are the sums of theirs.
struct PointTerms {
  struct Ray {
    PiecewisePolynomial curve, slope;  ///< of the side: its position and d/ds, see VertexRay; empty: none
    PiecewisePolynomial added;         ///< to the slope, as that of a cubic ray
    Vec3 corner = Vec3::Zero();
    Vec3 to_next = Vec3::Zero(), to_previous = Vec3::Zero();
    bool is_quintic = false;
    /// Second derivatives at the ends of quintic rays, by powers of t.
    std::array<Vec3, 4> vertex_second = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()}, side_second = vertex_second;
  };
  std::array<Ray, 3> rays;
  std::array<PiecewisePolynomial, 3> second_cross;  ///< what 1/2 b_i^2 and the cubic side weight multiply; empty: none
  Vec3 moved_by = Vec3::Zero();                     ///< added to all positions
  Points inside = Points(0, 3);  ///< of what the squared bubble multiplies, by powers of b0 - 1/3 and b1 - 1/3, the highest first

  friend PointTerms operator+(const PointTerms& a, const PointTerms& b);
};

/// Made where it is asked for first: most patches have few points.
class PointFormula {
public:
  explicit PointFormula(std::function<PointTerms()> terms);
  ~PointFormula();
  PointTerms terms() const { return terms_(); }
  /// Of so many points it takes less time than their derivatives, and the machine can.
  bool is_worth(Index points) const;
  /// As Surface::positions_and_normals. `surface` gives those so near to a vertex that derivatives there are continued.
  void evaluate(const Surface& surface, const double* b, Index n, double* positions, double* normals) const;

private:
  class Kernel;
  const Kernel* kernel() const;

  std::function<PointTerms()> terms_;
  mutable std::once_flag once_;
  mutable std::unique_ptr<const Kernel> kernel_;
};

/// A surface that has such a formula, or null.
class FormulaSurface {
public:
  virtual ~FormulaSurface() = default;
  virtual const PointFormula* formula() const = 0;
};

/// Of a surface, where it has one.
const PointFormula* formula_of(const Surface& surface);

}  // namespace tripatch
