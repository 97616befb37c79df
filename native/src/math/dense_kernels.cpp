#include "tripatch/math/dense_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tripatch/math/simd.h"

// Eigen's products take what the compiler may assume of every machine. These are compiled for newer ones too, and chosen at run time;
// newer machines all make the same bits, for each sum is made in the same order.
#ifdef TRIPATCH_PACKS
#define TRIPATCH_INLINE inline __attribute__((always_inline))
#else
#define TRIPATCH_INLINE inline
#endif

namespace tripatch {
namespace {

/// Columns of a row, of a block of them, and of a product at least; rows of a Cholesky factor made at a time stay in the first cache.
constexpr Index width = 24, block = 8, panel = 16;

/// Products as the compiler finds them.
struct AnyRegisters {
  using OfFour = AnyRegisters;                                               ///< for products of four columns
  static constexpr Index rows = four, columns = block, max_columns = block;  // of a product: what the registers hold

  /// sum = a b, where a is `rows` by k and b is k by `columns`.
  template <Index Rows, Index Columns>
  TRIPATCH_INLINE static void product(const double* a, Index a_row, Index a_column, Index k, const double* b, Index b_row,
                                      double (&sum)[Rows][Columns]) {
    for (Index p = 0; p < Rows; ++p)
      for (Index q = 0; q < Columns; ++q) sum[p][q] = 0;
    for (Index l = 0; l < k; ++l)
      for (Index p = 0; p < Rows; ++p)
        for (Index q = 0; q < Columns; ++q) sum[p][q] += a[p * a_row + l * a_column] * b[l * b_row + q];
  }

  /// sum = a x for rows of n that begin `stride` after each other.
  template <Index Rows>
  TRIPATCH_INLINE static void dots(const double* a, Index stride, Index n, const double* x, double (&sum)[Rows]) {
    for (Index p = 0; p < Rows; ++p) {
      double part[4] = {};
      const double* const row = a + p * stride;
      Index q = 0;
      for (; q + 4 <= n; q += 4)
        for (Index w = 0; w < 4; ++w) part[w] += row[q + w] * x[q + w];
      sum[p] = (part[0] + part[2]) + (part[1] + part[3]);
      for (; q < n; ++q) sum[p] += row[q] * x[q];
    }
  }

  /// to -= factor from.
  template <Index Columns>
  TRIPATCH_INLINE static void take(double factor, const double* from, double* __restrict to) {
    for (Index q = 0; q < Columns; ++q) to[q] -= factor * from[q];
  }

