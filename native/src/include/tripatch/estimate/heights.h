// The heights that a plane is fitted to, eight at a time, and the sums over them that fits ask for: compiled for each kind of machine.
#pragma once

#include <array>
#include <vector>

#include "tripatch/math/dense_kernels.h"
#include "tripatch/types.h"

namespace tripatch {

constexpr int fit_degree = 5;  ///< of the local polynomials

/// Of two coordinates' monomials, by degree and in each by the power j of the second one.
constexpr int place_of(int degree, int j) { return degree * (degree + 1) / 2 + j; }
constexpr int fit_terms = place_of(fit_degree + 1, 0);

/// Eight points over a frame, in the units of the local mesh; where fewer are left the rest are nothing and have no share.
struct SampleBlock {
  std::array<double, 8> x, y, z;   ///< place and height
  std::array<double, 8> share, g;  ///< weight by place, radius^(2 degree + 2)
};

/// Heights over a frame whose origin they are given about, in x, y and z; sets g.
void lay_over(const Vec3& along, const Vec3& across, const Vec3& up, std::vector<SampleBlock>& heights);

/// Of a height: noise, and over radius^(2 degree + 2) what the polynomial leaves out.
struct HeightVariances {
  double noise, truncation;
};

/// Room for sums over many heights.
struct Workspace {
  std::vector<double> weight;  ///< share over variance, eight for each eight heights
  std::vector<double> powers;
};

/// The normal matrix of the monomials up to fit_degree in the first rows and columns of `out`, both triangles, and in column fit_terms what
/// they make with the heights: sums of weights times products. Sets the weights.
void sum_products(const std::vector<SampleBlock>& heights, const HeightVariances& variances, Workspace& room, SquareOf24& out);

/// Numbers by monomial, and three more.
using ByMonomial = std::array<double, 24>;
/// Sums of the monomials times weight and what a polynomial is above the heights. coefficients: of the monomials.
void sum_residuals(const std::vector<SampleBlock>& heights, const Workspace& room, const double* coefficients, ByMonomial& out);

/// What noise and truncation explain of heights that a polynomial is fitted to.
struct ExplainedHeights {
  double noise = 0, truncation = 0;                ///< sums of squares,
  double noise_count = 0, truncation_count = 0;    ///< and over how many heights, without those that determine the polynomial
  double noise_points = 0, truncation_points = 0;  ///< with them
};
/// Of the upper triangles r below, whose diagonals have these reciprocals.
using Reciprocals = std::array<double, fit_terms>;
/// r: the root of the normal matrix, r'r.
ExplainedHeights explain_heights(const std::vector<SampleBlock>& heights, const HeightVariances& variances, const Workspace& room,
                                 const double* coefficients, const SquareOf24& r, const Reciprocals& over);
/// The diagonal of (r'r)^-1.
ByMonomial coefficient_variances(const SquareOf24& r, const Reciprocals& over);

/// x becomes r^-1 x, r'^-1 x.
void solve_upper(const SquareOf24& r, const Reciprocals& over, double* x);
void solve_upper_transposed(const SquareOf24& r, const Reciprocals& over, double* x);
/// The squares of the columns 1, 2 and 5 of r'^-1, and the product of the first two.
using ColumnProducts = std::array<double, 4>;
ColumnProducts products_of_columns(const SquareOf24& r, const Reciprocals& over);

}  // namespace tripatch
