#include "tripatch/annulus/match.h"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

constexpr int match_samples = 96;  ///< ribs that are compared: a choice
/// The second parameter runs at least so fast against the first.
constexpr double min_speed = share::little;

struct RibEnd {
  Vec3 point, way;
};

/// What the shifts of the samples are judged by, and how it changes with each.
class Matching {
public:
  Matching(const Side& first, const Side& second, const RibDirections& out_of_first, const RibDirections& out_of_second)
      : second_(second), out_of_second_(out_of_second) {
    for (int k = 0; k < match_samples; ++k) {
      const double u = static_cast<double>(k) / match_samples;
      first_.push_back({first.c(u), -out_of_first(u)});
      around_.push_back(second.c(u));
    }
  }

  /// The shift of all ribs that makes them shortest; against: the second boundary runs against the first.
  std::pair<int, double> shortest(bool against) const {
    std::pair<int, double> best = {0, INFINITY};
    for (int s = 0; s < match_samples; ++s) {
      double sum = 0;
      for (int k = 0; k < match_samples; ++k)
        sum += (around_[static_cast<std::size_t>((s + (against ? match_samples - k : k)) % match_samples)] -
                first_[static_cast<std::size_t>(k)].point)
                   .squaredNorm();
      if (sum < best.second) best = {s, sum};
    }
    return best;
  }

  void scale_by(double squares) { scale_ = std::sqrt(squares / match_samples); }

  /// Of rib k: how its ends lean from the chord, and its length.
  Eigen::Vector4d lean(int k, double shift) const {
    const double t = wrapped_parameter(shift - static_cast<double>(k) / match_samples);
    const RibEnd& from = first_[static_cast<std::size_t>(k)];
    const Vec3 chord = second_.c(t) - from.point, ways = from.way + out_of_second_(t), e = chord.stableNormalized();
    Eigen::Vector4d out;
    out << ways - ways.dot(e) * e, std::sqrt(tolerance::slight) * chord.norm() / scale_;
    return out;
  }

  double value(const Eigen::VectorXd& shift) const {
    double sum = 0;
    for (int k = 0; k < match_samples; ++k) {
      const double uneven = (shift[(k + 1) % match_samples] - shift[k]) * match_samples;
      if (uneven > 1 - min_speed) return INFINITY;
      sum += lean(k, shift[k]).squaredNorm() + tolerance::slight * uneven * uneven;
    }
    return sum;
  }

  Eigen::VectorXd step(const Eigen::VectorXd& shift, double damping) const {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(match_samples, match_samples);
    Eigen::VectorXd down = Eigen::VectorXd::Zero(match_samples);
    for (int k = 0; k < match_samples; ++k) {
      const Eigen::Vector4d here = lean(k, shift[k]),
                            slope = (lean(k, shift[k] + tolerance::close) - lean(k, shift[k] - tolerance::close)) /
                                    (2 * tolerance::close);
      normal(k, k) += slope.squaredNorm() * (1 + damping);
      down[k] -= slope.dot(here);
      const int next = (k + 1) % match_samples;
      const double weight = tolerance::slight * match_samples * match_samples, apart = shift[next] - shift[k];
      normal(k, k) += weight;
      normal(next, next) += weight;
      normal(k, next) -= weight;
      normal(next, k) -= weight;
      down[k] += weight * apart;
      down[next] -= weight * apart;
    }
    normal.diagonal().array() += tolerance::solved * normal.trace() / match_samples;
    return normal.ldlt().solve(down);
  }

private:
  const Side& second_;
  const RibDirections& out_of_second_;
  std::vector<RibEnd> first_;
  std::vector<Vec3> around_;
  double scale_ = 1;
};

/// A scalar of u, periodic, through values at even places.
PiecewisePolynomial through_even(const Eigen::VectorXd& values) {
  constexpr int beyond = count::dozens;  // what the spline does at its ends has died away to rounding then
  std::vector<double> at, given;
  for (int k = -beyond; k <= match_samples + beyond; ++k) {
    at.push_back(static_cast<double>(k + beyond) / (match_samples + 2 * beyond));
    given.push_back(values[(k + match_samples) % match_samples]);
  }
  constexpr double whole = match_samples + 2 * beyond;
  return PiecewisePolynomial::spline(at, given, 1).part(beyond / whole, (beyond + match_samples) / whole);
}

}  // namespace

double wrapped_parameter(double t) {
  const double in = t - std::floor(t);
  return in < 1 ? in : 0;
}

PiecewisePolynomial match_boundaries(const Side& first, const Side& second, const RibDirections& out_of_first,
                                     const RibDirections& out_of_second) {
  Matching matching(first, second, out_of_first, out_of_second);
  const auto [begin, squares] = matching.shortest(true);
  if (matching.shortest(false).second < squares / 2) throw CodedRefusal(Code::boundaries_face_opposite_ways);
  matching.scale_by(squares);
  Eigen::VectorXd shift = Eigen::VectorXd::Constant(match_samples, static_cast<double>(begin) / match_samples);
  double value = matching.value(shift), damping = tolerance::slight;
  for (int k = 0; k < tolerance::newton_steps; ++k) {
    const Eigen::VectorXd change = matching.step(shift, damping);
    const double next = change.allFinite() ? matching.value(shift + change) : INFINITY;
    if (next < value) {
      const bool done = value - next < tolerance::rounding * value;
      shift += change;
      value = next;
      damping = std::max(damping / 10, tolerance::solved);
      if (done) break;
    } else {
      damping *= 10;
    }
  }
  return through_even(shift);
}

}  // namespace tripatch