  /// Takes from each of `count` rows of 24 `across` times its entry at `column`, which becomes 0. products: of the next column as it
  /// then is with all columns. Only the last `Columns` columns are looked at; a and across begin with them.
  template <Index Columns>
  TRIPATCH_INLINE static void reflect_rows(double* a, Index count, Index column, const double* across, double* products) {
    double sum[Columns] = {};
    for (Index r = 0; r < count; ++r, a += 24) {
      const double entry = a[column];
      for (Index q = 0; q < Columns; ++q) a[q] -= entry * across[q];
      a[column] = 0;
      for (Index q = 0; q < Columns; ++q) sum[q] += a[column + 1] * a[q];
    }
    for (Index q = 0; q < Columns; ++q) products[q] = sum[q];
  }
};

/// Adds `sign` times a' a to c from row `begin` on: the upper triangle of it or the lower, and some elements beyond.
template <class Registers, bool Upper>
TRIPATCH_INLINE void add_gram_with(const double* a, Index m, Index n, Index begin, double sign, double* __restrict c) {
  constexpr Index rows = Registers::rows, columns = Registers::columns;
  if (n < columns) {
    for (Index k = 0; k < m; ++k)
      for (Index p = begin; p < n; ++p)
        for (Index q = 0; q < n; ++q) c[p * n + q] += sign * a[k * n + p] * a[k * n + q];
    return;
  }
  for (Index below = begin; below < n; below += rows)
    for (Index right = Upper ? below : 0; right < (Upper ? n : std::min(n, below + rows)); right += columns) {
      const Index i = std::min(below, n - rows), j = std::min(right, n - columns);  // the last overlap those before
      double sum[rows][columns];
      Registers::product(a + i, 1, n, m, a + j, n, sum);
      for (Index p = below - i; p < rows; ++p)
        for (Index q = right - j; q < columns; ++q) c[(i + p) * n + j + q] += sign * sum[p][q];
    }
}

template <class Registers, Index Columns>
TRIPATCH_INLINE void multiply_four_with(const double* a, Index k, const double* b, Index n, double* __restrict out,
                                        Index stride) {
  for (Index next = 0; next < n; next += Columns) {
    const Index j = std::min(next, n - Columns);  // the last makes some columns again
    double sum[4][Columns];
    Registers::product(a, k, 1, k, b + j, n, sum);
    for (Index p = 0; p < 4; ++p)
      for (Index q = 0; q < Columns; ++q) out[p * stride + j + q] = sum[p][q];
  }
}

/// b: k rows of four, the last of each nothing.
template <class Registers>
TRIPATCH_INLINE void add_product_of_fours_with(const double* a, Index m, Index k, const double* b, double* __restrict out) {
  constexpr Index rows = block;
  Index i = 0;
  double sum[rows][4], one[1][4];
  for (; i + rows <= m; i += rows) {
    Registers::OfFour::product(a + i * k, k, 1, k, b, 4, sum);
    for (Index p = 0; p < rows; ++p)
      for (Index x = 0; x < 3; ++x) out[3 * (i + p) + x] += sum[p][x];
  }
  for (; i < m; ++i) {
    Registers::OfFour::product(a + i * k, k, 1, k, b, 4, one);
    for (Index x = 0; x < 3; ++x) out[3 * i + x] += one[0][x];
  }
}

template <class Registers>
TRIPATCH_INLINE void add_dots_with(const double* a, Index m, Index n, const double* x, double* __restrict out) {
  constexpr Index rows = four;
  Index i = 0;
  double sum[rows], one[1];
  for (; i + rows <= m; i += rows) {
    Registers::dots(a + i * n, n, n, x, sum);
    for (Index p = 0; p < rows; ++p) out[i + p] += sum[p];
  }
  for (; i < m; ++i) {
    Registers::dots(a + i * n, n, n, x, one);
    out[i] += one[0];
  }
}

/// Takes `pivot` times its own entries over the diagonal element from the rows begin to end - 1 of 24 columns each, of which only the last
/// `Columns` are looked at.
template <class Registers, Index Columns>
TRIPATCH_INLINE void eliminate_rows(const double* pivot, double over, Index begin, Index end, double* a) {
  constexpr Index from = width - Columns;
  for (Index i = begin; i < end; ++i) Registers::template take<Columns>(pivot[i] * over, pivot + from, a + i * width + from);
}

/// Row by row from what those below still have: as soon as one is done the next one is begun.
template <class Registers>
TRIPATCH_INLINE bool factor_symmetric_with(double* a, Index n, double least) {
  double enough[width];
  for (Index i = 0; i < n; ++i) enough[i] = least * a[i * width + i];
  for (Index k = 0; k < n; ++k) {
    double* const row = a + k * width;
    const double left = row[k], over = 1 / left;
    if (!(left > enough[k])) return false;
    eliminate_rows<Registers, 24>(row, over, k + 1, std::min(n, block), a);
    eliminate_rows<Registers, 16>(row, over, std::max(k + 1, block), std::min(n, 2 * block), a);
    eliminate_rows<Registers, 8>(row, over, std::max(k + 1, 2 * block), n, a);
    const double root = 1 / std::sqrt(left);
    for (Index c = k / block * block; c < width; ++c) row[c] *= root;
  }
  return true;
}

/// m rows of 24: for each of the first n columns, fewer than 24, Householder's reflection that leaves of it what is above and its
/// diagonal element. The rows are passed once a column: what reflects one makes the products that the next one asks for.
template <class Registers>
TRIPATCH_INLINE void reflect_columns_with(double* a, Index m, Index n) {
  double products[width], across[width];  // of the column with all from `begin` on
  for (Index c = 0; c < width; c += block)
    Registers::product(a, 0, width, m, a + c, width, reinterpret_cast<double (&)[1][block]>(products[c]));
  for (Index k = 0; k < n; ++k) {
    const Index begin = k / block * block, left = m - k - 1;
    double* const first = a + k * width;
    const double length = std::sqrt(products[k]), end = first[k] > 0 ? -length : length;
    const double head = first[k] - end, over = 1 / (length * std::abs(head));
    for (Index c = begin; c < width; ++c) across[c] = (products[c] - end * first[c]) * over;
    double *const below = first + width + begin, *const from = across + begin, *const to = products + begin;
    switch (width - begin) {
      case 24: Registers::template reflect_rows<24>(below, left, k - begin, from, to); break;
      case 16: Registers::template reflect_rows<16>(below, left, k - begin, from, to); break;
      default: Registers::template reflect_rows<8>(below, left, k - begin, from, to); break;
    }
    for (Index c = begin; c < width; ++c) first[c] -= head * across[c];
  }
}

/// Rows [from, to) of an upper triangular factor, in place; false where the matrix is not positive definite.
TRIPATCH_INLINE bool factor_panel_rows(double* __restrict a, Index n, Index from, Index to) {
  for (Index k = from; k < to; ++k) {
    double* const row = a + k * n;
    if (!(row[k] > 0)) return false;
    row[k] = std::sqrt(row[k]);
    const double over = 1 / row[k];
    for (Index j = k + 1; j < n; ++j) row[j] *= over;
    for (Index i = k + 1; i < to; ++i)
      for (Index j = i; j < n; ++j) a[i * n + j] -= row[i] * row[j];
  }
  return true;
}

/// Householder's reflections one after the other (Golub and Van Loan, "Matrix computations", 8.3.1), in one pass over the matrix each: what
/// a reflection takes away is taken away where the next one's product is made. v, w, x, p: vectors of n; a row of b is n long.
struct Reflecting {
  double* __restrict a;
  Index n;
  double* __restrict v;  // the matrix lacks v w' + w v'
  double* __restrict w;
  double* __restrict x;  // the next v
  double* __restrict p;  // the matrix times it
};

/// What is lacking of so many columns from j on, below the diagonal, is taken away, and their share of p made.
template <Index Columns>
TRIPATCH_INLINE void reflect_some_columns(const Reflecting& r, Index j) {
  const Index n = r.n;
  double* const __restrict a = r.a + j * n;
  const double* const __restrict v = r.v;
  const double* const __restrict w = r.w;
  const double* const __restrict x = r.x;
  double* const __restrict p = r.p;
  double vj[Columns], wj[Columns], xj[Columns], own[Columns] = {};
  for (Index c = 0; c < Columns; ++c) vj[c] = v[j + c], wj[c] = w[j + c], xj[c] = x[j + c];
  const auto reflect_row = [&](Index i, Index columns) {
    for (Index c = 0; c < columns; ++c) {
      const double left = a[c * n + i] -= v[i] * wj[c] + w[i] * vj[c];
      p[i] += left * xj[c];
      own[c] += left * x[i];
    }
  };
  for (Index c = 0; c < Columns; ++c) {
    reflect_row(j + c, c);
    own[c] += (a[c * n + j + c] -= 2 * vj[c] * wj[c]) * xj[c];
  }
  Index i = j + Columns;
#ifdef __GNUC__
  typedef double Four __attribute__((vector_size(8 * four), aligned(8), may_alias));
  Four sum[Columns] = {};
  for (; i + four <= n; i += four) {  // no function returns a Four: clang 14 takes its reference for aligned to 32 bytes
    const Four vi = *reinterpret_cast<const Four*>(v + i), wi = *reinterpret_cast<const Four*>(w + i),
               xi = *reinterpret_cast<const Four*>(x + i);
    Four pi = *reinterpret_cast<const Four*>(p + i);
#pragma GCC unroll 2
    for (Index c = 0; c < Columns; ++c) {
      Four& column = *reinterpret_cast<Four*>(a + c * n + i);
      const Four left = column - vi * wj[c] - wi * vj[c];
      column = left;
      pi += left * xj[c];
      sum[c] += left * xi;
    }
    *reinterpret_cast<Four*>(p + i) = pi;
  }
  for (Index c = 0; c < Columns; ++c) own[c] += (sum[c][0] + sum[c][2]) + (sum[c][1] + sum[c][3]);
  for (Index rest = 0; rest < four - 1 && i < n; ++rest, ++i) reflect_row(i, Columns);
#else
  for (; i < n; ++i) reflect_row(i, Columns);
#endif
  for (Index c = 0; c < Columns; ++c) p[j + c] += own[c];
}

/// The same of all from `first` on: two at a time read v, w, x and p once.
TRIPATCH_INLINE void reflect_columns_from(const Reflecting& r, Index first) {
  for (; first + 2 <= r.n; first += 2) reflect_some_columns<2>(r, first);
  if (first < r.n) reflect_some_columns<1>(r, first);
}

/// The products of one kind of machine.
struct Products {
  void (*reflect_columns)(double* a, Index m, Index n);
  void (*add_gram)(const double* a, Index m, Index n, double* c);
  void (*subtract_gram)(const double* u, Index count, Index n, Index begin, double* c);
  void (*multiply_four)(const double* a, Index k, const double* b, Index n, double* out, Index stride);  ///< n: eight or more
  void (*add_product_of_fours)(const double* a, Index m, Index k, const double* b, double* out);
  void (*add_dots)(const double* a, Index m, Index n, const double* x, double* out);
  bool (*factor_symmetric)(double* a, Index n, double least);
  bool (*factor_panel)(double* a, Index n, Index from, Index to);
  void (*reflect_from)(const Reflecting& r, Index first);
};

#define TRIPATCH_PRODUCTS(name, Registers, machine)                                                                         \
  machine void add_gram_##name(const double* a, Index m, Index n, double* c) {                                              \
    add_gram_with<Registers, false>(a, m, n, 0, 1, c);                                                                      \
  }                                                                                                                         \
  machine void reflect_columns_##name(double* a, Index m, Index n) { reflect_columns_with<Registers>(a, m, n); }            \
  machine void subtract_gram_##name(const double* u, Index count, Index n, Index begin, double* c) {                        \
    add_gram_with<Registers, true>(u, count, n, begin, -1, c);                                                              \
  }                                                                                                                         \
  machine void multiply_four_##name(const double* a, Index k, const double* b, Index n, double* out, Index stride) {        \
    if (n >= Registers::max_columns) return multiply_four_with<Registers, Registers::max_columns>(a, k, b, n, out, stride); \
    multiply_four_with<Registers, 8>(a, k, b, n, out, stride);                                                              \
  }                                                                                                                         \
  machine void add_product_of_fours_##name(const double* a, Index m, Index k, const double* b, double* out) {               \
    add_product_of_fours_with<Registers>(a, m, k, b, out);                                                                  \
  }                                                                                                                         \
  machine void add_dots_##name(const double* a, Index m, Index n, const double* x, double* out) {                           \
    add_dots_with<Registers>(a, m, n, x, out);                                                                              \
  }                                                                                                                         \
  machine bool factor_symmetric_##name(double* a, Index n, double least) {                                                  \
    return factor_symmetric_with<Registers>(a, n, least);                                                                   \
  }                                                                                                                         \
  machine bool factor_panel_##name(double* a, Index n, Index from, Index to) { return factor_panel_rows(a, n, from, to); }  \
  machine void reflect_from_##name(const Reflecting& r, Index first) { reflect_columns_from(r, first); }                    \
  constexpr Products name = {reflect_columns_##name,      add_gram_##name, subtract_gram_##name,    multiply_four_##name,   \
                             add_product_of_fours_##name, add_dots_##name, factor_symmetric_##name, factor_panel_##name,    \
                             reflect_from_##name};

TRIPATCH_PRODUCTS(any_machine, AnyRegisters, )

#ifdef __GNUC__
/// Registers of `width` doubles, which the compiler does not find by itself everywhere.
template <Index Width, Index ProductRows, Index ProductColumns>
struct VectorRegisters {
  static constexpr Index rows = ProductRows, columns = block, max_columns = ProductColumns;
  using OfFour = VectorRegisters<4, 4, 8>;
  typedef double Vector __attribute__((vector_size(8 * Width), aligned(8), may_alias));

  template <Index Rows, Index Columns>
  TRIPATCH_INLINE static void product(const double* a, Index a_row, Index a_column, Index k, const double* b, Index b_row,
                                      double (&sum)[Rows][Columns]) {
    Vector part[Rows][Columns / Width] = {};
    for (Index l = 0; l < k; ++l, a += a_column, b += b_row)
#pragma GCC unroll 8
      for (Index p = 0; p < Rows; ++p)
#pragma GCC unroll 2
        for (Index w = 0; w < Columns / Width; ++w) part[p][w] += a[p * a_row] * *reinterpret_cast<const Vector*>(b + Width * w);
    for (Index p = 0; p < Rows; ++p)
      for (Index w = 0; w < Columns / Width; ++w) *reinterpret_cast<Vector*>(&sum[p][Width * w]) = part[p][w];
  }

  template <Index Rows>
  TRIPATCH_INLINE static void dots(const double* a, Index stride, Index n, const double* x, double (&sum)[Rows]) {
    typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));
    Four part[Rows] = {};
    Index q = 0;
    for (; q + 4 <= n; q += 4)
#pragma GCC unroll 4
      for (Index p = 0; p < Rows; ++p)
        part[p] += *reinterpret_cast<const Four*>(a + p * stride + q) * *reinterpret_cast<const Four*>(x + q);
    for (Index p = 0; p < Rows; ++p) {
      sum[p] = (part[p][0] + part[p][2]) + (part[p][1] + part[p][3]);
      for (Index r = q; r < n; ++r) sum[p] += a[p * stride + r] * x[r];
    }
  }

  template <Index Columns>
  TRIPATCH_INLINE static void take(double factor, const double* from, double* __restrict to) {
#pragma GCC unroll 6
    for (Index q = 0; q < Columns; q += Width)
      *reinterpret_cast<Vector*>(to + q) -= factor * *reinterpret_cast<const Vector*>(from + q);
  }

  template <Index Columns>
  TRIPATCH_INLINE static void reflect_rows(double* a, Index count, Index column, const double* across, double* products) {
    constexpr Index vectors = Columns / Width;
    Vector sum[vectors] = {}, taken[vectors];
    for (Index w = 0; w < vectors; ++w) taken[w] = *reinterpret_cast<const Vector*>(across + Width * w);
    const double taken_next = across[column + 1];
    for (Index r = 0; r < count; ++r, a += 24) {
      const double entry = a[column], next = a[column + 1] - entry * taken_next;
#pragma GCC unroll 6
      for (Index w = 0; w < vectors; ++w) {
        Vector& row = *reinterpret_cast<Vector*>(a + Width * w);
        row -= entry * taken[w];
        sum[w] += next * row;
      }
      a[column] = 0;
    }
    for (Index w = 0; w < vectors; ++w) *reinterpret_cast<Vector*>(products + Width * w) = sum[w];
  }
};
#endif

