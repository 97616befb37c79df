// How far the curvature of a patch is from that of its surroundings along its sides.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tripatch/fairing/curvature.h"
#include "tripatch/polygon/fair.h"

namespace tripatch::testing {

/// `samples` parameters from `margin` to 1 - margin, in the middles of equal parts.
inline std::vector<double> middles(int samples, double margin) {
  std::vector<double> t(samples);
  for (int k = 0; k < samples; ++k) t[k] = margin + (1 - 2 * margin) * (k + 0.5) / samples;
  return t;
}

/// The largest difference of normal curvature across a side between a patch, whose derivatives across at the points t are given, and
/// the surroundings, over the larger of the two forms' norms there.
inline double largest_jump(const Side& side, const std::vector<double>& t, const std::vector<Across>& across) {
  double worst = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    const SideForm form = side_form(side, t[k]);
    const double jump = std::abs(form.n.dot(across[k].second) - form(across[k].first)) / form.across(across[k].first);
    worst = std::max(worst, jump / std::max(std::sqrt(form.squared_norm()), 1e-300));
  }
  return worst;
}

/// Across the sides marked.
inline double curvature_jump(const Surface& patch, const Sides& sides, const std::array<bool, 3>& marked, int samples = 99,
                             double margin = 0.01) {
  const std::vector<double> t = middles(samples, margin);
  double worst = 0;
  for (int i = 0; i < 3; ++i)
    if (marked[i]) worst = std::max(worst, largest_jump(sides[i], t, derivatives_across(patch, i, t)));
  return worst;
}

/// Across all sides.
inline double curvature_jump(const Surface& patch, const PolygonDomain& domain, const SideList& sides) {
  const std::vector<double> t = middles(99, 0.01);
  double worst = 0;
  for (int i = 0; i < domain.sides(); ++i)
    worst = std::max(worst, largest_jump(sides[i], t, derivatives_across(patch, domain, i, t)));
  return worst;
}

}  // namespace tripatch::testing
