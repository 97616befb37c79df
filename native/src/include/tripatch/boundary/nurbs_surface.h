// NURBS surface of any degree, knots and weights. L. Piegl and W. Tiller, The NURBS Book, chapters 2 to 4.
#pragma once

#include "tripatch/boundary/rectangle_surface.h"

namespace tripatch {

class NurbsSurface final : public RectangleSurface {
public:
  /// points: count_u x count_v, v running fastest; weights alike (empty: all 1). The degrees follow from the numbers of knots:
  /// degree = knots - points - 1. The domain is from knot number `degree` to knot number `count`. Throws InvalidArgument for wrong
  /// sizes, knots that decrease or leave the surface torn, weights of zero or below, and numbers that are not finite.
  NurbsSurface(Points points, Index count_u, Index count_v, std::vector<double> weights, std::vector<double> knots_u,
               std::vector<double> knots_v);

  int degree_u() const { return axis_[0].degree; }
  int degree_v() const { return axis_[1].degree; }

  void evaluate(const double* uv, Index n, int order, double* out) const override;
  std::array<double, 4> domain() const override;
  /// Exact pieces where the weights are equal; else fitted between the knots to 1e-13.
  Side side(int edge, bool reversed) const override;

private:
  struct Axis {
    std::vector<double> knots;
    Index count = 0;
    int degree = 0;

    double from() const { return knots[degree]; }
    double to() const { return knots[count]; }
    Index span(double u) const;
    /// Taylor coefficients at u of the basis functions that live on a span, (degree + 1) x (order + 1); the first belongs to
    /// point span - degree.
    void basis(Index span, double u, int order, double* out) const;
    std::vector<double> breaks() const;  ///< the domain's distinct knots
  };

  struct Edge;

  std::array<Axis, 2> axis_;
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> homogeneous_;  // w x, w y, w z, w
  bool rational_ = false;
};

}  // namespace tripatch
