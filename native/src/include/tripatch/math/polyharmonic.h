// Polyharmonic kernels r^(2m-2), with a logarithm where the exponent is even, around points of a plane, and sums of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "tripatch/math/plane.h"

namespace tripatch {

/// The exponent of a kernel of order m, twice which is a whole number; the degree of the polynomials that are free next to it, and how many.
int polyharmonic_exponent(double order);
/// What the power of the distance, with the logarithm of its square where the exponent is even, is taken times: then it is definite among
/// contrasts.
double polyharmonic_factor(int exponent);
int free_degree_of(double order);
int free_polynomials(double order);

/// Distances of points from others, a column for each of these: what the kernels of several orders are made of.
struct PlaneDistances {
  PlaneDistances(const PlanePoints& points, const PlanePoints& others);
  Eigen::MatrixXd itself, squared;
};
/// With the limit 0 at 0.
Eigen::MatrixXd polyharmonic_kernel(double order, const PlaneDistances& apart);

/// Kernels of some orders around the same centers, and polynomials: values in space over a plane. Some points are taken at a time.
class PolyharmonicSum {
public:
  explicit PolyharmonicSum(const PlanePoints& centers) : centers_(centers) {}

  /// weights: a row for each center; polynomial: a row for each u^i v^j, i + j up to the order's degree, j the faster.
  void add(double order, double share, const Eigen::MatrixXd& weights, const Eigen::MatrixXd& polynomial);

  /// Values at n places and derivatives by u and v to an order of 0, 1 or 2, in the order and with the factors of a Surface's.
  void evaluate(const PlanePoints& at, int order, double* out) const;
  Points values(const PlanePoints& at) const;

private:
  struct Term {
    int exponent;
    int step;        // powers of the squared distance more than of the term before
    Points weights;  // times share and sign
  };
  /// A number of each axis, to an order: the value, then as of evaluate.
  template <class Values, int Order>
  using Jets = std::array<std::array<Values, 3>, (Order + 1) * (Order + 2) / 2>;
  template <class Values, int Order>
  Jets<Values, Order> polynomials_at(const Values& x, const Values& y) const;
  template <int Lanes>
  using Lane = Eigen::Array<double, Lanes, 1>;
  void add_odd_terms(const Lane<8>& x, const Lane<8>& y, std::array<Lane<8>, 3>& sum) const;
  template <int Order>
  void add_odd_derivatives(const Lane<4>& x, const Lane<4>& y, Jets<Lane<4>, Order>& sum) const;
  template <class Values, class First>
  void add_terms(const std::vector<Term>& terms, const Values& x, const Values& y, const First& first,
                 std::array<Values, 3>& sum) const;
  template <int Lanes>
  void values_at(const PlanePoints& at, Index first, double* out) const;
  template <int Lanes, int Order>
  void derivatives_at(const PlanePoints& at, Index first, double* out) const;

  PlanePoints centers_;
  std::vector<Term> odd_, even_;  // by their exponents
  int degree_ = -1;
  Points polynomial_;  // of that degree
};

}  // namespace tripatch
