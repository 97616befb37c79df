#include "tripatch/estimate/side_planes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

namespace {

// Half and twice of these numbers were tried on 78 rims in meshes of balls, tori, saddles and fillets, of 1 to 16 edges a side, with noise
// of 0 to 2% of an edge. Two percentages tell by how much planes err more in the mean: with half, with twice of it.
constexpr double flat_enough = 5e-4;       ///< slope over the guess of a plane: no second fit; 0%, 0%
constexpr double max_tilt = share::fifth;  ///< slope over the faces that is handed on to the next vertex; 1%, 1%
constexpr int pooled = count::pair;        ///< vertices to each side that are judged together; 4%, 2%
/// Logarithm of densities: what is near is predicted within a seventh. Less says nothing, for the first guess of a plane is made of the
/// nearest faces themselves: where the noise is 1% of the edges, one ring seems better by 1 to 1.6.
constexpr double by_far = factor::clear;
/// Without noise: a fifth; nothing where the other is as much less certain of its plane.
constexpr double by_some = share::half;
/// Vertices to each side along the rim that a vertex is compared with.
constexpr int max_compared = count::few, min_compared = count::pair;
/// Of the mean rim edge: a rim of a deviation of less has no noise; coarse meshes of 12 degrees an edge have 1e-3.
constexpr double noisy_rim = noise::some;
/// If the rim has no noise, a fit of r rings gets at least the variance of such noise over the cube of r rows of faces, times
/// this factor. Of 1 to 30, tried on ten surfaces with noise of 0.1 to 3% of the edges, it left the smallest errors.
constexpr double known_by_ring = factor::huge;
/// Nor better than this part of what the faces near it lean by, over the square of r: a row of them tells a plane, not how the surface
/// bends away.
constexpr double known_by_lean = share::quarter;
constexpr double agrees =
    deviations::certain;  ///< standard deviations from a plane to facets that have nothing against them; 0%, 0%
/// By how much a plane is off along the rim where a side turns by x radians an edge: this times x^3, as the ends of a spline through an
/// arc are. 2.7 to 3.2 degrees on arcs of 70 to 120 degrees in two edges.
constexpr double expected_error_turn = 7.5 * std::numbers::pi / 180;
/// Of a side; of more, fits see the turn themselves: less by the square of their number.
constexpr int few_edges = count::several;
constexpr double bent = angle::slight;  ///< degrees that a side turns by at least, for its faces to tell their plane; 0%, 0%
/// Sine of the angle by which a plane may always lean against the faces next to it, 1 degree.
constexpr double always_plausible = share::trace;

/// The heights nearest to a rim vertex, which every neighborhood has to explain.
std::vector<double> densities(const LocalMesh& w, const SideDraft& side, int k, const std::vector<Share>& nearest,
                              const Seen& seen, const PlaneFit& fit, const FitRoom& room, const VarianceComponents& components) {
  std::vector<double> all;
  const Stencil& s = seen.stencil;
  for (const auto& [v, counts] : nearest) {
    if (v == side.vertex[k]) continue;
    const Vec3 d = w.position[v] - side.position[k];
    const auto place = std::find_if(seen.used.begin(), seen.used.end(), [v = v](const Share& u) { return u.first == v; });
    all.push_back(counts * predicted_density(fit, room, components, {d.dot(s.e1), d.dot(s.e2) / s.depth, d.dot(s.e3)},
                                             place == seen.used.end() ? 0 : place->second));
  }
  return all;
}

/// Slope over the faces next to the rim, with `outward`, at which the surface that the last fit found continues `step` further.
double slope_ahead(const VertexFit& last, const Vec3& step, const Vec3& faces, const Vec3& outward) {
  const Vec3 ahead = last.normal - last.second * step;
  const double up = ahead.dot(faces);
  return up > 0 ? std::clamp(-ahead.dot(outward) / up, -max_tilt, max_tilt) : 0;
}

}  // namespace

bool is_known(const VertexFit& fit) { return fit.slope_variances < well_known * well_known; }

void SideFitting::go_on(int vertices) {
  for (const int end = next_ + std::min(vertices, left()); next_ < end; ++next_)
    if (!is_left_out(next_) && !fit_at(next_)) return;
}

bool SideFitting::fit_at(int place) {
  const int k = side_.looked_at(place);
  if (place > 0) {
    const Vec3 outward = side_.tangent[k].cross(side_.guess[k]);
    int before = place - 1;
    while (is_left_out(before)) --before;
    const int last = side_.looked_at(before);
    side_.guess[k] -= slope_ahead(fits_[last], side_.position[k] - side_.position[last], side_.guess[k], outward) * outward;
  }
  fits_[k] = fit(k);
  if (!nearest_.empty() || is_known(fits_[k])) return true;
  fits_.clear();
  next_ = 0;
  return false;
}

