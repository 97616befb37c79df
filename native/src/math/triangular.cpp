#include "tripatch/math/triangular.h"

#include <algorithm>

namespace tripatch {

/// Four rows at a time: what those before take away is a product for which the machine's registers are used, as Eigen's is not.
void solve_lower_triangular(const Eigen::MatrixXd& a, RowMajor& b) {
  constexpr Index four = 4;
  const Index n = a.rows(), columns = b.cols();
  RowMajor taken(four, columns);
  for (Index from = 0; from < n; from += four) {
    const Index own = std::min(four, n - from);
    if (from > 0) {
      RowMajor rows = RowMajor::Zero(four, from);  // a new one: resize() frees, and frees again where there is no memory then
      rows.topRows(own) = a.block(from, 0, own, from);
      multiply_four(rows.data(), from, b.data(), columns, taken.data(), columns);
      b.middleRows(from, own) -= taken.topRows(own);
    }
    for (Index i = from; i < from + own; ++i) {
      for (Index k = from; k < i; ++k) b.row(i) -= a(i, k) * b.row(k);
      b.row(i) /= a(i, i);
    }
  }
}

}  // namespace tripatch
