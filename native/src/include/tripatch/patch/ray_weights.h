// How a ray from a vertex to the opposite side is mixed of what is known at both ends.
#pragma once

#include "tripatch/math/simd.h"

namespace tripatch {

/// What multiplies slope and second derivative at the vertex, then position, slope and second derivative at the side.
template <class P>
struct RayWeights {
  P h1, h2, h3, h4, h5;
  P d1, d2, d3, d4, d5;  ///< derivatives by s
};

/// r: 1 at the vertex, and s = 1 - r. P: a number or a pack. Cubic rays have no second derivatives.
template <bool Quintic, class P>
TRIPATCH_ANY_PACK void weigh_ray(const P& r, const P& s, RayWeights<P>& w) {
  const P ss = s * s, rr = r * r;
  if constexpr (Quintic) {
    const P sss = ss * s, rrr = rr * r;
    w.h1 = s * rrr * (1.0 + 3.0 * s), w.h3 = sss * (1.0 + r * (3.0 + 6 * r)), w.h4 = sss * r * (-1.0 - 3.0 * r);
    w.h2 = 0.5 * ss * rrr, w.h5 = 0.5 * rr * sss;
    w.d1 = rr * (1.0 - 3.0 * s) * (1.0 + 5 * s), w.d3 = 30 * rr * ss, w.d4 = ss * (1.0 - 3.0 * r) * (1.0 + 5 * r);
    w.d2 = s * rr * (1.0 - 5 * s / 2), w.d5 = r * ss * (5 * r / 2 - 1.0);
  } else {
    w.h1 = s * rr, w.h3 = ss * (1.0 + 2.0 * r), w.h4 = -ss * r;
    w.d1 = r * (1.0 - 3.0 * s), w.d3 = 6 * s * r, w.d4 = s * (1.0 - 3.0 * r);
  }
}

}  // namespace tripatch
