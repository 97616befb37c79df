// As T. Davis's LDL ("Algorithm 849: a concise sparse Cholesky factorization package", 2005), row by row, with blocks for numbers.
#include "tripatch/math/block_ldlt.h"

#include <algorithm>

#include "tripatch/math/simd.h"

namespace tripatch {
namespace {

using Column = Eigen::Map<Eigen::Vector2d, Eigen::Aligned16>;
using KnownColumn = Eigen::Map<const Eigen::Vector2d, Eigen::Aligned16>;

/// y -= x times the transpose of l.
void subtract_product(double* y, const Eigen::Vector2d& x0, const Eigen::Vector2d& x1, const double* l) {
  Column(y) -= x0 * l[0] + x1 * l[2];
  Column(y + 2) -= x0 * l[1] + x1 * l[3];
}

/// The same for all blocks l of a column of the factor; rows: of y.
void subtract_products(double* y, const Eigen::Vector2d& x0, const Eigen::Vector2d& x1, const double* l, const int* rows,
                       int count) {
  for (int p = 0; p < count; ++p) subtract_product(y + 4 * rows[p], x0, x1, l + 4 * p);
}

#ifdef TRIPATCH_PACKS
TRIPATCH_PACKED void subtract_packed(double* y, const Eigen::Vector2d& x0, const Eigen::Vector2d& x1, const double* l,
                                     const int* rows, int count) {
  const Pack first = {x0[0], x0[1], x0[0], x0[1]}, second = {x1[0], x1[1], x1[0], x1[1]};
  for (int p = 0; p < count; ++p) {
    const Pack block = loaded(l + 4 * p);
    double* const to = y + 4 * rows[p];
    store(loaded(to) - (first * __builtin_shufflevector(block, block, 0, 0, 1, 1) +
                        second * __builtin_shufflevector(block, block, 2, 2, 3, 3)),
          to);
  }
}
const auto subtract = has_packs() ? subtract_packed : subtract_products;
#else
constexpr auto subtract = subtract_products;
#endif

/// Of a symmetric block; false where it has no inverse.
bool invert(const double* d, double* inverse) {
  const double determinant = d[0] * d[3] - d[1] * d[1];
  if (determinant == 0) return false;
  inverse[0] = d[3] / determinant;
  inverse[1] = inverse[2] = -d[1] / determinant;
  inverse[3] = d[0] / determinant;
  return true;
}

}  // namespace

BlockLdlt::BlockLdlt(const std::vector<std::vector<int>>& before) {
  const int n = static_cast<int>(before.size());
  std::vector<int> parent(n, -1), marked(n, -1), count(n, 0), path(n), pattern(n);  // parent: in the elimination tree
  row_start_ = fill_start_ = {0};
  for (int k = 0; k < n; ++k) {
    int top = n;  // pattern[top..]: columns of row k of the factor
    marked[k] = k;
    for (int c : before[k]) {
      columns_.push_back(c);
      int length = 0;
      for (int i = c; marked[i] != k; i = parent[i]) {
        if (parent[i] < 0) parent[i] = k;
        path[length++] = i;
        marked[i] = k;
      }
      while (length > 0) pattern[--top] = path[--length];
    }
    fill_.insert(fill_.end(), pattern.begin() + top, pattern.end());
    for (; top < n; ++top) ++count[pattern[top]];
    row_start_.push_back(static_cast<int>(columns_.size()));
    fill_start_.push_back(static_cast<int>(fill_.size()));
  }
  start_ = {0};
  for (int k = 0; k < n; ++k) start_.push_back(start_.back() + count[k]);
  rows_.resize(fill_.size());
  std::vector<int> next(start_.begin(), start_.end() - 1);
  for (int k = 0; k < n; ++k)
    for (int at = fill_start_[k]; at < fill_start_[k + 1]; ++at) rows_[next[fill_[at]]++] = k;
  factor_.resize(4 * rows_.size());
  inverse_.resize(4 * static_cast<std::size_t>(n));
  own_.resize(inverse_.size());
  beside_.resize(4 * columns_.size());
}

int BlockLdlt::place(int k, int c) const {
  const auto from = columns_.begin() + row_start_[k];
  return static_cast<int>(std::lower_bound(from, columns_.begin() + row_start_[k + 1], c) - columns_.begin());
}

void BlockLdlt::clear() {
  std::fill(own_.begin(), own_.end(), 0.0);
  std::fill(beside_.begin(), beside_.end(), 0.0);
}

bool BlockLdlt::factorize() {
  const int n = rows();
  std::vector<int> filled(start_.begin(), start_.end() - 1);
  std::vector<double> row(4 * static_cast<std::size_t>(n), 0.0);  // L D, of one row
  for (int k = 0; k < n; ++k) {
    for (int at = row_start_[k]; at < row_start_[k + 1]; ++at)
      std::copy_n(beside_.data() + 4 * at, 4, row.data() + 4 * columns_[at]);
    Eigen::Matrix2d pivot = Eigen::Map<const Eigen::Matrix2d>(own_.data() + 4 * k);
    for (int at = fill_start_[k]; at < fill_start_[k + 1]; ++at) {
      const int i = fill_[at], p = filled[i]++;
      double* const y = row.data() + 4 * i;
      const Eigen::Vector2d y0 = KnownColumn(y), y1 = KnownColumn(y + 2);
      std::fill_n(y, 4, 0.0);
      subtract(row.data(), y0, y1, factor_.data() + 4 * start_[i], rows_.data() + start_[i], p - start_[i]);
      const double* const inverse = inverse_.data() + 4 * i;
      double* const l = factor_.data() + 4 * p;
      Column first(l), second(l + 2);
      first = y0 * inverse[0] + y1 * inverse[1];
      second = y0 * inverse[2] + y1 * inverse[3];
      subtract_product(pivot.data(), y0, y1, l);
    }
    if (!invert(pivot.data(), inverse_.data() + 4 * k)) return false;
  }
  return true;
}

bool BlockLdlt::is_definite() const {
  for (std::size_t k = 0; k < inverse_.size(); k += 4) {
    const double* const pivot = inverse_.data() + k;
    if (!(pivot[0] > 0 && pivot[0] * pivot[3] > pivot[1] * pivot[1])) return false;
  }
  return true;
}

Eigen::VectorXd BlockLdlt::solve(Eigen::VectorXd x) const {
  const int n = rows();
  const auto factor = [&](int p) { return Eigen::Map<const Eigen::Matrix2d>(factor_.data() + 4 * p); };
  for (int k = 0; k < n; ++k)
    for (int p = start_[k]; p < start_[k + 1]; ++p)
      x.segment<2>(2 * rows_[p]) -= factor(p) * Eigen::Vector2d(x.segment<2>(2 * k));
  for (int k = n; k-- > 0;) {
    Eigen::Vector2d own = Eigen::Map<const Eigen::Matrix2d>(inverse_.data() + 4 * k) * Eigen::Vector2d(x.segment<2>(2 * k));
    for (int p = start_[k]; p < start_[k + 1]; ++p) own -= factor(p).transpose() * x.segment<2>(2 * rows_[p]);
    x.segment<2>(2 * k) = own;
  }
  return x;
}

}  // namespace tripatch
