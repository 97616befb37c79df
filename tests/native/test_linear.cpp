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
  }
}
