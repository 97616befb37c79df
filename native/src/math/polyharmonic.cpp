#include "tripatch/math/polyharmonic.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/math/interruption.h"
#include "tripatch/math/simd.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {
namespace {

constexpr double min_square = std::numeric_limits<double>::min();

/// Of u^i v^j among monomials up to a degree.
int monomial_row(int degree, int i, int j) { return i * (degree + 1) - i * (i - 1) / 2 + j; }

/// Coordinates of so many places from one on; beyond the last it again.
template <int Lanes>
std::array<Eigen::Array<double, Lanes, 1>, 2> lanes_of(const PlanePoints& at, Index first) {
  std::array<Eigen::Array<double, Lanes, 1>, 2> out;
  for (Index k = 0; k < Lanes; ++k)
    for (int axis = 0; axis < 2; ++axis) out[axis][k] = at(std::min(first + k, at.rows() - 1), axis);
  return out;
}

}  // namespace

int polyharmonic_exponent(double order) { return static_cast<int>(std::lround(2 * order - 2)); }
double polyharmonic_factor(int e) {
  const int turns = e % 2 == 0 ? e / 2 + 1 : (e + 1) / 2;
  return (e % 2 == 0 ? 0.5 : 1) * (turns % 2 == 0 ? 1 : -1);
}
int free_degree_of(double order) { return static_cast<int>(std::floor(order - 1 + tolerance::solved)); }
int free_polynomials(double order) { return (free_degree_of(order) + 1) * (free_degree_of(order) + 2) / 2; }

PlaneDistances::PlaneDistances(const PlanePoints& points, const PlanePoints& others)
    : itself(points.rows(), others.rows()), squared(points.rows(), others.rows()) {
  for (Index j = 0; j < others.rows(); ++j)
    squared.col(j) = (points.col(0).array() - others(j, 0)).square() + (points.col(1).array() - others(j, 1)).square();
  itself = squared.cwiseSqrt();
}

Eigen::MatrixXd polyharmonic_kernel(double order, const PlaneDistances& apart) {
  const int e = polyharmonic_exponent(order);
  Eigen::MatrixXd kernel(apart.squared.rows(), apart.squared.cols());
  const auto& s = apart.squared.array();
  const auto root = polyharmonic_factor(e) * apart.itself.array();
  switch (e) {  // the common ones in one pass
    case 3: kernel.array() = root * s; return kernel;
    case 5: kernel.array() = root * s * s; return kernel;
    case 9: kernel.array() = root * s * s * s * s; return kernel;
    default: break;
  }
  if (e % 2 == 1)
    kernel = root.matrix();
  else
    kernel = (polyharmonic_factor(e) * s.max(min_square).log()).matrix();
  for (int k = 0; k < e / 2; ++k) kernel.array() *= s;
  return kernel;
}

void PolyharmonicSum::add(double order, double share, const Eigen::MatrixXd& weights, const Eigen::MatrixXd& polynomial) {
  const int e = polyharmonic_exponent(order), d = free_degree_of(order);
  std::vector<Term>& terms = e % 2 == 1 ? odd_ : even_;
  terms.push_back({e, 0, share * polyharmonic_factor(e) * weights});
  std::sort(terms.begin(), terms.end(), [](const Term& a, const Term& b) { return a.exponent < b.exponent; });
  for (int power = 0; Term& term : terms) {
    term.step = term.exponent / 2 - power;
    power += term.step;
  }
  if (d > degree_) {
    Points larger = Points::Zero((d + 1) * (d + 2) / 2, 3);
    for (int i = 0; i <= degree_; ++i)
      for (int j = 0; i + j <= degree_; ++j) larger.row(monomial_row(d, i, j)) = polynomial_.row(monomial_row(degree_, i, j));
    polynomial_ = std::move(larger);
    degree_ = d;
  }
  for (int i = 0; i <= d; ++i)
    for (int j = 0; i + j <= d; ++j)
      polynomial_.row(monomial_row(degree_, i, j)) += share * polynomial.row(monomial_row(d, i, j));
}

