// Choices between numbers that come from coordinates. On symmetric meshes many of them are equal, and the last bits, which change when
// the mesh is turned, moved or scaled, must not choose.
#pragma once

#include <cmath>

namespace tripatch {

/// Relative: what differs by less is a tie. Rounding makes 1e-15 of a coordinate that is not far from the origin, 1e-10 at a million
/// sizes from it, and some hundred times that of what is computed from it.
constexpr double tie = 2e-8;

inline bool clearly_less(double a, double b) { return a < b && (std::isinf(b) || b - a > tie * std::abs(b)); }
inline bool clearly_more(double a, double b) { return a > b && (std::isinf(a) || a - b > tie * std::abs(b)); }
/// Not clearly less; false of what is no number.
inline bool at_least(double a, double b) { return a >= b || b - a <= tie * std::abs(b); }

/// With 16 binary digits: a key to sort by where equal numbers are to keep the order they have.
inline double coarse(double x) {
  if (!std::isfinite(x)) return x;
  int exponent = 0;
  const double mantissa = std::frexp(x, &exponent);
  return std::ldexp(std::round(std::ldexp(mantissa, 16)), exponent - 16);
}

}  // namespace tripatch
