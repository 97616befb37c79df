#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "tripatch/math/linear.h"

using namespace tripatch;

TEST_CASE("products by rows are those of Eigen, whatever the size") {
  for (const Index n : {1, 3, 4, 7, 8, 9, 24, 27, 57, 105}) {
    CAPTURE(n);
    const RowMajor a = RowMajor::Random(13, n), b = RowMajor::Random(9, n), four = RowMajor::Random(4, 9);
    const RowMajor given = RowMajor::Random(n, n);
    RowMajor gram = given;
    add_gram(a, gram);
    const RowMajor wanted = given + a.transpose() * a, off = gram - wanted;
    CHECK(RowMajor(off.triangularView<Eigen::Lower>()).cwiseAbs().maxCoeff() < 1e-13);

    RowMajor out = RowMajor::Constant(4, n + 5, 7);  // between others' columns
    multiply_four(four.data(), 9, b.data(), n, out.data() + 2, n + 5);
    CHECK((out.middleCols(2, n) - four * b).cwiseAbs().maxCoeff() < 1e-13);
    CHECK((out.leftCols(2).array() == 7).all());
    CHECK((out.rightCols(3).array() == 7).all());

    const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(n, 3);
    Points sum = Points::Constant(13, 3, 7);
    add_product(a.data(), 13, n, columns.data(), sum.data());
    CHECK((sum.array() - 7 - (a * columns).array()).abs().maxCoeff() < 1e-13);
  }
}

TEST_CASE("a lower triangle times its solution is the right-hand side, whatever the size and whatever stands above") {
  for (const Index n : {1, 3, 4, 5, 9, 57})
    for (const Index k : {1, 3, 8, 21}) {
      CAPTURE(n, k);
      Eigen::MatrixXd a = Eigen::MatrixXd::Random(n, n);
      a.diagonal().array() += 5;
      const RowMajor right = RowMajor::Random(n, k);
      RowMajor x = right;
      solve_lower_triangular(a, x);
      CHECK((a.triangularView<Eigen::Lower>() * x - right).cwiseAbs().maxCoeff() < 1e-12);
    }
}

TEST_CASE("a quadratic minimum is where the gradient vanishes, whatever the size; without one it is not finite") {
  for (const Index n : {1, 2, 7, 8, 15, 16, 17, 31, 33, 64, 105}) {
    CAPTURE(n);
    const Eigen::MatrixXd root = Eigen::MatrixXd::Random(n + 3, n);
    Eigen::MatrixXd a = root.transpose() * root + 0.1 * Eigen::MatrixXd::Identity(n, n);
    const Eigen::VectorXd b = Eigen::VectorXd::Random(n);
    const Eigen::VectorXd x = constrained_quadratic_minimum(a, b, Eigen::MatrixXd(0, n));
    CHECK((a * x + b).norm() < 1e-11 * b.norm() * a.norm());
    a(n / 2, n / 2) = -1;
    CHECK_FALSE(constrained_quadratic_minimum(a, b, Eigen::MatrixXd(0, n)).allFinite());
  }
}

TEST_CASE("minimum-norm least squares: of all that are nearest the shortest") {
  Eigen::MatrixXd a(4, 3);  // of rank 2: the last column is the sum of the others
  a << 1, 0, 1, 0, 1, 1, 1, 1, 2, 1, -1, 0;
  const Eigen::VectorXd b = (Eigen::VectorXd(4) << 1, 2, 0, 1).finished(), kernel = (Eigen::VectorXd(3) << 1, 1, -1).finished();
  const auto [x, rank] = minimum_norm_least_squares(a, b, 1e-11);
  CHECK(rank == 2);
  CHECK((a.transpose() * (a * x - b)).norm() < 1e-14);
  CHECK(std::abs(kernel.dot(x.col(0))) < 1e-14);
  CHECK((least_squares(a, b) - x).norm() < 1e-14);
  // a pivot on either side of the threshold
  Eigen::Matrix2d small = Eigen::Vector2d(1, 1e-8).asDiagonal();
  CHECK(minimum_norm_least_squares(small, Eigen::Vector2d(1, 1), 0.9e-8).rank == 2);
  CHECK(minimum_norm_least_squares(small, Eigen::Vector2d(1, 1), 1.1e-8).rank == 1);
}

TEST_CASE("a constrained quadratic minimum keeps its constraints, and nothing that keeps them is less") {
  const Eigen::MatrixXd root = Eigen::MatrixXd::Random(9, 6), a = root.transpose() * root, held = Eigen::MatrixXd::Random(2, 6);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(6);
  const Eigen::MatrixXd lower = a.triangularView<Eigen::Lower>();  // all that is read
  const Eigen::VectorXd x = constrained_quadratic_minimum(lower, b, held);
  CHECK((held * x).norm() < 1e-13);
  const Eigen::VectorXd gradient = a * x + b, multipliers = least_squares(held.transpose(), gradient);
  CHECK((gradient - held.transpose() * multipliers).norm() < 1e-11);
  const Eigen::VectorXd free = constrained_quadratic_minimum(lower, b, Eigen::MatrixXd(0, 6));
  CHECK((a * free + b).norm() < 1e-11);
  CHECK_FALSE(constrained_quadratic_minimum(-a, b, held).allFinite());
}

