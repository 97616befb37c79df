// Surfaces over a rectangle, given by formula, as surroundings of a hole: an edge of theirs becomes a side, exactly.
#pragma once

#include <algorithm>

#include "tripatch/boundary/side.h"
#include "tripatch/math/places.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/messages.h"

namespace tripatch {

/// Largest degree of Bezier and NURBS surfaces in u and in v.
constexpr int max_rectangle_degree = 20;

class RectangleSurface {
public:
  virtual ~RectangleSurface() = default;
  /// uv: n x 2 inside the domain. out: n x jet_size(order) x 3 Taylor coefficients in (u, v), in the order of Surface::evaluate.
  /// order 0 .. 4.
  virtual void evaluate(const double* uv, Index n, int order, double* out) const = 0;
  /// u from, u to, v from, v to.
  virtual std::array<double, 4> domain() const = 0;
  /// Edge 0: v lowest, 1: u highest, 2: v highest, 3: u lowest; counter-clockwise in (u, v), t from 0 to 1. r and q are the first
  /// and second derivative with respect to u or v, r into the surface. reversed: the other direction along the edge, in which the
  /// side's normal is S_u x S_v. Throws a Refusal for an edge that is a single point.
  virtual Side side(int edge, bool reversed) const = 0;
};

/// A side turned round where asked, once its edge is known to have a length: more than the rounding of its positions.
inline Side checked_edge(Side side, int edge, bool reversed) {
  double length = 0, size = 0;
  Vec3 before = side.c(0);
  for (const double t : evenly(8)) {
    const Vec3 at = side.c(t);
    length += (at - before).norm();
    size = std::max({size, at.norm(), side.r(t).norm()});
    before = at;
  }
  if (!(length > tolerance::rounding * size)) throw CodedRefusal(Code::edge_is_point, {{"edge", edge}});
  if (!reversed) return side;
  return {side.c.reversed(), side.r.reversed(), side.q.empty() ? side.q : side.q.reversed()};
}

}  // namespace tripatch
