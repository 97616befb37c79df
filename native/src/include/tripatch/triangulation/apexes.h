// The apexes of a chord in a minimum-weight triangulation, compared four at a time.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "tripatch/math/simd.h"
#include "tripatch/types.h"

namespace tripatch {

// Angles whose signed squared cosines round to the same are equally good, and the area decides: within 4 degrees at 0 and 90.
// Numbers of this size are 1 / 256 apart.
inline constexpr double score_rounder = 1.5 * (1LL << 44);
inline constexpr double without_normal =
    1e-8;  // squared: twice the area over the squared longest edge of a triangle that has no normal

/// What the apexes of a chord (i, k) are compared by, one after the other from vertex i + 1 on.
struct Apexes {
  std::array<const double*, 3> x;              // the vertices themselves
  std::array<double, 3> start, chord;          // vertex i, and from there to k
  std::array<const double*, 3> before, after;  // the normals at the chords (i, m) and (m, k)
  const double *worst_before, *worst_after;    // of the fills beyond them
  Index count;
};

#ifdef TRIPATCH_PACKS
/// The same bits as Filler::compare, of four apexes or more. only_best: where four are all worse than one before them, only so much as the
/// fills beyond them tell.
TRIPATCH_PACKED inline void compare_packed(const Apexes& apexes, bool only_best, double* score) {
  const auto& [x, start, chord, before, after, worst_before, worst_after, count] = apexes;
  const double e2 = chord[0] * chord[0] + chord[1] * chord[1] + chord[2] * chord[2];
  const double tiny = std::numeric_limits<double>::min();
  const Pack one = all_lanes(1);
  double threshold = -std::numeric_limits<double>::infinity();
  for (Index next = 0; next < count; next += lanes) {
    const Index j = std::min(next, count - lanes);  // the last four overlap others
    const Pack beyond = smaller(loaded(worst_before + j), loaded(worst_after + j));
    if (!any_at_least(beyond, threshold)) {
      store(beyond, score + j);
      continue;
    }
    const Pack ux = loaded(x[0] + j) - start[0], uy = loaded(x[1] + j) - start[1], uz = loaded(x[2] + j) - start[2];
    const Pack nx = uy * chord[2] - uz * chord[1], ny = uz * chord[0] - ux * chord[2], nz = ux * chord[1] - uy * chord[0];
    const Pack square = nx * nx + ny * ny + nz * nz, lengths = e2 + ux * ux + uy * uy + uz * uz;
    const Pack least = smaller(square / (lengths * lengths * without_normal + tiny), one);
    const Pack cosine = smaller(nx * loaded(before[0] + j) + ny * loaded(before[1] + j) + nz * loaded(before[2] + j),
                                nx * loaded(after[0] + j) + ny * loaded(after[1] + j) + nz * loaded(after[2] + j));
    const Pack size = cosine < 0 ? -cosine : cosine;
    const Pack angle = cosine * size / (square + tiny) * least - (one - least);
    const Pack found = smaller((angle + score_rounder) - score_rounder, beyond);
    store(found, score + j);
    if (only_best && any_at_least(found, threshold))
      for (int lane = 0; lane < lanes; ++lane) threshold = std::max(threshold, found[lane]);
  }
}
#endif

}  // namespace tripatch
