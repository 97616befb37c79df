// A curve or field along a side: vectors that are polynomials of t on each piece of [0, 1].
// Every source of side data (plain mesh, subdivision limit, Bezier, NURBS, functions) is turned into this one form, so that
// evaluation is the same fast loop for all, with exact derivatives of any order and no call back into the source.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// Refused so: what is computed of finite numbers and is not finite itself.
inline constexpr const char* beyond_measure =
    "Numbers along a side are not finite, or too large to compute with; move what lies far away";

/// Never changed once made: copies share what they hold, and fields of the same pieces share these.
class PiecewisePolynomial {
public:
  PiecewisePolynomial();
  PiecewisePolynomial(const PiecewisePolynomial&) = default;  // and no moves: what is moved from stays whole
  PiecewisePolynomial& operator=(const PiecewisePolynomial&) = default;
  /// breaks: pieces + 1 increasing values from 0 to 1. coefficients: for piece p, power k (of t - middle of the piece) and
  /// component x: coefficients[(p * (degree + 1) + k) * dimension + x].
  PiecewisePolynomial(std::vector<double> breaks, int degree, int dimension, std::vector<double> coefficients);

  static PiecewisePolynomial constant(std::span<const double> value);
  /// a polynomial of t from Bernstein coefficients, (degree + 1) x dimension, row by row.
  static PiecewisePolynomial bezier(std::span<const double> net, int dimension);
  /// a at 0, b at 1; a scalar.
  static PiecewisePolynomial linear(double a, double b);
  /// C2 cubic spline through values (n x dimension, row by row) at increasing parameters from 0 to 1; not-a-knot ends, or the
  /// given end derivatives (each `dimension` long; empty: not-a-knot). Fewer than four values: the polynomial through them.
  static PiecewisePolynomial spline(std::span<const double> parameters, std::span<const double> values, int dimension,
                                    std::span<const double> start_derivative = {}, std::span<const double> end_derivative = {});
  /// Cubic Hermite pieces through values with the given derivatives.
  static PiecewisePolynomial hermite(std::span<const double> parameters, std::span<const double> values,
                                     std::span<const double> derivatives, int dimension);
  /// Adaptive Chebyshev fit of a function sampled in batches: f(t, out) with out |t| x dimension. Pieces are halved until the
  /// error at check points is under tolerance times the largest value, or the pieces are shorter than 2^-max_depth. A Refusal
  /// where a value is not finite: whoever takes functions from outside has looked at theirs, what is computed here overflowed.
  static PiecewisePolynomial fit(const std::function<void(std::span<const double>, std::span<double>)>& f, int dimension,
                                 double tolerance = 1e-13, int degree = 9, int max_depth = 9);

  /// Fields end to end: each takes its share of [0, 1] (empty: an equal one).
  static PiecewisePolynomial joined(const std::vector<PiecewisePolynomial>& parts, std::vector<double> shares = {});

  int dimension() const { return dimension_; }
  int degree() const { return degree_; }
  Index pieces() const { return static_cast<Index>(breaks().size()) - 1; }
  const std::vector<double>& breaks() const { return places_->breaks; }
  std::span<const double> coefficients() const { return *coefficients_; }
  bool empty() const { return breaks().size() < 2; }
  /// Whether all its coefficients are.
  bool is_finite() const;

  /// Taylor coefficients at t up to `order`: out[k * dimension + x] is the k-th derivative over k!. Outside [0, 1] the end
  /// pieces are continued.
  void taylor(double t, int order, double* out) const;
  /// Three-dimensional fields: value and derivatives.
  Vec3 operator()(double t) const;
  Vec3 derivative_at(double t, int order = 1) const;

  PiecewisePolynomial derivative() const;
  PiecewisePolynomial reversed() const;  ///< t -> 1 - t
  /// The part from t0 to t1 (t0 < t1), as a field over [0, 1] again.
  PiecewisePolynomial part(double t0, double t1) const;
  /// The same field on more pieces (breaks of both) and of at least this degree.
  PiecewisePolynomial refined(const std::vector<double>& more_breaks, int degree) const;
  friend PiecewisePolynomial operator+(const PiecewisePolynomial& a, const PiecewisePolynomial& b);
  friend PiecewisePolynomial operator-(const PiecewisePolynomial& a, const PiecewisePolynomial& b);
  friend PiecewisePolynomial operator*(double s, const PiecewisePolynomial& a);
  /// Scalar field (dimension 1) times field.
  friend PiecewisePolynomial operator*(const PiecewisePolynomial& scalar, const PiecewisePolynomial& field);

private:
  /// The breaks, and how a parameter is found among them.
  struct Places {
    std::vector<double> breaks;
    std::vector<std::int32_t> lookup;  // first candidate piece for floor(t * lookup size)

    explicit Places(std::vector<double> given);
    Index piece(double t) const;
    double middle(Index p) const { return 0.5 * (breaks[p] + breaks[p + 1]); }
  };

  PiecewisePolynomial(std::shared_ptr<const Places> places, std::vector<double> coefficients, int degree, int dimension);
  /// On pieces that lie within its own.
  PiecewisePolynomial on(const std::shared_ptr<const Places>& places, int degree) const;
  /// Pieces of both.
  std::shared_ptr<const Places> common_places(const PiecewisePolynomial& o) const;

  std::shared_ptr<const Places> places_;
  int degree_;
  int dimension_;
  std::shared_ptr<const std::vector<double>> coefficients_;
};

/// Of a curve in space, by 32 chords.
double arc_length(const PiecewisePolynomial& curve);

}  // namespace tripatch