void SideFitting::fit_between() {
  FitsBetween between(side_, fits_);
  for (int place = 0; place <= side_.edges(); ++place) {
    if (!is_left_out(place)) continue;
    if (std::optional<VertexFit> told = between.at(side_.looked_at(place)))
      fits_[side_.looked_at(place)] = std::move(*told);
    else if (!fit_at(place))
      return;
  }
}

std::vector<VertexFit> SideFitting::fits() {
  if (!fits_.empty()) fit_between();
  return std::move(fits_);
}

VertexFit SideFitting::fit(int k) {
  measure(w_, side_, k, near_, search_, seen_);
  PlaneFit fit = fit_plane(seen_.stencil, components_, room_);
  if (std::abs(fit.mean[2]) > flat_enough * seen_.stencil.depth) {  // once more over the plane just found
    side_.guess[k] = seen_.stencil.e3 - fit.mean[2] / seen_.stencil.depth * seen_.stencil.e2;
    measure(w_, side_, k, near_, search_, seen_);
    fit = fit_plane(seen_.stencil, components_, room_);
  }
  refine(seen_.stencil, room_, fit);
  const Stencil& s = seen_.stencil;
  const Eigen::Vector2d over(1, 1 / s.depth);  // by what derivatives along and across are multiplied
  const double fx = fit.mean[1], fy = fit.mean[2] / s.depth;
  VertexFit at;
  at.normal = (s.e3 - fx * s.e1 - fy * s.e2).normalized();
  at.frame << s.e1, s.e2;
  Eigen::Matrix2d hessian;
  hessian << fit.mean[3], fit.mean[4], fit.mean[4], fit.mean[5];
  hessian = over.asDiagonal() * hessian * over.asDiagonal();
  at.second = at.frame * (hessian / std::sqrt(1 + fx * fx + fy * fy)) * at.frame.transpose();
  const FitVariances known = variances_of(room_);
  at.covariance = over.asDiagonal() * known.slopes * over.asDiagonal();
  at.slope_variances = at.covariance.trace();
  at.bend_variance = known.bend * std::pow(over[1], 4);
  if (!nearest_.empty()) at.density = densities(w_, side_, k, nearest_[k], seen_, fit, room_, components_);
  return at;
}

std::vector<VertexFit> fit_side(const LocalMesh& w, const VarianceComponents& components, const SideDraft& side,
                                const Neighborhood& near, const std::vector<std::vector<Share>>& nearest, SideSearch& search) {
  SideFitting fitting(w, components, side, near, nearest, search);
  fitting.go_on(fitting.left());
  return fitting.fits();
}

std::vector<std::vector<Share>> nearest_of(const LocalMesh& w, const SideDraft& side, SideSearch& search) {
  std::vector<std::vector<Share>> nearest;
  for (int k = 0; k <= side.edges(); ++k) {
    Seen seen;
    look(w, side, k, {1, false, false, false}, search, seen);
    nearest.push_back(std::move(seen.used));
  }
  return nearest;
}

