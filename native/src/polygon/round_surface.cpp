#include <cmath>
#include <numbers>

#include "tripatch/polygon/round.h"
#include "tripatch/polygon/round_problem.h"

namespace tripatch {

Vec2 on_circle(double t) {
  const double angle = 2 * std::numbers::pi * t;
  return {std::cos(angle), std::sin(angle)};
}

void RoundSurface::evaluate(const double* b, Index n, int order, double* out) const {
  Index waves = 0;
  for (const Harmonic& term : terms_) waves = std::max(waves, (term.rows() - 1) / 2);
  with_order<0, max_order>(order, [&](auto constant) {
    constexpr int N = constant.value;
    std::vector<JetPoint<N>> sums(terms_.size());
    for (Index row = 0; row < n; ++row) {
      const Jet<N> u = Jet<N>::linear(b[3 * row], 1, 0), v = Jet<N>::linear(b[3 * row + 1], 0, 1);
      for (std::size_t j = 0; j < terms_.size(); ++j)
        for (int x = 0; x < 3; ++x) sums[j].x[x] = Jet<N>(terms_[j](0, x));
      Jet<N> re = u, im = v;
      for (Index k = 1; k <= waves; ++k) {
        for (std::size_t j = 0; j < terms_.size(); ++j) {
          if (terms_[j].rows() <= 2 * k) continue;
          for (int x = 0; x < 3; ++x) sums[j].x[x] += terms_[j](2 * k - 1, x) * re + terms_[j](2 * k, x) * im;
        }
        const Jet<N> next = re * u - im * v;
        im = re * v + im * u;
        re = next;
      }
      const Jet<N> w = 1.0 - (u * u + v * v);
      JetPoint<N> p;
      for (std::size_t j = terms_.size(); j-- > 0;)
        for (int x = 0; x < 3; ++x) p.x[x] = w * p.x[x] + sums[j].x[x];
      out = store(p, out);
    }
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
