// Where seams are measured: all along a side, but beside a corner whose two sides have different planes no patch can have both.
#pragma once

namespace tripatch {

inline constexpr double same_plane = 1e-6;     ///< degrees between the planes of two sides up to which a corner has one
inline constexpr double beside_corner = 0.01;  ///< of a side: what is left out beside a corner that has two

}  // namespace tripatch