namespace {

/// By how much the logarithm of the density of what is near vertex k of a side is higher by one fit than by another, for a vertex. Along
/// the side neighbors are judged together, for a single vertex says little.
double lead_of(const std::vector<VertexFit>& fit, const std::vector<VertexFit>& other, int k) {
  double sum = 0, count = 0;
  const int last = static_cast<int>(fit.size()) - 1;
  for (int j = std::max(k - pooled, 0); j <= std::min(k + pooled, last); ++j)
    for (std::size_t p = 0; p < fit[j].density.size(); ++p, ++count) sum += fit[j].density[p] - other[j].density[p];
  return count > 0 ? sum / count : 0;
}

/// Whether the faces next to a side lie in one plane, in which the side bends: then they are that plane, whatever lies behind them. Next to
/// a straight side they may be a strip of any surface.
bool lies_in_plane(const LocalMesh& w, const SideDraft& side) {
  const Vec3 n = w.area[side.face[0]];
  for (int f : side.face)
    if (degrees_between(w.area[f], n) > coplanar) return false;
  double turned = 0;
  for (const Vec3& t : side.tangent) turned = std::max(turned, degrees_between(t, side.tangent[0]));
  return turned > bent;
}

/// The plane of such faces.
VertexFit plane_of(const LocalMesh& w, const SideDraft& side) {
  VertexFit fit;
  fit.normal = w.area[side.face[0]].normalized();
  fit.second.setZero();
  fit.slope_variances = std::pow(coplanar * std::numbers::pi / 180, 2);
  fit.bend_variance = 0;
  fit.frame.col(0) = fit.normal.unitOrthogonal();
  fit.frame.col(1) = fit.normal.cross(fit.frame.col(0));
  fit.covariance = fit.slope_variances * Eigen::Matrix2d::Identity();
  return fit;
}

/// Sine of the angle by which a normal leans over a side's vertex, outwards or inwards, against the faces next to it.
double lean(const SideDraft& side, int k, const Vec3& normal) {
  return std::abs(normal.dot(side.tangent[k].cross(side.faces[k]))) / normal.norm();
}

/// By how much a plane at vertex k of a side may lean: twice as much as the faces next to the rim there and those within two steps from
/// them do. Where rings of faces see nothing but what lies far off, as in a plane that is meshed with long triangles, fits may lean
/// by anything.
double max_lean(const LocalMesh& w, const SideDraft& side, int k) {
  std::vector<int> near;
  for (int e = std::max(k - pooled, 0); e < std::min(k + pooled, side.edges()); ++e) near.push_back(side.face[e]);
  for (std::size_t at = 0, step = 0, end = near.size(); step < 2; ++step, end = near.size())
    for (; at < end; ++at)
      for (int c = w.part.offsets[near[at]]; c < w.part.offsets[near[at] + 1]; ++c)
        if (w.across[c] >= 0 && std::find(near.begin(), near.end(), w.across[c]) == near.end()) near.push_back(w.across[c]);
  double most = 0;
  for (int f : near)
    if (w.area[f].dot(side.faces[k]) > same_sheet * w.area[f].norm()) most = std::max(most, lean(side, k, w.area[f]));
  return always_plausible + 2 * most;
}

/// Variance of a side's vertices, by what each differs from its next neighbors along the side, up to three to each side of it,
/// interpolated. It is that of noise: what a smooth curve of edges that turn by x leaves is an edge times x^3 to x^5. Nothing where the
/// side is too short to tell.
std::optional<double> roughness(const SideDraft& side) {
  const int last = side.edges(), reach = std::min(last / 2, max_compared);
  if (reach < min_compared) return {};
  double sum = 0;
  for (int k = reach; k <= last - reach; ++k) {
    Vec3 off = side.position[k];
    double squares = 1;
    for (int j = k - reach; j <= k + reach; ++j) {
      if (j == k) continue;
      double weight = 1;  // Lagrange's
      for (int i = k - reach; i <= k + reach; ++i)
        if (i != j && i != k) weight *= (side.t[k] - side.t[i]) / (side.t[j] - side.t[i]);
      off -= weight * side.position[j];
      squares += weight * weight;
    }
    off -= side.tangent[k] * side.tangent[k].dot(off);
    sum += off.squaredNorm() / (2 * squares);
  }
  return sum / (last - 2 * reach + 1);
}

}  // namespace

double roughness(const std::array<SideDraft, 3>& drafts) {
  std::optional<double> least;
  for (const SideDraft& side : drafts)
    if (const std::optional<double> own = roughness(side)) least = std::min(*own, least.value_or(*own));
  return least.value_or(0);
}

Vec3 mean_of_facets(const LocalMesh& w, const SideDraft& side, int k) {
  const int v = side.vertex[k];
  Vec3 sum = Vec3::Zero();
  for (int f : w.part.faces_at(v)) {
    const std::span<const int> face = w.part[f];
    const std::size_t size = face.size(), c = std::find(face.begin(), face.end(), v) - face.begin();
    const Vec3 a = w.position[face[(c + 1) % size]] - w.position[v], b = w.position[face[(c + size - 1) % size]] - w.position[v];
    if (w.area[f].norm() > 0) sum += angle_between(a, b) * w.area[f].normalized();
  }
  return sum;
}

