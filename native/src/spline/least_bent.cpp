#include "tripatch/spline/least_bent.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace tripatch {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// Cotangents of angles below half a degree, and areas below this share of the mean, come of triangles that are all but an edge.
constexpr double steepest = 100, least_area = 1e-3;

/// Weights of the edges and areas of the vertices of some triangles.
struct Measures {
  std::vector<Eigen::Triplet<double>> weights;  // of the Laplacian's entries
  Eigen::VectorXd areas;
};

Measures measured(const Points& points, const std::vector<std::array<Index, 3>>& triangles) {
  Measures out;
  out.areas = Eigen::VectorXd::Zero(points.rows());
  double sum = 0;
  for (const std::array<Index, 3>& t : triangles) {
    const Vec3 p[3] = {points.row(t[0]), points.row(t[1]), points.row(t[2])};
    const double twice = (p[1] - p[0]).cross(p[2] - p[0]).norm();
    sum += twice / 2;
    for (int k = 0; k < 3; ++k) {
      const Vec3 u = p[(k + 1) % 3] - p[k], v = p[(k + 2) % 3] - p[k];
      const double cotangent = std::clamp(u.dot(v) / std::max(twice, 1e-300), -steepest, steepest) / 2;
      const int a = static_cast<int>(t[(k + 1) % 3]), b = static_cast<int>(t[(k + 2) % 3]);
      out.weights.insert(out.weights.end(), {{a, b, cotangent}, {b, a, cotangent}, {a, a, -cotangent}, {b, b, -cotangent}});
      out.areas[t[k]] += twice / 6;
    }
  }
  out.areas = out.areas.cwiseMax(least_area * sum / static_cast<double>(std::max<std::size_t>(triangles.size(), 1)));
  return out;
}

}  // namespace

std::optional<Points> least_bent(const Points& points, const std::vector<std::array<Index, 3>>& triangles, Index first,
                                 Index count) {
  const Index n = points.rows();
  const Measures measures = measured(points, triangles);
  SparseRows laplacian(n, n);
  laplacian.setFromTriplets(measures.weights.begin(), measures.weights.end());
  std::vector<Eigen::Triplet<double>> entries;
  Points right = Points::Zero(n, 3);  // what the rows that stay bend
  const auto is_free = [&](Index v) { return first <= v && v < first + count; };
  for (Index v = 0; v < n; ++v) {
    bool any = false;
    for (SparseRows::InnerIterator at(laplacian, v); at && !any; ++at) any = is_free(at.col());
    if (!any) continue;
    const double scale = 1 / std::sqrt(measures.areas[v]);
    for (SparseRows::InnerIterator at(laplacian, v); at; ++at) {
      if (is_free(at.col()))
        entries.emplace_back(static_cast<int>(v), static_cast<int>(at.col() - first), scale * at.value());
      else
        right.row(v) -= scale * at.value() * points.row(at.col());
    }
  }
  Eigen::SparseMatrix<double> bent(n, count);
  bent.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> normal = bent.transpose() * bent;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
  if (solver.info() != Eigen::Success) return {};
  Points out = solver.solve(Eigen::MatrixXd(bent.transpose() * right));
  if (!out.allFinite()) return {};
  return out;
}

}  // namespace tripatch
