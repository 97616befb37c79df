#include "tripatch/fairing/fold_removal.h"

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "tripatch/fairing/fairing_space.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/triangular_grid.h"
#include "tripatch/patch/rim_normals.h"

namespace tripatch {
namespace {

constexpr int degree = count::degree;  // of the interior term
constexpr Index rows = fold_grid_rows;
constexpr double facing = share::trace;  // cosine, least wanted, to the rim's normals: a little more than FoldCounter asks
constexpr double neighbors =
    share::half + share::little;        // cosine, least wanted, between neighbors' normals: FoldCounter asks for 0.5
constexpr double far = share::quarter;  // times the size: where that is not enough, nothing is
constexpr int rounds = count::places;   // at most, of a penalty that grows threefold
constexpr double first_penalty = factor::huge, growth = factor::strong;

/// The points of the grid inside the triangle, what normals are wanted there, and what the functions do to them.
struct Inside {
  TriangularGrid grid = {rows - 3};
  Points b = Points(grid.size(), 3);
  std::vector<Vec3> wanted;
  Eigen::MatrixXd first;  // derivatives of the functions in b0 and b1, over the size

  Inside(const Sides& sides, const FairingSpace& functions, double size) {
    const RimNormals rim(sides);
    for (Index q = 1; q < rows; ++q)
      for (Index p = 1; p + q < rows; ++p)
        b.row(grid.at(p - 1, q - 1)) << double(rows - p - q) / rows, double(p) / rows, double(q) / rows;
    const Index count = functions.combination.cols();
    first.resize(2 * b.rows(), count);
    for (Index k = 0; k < b.rows(); ++k) {
      wanted.push_back(rim.at(b.row(k).data()).normalized());
      const std::vector<Jet<1>> basis = scalar_basis(Barycentric<1>(b.row(k).data()), degree, 0);
      for (Index c = 0; c < count; ++c) first.block<2, 1>(2 * k, c) << basis[c].c[1], basis[c].c[2];
    }
    first = size * (first * functions.combination);
  }
};

/// The patch at those points.
struct Facing {
  std::vector<Vec3> p, q, normal;  // derivatives in b0 and b1
  std::vector<double> area;

  Facing(const Inside& inside, const Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor>& jets, const Eigen::MatrixXd& x) {
    for (Index k = 0; k < jets.rows(); ++k) {
      p.emplace_back(jets.row(k).segment<3>(3).transpose() + x.transpose() * inside.first.row(2 * k).transpose());
      q.emplace_back(jets.row(k).segment<3>(6).transpose() + x.transpose() * inside.first.row(2 * k + 1).transpose());
      area.push_back(p[k].cross(q[k]).norm());
      normal.emplace_back(p[k].cross(q[k]) / area[k]);
    }
  }
};

/// The folds there are: what takes each away, one a column, and how much it lacks.
struct Folds {
  Eigen::MatrixXd columns;
  Eigen::VectorXd lacking;
  Index count = 0;

  Folds(const Inside& inside, const Facing& at) {
    const Index points = inside.b.rows(), most = points + 3 * inside.grid.rows * (inside.grid.rows + 1) / 2;
    columns.resize(3 * inside.first.cols(), most);
    lacking.resize(most);
    for (Index k = 0; k < points; ++k)
      if (begin(facing - at.normal[k].dot(inside.wanted[k]))) {
        add(inside, at, k, inside.wanted[k]);
        ++count;
      }
    inside.grid.for_edges([&](Index a, Index b) {
      if (!begin(neighbors - at.normal[a].dot(at.normal[b]))) return;
      add(inside, at, a, at.normal[b]);
      add(inside, at, b, at.normal[a]);
      ++count;
    });
  }

private:
  bool begin(double lacks) {
    lacking[count] = lacks;
    if (!(lacks > 0)) return false;
    columns.col(count).setZero();
    return true;
  }

  /// what a change does to n_k . m: (dp x q + p x dq) . m' = dp . (q x m') + dq . (m' x p), m' the part of m across n_k, over the area
  void add(const Inside& inside, const Facing& at, Index k, const Vec3& m) {
    const Index n = inside.first.cols();
    const Vec3 across = (m - at.normal[k] * at.normal[k].dot(m)) / at.area[k], of_p = at.q[k].cross(across),
               of_q = across.cross(at.p[k]);
    for (int c = 0; c < 3; ++c)
      columns.col(count).segment(c * n, n) += of_p[c] * inside.first.row(2 * k) + of_q[c] * inside.first.row(2 * k + 1);
  }
};

}  // namespace

SurfacePtr fold_removal(const SurfacePtr& patch, const Sides& sides, double size, const FoldCounter& folds) {
  const FairingSpace& functions = fairing_space(degree, 0, 0, 8);
  const Inside inside(sides, functions, size);
  const Index points = inside.b.rows(), unknowns = 3 * inside.first.cols();
  Eigen::Matrix<double, Eigen::Dynamic, 9, Eigen::RowMajor> jets(points, 9);
  patch->evaluate(inside.b.data(), points, 1, jets.data());

  const std::array<double, 3> none = {0, 0, 0};
  const PiecewisePolynomial zero = PiecewisePolynomial::constant(none);
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(inside.first.cols(), 3);
  double penalty = first_penalty;
  for (int round = 0; round < rounds; ++round, penalty *= growth) {
    const Folds active(inside, Facing(inside, jets, x));
    if (active.count == 0) return nullptr;  // folds are counted on more than this grid, or on a patch with more added
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(unknowns, unknowns);
    const auto columns = active.columns.leftCols(active.count);
    matrix.selfadjointView<Eigen::Lower>().rankUpdate(columns, penalty);
    const Eigen::VectorXd right = penalty * columns * (active.lacking.head(active.count) + columns.transpose() * x.reshaped());
    x.reshaped() = constrained_quadratic_minimum(matrix, -right, Eigen::MatrixXd(0, unknowns));
    if (!x.allFinite()) return nullptr;
    const SurfacePtr candidate =
        correction(std::array<PiecewisePolynomial, 3>{zero, zero, zero}, degree, 0, Points(size * (functions.combination * x)));
    if (!(candidate->positions(inside.b).rowwise().norm().maxCoeff() < far * size)) return nullptr;
    if (folds(*sum(patch, candidate)) == 0) return candidate;
  }
  return nullptr;
}

}  // namespace tripatch