namespace {

/// Radians by which a side turns about an inner vertex, out of its faces.
double turn_at(const SideDraft& side, int k) {
  const Vec3 before = (side.position[k] - side.position[k - 1]).normalized(),
             after = (side.position[k + 1] - side.position[k]).normalized();
  return std::abs((after - before).dot(side.faces[k]));
}

/// Whether a side turns by so much that polynomials of its heights say little.
bool turns_coarsely(const SideDraft& side) {
  double squares = 0;
  for (int k = 1; k < side.edges(); ++k) squares += std::pow(turn_at(side, k), 2);
  return squares > coarse_turn * coarse_turn * (side.edges() - 1);
}

/// The variance of a side's planes that is due to how far it turns from edge to edge, which no fit sees: few points on an arc look like
/// those of a parabola. A side of one edge tells nothing of how it bends: what its planes differ by from the facets' mean.
double turn_variance(const LocalMesh& w, const SideDraft& side) {
  const int edges = side.edges();
  double sum = 0;
  if (edges == 1) {
    for (int k : {0, 1}) {
      const double differs = angle_between(mean_of_facets(w, side, k), side.normal[k]);
      sum += differs * differs / 2;
    }
    return sum;
  }
  for (int k = 1; k < edges; ++k) sum += std::pow(turn_at(side, k), 6) / (edges - 1);
  return sum * std::pow(expected_error_turn * std::min(1.0, std::pow(double(few_edges) / edges, 2)), 2);
}

/// The facets' means at the inner vertices of a side, if each is as near to the plane taken there as that is known: then there is
/// nothing against them, and next to strips of equal facets, as of cylinders and fillets, they are exact.
std::vector<Vec3> facets_that_agree(const LocalMesh& w, const SideDraft& side, const std::vector<double>& variance) {
  std::vector<Vec3> means;
  for (int k = 1; k < side.edges(); ++k) {
    const Vec3 mean = mean_of_facets(w, side, k).stableNormalized();
    const double differs = (mean - side.normal[k]).norm();
    if (!(differs <= always_plausible && differs <= agrees * std::sqrt(variance[k]))) return {};
    means.push_back(mean);
  }
  return means;
}

}  // namespace

SideFit choose(const LocalMesh& w, const std::vector<std::vector<VertexFit>>& fits, SideDraft& side, double rough) {
  SideFit result;
  const int edges = side.edges();
  const bool is_plane = fits.size() > 1 && lies_in_plane(w, side);  // a single fit knows it by itself
  const std::optional<VertexFit> plane = is_plane ? std::optional(plane_of(w, side)) : std::nullopt;
  const bool noisy = rough > noisy_rim * noisy_rim, coarse = turns_coarsely(side);
  std::vector<double> variances;  // of the planes taken
  for (int k = 0; k <= edges; ++k) {
    std::size_t best = 0;
    const double most = fits.size() > 1 ? max_lean(w, side, k) : 0;  // one alone is taken
    const bool doubtful = noisy || coarse || most > 2 * coarse_turn;
    const auto variance = [&](std::size_t f) {
      const double by_noise = known_by_ring * rough / (side.depth * side.depth * std::pow(neighborhoods[f].rings, 3));
      return std::max(fits[f][k].slope_variances, by_noise);
    };
    const auto doubt = [&](std::size_t f) {
      const double by_lean = known_by_lean * 0.5 * (most - always_plausible) / std::pow(neighborhoods[f].rings, 2);
      return std::max(variance(f), by_lean * by_lean);
    };
    const auto leans = [&](std::size_t f) {  // or may
      return std::max(lean(side, k, fits[f][k].normal), std::sqrt(fits[f][k].slope_variances));
    };
    for (std::size_t f = 1; f < fits.size(); ++f) {
      if (leans(best) > most && leans(f) < leans(best)) {
        best = f;
        continue;
      }
      if (leans(f) > most) continue;
      const double less_certain = std::max(0.5 * std::log(doubt(f) / doubt(best)), doubtful ? 0 : -by_some);
      if (lead_of(fits[f], fits[best], k) > (doubtful ? by_far : by_some) + less_certain) best = f;
    }
    const VertexFit& fit = plane ? *plane : fits[best][k];
    side.normal.push_back(fit.normal);
    side.second.push_back(fit.second);
    variances.push_back(plane ? fit.slope_variances : variance(best));
    result.bend_variance += fit.bend_variance / (edges + 1);
    if (k == 0 || k == edges) result.ends[k == 0 ? 0 : 1] = fit;
  }
  if (!plane) {
    const double turned = turn_variance(w, side);
    result.slope_variances = variances;
    result.turned = turned;
    for (double& variance : variances) variance += turned;
  } else {
    result.slope_variances = variances;
  }
  if (!noisy && !plane) {
    const std::vector<Vec3> means = facets_that_agree(w, side, variances);
    std::copy(means.begin(), means.end(), side.normal.begin() + 1);
  }
  return result;
}

}  // namespace tripatch
