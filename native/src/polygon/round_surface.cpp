#include <algorithm>
#include <cmath>
#include <numbers>

#include "tripatch/math/simd.h"
#include "tripatch/polygon/round.h"
#include "tripatch/polygon/round_problem.h"

namespace tripatch {

Vec2 on_circle(double t) {
  const double angle = 2 * std::numbers::pi * t;
  return {std::cos(angle), std::sin(angle)};
}

namespace {

/// Taylor coefficients of order N at (u, v), as of a Jet. A harmonic polynomial is the real part of one of z = u + i v, whose Taylor
/// coefficients Horner's scheme makes; then follow those of the powers of 1 - u^2 - v^2. P: a number or a pack.
template <int N, class P>
TRIPATCH_ANY_PACK void round_jet(const std::vector<Harmonic>& terms, const P& u, const P& v, P (&out)[jet_size(N)][3]) {
  const P beside_rim = 1.0 - (u * u + v * v);
  for (int axis = 0; axis < 3; ++axis) {
    P sum[jet_size(N)] = {};
    for (std::size_t j = terms.size(); j-- > 0;) {
      const Harmonic& term = terms[j];
      P real[N + 1] = {}, imaginary[N + 1] = {};
      for (Index k = (term.rows() - 1) / 2; k >= 0; --k) {
        for (int d = N; d >= 0; --d) {
          const P turned = real[d] * v + imaginary[d] * u;
          real[d] = real[d] * u - imaginary[d] * v;
          imaginary[d] = turned;
          if (d == 0) continue;
          real[d] += real[d - 1];
          imaginary[d] += imaginary[d - 1];
        }
        real[0] += term(k > 0 ? 2 * k - 1 : 0, axis);
        if (k > 0) imaginary[0] -= term(2 * k, axis);
      }
      for (int d = N; d >= 0; --d) {
        double choose = 1;  // d of b, b = 0, 1, ...
        for (int b = 0; b <= d; choose = choose * (d - b) / (b + 1), ++b) {
          const int a = d - b;
          P& own = sum[jet_index(a, b)];
          own *= beside_rim;
          if (a > 0) own -= 2.0 * u * sum[jet_index(a - 1, b)];
          if (b > 0) own -= 2.0 * v * sum[jet_index(a, b - 1)];
          if (a > 1) own -= sum[jet_index(a - 2, b)];
          if (b > 1) own -= sum[jet_index(a, b - 2)];
          const P turned = b % 2 == 0 ? real[d] : imaginary[d];  // times i^b, its real part
          own += (b % 4 == 1 || b % 4 == 2 ? -choose : choose) * turned;
        }
      }
    }
    for (int d = 0; d < jet_size(N); ++d) out[d][axis] = sum[d];
  }
}

template <int N>
void round_jets(const std::vector<Harmonic>& terms, const double* b, Index n, double* out) {
  double jet[jet_size(N)][3];
  for (Index row = 0; row < n; ++row) {
    round_jet<N, double>(terms, b[3 * row], b[3 * row + 1], jet);
    out = std::copy_n(&jet[0][0], 3 * jet_size(N), out);
  }
}

#ifdef TRIPATCH_PACKS
/// The same bits, of four places at once.
template <int N>
TRIPATCH_PACKED void round_jets_packed(const std::vector<Harmonic>& terms, const double* b, Index n, double* out) {
  constexpr int size = 3 * jet_size(N);
  Pack jet[jet_size(N)][3];
  for (Index row = 0; row < n; row += lanes) {
    Pack u{}, v{};
    for (Index k = 0; k < lanes; ++k) {
      const double* const place = b + 3 * std::min(row + k, n - 1);
      u[k] = place[0], v[k] = place[1];
    }
    round_jet<N, Pack>(terms, u, v, jet);
    for (Index k = 0; k < std::min<Index>(lanes, n - row); ++k)
      for (int d = 0; d < size; ++d) out[size * (row + k) + d] = jet[d / 3][d % 3][k];
  }
}
#endif

}  // namespace

void RoundSurface::evaluate(const double* b, Index n, int order, double* out) const {
  with_order<0, max_order>(order, [&](auto constant) {
#ifdef TRIPATCH_PACKS
    if (has_packs()) return round_jets_packed<constant.value>(terms_, b, n, out);
#endif
    round_jets<constant.value>(terms_, b, n, out);
  });
}

std::vector<Harmonic> round_terms(const Points& coefficients, int degree) {
  std::vector<Harmonic> terms(2);
  for (int j = 0; 2 * j <= degree; ++j) terms.emplace_back(Harmonic::Zero(2 * (degree - 2 * j) + 1, 3));
  for (Harmonic& term : terms)
    if (term.rows() == 0) term.setZero(1, 3);
  Index row = 0;  // in the order of round_basis
  for (int d = 0; d <= degree; ++d)
    for (int k = d; k >= 0; k -= 2) {
      Harmonic& term = terms[2 + (d - k) / 2];
      if (k > 0) term.row(2 * k - 1) = coefficients.row(row++);
      term.row(2 * k) = coefficients.row(row++);
    }
  return terms;
}

void of_revolution(std::vector<Harmonic>& terms, const Eigen::Matrix3d& frame) {
  for (Harmonic& term : terms) {
    const Vec3 axis = frame.col(2), middle = term.row(0);
    term.row(0) = axis.dot(middle) * axis;
    if (term.rows() < 3) continue;
    const Vec3 a = term.row(1), b = term.row(2);
    const double radial = 0.5 * (a.dot(frame.col(0)) + b.dot(frame.col(1))),
                 turning = 0.5 * (a.dot(frame.col(1)) - b.dot(frame.col(0)));
    term.row(1) = radial * frame.col(0) + turning * frame.col(1);
    term.row(2) = radial * frame.col(1) - turning * frame.col(0);
    term.bottomRows(term.rows() - 3).setZero();
  }
}

std::vector<Harmonic> sum_of(std::vector<Harmonic> a, const std::vector<Harmonic>& b) {
  if (a.size() < b.size()) a.resize(b.size(), Harmonic::Zero(1, 3));
  for (std::size_t j = 0; j < b.size(); ++j) {
    if (a[j].rows() < b[j].rows()) {
      const Index own = a[j].rows();
      a[j].conservativeResize(b[j].rows(), 3);
      a[j].bottomRows(b[j].rows() - own).setZero();
    }
    a[j].topRows(b[j].rows()) += b[j];
  }
  return a;
}

}  // namespace tripatch