#if defined(TRIPATCH_PACKS) && defined(__x86_64__)
using FourWide = VectorRegisters<4, 4, 8>;
TRIPATCH_PRODUCTS(fused_products, FourWide, TRIPATCH_FUSED)
#ifdef TRIPATCH_WIDE
using EightWide = VectorRegisters<8, 8, 16>;
TRIPATCH_PRODUCTS(wide_products, EightWide, TRIPATCH_WIDE)
#else
constexpr Products wide_products = fused_products;
#endif
const Products products = machine() == Machine::wide ? wide_products : machine() == Machine::fused ? fused_products : any_machine;
#else
constexpr Products products = any_machine;
#endif

}  // namespace

/// By columns: Eigen's takes twice the time, for it is compiled for every machine.
bool factor_cholesky(Eigen::MatrixXd& a) {
  const Index n = a.rows();  // columns of the lower factor are rows of the upper one
  for (Index from = 0; from < n; from += panel) {
    const Index to = std::min(n, from + panel);
    if (!products.factor_panel(a.data(), n, from, to)) return false;
    // what these rows of the factor take away from those below
    products.subtract_gram(a.data() + from * n, to - from, n, to, a.data());
  }
  return true;
}

Tridiagonal tridiagonalize(Eigen::MatrixXd& a, Eigen::MatrixXd& b) {
  const Index n = a.rows();
  Tridiagonal out{Eigen::VectorXd(n), Eigen::VectorXd(n - 1)};
  Eigen::VectorXd v = Eigen::VectorXd::Zero(n), w = v, x(n), p(n);
  for (Index k = 0; k + 1 < n; ++k) {
    const Index left = n - k - 1;
    auto column = a.col(k).tail(left + 1);
    column -= v.tail(left + 1) * w[k] + w.tail(left + 1) * v[k];
    out.diagonal[k] = column[0];
    const double head = column[1], beyond = column.tail(left - 1).squaredNorm();
    double share = 0;
    out.beside[k] = head;
    x[k + 1] = 1;
    if (beyond > std::numeric_limits<double>::min()) {
      const double end = head > 0 ? -std::sqrt(head * head + beyond) : std::sqrt(head * head + beyond);
      out.beside[k] = end;
      x.tail(left - 1) = column.tail(left - 1) / (head - end);
      share = (end - head) / end;
    } else {
      x.tail(left - 1).setZero();
    }
    p.tail(left).setZero();
    products.reflect_from({a.data(), n, v.data(), w.data(), x.data(), p.data()}, k + 1);
    p.tail(left) *= share;
    p.tail(left) -= share / 2 * p.tail(left).dot(x.tail(left)) * x.tail(left);
    for (Index c = 0; c < b.cols(); ++c) b.col(c).tail(left) -= share * x.tail(left).dot(b.col(c).tail(left)) * x.tail(left);
    v.swap(x);
    w.swap(p);
  }
  out.diagonal[n - 1] = a(n - 1, n - 1) - 2 * v[n - 1] * w[n - 1];
  return out;
}

