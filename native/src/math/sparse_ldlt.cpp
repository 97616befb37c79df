// As T. Davis's LDL ("Algorithm 849: a concise sparse Cholesky factorization package", 2005), row by row. Neighboring columns with the same
// rows are subtracted together: each place is read once for all of them, and takes them in their order.
#include "tripatch/math/sparse_ldlt.h"

#include <array>
#include <vector>

#include "tripatch/math/interruption.h"
#include "tripatch/math/simd.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

constexpr int max_together = count::octet;

/// Columns of the factor from the rows on that they have in common, and what they are multiplied by.
struct Columns {
  std::array<const double*, max_together> values;
  std::array<double, max_together> times;
};

/// y less N columns, from `first` of their rows on.
template <int N>
void subtract_columns_from(int first, double* y, const Columns& columns, const int* rows, int size) {
  for (int p = first; p < size; ++p) {
    double sum = y[rows[p]];
    for (int c = 0; c < N; ++c) sum -= columns.values[c][p] * columns.times[c];
    y[rows[p]] = sum;
  }
}

#ifdef TRIPATCH_PACKS
/// Rows that follow each other by fours.
template <int N>
TRIPATCH_PACKED void subtract_columns_packed(double* y, const Columns& columns, const int* rows, int size) {
  int p = 0;
  for (; p + lanes <= size; p += lanes) {
    if (rows[p + lanes - 1] - rows[p] != lanes - 1) {
      subtract_columns_from<N>(p, y, columns, rows, p + lanes);
      continue;
    }
    Pack sum = loaded(y + rows[p]);
    for (int c = 0; c < N; ++c) sum = sum - loaded(columns.values[c] + p) * all_lanes(columns.times[c]);
    store(sum, y + rows[p]);
  }
  subtract_columns_from<N>(p, y, columns, rows, size);
}
#endif

template <int N>
void subtract_columns(double* y, const Columns& columns, const int* rows, int size) {
#ifdef TRIPATCH_PACKS
  if (has_packs()) return subtract_columns_packed<N>(y, columns, rows, size);
#endif
  subtract_columns_from<N>(0, y, columns, rows, size);
}

constexpr std::array subtract_any_columns = {subtract_columns<1>, subtract_columns<2>, subtract_columns<3>, subtract_columns<4>,
                                             subtract_columns<5>, subtract_columns<6>, subtract_columns<7>, subtract_columns<8>};
static_assert(subtract_any_columns.size() == max_together);

}  // namespace

void SparseLdlt::factorize(const Eigen::SparseMatrix<double>& matrix) {
  CholMatrixType ordered(matrix.rows(), matrix.cols());
  if (m_P.size() > 0)
    ordered.selfadjointView<Eigen::Upper>() = matrix.selfadjointView<Eigen::Lower>().twistedBy(m_P);
  else
    ordered.selfadjointView<Eigen::Upper>() = matrix.selfadjointView<Eigen::Lower>();
  factorize_ordered(ordered);
}

void SparseLdlt::factorize_ordered(const CholMatrixType& ordered) {
  const int size = static_cast<int>(ordered.rows());
  const int* const start = m_matrix.outerIndexPtr();
  int* const rows = m_matrix.innerIndexPtr();
  double* const values = m_matrix.valuePtr();
  std::vector<double> y(static_cast<std::size_t>(size), 0.0);
  std::vector<int> pattern(y.size()), tags(y.size(), -1), filled(start, start + size);  // filled: the end of a column as it is
  const auto goes_on = [&](int i) { return m_parent[i] == i + 1 && start[i + 1] - start[i] == start[i + 2] - start[i + 1] + 1; };
  m_diag.resize(size);
  m_info = Eigen::Success;
  m_factorizationIsOk = true;
  for (int k = 0; k < size; ++k) {
    check_interruption();
    y[k] = 0;
    tags[k] = k;
    int top = size;  // pattern[top..]: columns in row k of the factor, each before those that it changes
    for (CholMatrixType::InnerIterator it(ordered, k); it; ++it) {
      int i = it.index();
      if (i > k) continue;
      y[i] += it.value();
      int length = 0;
      for (; tags[i] != k; i = m_parent[i]) {
        pattern[length++] = i;
        tags[i] = k;
      }
      while (length > 0) pattern[--top] = pattern[--length];
    }
    double d = y[k];
    y[k] = 0;
    while (top < size) {
      const int first = pattern[top];
      int count = 1;
      while (count < max_together && top + count < size && pattern[top + count] == first + count && goes_on(first + count - 1))
        ++count;
      Columns columns = {};
      for (int c = 0; c < count; ++c) {
        const int i = first + c;
        const double x = y[i];
        y[i] = 0;
        for (int later = c + 1; later < count; ++later) y[first + later] -= values[start[i] + later - c - 1] * x;
        columns.values[c] = values + start[i] + count - 1 - c;
        columns.times[c] = x;
        d -= x / m_diag[i] * x;
      }
      const int last = first + count - 1;
      subtract_any_columns[count - 1](y.data(), columns, rows + start[last], filled[last] - start[last]);
      for (int c = 0; c < count; ++c) {
        const int i = first + c;
        rows[filled[i]] = k;
        values[filled[i]++] = columns.times[c] / m_diag[i];
      }
      top += count;
    }
    m_diag[k] = d;
    if (d == 0) {
      m_info = Eigen::NumericalIssue;
      break;
    }
  }
  for (int k = 0; k < size; ++k) m_nonZerosPerCol[k] = filled[k] - start[k];
}

}  // namespace tripatch
