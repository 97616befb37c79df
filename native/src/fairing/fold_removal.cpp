#include "tripatch/fairing/fold_removal.h"

#include <Eigen/Dense>
#include <array>
#include <memory>
#include <vector>

#include "tripatch/fairing/fairing_space.h"
#include "tripatch/math/linear.h"
#include "tripatch/patch/rim_normals.h"

namespace tripatch {

SurfacePtr fold_removal(const SurfacePtr& patch, const Sides& sides, double size, const FoldCounter& folds) {
  constexpr int rows = 64, rounds = 16, degree = 9;
  constexpr double faces = 0.02, neighbours = 0.55;  // cosines: least wanted
  constexpr double far = 0.25;                       // times the size: where that is not enough, nothing is
  const FairingSpace& functions = fairing_space(degree, 0, 0, 8);
  const Index count = functions.combination.cols();
  std::vector<Vec3> wanted;
  std::vector<double> at;
  std::vector<std::array<Index, 2>> edges;
  const RimNormals rim(sides);
  for (int q = 1; q < rows; ++q)
    for (int p = 1; p + q < rows; ++p) {
      const Index here = static_cast<Index>(wanted.size()), above = here + rows - 1 - q;
      if (p + q + 1 < rows) edges.insert(edges.end(), {{here, here + 1}, {here, above}, {here + 1, above}});
      const std::array<double, 3> b = {double(rows - p - q) / rows, double(p) / rows, double(q) / rows};
      wanted.push_back(rim.at(b.data()).normalized());
      at.insert(at.end(), b.begin(), b.end());
    }
  const Index points = static_cast<Index>(wanted.size());
  Eigen::MatrixXd first(2 * points, count);  // derivatives of the functions in b0 and b1, over the size
  for (Index k = 0; k < points; ++k) {
    const std::vector<Jet<1>> basis = scalar_basis(Barycentric<1>(&at[3 * k]), degree, 0);
    for (Index c = 0; c < count; ++c) first.block<2, 1>(2 * k, c) << basis[c].c[1], basis[c].c[2];
  }
  first = size * (first * functions.combination);
  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> jets(points, 9);
  patch->evaluate(at.data(), points, 1, jets.data());

  const std::array<double, 3> none = {0, 0, 0};
  const PiecewisePolynomial zero = PiecewisePolynomial::constant(none);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(count, 3);
  double penalty = 10;
  for (int round = 0; round < rounds; ++round, penalty *= 3) {
    std::vector<Vec3> p(points), q(points), normal(points);
    std::vector<double> area(points);
    for (Index k = 0; k < points; ++k) {
      p[k] = jets.row(k).segment<3>(3).transpose() + x.transpose() * first.row(2 * k).transpose();
      q[k] = jets.row(k).segment<3>(6).transpose() + x.transpose() * first.row(2 * k + 1).transpose();
      area[k] = p[k].cross(q[k]).norm();
      normal[k] = p[k].cross(q[k]) / area[k];
    }
    Eigen::MatrixXd folded(3 * count, points + static_cast<Index>(edges.size()));  // what takes each fold away, one a column
    Eigen::VectorXd lacking(folded.cols());
    Index active = 0;
    // what a change does to n_k . m: (dp x q + p x dq) . m' = dp . (q x m') + dq . (m' x p), m' the part of m across n_k, over the area
    const auto add = [&](Index k, const Vec3& m) {
      const Vec3 across = (m - normal[k] * normal[k].dot(m)) / area[k], of_p = q[k].cross(across), of_q = across.cross(p[k]);
      for (int c = 0; c < 3; ++c)
        folded.col(active).segment(c * count, count) += of_p[c] * first.row(2 * k) + of_q[c] * first.row(2 * k + 1);
    };
    for (Index k = 0; k < points; ++k) {
      lacking[active] = faces - normal[k].dot(wanted[k]);
      if (!(lacking[active] > 0)) continue;
      folded.col(active).setZero();
      add(k, wanted[k]);
      ++active;
    }
    for (const auto& [a, b] : edges) {
      lacking[active] = neighbours - normal[a].dot(normal[b]);
      if (!(lacking[active] > 0)) continue;
      folded.col(active).setZero();
      add(a, normal[b]);
      add(b, normal[a]);
      ++active;
    }
    if (active == 0) return nullptr;  // folds are counted on more than this grid, or on a patch with more added
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(3 * count, 3 * count);
    const auto columns = folded.leftCols(active);
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(columns, penalty);
    const Eigen::VectorXd right = penalty * columns * (lacking.head(active) + columns.transpose() * x.reshaped());
    x.reshaped() = least_quadratic(matrix, -right, Eigen::MatrixXd(0, 3 * count));
    if (!x.allFinite()) return nullptr;
    const SurfacePtr candidate =
        correction(std::array<PiecewisePolynomial, 3>{zero, zero, zero}, degree, 0, Points(size * (functions.combination * x)));
    const Points added = candidate->positions(Eigen::Map<const Points>(at.data(), points, 3));
    if (!(added.rowwise().norm().maxCoeff() < far * size)) return nullptr;
    if (folds(*sum(patch, candidate)) == 0) return candidate;
  }
  return nullptr;
}

}  // namespace tripatch
