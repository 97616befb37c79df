#include "tripatch/patch/vertex_ray.h"

namespace tripatch {
namespace {

/// d/ds = -delta_i + (t - 1/2) (along the side).
PiecewisePolynomial slope_at_side(const Ribbon& ribbon) {
  return ribbon.d + PiecewisePolynomial::linear(-0.5, 0.5) * ribbon.c.derivative();
}

}  // namespace

VertexRay::VertexRay(const Boundary& boundary, int i, RayDegree degree)
    : i_(i),
      degree_(degree),
      curve_(boundary.ribbons[i].c),
      side_slope_(slope_at_side(boundary.ribbons[i])),
      c_(curve_),
      slope_(side_slope_),
      same_pieces_(c_.has_places_of(slope_)) {
  const auto& ribbons = boundary.ribbons;
  for (int k = 0; k < 3; ++k) corner_[k] = ribbons[(k + 2) % 3].c(0);
  // towards corner i + 1 along side i + 2, towards corner i + 2 back along side i + 1
  to_next_ = ribbons[(i + 2) % 3].c.derivative_at(0) + boundary.inward[i];
  to_previous_ = -ribbons[(i + 1) % 3].c.derivative_at(1) + boundary.inward[i];
  if (degree != RayDegree::quintic) return;

  // At the vertex: the second derivatives of the two sides that meet there and the mixed one, which both sides give
  // (their values differ within the tangent plane only, where the planes of the sides agree along both).
  const Ribbon &next = ribbons[(i + 2) % 3], &previous = ribbons[(i + 1) % 3];
  const Vec3 nn = next.c.derivative_at(0, 2), pp = previous.c.derivative_at(1, 2);
  const Vec3 np = 0.5 * (0.5 * nn - next.d.derivative_at(0) + 0.5 * pp + previous.d.derivative_at(1));
  vertex_second_ = {nn, 2 * (np - nn), nn - 2 * np + pp, Vec3::Zero()};
  // At the side: Q + 2 (t - 1/2) d' + (t - 1/2)^2 c'', with Q, d' and c'' linear between the corners, as for cubic surfaces. Q is
  // such that a ray along one of the other two sides has that side's own second derivative. The d' and c'' of a spline in between
  // are left alone: the patch would take four of its derivatives.
  const PiecewisePolynomial& d = ribbons[i].d;
  const Vec3 c0 = ribbons[i].c.derivative_at(0, 2), c1 = ribbons[i].c.derivative_at(1, 2), d0 = d.derivative_at(0),
             d1 = d.derivative_at(1);
  const Vec3 q0 = next.c.derivative_at(1, 2) + d0 - 0.25 * c0, q1 = previous.c.derivative_at(0, 2) - d1 - 0.25 * c1;
  const Vec3 q = q1 - q0, e = d1 - d0, c = c1 - c0;
  side_second_ = {q0 - d0 + 0.25 * c0, q + 2 * d0 - e + 0.25 * c - c0, 2 * e + c0 - c, c};
}

}  // namespace tripatch
