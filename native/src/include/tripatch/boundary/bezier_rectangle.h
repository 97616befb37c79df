// Bezier rectangle (tensor-product patch) over the unit square.
#pragma once

#include "tripatch/boundary/rectangle_surface.h"

namespace tripatch {

class BezierRectangle final : public RectangleSurface {
public:
  /// net: (degree_u + 1)(degree_v + 1) points, v running fastest.
  BezierRectangle(Points net, int degree_u, int degree_v);

  int degree_u() const { return degree_u_; }
  int degree_v() const { return degree_v_; }
  const Points& net() const { return net_; }
  Index row(int i, int j) const { return Index(i) * (degree_v_ + 1) + j; }

  void evaluate(const double* uv, Index n, int order, double* out) const override;  ///< by de Casteljau
  std::array<double, 4> domain() const override { return {0, 1, 0, 1}; }
  Side side(int edge, bool reversed) const override;

private:
  int degree_u_, degree_v_;
  Points net_;
};

}  // namespace tripatch
