#include <Eigen/Dense>
#include <atomic>
#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "tripatch/math/interruption.h"
#include "tripatch/math/sparse_ldlt.h"

using namespace tripatch;

namespace {

/// Of a grid of vertices with `each` unknowns, which occur with those two steps off.
Eigen::SparseMatrix<double> grid_matrix(int n, int each) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> value(-1, 1);
  std::vector<Eigen::Triplet<double>> entries;
  const auto number = [&](int i, int j, int x) { return each * (n * i + j) + x; };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int di = 0; di <= 2 && i + di < n; ++di)
        for (int dj = -2; dj <= 2; ++dj) {
          if (j + dj < 0 || j + dj >= n || (di == 0 && dj < 0)) continue;
          for (int x = 0; x < each; ++x)
            for (int y = 0; y < each; ++y) {
              const int a = number(i, j, x), b = number(i + di, j + dj, y);
              if (di == 0 && dj == 0 && b < a) continue;
              const double entry = a == b ? 30 : value(random);
              entries.emplace_back(a, b, entry);
              if (a != b) entries.emplace_back(b, a, entry);
            }
        }
  Eigen::SparseMatrix<double> matrix(each * n * n, each * n * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

TEST_CASE("Sparse matrices are factorized as by Eigen, to the last bit", "[math]") {
  for (int each : {1, 2, 3, 5}) {
    const Eigen::SparseMatrix<double> matrix = grid_matrix(9, each);
    const Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(matrix.rows(), -1, 2);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> eigen(matrix);
    SparseLdlt own;
    own.analyzePattern(matrix);
    for (int times = 0; times < 2; ++times) {
      own.factorize(matrix);
      REQUIRE(own.info() == Eigen::Success);
      CHECK(own.solve(right) == eigen.solve(right));
    }
    CHECK((matrix * own.solve(right) - right).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("A sparse matrix with a pivot of zero is not factorized", "[math]") {
  Eigen::SparseMatrix<double> matrix = grid_matrix(3, 2);
  matrix *= 0.0;
  SparseLdlt own;
  own.analyzePattern(matrix);
  own.factorize(matrix);
  CHECK(own.info() == Eigen::NumericalIssue);
}

TEST_CASE("A factorization ends where it is interrupted", "[math]") {
  const Eigen::SparseMatrix<double> matrix = grid_matrix(9, 3);
  SparseLdlt own;
  own.analyzePattern(matrix);
  Cancel cancel;
  cancel.request();
  const CancelScope scope(&cancel);
  CHECK_THROWS_AS(own.factorize(matrix), Interrupted);
}
