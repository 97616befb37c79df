#include "tripatch/fairing/curvature_variation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

#include "tripatch/math/simd.h"

namespace tripatch {
namespace {

constexpr double root3 = std::numbers::sqrt3;

/// Derivatives in (x, y) from Taylor coefficients in (b0, b1): db0 = dx - dy / sqrt 3, db1 = 2 dy / sqrt 3.
Eigen::Matrix<double, 9, 9> chart_change() {
  Eigen::Matrix<double, 9, 9> m = Eigen::Matrix<double, 9, 9>::Zero();
  const Jet<3> b0 = Jet<3>::linear(0, 1, -1 / root3), b1 = Jet<3>::linear(0, 0, 2 / root3);
  const std::array<double, 4> factorial = {1, 1, 2, 6};
  for (int d = 1; d <= 3; ++d)
    for (int j = 0; j <= d; ++j) {
      Jet<3> term(1.0);
      for (int k = 0; k < d - j; ++k) term *= b0;
      for (int k = 0; k < j; ++k) term *= b1;
      for (int k = 0; k <= d; ++k)
        m(jet_index(d - k, k) - 1, jet_index(d - j, j) - 1) = term.c[jet_index(d - k, k)] * factorial[d - k] * factorial[k];
    }
  return m;
}

constexpr int second(int i, int j) { return 2 + i + j; }
constexpr int third(int i, int j, int k) { return 5 + i + j + k; }
constexpr int at(int derivative, int x) { return 3 * derivative + x; }
constexpr std::array<double, 4> multiplicity = {1, root3, root3, 1};
constexpr std::array<std::array<int, 3>, 4> component = {{{0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {1, 1, 1}}};

namespace single {

double root(double x) { return std::sqrt(x); }
double with_sign(double length, double of) { return of < 0 ? -length : length; }
#define TRIPATCH_NUMBER double
#define TRIPATCH_FORMULA inline
#include "tripatch/fairing/curvature_formulas.def"
#undef TRIPATCH_NUMBER
#undef TRIPATCH_FORMULA

}  // namespace single

#ifdef TRIPATCH_PACKS
namespace packed {

TRIPATCH_PACKED_INLINE Pack root(const Pack& x) { return square_root(x); }
TRIPATCH_PACKED_INLINE Pack with_sign(const Pack& length, const Pack& of) { return of < 0.0 ? -length : length; }
#define TRIPATCH_NUMBER Pack
#define TRIPATCH_FORMULA TRIPATCH_PACKED_INLINE
#include "tripatch/fairing/curvature_formulas.def"
#undef TRIPATCH_NUMBER
#undef TRIPATCH_FORMULA

/// Of four points.
TRIPATCH_PACKED_INLINE void gather(const Derivatives* d, Pack (&given)[9][3]) {
  const double* const p = d->data();
  constexpr Index size = Derivatives::SizeAtCompileTime;
  for (int k = 0; k < 9; ++k)
    for (int x = 0; x < 3; ++x) {
      const double* const from = p + 3 * k + x;
      given[k][x] = Pack{from[0], from[size], from[2 * size], from[3 * size]};
    }
}

TRIPATCH_PACKED void variations(const Derivatives* d, double flat, CurvatureVariation* out) {
  Pack given[9][3];
  gather(d, given);
  const Variation v(given, flat);
  for (int lane = 0; lane < lanes; ++lane) {
    out[lane].area = v.area[lane];
    for (int m = 0; m < 4; ++m) {
      out[lane].variation[m] = v.variation[m][lane];
      out[lane].quadric[m] = v.quadric[m][lane];
    }
  }
}

TRIPATCH_PACKED void variation_rows(const Derivatives* d, double flat, CurvatureVariationRows* out) {
  Pack given[9][3];
  gather(d, given);
  const VariationRows rows(given, flat);
  for (int lane = 0; lane < lanes; ++lane)
    for (int m = 0; m < 8; ++m) {
      out[lane].value[m] = rows.value[m][lane];
      for (int k = 0; k < 27; ++k) out[lane].derivative(m, k) = rows.derivative[m][k][lane];
    }
}

}  // namespace packed
#endif

using Given = const double (&)[9][3];
Given given_of(const Derivatives& d) { return *reinterpret_cast<const double (*)[9][3]>(d.data()); }

}  // namespace

std::vector<Derivatives> cartesian_derivatives(const Surface& surface, const Points& b) {
  static const Eigen::Matrix<double, 9, 9> change = chart_change();
  Eigen::Matrix<double, Eigen::Dynamic, 30, Eigen::RowMajor> jets(b.rows(), 30);
  surface.evaluate(b.data(), b.rows(), 3, jets.data());
  std::vector<Derivatives> out(b.rows());
  for (Index k = 0; k < b.rows(); ++k) out[k].noalias() = change * Eigen::Map<const Derivatives>(jets.row(k).data() + 3);
  return out;
}

CurvatureVariation curvature_variation(const Derivatives& d, double flat) {
  const single::Variation v(given_of(d), flat);
  return {v.area, Eigen::Vector4d(v.variation), Eigen::Vector4d(v.quadric)};
}

CurvatureVariationRows curvature_variation_rows(const Derivatives& d, double flat) {
  const single::VariationRows rows(given_of(d), flat);
  CurvatureVariationRows out;
  std::copy_n(rows.value, 8, out.value.data());
  std::copy_n(rows.derivative[0], 8 * 27, out.derivative.data());
  return out;
}

void curvature_variations(std::span<const Derivatives> d, double flat, CurvatureVariation* out) {
  std::size_t k = 0;
#ifdef TRIPATCH_PACKS
  for (; has_packs() && k + lanes <= d.size(); k += lanes) packed::variations(&d[k], flat, out + k);
#endif
  for (; k < d.size(); ++k) out[k] = curvature_variation(d[k], flat);
}

void curvature_variation_rows(std::span<const Derivatives> d, double flat, CurvatureVariationRows* out) {
  std::size_t k = 0;
#ifdef TRIPATCH_PACKS
  for (; has_packs() && k + lanes <= d.size(); k += lanes) packed::variation_rows(&d[k], flat, out + k);
#endif
  for (; k < d.size(); ++k) out[k] = curvature_variation_rows(d[k], flat);
}

}  // namespace tripatch
