// The least of the energies of a EnergyProblem: one solve for the quadratic ones, steps downhill for the geometric ones.
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "tripatch/fairing/energy_problem.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

/// The minimum of a quadratic energy, slopes free; with the scalar functions alone where alpha would leave its bound, or, where tension
/// or the center is a person's to change (which shall not jump), most of the way from there to the bound. Curvature that is to be
/// followed weighs a tenth of the energy at the start for each jump tolerated; two passes, because slopes enter it squared.
Eigen::VectorXd minimum(const EnergyProblem& problem, const Quadratic& energy);

/// The parameterization is free in the geometric energies. A little of the third-derivative energy settles it: a step may gain on it a
/// tenth (relative) of what it loses. With less than 0.05 the minimizer depends on rounding and on the quadrature; with 0.2 to 0.3 the
/// distance to the truth grows by a third to two thirds (holes of docs/holebench.md).
constexpr double parameterization_counts = share::tenth;

/// A geometric energy as the logarithm of its value, so that "auto" weighs its two parts without units, plus the jumps of curvature.
class Merit {
public:
  /// third: the third-derivative energy. tension: added to the energy; without unknowns: none. All must outlive this.
  Merit(const EnergyProblem& problem, const Quadratic& third, Quadratic tension, Fairing energy);

  struct Value {
    double log = std::numeric_limits<double>::infinity();
    double variation = 0, quadric = 0, third = 0;
    double energy = 0;
    std::shared_ptr<const std::vector<Derivatives>> derivatives;  ///< of the surface at the nodes, there
  };
  Value operator()(const Eigen::VectorXd& x) const;

  /// Gauss-Newton's models of all parts about x.
  struct Model {
    std::array<Quadratic, 2> variation;
    Quadratic jumps;
    std::array<bool, 2> used;
  };
  Model linearized(const Eigen::VectorXd& x, const Value& v) const;

  /// The step that makes the model of the logarithm least, by repeated weighting: a logarithm's weight is one over its value where the
  /// step leads, not where it starts. `damping` is the weight of `metric`, relative to the model's.
  Eigen::VectorXd step(const Model& m, const Eigen::VectorXd& x, const Value& v, const Eigen::MatrixXd& metric,
                       double damping) const;

private:
  bool tense() const { return tension_.normal.size() > 0; }
  double tension(const Eigen::VectorXd& x) const { return tense() ? tension_(x) : 0; }
  double energy(double variation, double quadric) const;
  double quadric_share(double variation, double quadric) const;
  Quadratic weighted(const Model& m, const Eigen::VectorXd& x, const Eigen::VectorXd& third_slope, const Value& v,
                     const Eigen::VectorXd& y) const;

  const EnergyProblem& problem_;
  const Quadratic& third_;
  Quadratic tension_;
  Eigen::MatrixXd held_;
  bool quadric_, whole_;
};

/// Levenberg and Marquardt, damped in `metric` so that what the energy leaves open stays put: every step goes down. Stops when a step
/// gains less than a percent or the energy is next to none. Returns the steps taken.
int descend(const Merit& merit, const Eigen::MatrixXd& metric, Eigen::VectorXd& x, Merit::Value& value, int iterations);

}  // namespace tripatch