TEST_CASE("linear systems of special form") {
  const Eigen::MatrixXd a = Eigen::MatrixXd::Random(9, 5), b = Eigen::MatrixXd::Random(5, 2);
  const Eigen::MatrixXd symmetric = a.transpose() * a, upper = Eigen::MatrixXd(symmetric.triangularView<Eigen::Upper>());
  CHECK((symmetric * solve_symmetric(symmetric.triangularView<Eigen::Lower>().toDenseMatrix(), b) - b).norm() < 1e-10);
  CHECK((upper * solve_upper_triangular(upper, b) - b).norm() < 1e-10);
  const Eigen::MatrixXd c = orthonormalization(a), q = a * c;
  CHECK((q.transpose() * q - Eigen::MatrixXd::Identity(5, 5)).norm() < 1e-13);
  CHECK(Eigen::MatrixXd(c.triangularView<Eigen::StrictlyLower>()).norm() == 0);
  const Eigen::MatrixXd part = submatrix(a, {7, 0}, {4, 4, 1});
  CHECK(part.rows() == 2);
  CHECK(part(0, 0) == a(7, 4));
  CHECK(part(1, 1) == a(0, 4));
  CHECK(part(1, 2) == a(0, 1));
}

TEST_CASE("coordinates in a frame of two vectors") {
  const Vec3 a(1, 2, 0), b(0, 1, -1);
  CHECK((in_frame(a, b, 2 * a - 3 * b) - Eigen::Vector2d(2, -3)).norm() < 1e-14);
  CHECK((in_frame(a, b, 2 * a - 3 * b + 5 * a.cross(b)) - Eigen::Vector2d(2, -3)).norm() < 1e-13);
  CHECK((in_frame(a, 2 * a, 5 * a) - Eigen::Vector2d(1, 2)).norm() < 1e-13);  // the shortest
  CHECK(in_frame(Vec3::Zero(), Vec3::Zero(), a).norm() == 0);
}

TEST_CASE("a symmetric matrix of up to 24 unknowns has a factor unless it is nearly singular") {
  const Index n = 21;
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(40, n);
  const Eigen::VectorXd right = Eigen::VectorXd::Random(n);
  SquareOf24 a = SquareOf24::Zero();
  a.topLeftCorner(n, n) = rows.transpose() * rows;
  const Eigen::MatrixXd given = a.topLeftCorner(n, n);
  a.col(n).head(n) = right;
  REQUIRE(factor_symmetric(a, n, 1e-9));
  const Eigen::MatrixXd r = a.topLeftCorner(n, n).triangularView<Eigen::Upper>();
  CHECK((r.transpose() * r - given).cwiseAbs().maxCoeff() < 1e-12);
  CHECK((r.transpose() * a.col(n).head(n) - right).cwiseAbs().maxCoeff() < 1e-12);

  Eigen::MatrixXd fewer = rows;
  fewer.col(17) = fewer.col(3) + 1e-6 * fewer.col(17);  // its diagonal element is left with 1e-12 of itself
  a.setZero();
  a.topLeftCorner(n, n) = fewer.transpose() * fewer;
  CHECK_FALSE(factor_symmetric(a, n, 1e-9));
}

TEST_CASE("a symmetric matrix becomes tridiagonal with the same solutions and determinant, whatever the size") {
  for (const Index n : {1, 2, 3, 5, 8, 31, 64}) {
    CAPTURE(n);
    const Eigen::MatrixXd half = Eigen::MatrixXd::Random(n, n), given = Eigen::MatrixXd::Random(n, 3);
    const Eigen::MatrixXd a = half * half.transpose() + Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd lower = a.triangularView<Eigen::Lower>(), b = given;
    const auto [diagonal, beside] = tridiagonalize(lower, b);
    REQUIRE(beside.size() == n - 1);
    Eigen::MatrixXd made = diagonal.asDiagonal();
    made.diagonal(1) = made.diagonal(-1) = beside;
    CHECK(b.colwise().norm().isApprox(given.colwise().norm(), 1e-13));
    CHECK((b.transpose() * made * b).isApprox(given.transpose() * a * given, 1e-12));
    CHECK((b.transpose() * made.ldlt().solve(b)).isApprox(given.transpose() * a.ldlt().solve(given), 1e-10));
    CHECK(made.determinant() == Approx(a.determinant()).epsilon(1e-10));
  }
  Eigen::MatrixXd plain = Eigen::Vector4d(3, -1, 2, 5).asDiagonal(), b = Eigen::MatrixXd::Identity(4, 4);
  const auto [diagonal, beside] = tridiagonalize(plain, b);  // nothing to be reflected
  CHECK(diagonal == Eigen::Vector4d(3, -1, 2, 5));
  CHECK(beside.isZero(0));
  CHECK(b.isIdentity(0));
}

TEST_CASE("Cholesky's factor is made in the lower triangle, and none of what is not definite") {
  for (const Index n : {1, 2, 15, 16, 17, 50}) {
    CAPTURE(n);
    const Eigen::MatrixXd half = Eigen::MatrixXd::Random(n, n);
    const Eigen::MatrixXd a = half * half.transpose() + Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd lower = a;
    REQUIRE(factor_cholesky(lower));
    const Eigen::MatrixXd factor = lower.triangularView<Eigen::Lower>();
    CHECK((factor * factor.transpose()).isApprox(a, 1e-13));
    Eigen::MatrixXd indefinite = a;
    indefinite(n - 1, n - 1) = -1;
    CHECK_FALSE(factor_cholesky(indefinite));
  }
}
