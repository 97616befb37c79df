#include "tripatch/estimate/fits_between.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <span>

namespace tripatch {
namespace {

constexpr int nodes = 6;
/// Edges of sides from which on every second vertex is fitted, or every fourth: that no vertex is farther from one that is than what the fit
/// there looks at.
constexpr int long_side = 24, very_long = 64;
/// Vertices at the ends of a side that have fits of their own: the interpolation has no vertices beyond them.
constexpr int at_end = 3;
/// What the planes around a fit may miss it by, and its second derivatives by an edge: a fiftieth of what nobody sees. What they miss between
/// fits is a sixty-fourth of that.
constexpr double told = well_known / 50;

/// What lies at t on the polynomials through some fits.
struct Interpolated {
  Vec3 normal = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();

  Interpolated(const SideDraft& side, const std::vector<VertexFit>& fits, const std::array<int, nodes>& through, double t) {
    for (int a : through) {
      double over = 1, under = 1;
      for (int b : through)
        if (b != a) over *= t - side.t[b], under *= side.t[a] - side.t[b];
      const double weight = over / under;
      normal += weight * fits[a].normal;
      second += weight * fits[a].second;
    }
    normal.normalize();
    const Eigen::Matrix3d in_plane = Eigen::Matrix3d::Identity() - normal * normal.transpose();
    second = in_plane * second * in_plane;
  }
};

/// `count` of some vertices about place `middle` among them, as far as there are any to both sides.
std::span<const int> around(const std::vector<int>& some, std::ptrdiff_t middle, std::ptrdiff_t count) {
  const std::ptrdiff_t first = std::clamp<std::ptrdiff_t>(middle - count / 2, 0, std::ssize(some) - count);
  return std::span(some).subspan(first, count);
}

}  // namespace

bool is_between(int vertex, int edges) {
  if (edges < long_side) return false;
  const int away = std::min(vertex, edges - vertex), middle = edges / 2;
  return away >= at_end && away % (edges < very_long ? 2 : 4) != 0 && away != middle;
}

FitsBetween::FitsBetween(const SideDraft& side, const std::vector<VertexFit>& fits) : side_(side), fits_(fits) {
  for (int k = 0; k <= side.edges(); ++k)
    if (!is_between(k, side.edges())) fitted_.push_back(k);
  told_.resize(fitted_.size());
}

bool FitsBetween::is_told(std::size_t place) {
  if (told_[place]) return *told_[place];
  std::array<int, nodes> through;
  std::ranges::remove_copy(around(fitted_, static_cast<std::ptrdiff_t>(place), nodes + 1), through.begin(), fitted_[place]);
  const VertexFit& fit = fits_[fitted_[place]];
  const Interpolated at(side_, fits_, through, side_.t[fitted_[place]]);
  told_[place] = (at.normal - fit.normal).norm() <= told && (at.second - fit.second).norm() <= told;
  return *told_[place];
}

std::optional<VertexFit> FitsBetween::at(int vertex) {
  const auto after = std::ranges::upper_bound(fitted_, vertex);
  const std::size_t place = after - fitted_.begin();
  if (!is_told(place - 1) || !is_told(place)) return {};
  std::array<int, nodes> through;
  std::ranges::copy(around(fitted_, static_cast<std::ptrdiff_t>(place), nodes), through.begin());
  const Interpolated at(side_, fits_, through, side_.t[vertex]);
  const VertexFit &a = fits_[*(after - 1)], &b = fits_[*after];
  VertexFit fit;
  fit.normal = at.normal;
  fit.second = at.second;
  fit.frame << side_.tangent[vertex], side_.tangent[vertex].cross(at.normal);
  fit.covariance = (a.covariance + b.covariance) / 2;
  fit.slope_variances = fit.covariance.trace();
  fit.bend_variance = (a.bend_variance + b.bend_variance) / 2;
  return fit;
}

}  // namespace tripatch
