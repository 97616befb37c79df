// Parameters from 0 to 1 at which something is looked at.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

namespace tripatch {

/// Equal steps from 0 to 1, both ends among them.
inline std::vector<double> evenly(int steps) {
  std::vector<double> places;
  for (int k = 0; k <= steps; ++k) places.push_back(static_cast<double>(k) / steps);
  return places;
}

/// Multiples of the golden ratio without their integers: between 0 and 1, and in step with nothing.
inline std::vector<double> scattered(int count) {
  std::vector<double> places;
  for (int k = 1; k <= count; ++k) places.push_back(std::fmod(k * std::numbers::phi, 1));
  return places;
}

}  // namespace tripatch
