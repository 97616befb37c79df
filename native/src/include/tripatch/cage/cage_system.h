// Least squares in the free vertices of a cage: every term is a sum of vertices with weights, so the normal equations are sparse,
// in blocks of 3 x 3, and of one pattern for all terms.
#pragma once

#include <Eigen/Sparse>
#include <vector>

#include "tripatch/math/sparse_ldlt.h"
#include "tripatch/types.h"

namespace tripatch {

using Weights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Several sums of the same vertices: of the free ones by weights, a row a sum and a column a slot, and the rest as it is.
struct Sums {
  std::vector<int> slots;
  Weights weights;
  Points rest;
  Points at(const Points& free) const;
};

class CageSystem {
public:
  /// free: vertex of each slot.
  CageSystem(const Points& vertices, std::vector<Index> free);

  const std::vector<Index>& free() const { return free_; }
  Sums sums(const std::vector<Index>& vertices, const Weights& weights) const;
  /// The same with those that are not free in other places.
  Sums sums(const std::vector<Index>& vertices, const Weights& weights, const Points& places) const;

  /// A sum of squares |A y + b|^2 in the movement y of the free vertices, three unknowns a slot: y' h y + 2 g' y + c.
  struct Term {
    Eigen::SparseMatrix<double> h;
    Eigen::VectorXd g;
    double c = 0;
    double operator()(const Eigen::VectorXd& y) const { return y.dot(h * y + 2 * g) + c; }
  };
  /// Before the first term: slots that occur together, for all terms to come.
  void prepare(const std::vector<const Sums*>& together);
  Term zero() const;
  /// to += weight * from
  static void add(Term& to, double weight, const Term& from);
  /// Adds d' metric d, d the movement of sum `row` plus `residual`.
  void add(Term& term, const Sums& sums, Index row, const Eigen::Matrix3d& metric, const Vec3& residual) const;
  /// Adds |jacobian y + value|^2, the jacobian three columns a slot of `slots`.
  void add(Term& term, const std::vector<int>& slots, const Weights& jacobian, const Eigen::VectorXd& value) const;
  /// The step from y that makes the term least, its diagonal larger by that part.
  Eigen::VectorXd step(const Term& term, const Eigen::VectorXd& y, double damping);

private:
  double* block(Term& term, int row, int column) const;

  const Points& vertices_;
  std::vector<Index> free_;
  std::vector<int> slot_;               ///< of each vertex, -1: not free
  std::vector<std::vector<int>> rows_;  ///< of each slot, those that it occurs with, itself included, in order
  Eigen::SparseMatrix<double> pattern_;
  SparseLdlt solver_;
};

}  // namespace tripatch
