// L D L' of sparse symmetric matrices, as Eigen's to the last bit, which can be interrupted.
#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace tripatch {

class SparseLdlt : public Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> {
public:
  /// A matrix of the pattern that was analyzed. Thousands of unknowns with hundreds next to each take seconds: it looks up at every row.
  void factorize(const Eigen::SparseMatrix<double>& matrix);

private:
  void factorize_ordered(const CholMatrixType& ordered);
};

}  // namespace tripatch
