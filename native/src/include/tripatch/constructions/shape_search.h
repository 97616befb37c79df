// The shape parameters of a Szilvasi-Nagy blend that make its energy least.
#pragma once

#include <array>
#include <vector>

#include "tripatch/constructions/szilvasi_nagy.h"

namespace tripatch {

/// The energy as a function of lambda. The blend is linear in each of the three mu_i, so with the terms of the energy of each L_i stacked
/// into one long vector, the energy is the squared length of their sum, and its derivatives are inner products.
class ShapeEnergy {
public:
  virtual ~ShapeEnergy() = default;
  /// The stacked second derivatives of the term that depends on lambda[i], or of its derivatives with respect to it.
  virtual Eigen::VectorXd stacked(int i, double lambda, int derivative = 0) const = 0;
};

/// The path to the least energy, from the best local minima of a scan, by Newton's method; before it the shape that was given.
std::vector<SzilvasiNagy::Step> min_energy(const ShapeEnergy& energy, const std::array<double, 3>& given);

}  // namespace tripatch