void add_product(const double* a, Index m, Index k, const double* b, double* out) {
  std::vector<double> fours(4 * k);
  for (Index j = 0; j < k; ++j)
    for (Index x = 0; x < 3; ++x) fours[4 * j + x] = b[x * k + j];
  products.add_product_of_fours(a, m, k, fours.data(), out);
}

void add_product(const RowsOf24& a, const double* x, double* out) { products.add_dots(a.data(), a.rows(), 24, x, out); }

void add_product(const RowMajor& a, const VectorRef& x, double* out) {
  products.add_dots(a.data(), a.rows(), a.cols(), x.data(), out);
}

Eigen::VectorXd symmetric_product(const Eigen::MatrixXd& a, const VectorRef& x) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(a.cols());
  products.add_dots(a.data(), a.cols(), a.rows(), x.data(), out.data());
  return out;
}

Eigen::MatrixXd symmetric_of_lower(const RowMajor& a, Index n) {
  Eigen::MatrixXd out(n, n);  // block by block, of which both copies stay in the cache
  for (Index from = 0; from < n; from += block)
    for (Index left = 0; left <= from; left += block)
      for (Index i = from; i < std::min(from + block, n); ++i)
        for (Index j = left; j < std::min(left + block, i + 1); ++j) out(i, j) = out(j, i) = a(i, j);
  return out;
}

void multiply_four(const double* a, Index k, const double* b, Index n, double* out, Index stride) {
  if (n >= 8) return products.multiply_four(a, k, b, n, out, stride);
  for (Index p = 0; p < 4; ++p)
    for (Index q = 0; q < n; ++q) {
      double sum = 0;
      for (Index l = 0; l < k; ++l) sum += a[p * k + l] * b[l * n + q];
      out[p * stride + q] = sum;
    }
}

void add_gram(const RowMajor& a, RowMajor& c) { products.add_gram(a.data(), a.rows(), a.cols(), c.data()); }

void triangularize(RowsOf24& a, Index n) { products.reflect_columns(a.data(), a.rows(), n); }

bool factor_symmetric(SquareOf24& a, Index n, double least) { return products.factor_symmetric(a.data(), n, least); }

/// Four rows at a time: what those before take away is a product for which the machine's registers are used, as Eigen's is not.
void solve_lower_triangular(const Eigen::MatrixXd& a, RowMajor& b) {
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
