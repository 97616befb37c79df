// The energies of a surface over any plane domain as functions of what may be added to it: scalar functions of the domain with vector
// coefficients, the same for all holes, and vector fields of the one hole.
#pragma once

#include <array>
#include <utility>
#include <vector>

#include "tripatch/fairing/curvature_following.h"
#include "tripatch/fairing/curvature_variation.h"
#include "tripatch/fairing/fairing.h"
#include "tripatch/fairing/quadratic.h"
#include "tripatch/math/dense_kernels.h"

namespace tripatch {

/// Binomial coefficient.
inline double choose(int n, int k) {
  double r = 1;
  for (int i = 1; i <= k; ++i) r = r * (n - k + i) / i;
  return r;
}

/// The nine derivatives of orders 1 to 3, as Derivatives has them.
template <int N>
Eigen::Matrix<double, 9, 1> derivatives_of(const Jet<N>& f) {
  Eigen::Matrix<double, 9, 1> d;
  for (int k = 0; k < 9; ++k) d[k] = f.c[k + 1];
  for (int k : {2, 4}) d[k] *= 2;
  for (int k : {5, 8}) d[k] *= 6;
  for (int k : {6, 7}) d[k] *= 2;
  return d;
}

/// Those of scalar functions at the nodes of a quadrature, nine rows a node, one function a column.
class NodeDerivatives {
public:
  explicit NodeDerivatives(Index nodes) : nodes_(nodes) {}
  void add(const std::vector<Jet<3>>& functions);  ///< at the next node
  auto at(Index node) const { return all_.middleRows(9 * node, 9); }
  Index nodes() const { return nodes_; }
  Index functions() const { return all_.cols(); }

private:
  Index nodes_, filled_ = 0;
  RowMajor all_;
};

/// What combines functions to ones that are orthonormal in the third-derivative energy, one a column.
Eigen::MatrixXd orthonormal_functions(const std::vector<double>& weights, const NodeDerivatives& functions);

/// Scalar functions at the nodes of a quadrature over the domain.
struct NodeBasis {
  std::vector<double> weights;                  ///< of the nodes, corner weight included
  Eigen::MatrixXd combination;                  ///< of the domain's plain functions, one basis function a column
  RowMajor interior;                            ///< derivatives of the functions, nine rows a node, one function a column
  std::array<Eigen::MatrixXd, 4> rows, normal;  ///< by order m of derivatives: rows sqrt(w) D^m of the functions

  NodeBasis(std::vector<double> weights_of_nodes, const NodeDerivatives& plain, Eigen::MatrixXd combined);

  /// Derivative d of order m counts as often as it occurs in D^m; where order m begins in Derivatives.
  static double factor(int m, int d) { return std::sqrt(choose(m, d)); }
  static int first_of(int m) { return (m - 1) * (m + 2) / 2; }
};

/// Unknowns are the coefficients of the scalar functions, component by component, then those of the fields.
class EnergyProblem {
public:
  virtual ~EnergyProblem() = default;

  const FairingOptions& options() const { return options_; }
  Index count() const { return 3 * interior_ + fields_; }
  Index scalars() const { return 3 * interior_; }  ///< those before the fields
  /// A person's hand is on it.
  bool controlled() const { return options_.tension > 0 || options_.center; }

  /// The unknowns of a problem of lower degree as those of this one, where its functions come first among those of this.
  Eigen::VectorXd raised(const EnergyProblem& lower, const Eigen::VectorXd& x) const;
  /// What the unknowns change of that which is held, a row each; none where nothing is.
  virtual Eigen::MatrixXd held() const = 0;
  virtual const CurvatureFollowing& following() const = 0;
  /// How much of x can be added until the surface is about to turn back over a side.
  virtual double reach(const Eigen::VectorXd& x) const = 0;
  bool open(const Eigen::VectorXd& x) const { return reach(x) >= 1; }

  /// The integral of w |D^order P|^2 over the size squared: thin_plate (2), third_derivative (3), tension (1).
  Quadratic quadratic(int order) const;
  /// The derivatives of the surface at the nodes, for these unknowns.
  std::vector<Derivatives> derivatives(const Eigen::VectorXd& x) const;
  /// minimum_variation and quadric_variation of these.
  std::pair<double, double> variation(const std::vector<Derivatives>& d) const;
  /// Gauss-Newton's model about them of minimum_variation (0) and quadric_variation (1), those that are wanted.
  std::array<Quadratic, 2> linearized(const std::vector<Derivatives>& d, const std::array<bool, 2>& wanted) const;

protected:
  /// nodes must outlive this.
  EnergyProblem(const NodeBasis& nodes, std::vector<Derivatives> base, FairingOptions options, double size, Index interior)
      : nodes_(nodes), base_(std::move(base)), options_(std::move(options)), size_(size), interior_(interior) {}

  const NodeBasis& nodes_;
  std::vector<Derivatives> base_;  // of the surface that is given, at the nodes
  FairingOptions options_;
  double size_;     // of the hole, scene units; coefficients of scalar functions are relative to it
  Index interior_;  // scalar functions
  Index fields_ = 0;
  RowMajor basis_;  // derivatives of the fields, 27 rows a node

private:
  std::array<RowMajor, 2> grams(const std::vector<Derivatives>& all, const std::array<bool, 2>& wanted, Index from,
                                Index to) const;
};

}  // namespace tripatch
