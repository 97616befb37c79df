#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <random>

#include "tripatch/math/block_ldlt.h"

using namespace tripatch;

namespace {

/// A symmetric matrix of blocks on a ring with chords, and the same for the solver.
struct Ring {
  explicit Ring(int n, double diagonal) : dense(Eigen::MatrixXd::Zero(2 * n, 2 * n)), before(n) {
    for (int k = 1; k < n; ++k)
      for (int c = 0; c < k; ++c)
        if (k - c == 1 || (k == n - 1 && c == 0) || (k + c) % 7 == 0) before[k].push_back(c);
    sparse = BlockLdlt(before);
    sparse.clear();
    std::mt19937 random(1);
    std::uniform_real_distribution<double> value(-1, 1);
    for (int k = 0; k < n; ++k) {
      for (int c : before[k])
        for (int j = 0; j < 2; ++j)
          for (int i = 0; i < 2; ++i) {
            const double x = value(random);
            sparse.block(sparse.place(k, c))[2 * j + i] += x;
            dense(2 * k + i, 2 * c + j) = dense(2 * c + j, 2 * k + i) = x;
          }
      const double beside = value(random);
      const Eigen::Matrix2d own{{diagonal, beside}, {beside, diagonal + 1}};
      dense.block<2, 2>(2 * k, 2 * k) = own;
      for (int i = 0; i < 4; ++i) sparse.diagonal(k)[i] += own(i);
    }
  }
  Eigen::MatrixXd dense;
  std::vector<std::vector<int>> before;
  BlockLdlt sparse;
};

}  // namespace

TEST_CASE("Sparse matrices of blocks are solved as dense ones, definite or not", "[math]") {
  for (double diagonal : {40.0, 0.5}) {
    Ring ring(30, diagonal);
    const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(60, -1, 2), right = ring.dense * x;
    REQUIRE(ring.sparse.factorize());
    CHECK((ring.sparse.solve(right) - x).cwiseAbs().maxCoeff() < 1e-9);
    REQUIRE(ring.sparse.factorize());  // of the same matrix again
    CHECK((ring.sparse.solve(right) - x).cwiseAbs().maxCoeff() < 1e-9);
  }
}

TEST_CASE("Whether a sparse matrix of blocks is definite its pivots tell", "[math]") {
  for (double diagonal : {40.0, 6.0, 4.0, 3.0, 2.0, 0.5}) {
    Ring ring(30, diagonal);
    REQUIRE(ring.sparse.factorize());
    const double least = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(ring.dense).eigenvalues()[0];
    CAPTURE(diagonal, least);
    CHECK(ring.sparse.is_definite() == (least > 0));
  }
}

TEST_CASE("A sparse matrix of blocks with one of zeros in a pivot is not factorized", "[math]") {
  Ring ring(5, 3);
  for (int i = 0; i < 4; ++i) ring.sparse.diagonal(0)[i] = 0;
  CHECK_FALSE(ring.sparse.factorize());
}

TEST_CASE("A matrix of blocks each of which is negative is not definite, though all its determinants are positive", "[math]") {
  Ring ring(30, -40);
  REQUIRE(ring.sparse.factorize());
  CHECK_FALSE(ring.sparse.is_definite());
}
