// Thresholds that many rooms share. A number is taken from here where one half as large again would do as well; what it means is said
// where it is used. A number that has to be more exact has a value of its own, and a measurement that shows why.
#pragma once

#include <numbers>

#include "tripatch/math/tolerances.h"  // IWYU pragma: export

namespace tripatch {

/// Degrees between two planes or directions.
namespace angle {
inline constexpr double flat = 1;        ///< one plane, as well as meshes tell it
inline constexpr double slight = 5;      ///< smooth, however coarse
inline constexpr double bend = 15;       ///< still one surface
inline constexpr double crease = 25;     ///< no longer one surface
inline constexpr double corner = 45;     ///< a corner of a side
inline constexpr double steep = 60;      ///< too steep for heights; its cosine is a half
inline constexpr double upright = 70;    ///< as good as a right angle
inline constexpr double reversed = 179;  ///< turned back: which way is rounding
}  // namespace angle

constexpr double radians(double degrees) { return degrees * std::numbers::pi / 180; }

/// Parts of a whole, sines and cosines.
namespace share {
inline constexpr double hundredth = 0.01, trace = 0.02, little = 0.05, tenth = 0.1, fifth = 0.2, quarter = 0.25,
                        three_tenths = 0.3, third = 1.0 / 3, half = 0.5, most = 0.75, nearly_all = 0.9;
}  // namespace share

/// How many times as large a number has to be.
namespace factor {
inline constexpr double slight = 1.5, clear = 2, strong = 3, large = 4, huge = 10, extreme = 100;
}  // namespace factor

/// Standard deviations from which on a difference is not chance.
namespace deviations {
inline constexpr double clear = 3, certain = 5;
}  // namespace deviations

/// Of a mesh's vertices, as a share of an edge.
namespace noise {
inline constexpr double some = 0.003, rough = 0.04;
}  // namespace noise

/// How many of something are looked at or tried.
namespace count {
inline constexpr int pair = 2, few = 3, several = 4, half_dozen = 6, octet = 8, dozen = 12, dozens = 24, hundred = 100,
                     hundreds = 200;
inline constexpr int degree = 9;           ///< of polynomials that follow a smooth curve to rounding
inline constexpr int places = 16;          ///< along a side
inline constexpr int many_places = 64;     ///< along a side that turns
inline constexpr int sweeps = 20;          ///< over all vertices
inline constexpr int rings = 40;           ///< of faces
inline constexpr int halvings = 50;        ///< of a step: what is left is rounding
inline constexpr int cubic = 160;          ///< items, if the time grows with their cube
inline constexpr int quadratic = 1000;     ///< items, if it grows with their square
inline constexpr int linear = 20'000;      ///< items, if it grows with their number
inline constexpr int million = 1'000'000;  ///< steps that take a moment
inline constexpr int block = 256;          ///< points that are evaluated together
inline constexpr int portion = 4096;       ///< points that are worth a thread, or a look at the clock
}  // namespace count

}  // namespace tripatch
