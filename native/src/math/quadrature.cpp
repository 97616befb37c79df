#include "tripatch/math/quadrature.h"

#include <cmath>
#include <numbers>

namespace tripatch {

GaussNodes gauss(int n) {
  GaussNodes nodes;
  auto& [x, w] = nodes;
  x.resize(n);
  w.resize(n);
  for (int k = 0; k < n; ++k) {
    double z = std::cos(std::numbers::pi * (k + 0.75) / (n + 0.5)), slope = 1;
    for (int it = 0; it < 100; ++it) {
      double p = 1, q = 0;
      for (int j = 0; j < n; ++j) {
        const double r = q;
        q = p;
        p = ((2 * j + 1) * z * q - j * r) / (j + 1);
      }
      slope = n * (z * p - q) / (z * z - 1);
      const double step = p / slope;
      z -= step;
      if (std::abs(step) < 1e-15) break;
    }
    x[k] = 0.5 * (1 - z);
    w[k] = 1 / ((1 - z * z) * slope * slope);
  }
  return nodes;
}

Quadrature corner_quadrature(int n) {
  const auto [x, w] = gauss(n);
  Quadrature result;
  result.b.resize(6 * n * n, 3);
  const double area = std::sqrt(3.0) / 4 / 6;  // of one of the six
  Index row = 0;
  for (int i = 0; i < 3; ++i)
    for (int side = 1; side < 3; ++side) {
      const Eigen::RowVector3d vertex = Eigen::RowVector3d::Unit(i),
                               midpoint = 0.5 * (vertex + Eigen::RowVector3d::Unit((i + side) % 3)),
                               center = Eigen::RowVector3d::Constant(1.0 / 3);
      for (int a = 0; a < n; ++a)
        for (int c = 0; c < n; ++c) {
          const Eigen::RowVector3d b = vertex + x[a] * ((1 - x[c]) * (midpoint - vertex) + x[c] * (center - vertex));
          result.b.row(row++) = b;
          result.weights.push_back(w[a] * w[c] * x[a] * 2 * area * 27 / 8 * (1 - b[0]) * (1 - b[1]) * (1 - b[2]));
        }
    }
  return result;
}

}  // namespace tripatch