#ifdef TRIPATCH_PACKS
/// The same of eight places where all exponents are odd, with registers of four.
TRIPATCH_PACKED void PolyharmonicSum::add_odd_terms(const Lane<8>& x, const Lane<8>& y, std::array<Lane<8>, 3>& sum) const {
  Pack own[2][2], total[3][2];
  for (int half = 0; half < 2; ++half) {
    own[0][half] = loaded(x.data() + lanes * half);
    own[1][half] = loaded(y.data() + lanes * half);
    for (int axis = 0; axis < 3; ++axis) total[axis][half] = loaded(sum[axis].data() + lanes * half);
  }
  const double* center = centers_.data();
  for (Index i = 0; i < centers_.rows(); ++i, center += 2) {
    Pack square[2], kernel[2];
    for (int half = 0; half < 2; ++half) {
      const Pack dx = own[0][half] - all_lanes(center[0]), dy = own[1][half] - all_lanes(center[1]);
      square[half] = dx * dx + dy * dy;
      kernel[half] = square_root(square[half]);
    }
    for (const Term& term : odd_) {
      for (int k = 0; k < term.step; ++k)
        for (int half = 0; half < 2; ++half) kernel[half] *= square[half];
      const double* const w = term.weights.data() + 3 * i;
      for (int axis = 0; axis < 3; ++axis)
        for (int half = 0; half < 2; ++half) total[axis][half] += all_lanes(w[axis]) * kernel[half];
    }
  }
  for (int axis = 0; axis < 3; ++axis)
    for (int half = 0; half < 2; ++half) store(total[axis][half], sum[axis].data() + lanes * half);
}
#endif

#ifdef TRIPATCH_PACKS
/// The derivatives of the same, of four places.
template <int Order>
TRIPATCH_PACKED void PolyharmonicSum::add_odd_derivatives(const Lane<lanes>& x, const Lane<lanes>& y,
                                                          Jets<Lane<lanes>, Order>& sum) const {
  constexpr int count = (Order + 1) * (Order + 2) / 2;
  const Pack own_x = loaded(x.data()), own_y = loaded(y.data()), nearest = all_lanes(tolerance::same * tolerance::same);
  Pack total[count][3];
  for (int d = 0; d < count; ++d)
    for (int axis = 0; axis < 3; ++axis) total[d][axis] = loaded(sum[d][axis].data());
  const double* center = centers_.data();
  for (Index i = 0; i < centers_.rows(); ++i, center += 2) {
    const Pack dx = own_x - all_lanes(center[0]), dy = own_y - all_lanes(center[1]), square = dx * dx + dy * dy;
    const auto beside = square < nearest;
    const Pack apart = beside ? nearest : square, root = square_root(apart);
    const Pack a = beside ? all_lanes(tolerance::same) : dx, b = beside ? all_lanes(0) : dy;
    Pack lower = root;
    int power = 1;
    for (const Term& term : odd_) {
      const int e = term.exponent;
      for (; power < e / 2; ++power) lower *= apart;
      Pack jet[count];
      Pack slope = all_lanes(e) * lower;
      jet[0] = lower * square;
      if (e == 1) {
        slope = 1 / root;
        jet[0] = square_root(square);
      }
      jet[1] = slope * dx;
      jet[2] = slope * dy;
      if constexpr (Order == 2) {
        const Pack bent = e == 1 ? -1 / (root * apart) : all_lanes(e * (e - 2)) * lower / apart, bent_a = bent * a;
        jet[3] = all_lanes(0.5) * (slope + bent_a * a);
        jet[4] = bent_a * b;
        jet[5] = all_lanes(0.5) * (slope + bent * b * b);
      }
      const double* const w = term.weights.data() + 3 * i;
      for (int axis = 0; axis < 3; ++axis)
        for (int d = 0; d < count; ++d) total[d][axis] += all_lanes(w[axis]) * jet[d];
    }
  }
  for (int d = 0; d < count; ++d)
    for (int axis = 0; axis < 3; ++axis) store(total[d][axis], sum[d][axis].data());
}
#endif

