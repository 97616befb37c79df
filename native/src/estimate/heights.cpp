#include "tripatch/estimate/heights.h"

#include <algorithm>

#include "tripatch/math/simd.h"

// As in linear.cpp: compiled for newer machines too, which all make the same bits, and chosen at run time.
#ifdef __GNUC__
#define TRIPATCH_INLINE inline __attribute__((always_inline))
#define TRIPATCH_UNROLL _Pragma("GCC unroll 24")
#else
#define TRIPATCH_INLINE inline
#define TRIPATCH_UNROLL
#endif

namespace tripatch {
namespace {

/// A register of so many numbers, or what the compiler makes of it; anywhere in memory. It is no template's argument and no function's
/// result: compilers forget then where it may lie.
template <int Width>
struct Register {
#ifdef __GNUC__
  typedef double Of __attribute__((vector_size(8 * Width), aligned(8), may_alias));
  TRIPATCH_INLINE static void clear(Of& all) { all = Of{}; }
#else
  using Of = Eigen::Array<double, Width, 1, Eigen::DontAlign>;
  TRIPATCH_INLINE static void clear(Of& all) { all.setZero(); }
#endif
};
#define TRIPATCH_IN(V, place) (*reinterpret_cast<V*>(place))
using Four = Register<4>::Of;
using Eight = Register<8>::Of;

constexpr int highest = fit_degree * 2;
/// Sums of products of two monomials, then from a multiple of four on those of monomials and heights, and some that are nothing.
constexpr int of_heights = (place_of(highest + 1, 0) + 3) / 4 * 4, all_sums = of_heights + 24;
/// Of a point: the powers of x from 1 on, and those of y times the weight and times the weighted height.
constexpr int weighted = highest, weighted_height = weighted + highest + 1, powers = weighted_height + fit_degree + 1;

/// The monomials of (x, y) from degree 1 on; the first stays.
template <int Width>
TRIPATCH_INLINE void set_monomials(const double* x, const double* y, typename Register<Width>::Of (&out)[fit_terms]) {
  using V = typename Register<Width>::Of;
  out[1] = TRIPATCH_IN(const V, x);
  out[2] = TRIPATCH_IN(const V, y);
  TRIPATCH_UNROLL
  for (int d = 2; d <= fit_degree; ++d) {
    TRIPATCH_UNROLL
    for (int j = 0; j < d; ++j) out[place_of(d, j)] = out[place_of(d - 1, j)] * out[1];
    out[place_of(d, d)] = out[place_of(d - 1, d - 1)] * out[2];
  }
}

/// The rows of eight at `sums` added up, `count` of them, a multiple of four.
TRIPATCH_INLINE void add_up(const double* sums, int count, double* out) {
  for (int k = 0; k < count; k += 4, sums += 32) {
#ifdef TRIPATCH_PACKS
    const Four a = TRIPATCH_IN(const Four, sums) + TRIPATCH_IN(const Four, sums + 4),
               b = TRIPATCH_IN(const Four, sums + 8) + TRIPATCH_IN(const Four, sums + 12),
               c = TRIPATCH_IN(const Four, sums + 16) + TRIPATCH_IN(const Four, sums + 20),
               d = TRIPATCH_IN(const Four, sums + 24) + TRIPATCH_IN(const Four, sums + 28);
    const Four ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7),
               cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
    TRIPATCH_IN(Four, out + k) = __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
#else
    for (int row = 0; row < 4; ++row) {
      const double* const a = sums + 8 * row;
      out[k + row] = ((a[0] + a[4]) + (a[1] + a[5])) + ((a[2] + a[6]) + (a[3] + a[7]));
    }
#endif
  }
}

template <int Width>
TRIPATCH_INLINE void lay_over_with(const double* along, const double* across, const double* up, SampleBlock* heights,
                                   Index count) {
  using V = typename Register<Width>::Of;
  for (Index k = 0; k < count; ++k)
    for (int half = 0; half < 8; half += Width) {
      SampleBlock& of = heights[k];
      V &x = TRIPATCH_IN(V, of.x.data() + half), &y = TRIPATCH_IN(V, of.y.data() + half), &z = TRIPATCH_IN(V, of.z.data() + half);
      const V a = x * along[0] + y * along[1] + z * along[2], b = x * across[0] + y * across[1] + z * across[2],
              c = x * up[0] + y * up[1] + z * up[2], square = a * a + b * b + c * c, cube = square * square * square;
      x = a;
      y = b;
      z = c;
      TRIPATCH_IN(V, of.g.data() + half) = cube * cube;
    }
}

/// Sums of x^i times the powers J and K of y, i + J and i + K from 0 to Highest: as many as registers hold.
template <int Width, int First, int Highest, int J, int K>
TRIPATCH_INLINE void sum_two(const typename Register<Width>::Of* p, Index count, double* out) {
  using V = typename Register<Width>::Of;
  constexpr int n = Highest - J + 1, m = K <= Highest ? Highest - K + 1 : 0;
  V a[n + m];
  TRIPATCH_UNROLL
  for (V& sum : a) Register<Width>::clear(sum);
  for (Index k = 0; k < count; ++k, p += powers) {
    const V f = p[First + J];
    a[0] += f;
    TRIPATCH_UNROLL
    for (int i = 1; i < n; ++i) a[i] += p[i - 1] * f;
    if constexpr (m > 0) {
      const V g = p[First + K];
      a[n] += g;
      TRIPATCH_UNROLL
      for (int i = 1; i < m; ++i) a[n + i] += p[i - 1] * g;
    }
  }
  TRIPATCH_UNROLL
  for (int i = 0; i < n; ++i) TRIPATCH_IN(V, out + 8 * place_of(i + J, J)) = a[i];
  TRIPATCH_UNROLL
  for (int i = 0; i < m; ++i) TRIPATCH_IN(V, out + 8 * place_of(i + K, K)) = a[n + i];
}

template <int Width>
TRIPATCH_INLINE void sum_products_with(const SampleBlock* heights, Index count, const HeightVariances& variances, double* weight,
                                       double* room, double* out) {
  using V = typename Register<Width>::Of;
  double sums[8 * all_sums];
  for (int k = place_of(highest + 1, 0); k < of_heights; ++k) std::fill(sums + 8 * k, sums + 8 * k + 8, 0.0);
  for (int k = of_heights + fit_terms; k < all_sums; ++k) std::fill(sums + 8 * k, sums + 8 * k + 8, 0.0);
  for (int half = 0; half < 8; half += Width) {
    V* const all = reinterpret_cast<V*>(room);
    V* p = all;
    for (Index k = 0; k < count; ++k, p += powers) {
      const SampleBlock& of = heights[k];
      const V x = TRIPATCH_IN(const V, of.x.data() + half), y = TRIPATCH_IN(const V, of.y.data() + half),
              z = TRIPATCH_IN(const V, of.z.data() + half);
      const V w = TRIPATCH_IN(const V, of.share.data() + half) /
                  (variances.noise + variances.truncation * TRIPATCH_IN(const V, of.g.data() + half));
      TRIPATCH_IN(V, weight + 8 * k + half) = w;
      p[0] = x;
      p[weighted] = w;
      p[weighted_height] = w * z;
      TRIPATCH_UNROLL
      for (int i = 1; i < highest; ++i) p[i] = p[i - 1] * x;
      TRIPATCH_UNROLL
      for (int i = 0; i < highest; ++i) p[weighted + i + 1] = p[weighted + i] * y;
      TRIPATCH_UNROLL
      for (int i = 0; i < fit_degree; ++i) p[weighted_height + i + 1] = p[weighted_height + i] * y;
    }
    double *const of_pairs = sums + half, *const with_heights = sums + 8 * of_heights + half;
    sum_two<Width, weighted, highest, 0, 11>(all, count, of_pairs);
    sum_two<Width, weighted, highest, 1, 10>(all, count, of_pairs);
    sum_two<Width, weighted, highest, 2, 9>(all, count, of_pairs);
    sum_two<Width, weighted, highest, 3, 8>(all, count, of_pairs);
    sum_two<Width, weighted, highest, 4, 7>(all, count, of_pairs);
    sum_two<Width, weighted, highest, 5, 6>(all, count, of_pairs);
    sum_two<Width, weighted_height, fit_degree, 0, 1>(all, count, with_heights);
    sum_two<Width, weighted_height, fit_degree, 2, 3>(all, count, with_heights);
    sum_two<Width, weighted_height, fit_degree, 4, 5>(all, count, with_heights);
  }
  double sum[all_sums];
  add_up(sums, all_sums, sum);
  double* row = out;
  TRIPATCH_UNROLL
  for (int d = 0; d <= fit_degree; ++d) {
    TRIPATCH_UNROLL
    for (int j = 0; j <= d; ++j, row += 24) {
      TRIPATCH_UNROLL
      for (int e = 0; e <= fit_degree; ++e)  // what is too many is overwritten
        TRIPATCH_IN(Eight, row + place_of(e, 0)) = TRIPATCH_IN(const Eight, sum + place_of(d + e, j));
      row[fit_terms] = sum[of_heights + place_of(d, j)];
      row[fit_terms + 1] = row[fit_terms + 2] = 0;
    }
  }
}

template <int Width>
TRIPATCH_INLINE void sum_residuals_with(const SampleBlock* heights, Index count, const double* weight, const double* c,
                                        double* out) {
  using V = typename Register<Width>::Of;
  double sums[8 * 24];
  for (int k = fit_terms; k < 24; ++k) std::fill(sums + 8 * k, sums + 8 * k + 8, 0.0);
  for (int half = 0; half < 8; half += Width) {
    V a[fit_terms], t[fit_terms];
    TRIPATCH_UNROLL
    for (V& sum : a) Register<Width>::clear(sum);
    for (Index k = 0; k < count; ++k) {
      const SampleBlock& of = heights[k];
      set_monomials<Width>(of.x.data() + half, of.y.data() + half, t);
      V even = c[0] - TRIPATCH_IN(const V, of.z.data() + half), odd = c[1] * t[1];
      TRIPATCH_UNROLL
      for (int i = 2; i < fit_terms; i += 2) even += c[i] * t[i];
      TRIPATCH_UNROLL
      for (int i = 3; i < fit_terms; i += 2) odd += c[i] * t[i];
      const V f = TRIPATCH_IN(const V, weight + 8 * k + half) * (even + odd);
      a[0] += f;
      TRIPATCH_UNROLL
      for (int i = 1; i < fit_terms; ++i) a[i] += t[i] * f;
    }
    TRIPATCH_UNROLL
    for (int i = 0; i < fit_terms; ++i) TRIPATCH_IN(V, sums + 8 * i + half) = a[i];
  }
  add_up(sums, 24, out);
}

/// The squared lengths of r'^-1 y, for as many y as a register holds, all 0 before `From`.
template <int Width, int From>
TRIPATCH_INLINE void square_lengths(const double* r, const double* over, typename Register<Width>::Of (&y)[fit_terms],
                                    typename Register<Width>::Of& squares) {
  Register<Width>::clear(squares);
  TRIPATCH_UNROLL
  for (int i = From; i < fit_terms; ++i) {
    y[i] = y[i] * over[i];
    squares += y[i] * y[i];
    TRIPATCH_UNROLL
    for (int j = i + 1; j < fit_terms; ++j) y[j] -= r[24 * i + j] * y[i];
  }
}

/// Variances of the heights that are fitted to eight points, and what the polynomial is above these.
template <int Width>
TRIPATCH_INLINE void look_at(const SampleBlock& of, const double* c, const double* r, const double* over, double* known,
                             double* residual) {
  using V = typename Register<Width>::Of;
  for (int half = 0; half < 8; half += Width) {
    V t[fit_terms], squares;
    set_monomials<Width>(of.x.data() + half, of.y.data() + half, t);
    Register<Width>::clear(t[0]);
    t[0] = 1 + t[0];
    V even = c[0] - TRIPATCH_IN(const V, of.z.data() + half), odd = c[1] * t[1];
    TRIPATCH_UNROLL
    for (int i = 2; i < fit_terms; i += 2) even += c[i] * t[i];
    TRIPATCH_UNROLL
    for (int i = 3; i < fit_terms; i += 2) odd += c[i] * t[i];
    TRIPATCH_IN(V, residual + half) = even + odd;
    square_lengths<Width, 0>(r, over, t, squares);
    TRIPATCH_IN(V, known + half) = squares;
  }
}

/// Of the coefficients from `First` on.
template <int Width, int First = 0>
TRIPATCH_INLINE void coefficient_variances_with(const double* r, const double* over, double* out) {
  using V = typename Register<Width>::Of;
  double unit[fit_terms][Width] = {};
  for (int k = First; k < std::min(First + Width, fit_terms); ++k) unit[k][k - First] = 1;
  V y[fit_terms], squares;
  TRIPATCH_UNROLL
  for (int k = First; k < fit_terms; ++k) y[k] = TRIPATCH_IN(const V, unit[k]);
  square_lengths<Width, First>(r, over, y, squares);
  TRIPATCH_IN(V, out + First) = squares;
  if constexpr (First + Width < 24) coefficient_variances_with<Width, First + Width>(r, over, out);
}

template <int Width>
TRIPATCH_INLINE void explain_heights_with(const SampleBlock* heights, Index count, const HeightVariances& variances,
                                          const double* weight, const double* c, const double* r, const double* over_diagonal,
                                          ExplainedHeights& out) {
  constexpr int sums = 6;
  double sum[sums][8] = {}, known[8], residual[8];
  for (Index k = 0; k < count; ++k) {
    const SampleBlock& of = heights[k];
    look_at<Width>(of, c, r, over_diagonal, known, residual);
    for (int i = 0; i < 8; ++i) {
      const double truncation = variances.truncation * of.g[i], over = 1 / (variances.noise + truncation);
      const double part = variances.noise * over, rest = truncation * over;
      const double left = std::max(of.share[i] - weight[8 * k + i] * known[i], 0.0);
      const double square = of.share[i] * residual[i] * residual[i];
      sum[0][i] += part * part * square;
      sum[1][i] += rest * variances.truncation * over * square;  // rest^2 / g
      sum[2][i] += left * part;
      sum[3][i] += left * rest;
      sum[4][i] += of.share[i] * part;
      sum[5][i] += of.share[i] * rest;
    }
  }
  double* const all[sums] = {&out.noise,        &out.truncation,       &out.noise_count, &out.truncation_count,
                             &out.noise_points, &out.truncation_points};
  for (int s = 0; s < sums; ++s) {
    const double* const a = sum[s];
    *all[s] = ((a[0] + a[4]) + (a[1] + a[5])) + ((a[2] + a[6]) + (a[3] + a[7]));
  }
}

TRIPATCH_INLINE void solve_upper_with(const double* r, const double* over, double* x) {
  double y[fit_terms];
  TRIPATCH_UNROLL
  for (int i = 0; i < fit_terms; ++i) y[i] = x[i];
  TRIPATCH_UNROLL
  for (int i = fit_terms - 1; i >= 0; --i) {
    x[i] = y[i] *= over[i];
    TRIPATCH_UNROLL
    for (int j = 0; j < i; ++j) y[j] -= r[24 * j + i] * y[i];
  }
}

TRIPATCH_INLINE void solve_upper_transposed_with(const double* r, const double* over, double* x) {
  double y[fit_terms];
  TRIPATCH_UNROLL
  for (int i = 0; i < fit_terms; ++i) y[i] = x[i];
  TRIPATCH_UNROLL
  for (int i = 0; i < fit_terms; ++i) {
    x[i] = y[i] *= over[i];
    TRIPATCH_UNROLL
    for (int j = i + 1; j < fit_terms; ++j) y[j] -= r[24 * i + j] * y[i];
  }
}

TRIPATCH_INLINE void products_of_columns_with(const double* r, const double* over, double* out) {
  Four y[fit_terms], squares;
  for (Four& column : y) Register<4>::clear(column);
  y[1][0] = y[2][1] = y[5][2] = 1;
  Register<4>::clear(squares);
  double both = 0;
  TRIPATCH_UNROLL
  for (int i = 1; i < fit_terms; ++i) {
    y[i] = y[i] * over[i];
    squares += y[i] * y[i];
    both += y[i][0] * y[i][1];
    TRIPATCH_UNROLL
    for (int j = i + 1; j < fit_terms; ++j) y[j] -= r[24 * i + j] * y[i];
  }
  for (int k = 0; k < 3; ++k) out[k] = squares[k];
  out[3] = both;
}

struct Sums {
  void (*lay_over)(const double* along, const double* across, const double* up, SampleBlock* heights, Index count);
  void (*products)(const SampleBlock* heights, Index count, const HeightVariances& variances, double* weight, double* room,
                   double* out);
  void (*residuals)(const SampleBlock* heights, Index count, const double* weight, const double* c, double* out);
  void (*explain)(const SampleBlock* heights, Index count, const HeightVariances& variances, const double* weight,
                  const double* c, const double* r, const double* over, ExplainedHeights& out);
  void (*coefficient_variances)(const double* r, const double* over, double* out);
  void (*solve_upper)(const double* r, const double* over, double* x);
  void (*solve_upper_transposed)(const double* r, const double* over, double* x);
  void (*products_of_columns)(const double* r, const double* over, double* out);
};

#define TRIPATCH_SUMS(name, width, machine)                                                                                      \
  machine void lay_over_##name(const double* along, const double* across, const double* up, SampleBlock* heights, Index count) { \
    lay_over_with<width>(along, across, up, heights, count);                                                                     \
  }                                                                                                                              \
  machine void products_##name(const SampleBlock* heights, Index count, const HeightVariances& variances, double* weight,        \
                               double* room, double* out) {                                                                      \
    sum_products_with<width>(heights, count, variances, weight, room, out);                                                      \
  }                                                                                                                              \
  machine void residuals_##name(const SampleBlock* heights, Index count, const double* weight, const double* c, double* out) {   \
    sum_residuals_with<width>(heights, count, weight, c, out);                                                                   \
  }                                                                                                                              \
  machine void explain_##name(const SampleBlock* heights, Index count, const HeightVariances& variances, const double* weight,   \
                              const double* c, const double* r, const double* over, ExplainedHeights& out) {                     \
    explain_heights_with<width>(heights, count, variances, weight, c, r, over, out);                                             \
  }                                                                                                                              \
  machine void coefficient_variances_##name(const double* r, const double* over, double* out) {                                  \
    coefficient_variances_with<width>(r, over, out);                                                                             \
  }                                                                                                                              \
  machine void solve_upper_##name(const double* r, const double* over, double* x) { solve_upper_with(r, over, x); }              \
  machine void solve_upper_transposed_##name(const double* r, const double* over, double* x) {                                   \
    solve_upper_transposed_with(r, over, x);                                                                                     \
  }                                                                                                                              \
  machine void products_of_columns_##name(const double* r, const double* over, double* out) {                                    \
    products_of_columns_with(r, over, out);                                                                                      \
  }                                                                                                                              \
  constexpr Sums name = {lay_over_##name,                                                                                        \
                         products_##name,                                                                                        \
                         residuals_##name,                                                                                       \
                         explain_##name,                                                                                         \
                         coefficient_variances_##name,                                                                           \
                         solve_upper_##name,                                                                                     \
                         solve_upper_transposed_##name,                                                                          \
                         products_of_columns_##name};

TRIPATCH_SUMS(any_machine_sums, 4, )
#if defined(TRIPATCH_PACKS) && defined(__x86_64__)
TRIPATCH_SUMS(fused_sums, 4, TRIPATCH_FUSED)
#ifdef TRIPATCH_WIDE
TRIPATCH_SUMS(wide_sums, 8, TRIPATCH_WIDE)
#else
constexpr Sums wide_sums = fused_sums;
#endif
const Sums sums = machine() == Machine::wide ? wide_sums : machine() == Machine::fused ? fused_sums : any_machine_sums;
#else
constexpr Sums sums = any_machine_sums;
#endif

}  // namespace

