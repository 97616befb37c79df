#include "tripatch/fairing/energy.h"

#include <algorithm>
#include <cmath>

#include "tripatch/math/thresholds.h"

namespace tripatch {

double soft_minimum(double variation, double quadric) {
  if (!(variation > 0)) return variation;  // of a plane both are 0
  const double ratio = quadric_ratio * variation / quadric;
  return variation / std::pow(1 + std::pow(ratio, 4), 0.25);
}

bool is_quadratic(Fairing energy) { return energy == Fairing::thin_plate || energy == Fairing::third_derivative; }

double energy(const Surface& surface, Fairing of, double size, int nodes_per_direction) {
  const Quadrature quadrature = corner_quadrature(nodes_per_direction);
  const std::vector<Derivatives> all = cartesian_derivatives(surface, quadrature.b);
  if (is_quadratic(of)) {
    double sum = 0;
    for (std::size_t k = 0; k < all.size(); ++k) {
      const Derivatives& d = all[k];
      sum += quadrature.weights[k] *
             (of == Fairing::thin_plate
                  ? d.row(2).squaredNorm() + 2 * d.row(3).squaredNorm() + d.row(4).squaredNorm()
                  : d.row(5).squaredNorm() + 3 * d.row(6).squaredNorm() + 3 * d.row(7).squaredNorm() + d.row(8).squaredNorm());
    }
    return sum;
  }
  double variation = 0, quadric = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const CurvatureVariation v = curvature_variation(all[k], flat_curvature(size));
    const double w = quadrature.weights[k] * size * size * v.area;
    variation += w * v.variation.squaredNorm();
    quadric += w * v.quadric.squaredNorm();
  }
  if (of == Fairing::minimum_variation) return variation;
  return of == Fairing::quadric_variation ? quadric : soft_minimum(variation, quadric);
}

double size_of(const Surface& surface) {
  // On a side: of one that is half of a circle 1 - cos(pi / 32), half a percent, is not seen at most.
  constexpr int steps = count::places;
  Points b(3 * steps, 3);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < steps; ++k) {
      b(steps * i + k, i) = 1 - static_cast<double>(k) / steps;
      b(steps * i + k, (i + 1) % 3) = static_cast<double>(k) / steps;
      b(steps * i + k, (i + 2) % 3) = 0;
    }
  const Points p = surface.positions(b);
  double size = 0;
  for (Index k = 0; k < p.rows(); ++k) size = std::max(size, (p.rowwise() - p.row(k)).rowwise().norm().maxCoeff());
  return size;
}

}  // namespace tripatch
