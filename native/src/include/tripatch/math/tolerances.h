// How little counts as nothing. Each is relative to what it is compared with, so that no fill depends on the unit of its mesh.
#pragma once

namespace tripatch::tolerance {

inline constexpr double tiny = 1e-300;  ///< absolute: nothing is divided by less, and no logarithm is of less
inline constexpr double fit = 1e-13;    ///< a thousand roundings: polynomials that are fitted, and the last step of an iteration
inline constexpr double rounding = 1e-12;  ///< lengths and areas that are rounding
inline constexpr double solved = 1e-9;     ///< what equations are solved to, and what is added to a diagonal that may be zero
inline constexpr double same =
    1e-6;  ///< places and directions that are one: single precision, of files and Blender, has a few digits more
inline constexpr double close = 1e-4;    ///< what nobody sees
inline constexpr double slight = 1e-3;   ///< a share that only keeps what it is a share of from vanishing
inline constexpr int newton_steps = 30;  ///< after which an iteration that ends when it has settled ends without

}  // namespace tripatch::tolerance
