// The surface through rows of points: cubic splines along the rows and across them.
#pragma once

#include <array>
#include <vector>

#include "tripatch/patch/surface.h"

namespace tripatch {

/// Twice continuously differentiable. Rows of evaluate are (u, v, not read), derivatives are by (u, v); all orders, those above the third
/// of each variable are 0.
class RowsSurface final : public Surface {
public:
  /// u, v: increasing, four places or more each; points: (i, j) is row i |v| + j, at (u[i], v[j]).
  RowsSurface(std::vector<double> u, std::vector<double> v, const Points& points);
  void evaluate(const double* b, Index n, int order, double* out) const override;

private:
  /// Of one piece: powers of u and v from its middle.
  using Piece = std::array<Vec3, 16>;
  const Piece& piece(Index i, Index j) const { return pieces_[static_cast<std::size_t>(i) * (v_.size() - 1) + j]; }

  std::vector<double> u_, v_;
  std::vector<Piece> pieces_;
};

}  // namespace tripatch