template <int Lanes>
void PolyharmonicSum::values_at(const PlanePoints& at, Index first, double* out) const {
  using Values = Lane<Lanes>;
  const auto [x, y] = lanes_of<Lanes>(at, first);
  std::array<Values, 3> sum = polynomials_at<Values, 0>(x, y)[0];
  bool added = odd_.empty();
#ifdef TRIPATCH_PACKS
  if constexpr (Lanes == 2 * lanes) {
    add_odd_terms(x, y, sum);
    added = true;
  }
#endif
  if (!added) add_terms(odd_, x, y, [](const Values& square) { return Values(square.sqrt()); }, sum);
  if (!even_.empty()) add_terms(even_, x, y, [](const Values& square) { return Values(square.max(min_square).log()); }, sum);
  const Index count = std::min<Index>(Lanes, at.rows() - first);
  for (Index k = 0; k < count; ++k)
    for (int axis = 0; axis < 3; ++axis) out[3 * (first + k) + axis] = sum[axis][k];
}

/// first: the lowest kernel, but for its power of the squared distance.
template <class Values, class First>
void PolyharmonicSum::add_terms(const std::vector<Term>& terms, const Values& x, const Values& y, const First& first,
                                std::array<Values, 3>& sum) const {
  Values a = sum[0], b = sum[1], c = sum[2];  // in registers
  const double* center = centers_.data();
  for (Index i = 0; i < centers_.rows(); ++i, center += 2) {
    const Values dx = x - center[0], dy = y - center[1], square = dx * dx + dy * dy;
    Values kernel = first(square);
    for (const Term& term : terms) {
      for (int k = 0; k < term.step; ++k) kernel *= square;
      const double* const w = term.weights.data() + 3 * i;
      a += w[0] * kernel;
      b += w[1] * kernel;
      c += w[2] * kernel;
    }
  }
  sum = {a, b, c};
}

template <int Lanes, int Order>
void PolyharmonicSum::derivatives_at(const PlanePoints& at, Index first, double* out) const {
  using Values = Lane<Lanes>;
  const auto [x, y] = lanes_of<Lanes>(at, first);
  Jets<Values, Order> sum = polynomials_at<Values, Order>(x, y);
  const double* const c = centers_.data();
  bool added = odd_.empty();
#ifdef TRIPATCH_PACKS
  if constexpr (Lanes == lanes) {
    add_odd_derivatives<Order>(x, y, sum);
    added = true;
  }
#endif
  for (Index i = 0; i < centers_.rows() && !(added && even_.empty()); ++i) {
    const Values dx = x - c[2 * i], dy = y - c[2 * i + 1], square = dx * dx + dy * dy;
    const Values apart = square.max(tolerance::same * tolerance::same);
    // slope: of the kernel, over the way from the center; bend: the slope's own, likewise
    const auto add = [&](const Term& term, const Values& kernel, const Values& slope, const auto& bend) {
      const double* const w = term.weights.data() + 3 * i;
      const auto add_all = [&](std::array<Values, 3>& to, const Values& values) {
        for (int axis = 0; axis < 3; ++axis) to[axis] += w[axis] * values;
      };
      add_all(sum[0], kernel);
      add_all(sum[1], slope * dx);
      add_all(sum[2], slope * dy);
      if constexpr (Order == 2) {
        // next to a center as a ten-millionth from it along u
        const auto beside = square < tolerance::same * tolerance::same;
        const Values a = beside.select(tolerance::same, dx), b = beside.select(0, dy), bent = bend(), bent_a = bent * a;
        add_all(sum[3], 0.5 * (slope + bent_a * a));
        add_all(sum[4], bent_a * b);
        add_all(sum[5], 0.5 * (slope + bent * b * b));
      }
    };
    Values root = apart.sqrt(), lower = root;  // lower: the kernel over the squared distance
    int power = 1;
    for (const Term& term : odd_) {
      if (added) break;
      const int e = term.exponent;
      for (; power < e / 2; ++power) lower *= apart;
      const Values& own = lower;
      if (e == 1)
        add(term, square.sqrt(), root.inverse(), [&] { return Values(-(root * apart).inverse()); });
      else
        add(term, own * square, e * own, [&] { return Values((e * (e - 2)) * own / apart); });
    }
    const auto times = [](Values x, const Values& factor, int power) {
      for (int k = 0; k < power; ++k) x *= factor;
      return x;
    };
    for (const Term& term : even_) {
      const int half = term.exponent / 2;
      const Values slope = times(half * apart.log() + 1, apart, half - 1);
      const auto bend = [&] {
        return Values(4 * times(half * (half - 1) * apart.log() + (2 * half - 1), apart, half - 1) / apart);
      };
      add(term, times(square.max(min_square).log(), square, half), 2 * slope, bend);
    }
  }
  const Index count = std::min<Index>(Lanes, at.rows() - first);
  for (Index k = 0; k < count; ++k)
    for (const std::array<Values, 3>& each : sum)
      for (int axis = 0; axis < 3; ++axis)
        out[3 * static_cast<Index>(sum.size()) * (first + k) + 3 * (&each - sum.data()) + axis] = each[axis][k];
}