void lay_over(const Vec3& along, const Vec3& across, const Vec3& up, std::vector<SampleBlock>& heights) {
  sums.lay_over(along.data(), across.data(), up.data(), heights.data(), static_cast<Index>(heights.size()));
}

void sum_products(const std::vector<SampleBlock>& heights, const HeightVariances& variances, Workspace& room, SquareOf24& out) {
  const Index count = static_cast<Index>(heights.size());
  room.weight.resize(8 * count);
  room.powers.resize(8 * powers * count);
  sums.products(heights.data(), count, variances, room.weight.data(), room.powers.data(), out.data());
}

void sum_residuals(const std::vector<SampleBlock>& heights, const Workspace& room, const double* coefficients, ByMonomial& out) {
  sums.residuals(heights.data(), static_cast<Index>(heights.size()), room.weight.data(), coefficients, out.data());
}

ExplainedHeights explain_heights(const std::vector<SampleBlock>& heights, const HeightVariances& variances, const Workspace& room,
                                 const double* coefficients, const SquareOf24& r, const Reciprocals& over) {
  ExplainedHeights out;
  sums.explain(heights.data(), static_cast<Index>(heights.size()), variances, room.weight.data(), coefficients, r.data(),
               over.data(), out);
  return out;
}

ByMonomial coefficient_variances(const SquareOf24& r, const Reciprocals& over) {
  ByMonomial out;
  sums.coefficient_variances(r.data(), over.data(), out.data());
  return out;
}

void solve_upper(const SquareOf24& r, const Reciprocals& over, double* x) { sums.solve_upper(r.data(), over.data(), x); }
void solve_upper_transposed(const SquareOf24& r, const Reciprocals& over, double* x) {
  sums.solve_upper_transposed(r.data(), over.data(), x);
}
ColumnProducts products_of_columns(const SquareOf24& r, const Reciprocals& over) {
  ColumnProducts out;
  sums.products_of_columns(r.data(), over.data(), out.data());
  return out;
}

}  // namespace tripatch
