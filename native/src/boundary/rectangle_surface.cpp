#include "tripatch/boundary/rectangle_surface.h"

#include <algorithm>
#include <string>

namespace tripatch {

Side checked_edge(Side side, int edge, bool reversed) {
  double length = 0, size = 0;
  for (int k = 1; k <= 8; ++k) {
    length += (side.c(k / 8.0) - side.c((k - 1) / 8.0)).norm();
    size = std::max({size, side.c(k / 8.0).norm(), side.r(k / 8.0).norm()});
  }
  if (!(length > 1e-12 * size)) throw Refusal("Edge " + std::to_string(edge) + " of the surface is a single point");
  if (!reversed) return side;
  return {side.c.reversed(), side.r.reversed(), side.q.empty() ? side.q : side.q.reversed()};
}

}  // namespace tripatch