/// By u, of polynomials by v.
template <class Values, int Order>
PolyharmonicSum::Jets<Values, Order> PolyharmonicSum::polynomials_at(const Values& x, const Values& y) const {
  Jets<Values, Order> sum;
  for (int axis = 0; axis < 3; ++axis) {
    for (std::array<Values, 3>& each : sum) each[axis].setZero();
    for (int i = degree_; i >= 0; --i) {
      std::array<Values, Order + 1> own;  // by v
      own.fill(Values::Zero());
      for (int j = degree_ - i; j >= 0; --j) {
        for (int d = Order; d > 0; --d) own[d] = own[d] * y + own[d - 1];
        own[0] = own[0] * y + polynomial_(monomial_row(degree_, i, j), axis);
      }
      if constexpr (Order == 2) sum[3][axis] = sum[3][axis] * x + sum[1][axis];
      if constexpr (Order == 2) sum[4][axis] = sum[4][axis] * x + sum[2][axis];
      if constexpr (Order == 2) sum[5][axis] = sum[5][axis] * x + own[2];
      if constexpr (Order >= 1) sum[1][axis] = sum[1][axis] * x + sum[0][axis];
      if constexpr (Order >= 1) sum[2][axis] = sum[2][axis] * x + own[1];
      sum[0][axis] = sum[0][axis] * x + own[0];
    }
  }
  return sum;
}

void PolyharmonicSum::evaluate(const PlanePoints& at, int order, double* out) const {
  Index k = 0;  // as many at a time as registers hold
#ifdef TRIPATCH_PACKS
  const bool packs = has_packs();
  for (; packs && order == 0 && k + 4 < at.rows(); k += 8) {
    check_interruption();
    values_at<8>(at, k, out);
  }
  for (; packs && order > 0 && k < at.rows(); k += 4) {
    check_interruption();
    if (order == 1)
      derivatives_at<4, 1>(at, k, out);
    else
      derivatives_at<4, 2>(at, k, out);
  }
#endif
  for (; k < at.rows(); k += order > 0 ? 2 : 4) {
    check_interruption();
    if (order == 0)
      values_at<4>(at, k, out);
    else if (order == 1)
      derivatives_at<2, 1>(at, k, out);
    else
      derivatives_at<2, 2>(at, k, out);
  }
}

Points PolyharmonicSum::values(const PlanePoints& at) const {
  Points out(at.rows(), 3);
  evaluate(at, 0, out.data());
  return out;
}

}  // namespace tripatch
