#include "tripatch/estimate/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

using Column = PlaneFit::Column;

// Half and twice of these numbers were tried on 78 rims in meshes of balls, tori, saddles and fillets, of 1 to 16 edges a side, with noise
// of 0 to 2% of an edge. Two percentages tell by how much planes err more in the mean: with half, with twice of it.
/// Of the variance components, and of these at most with half of the stencils. On ten surfaces of 8 to 32 edges a side, with noise of 0 to
/// 3% of an edge, planes err by 3% less in the mean than after 14, 8 of them with half, without going further than asked for.
constexpr int max_iterations = 10, max_with_half = count::octet;
/// Power of the ratio by which the variances of noise and truncation change, which creep otherwise: over-relaxation. With 2 they swing,
/// and planes err by 20% more.
constexpr double further = factor::slight;
constexpr double settled = 0.03;         ///< relative change of a variance: no more iterations (0%, 0%);
constexpr double nearly = share::tenth;  ///< with half of the stencils, which only begin (0%, 0%)
constexpr double min_noise = 1e-7;       ///< of the stencil radius, as a deviation: keeps the normal equations solvable
/// Of the squared curvature that the faces next to the rim show: the least variance of second derivatives. 0%, -1%.
constexpr double bends_at_least = share::three_tenths;
/// Of the variance that a term of one degree more would have at least: so little is left out of a plane.
constexpr double min_truncation = tolerance::same;
/// Of the squared curvature that the faces show: the least variance of the slope across the rim against the faces next to it.
constexpr double min_tilt = tolerance::close;
/// Of the squared curvature of a circle as large as the stencils: what the iteration starts from at least, for it cannot grow from nothing.
constexpr double min_start = share::hundredth;
/// Of the variance of the noise: a term that makes heights of less is not seen, and whether it has settled does not matter.
constexpr double unseen_share = share::tenth;

/// Of a diagonal element of a normal matrix: with less left of it, rounding would count.
constexpr double min_pivot = tolerance::close;
/// Of a fit, after which its coefficients are those of an orthogonal triangularization.
constexpr int refinements = count::pair;

/// The term of x^i y^j / (i! j!), so that the coefficients are the derivatives of the height.
struct Term {
  int i, j;
  double over;  // 1 / (i! j!)
};
constexpr std::array<Term, fit_terms> term = [] {
  std::array<Term, fit_terms> all{};
  constexpr std::array<double, fit_degree + 1> factorial = {1, 1, 2, 6, 24, 120};
  for (int d = 0, k = 0; d <= fit_degree; ++d)
    for (int j = 0; j <= d; ++j, ++k) all[k] = {d - j, j, 1 / (factorial[d - j] * factorial[j])};
  return all;
}();

/// x^i y^j of the terms.
Column monomials(double x, double y) {
  Column out;
  out[0] = 1;
  for (int d = 1; d <= fit_degree; ++d) {
    for (int j = 0; j < d; ++j) out[place_of(d, j)] = out[place_of(d - 1, j)] * x;
    out[place_of(d, d)] = out[place_of(d - 1, d - 1)] * y;
  }
  return out;
}

/// Coefficients of the monomials from those of the terms.
Column of_monomials(Column of_terms) {
  for (int k = 0; k < fit_terms; ++k) of_terms[k] *= term[k].over;
  return of_terms;
}

Column prior_of(const Stencil& s, const VarianceComponents& components) {
  Column prior;
  for (int k = 0; k < fit_terms; ++k) prior[k] = 1 / components.term[term[k].i + term[k].j];
  prior[2] = 1 / (components.tilt + components.noise * s.faces_noise);
  prior[1] += 1 / (components.noise * s.slope_noise + components.term[s.slope_order] * s.slope_truncation * s.slope_truncation);
  return prior;
}

/// Orthogonal triangularization of the weighted rows above those of the prior, heaviest first (Powell and Reid 1969), one column at
/// a time by Householder's reflections. Normal equations square what the weights differ by, 1e7 and more where there is
/// no noise, and leave to rounding what few points do not tell.
void reflect(const Stencil& s, FitRoom& room) {
  const std::vector<double>& weight = room.heights.weight;
  const Index points = s.points, rows = points + fit_terms;
  room.order.clear();
  for (Index k = 0; k < rows; ++k) room.order.emplace_back(-(k < points ? weight[k] : room.prior[k - points]), k);
  std::sort(room.order.begin(), room.order.end());
  room.rows.resize(rows, Eigen::NoChange);
  for (Index row = 0; row < rows; ++row) {
    const auto [minus_weight, k] = room.order[row];
    const double root = std::sqrt(-minus_weight);
    room.rows.row(row).setZero();
    if (k < points) {
      const SampleBlock& of = s.heights[k / 8];
      room.rows.row(row).head<fit_terms>() = root * monomials(of.x[k % 8], of.y[k % 8]);
      room.rows(row, fit_terms) = root * of.z[k % 8];
      continue;
    }
    room.rows(row, k - points) = root / term[k - points].over;
    if (k == points + 2) room.rows(row, fit_terms) = root * s.faces;
  }
  triangularize(room.rows, fit_terms);
  room.root.topRows<fit_terms>() = room.rows.topRows<fit_terms>();
}

/// The root of the normal matrix; false where it is left to rounding.
bool take_root(const Stencil& s, const VarianceComponents& components, FitRoom& room) {
  room.prior = prior_of(s, components);
  sum_products(s.heights, {components.noise, components.truncation}, room.heights, room.root);
  for (int k = 0; k < fit_terms; ++k) room.root(k, k) += room.prior[k] / (term[k].over * term[k].over);
  room.root(2, fit_terms) += room.prior[2] * s.faces;
  return factor_symmetric(room.root, fit_terms, min_pivot);
}

/// Root and mean.
void fit(const Stencil& s, const VarianceComponents& components, FitRoom& room) {
  room.normal_equations = take_root(s, components, room);
  if (!room.normal_equations) reflect(s, room);
  for (int k = 0; k < fit_terms; ++k) room.over[k] = 1 / room.root(k, k);
  room.mean = room.root.col(fit_terms).head<fit_terms>();
  solve_upper(room.root, room.over, room.mean.data());
  for (int k = 0; k < fit_terms; ++k) room.mean[k] /= term[k].over;
}

/// Adds what the residuals of the rows themselves still ask for (corrected seminormal equations: Bjorck 1987). Returns how much that is, in
/// deviations of the coefficients.
double correct(const Stencil& s, FitRoom& room) {
  Column x = -room.prior.cwiseProduct(room.mean);
  x[2] += room.prior[2] * s.faces;
  ByMonomial sums;
  sum_residuals(s.heights, room.heights, of_monomials(room.mean).data(), sums);
  for (int k = 0; k < fit_terms; ++k) x[k] = x[k] / term[k].over - sums[k];
  solve_upper_transposed(room.root, room.over, x.data());
  const double off = x.norm();
  solve_upper(room.root, room.over, x.data());
  for (int k = 0; k < fit_terms; ++k) room.mean[k] += x[k] / term[k].over;
  return off;
}

/// What one stencil says of each component: a sum of squares, and the number of well-determined parameters that it is over.
struct Explained {
  std::array<double, fit_degree + 1> sum = {}, count = {};
  double noise = 0, truncation = 0, noise_count = 0, truncation_count = 0, tilt = 0, tilt_count = 0;

  void operator+=(const Explained& e) {
    for (int d = 0; d <= fit_degree; ++d) {
      sum[d] += e.sum[d];
      count[d] += e.count[d];
    }
    noise += e.noise;
    truncation += e.truncation;
    noise_count += e.noise_count;
    truncation_count += e.truncation_count;
    tilt += e.tilt;
    tilt_count += e.tilt_count;
  }
};

Explained explain(const Stencil& s, const VarianceComponents& components, FitRoom& room) {
  fit(s, components, room);
  const ByMonomial variances = coefficient_variances(room.root, room.over);
  Explained e;
  const auto count = [&](int k, double prior) {
    return std::max(1 - variances[k] / (term[k].over * term[k].over) * prior, tolerance::slight);
  };
  for (int k = 0; k < fit_terms; ++k) {
    const int d = term[k].i + term[k].j;
    if (d == 1) continue;
    e.sum[d] += room.mean[k] * room.mean[k];
    e.count[d] += count(k, 1 / components.term[d]);
  }
  e.tilt = std::pow(room.mean[2] - s.faces, 2);
  e.tilt_count = count(2, room.prior[2]);
  // The points less the parameters that they determine: of each what is noise, and the rest. Sums of what is left of the points, for the
  // difference of the two numbers is often rounding.
  const ExplainedHeights heights = explain_heights(s.heights, {components.noise, components.truncation}, room.heights,
                                                   of_monomials(room.mean).data(), room.root, room.over);
  e.noise = heights.noise;
  e.truncation = heights.truncation;
  e.noise_count = std::max(heights.noise_count, tolerance::slight * heights.noise_points);
  e.truncation_count = std::max(heights.truncation_count, tolerance::slight * heights.truncation_points);
  return e;
}

/// The least that the components can be.
struct Floors {
  double radius, bend, min_bend;  // bend, min_bend: squared curvatures

  double noise() const { return least() * least(); }
  /// The variance of a term of this degree that makes heights of least() at the radius.
  double term(int d) const { return std::pow(least() / std::pow(radius, d), 2); }
  double truncation() const { return min_truncation * term(fit_degree + 1); }
  double least() const { return min_noise * radius; }
};

VarianceComponents components_of(const Explained& all, const Floors& floors) {
  const auto ratio = [](double above, double below) { return below > 0 ? above / below : 0; };
  VarianceComponents c;
  c.noise = std::max(ratio(all.noise, all.noise_count), floors.noise());
  c.truncation = std::max(ratio(all.truncation, all.truncation_count), floors.truncation());
  for (int d = 2; d <= fit_degree; ++d) c.term[d] = std::max(ratio(all.sum[d], all.count[d]), floors.term(d));
  c.term[2] = std::max(c.term[2], floors.min_bend);
  c.tilt = std::max(ratio(all.tilt, all.tilt_count), min_tilt * floors.bend);
  return c;
}

/// Noise and truncation, on from what they were before.
void go_further(const VarianceComponents& before, const Floors& floors, VarianceComponents& now) {
  now.noise = std::max(now.noise * std::pow(now.noise / before.noise, further - 1), floors.noise());
  now.truncation = std::max(now.truncation * std::pow(now.truncation / before.truncation, further - 1), floors.truncation());
}

bool have_settled(const VarianceComponents& now, const VarianceComponents& before, double radius, double enough) {
  const auto same = [=](double a, double b) { return std::abs(a - b) <= enough * b; };
  bool done = same(now.noise, before.noise) && same(now.truncation, before.truncation);
  for (int d = 2; d <= fit_degree; ++d) {
    const double unseen = unseen_share * now.noise / std::pow(radius, 2 * d);
    done = done && same(now.term[d] + unseen, before.term[d] + unseen);
  }
  return done;
}

}  // namespace

PlaneFit fit_plane(const Stencil& s, const VarianceComponents& components, FitRoom& room) {
  fit(s, components, room);
  return {room.mean, room.prior};
}

void refine(const Stencil& s, FitRoom& room, PlaneFit& fit) {
  if (!room.normal_equations) return;
  const double enough = tolerance::solved * room.root.col(fit_terms).head<fit_terms>().norm();
  for (int pass = 0; pass < refinements; ++pass)
    if (correct(s, room) < enough) break;
  fit.mean = room.mean;
}

FitVariances variances_of(const FitRoom& room) {
  const auto [along, across, bend, both] = products_of_columns(room.root, room.over);
  FitVariances known;
  known.slopes << along, both, both, across;
  known.bend = bend / (term[5].over * term[5].over);
  return known;
}

double predicted_density(const PlaneFit& fit, const FitRoom& room, const VarianceComponents& components, const Vec3& at,
                         double share) {
  Column row = monomials(at[0], at[1]);
  const double square = at.squaredNorm(), cube = square * square * square;
  const double own = components.noise + components.truncation * (cube * cube);
  const double off_mean = at[2] - row.dot(of_monomials(fit.mean));
  solve_upper_transposed(room.root, room.over, row.data());
  const double known = row.squaredNorm();
  // of the sum of the weights at the point, what is left without it
  const double left = std::max(1 - share * known / own, tolerance::solved);
  const double off = off_mean / left, variance = own + known / left;
  return -0.5 * (std::log(2 * std::numbers::pi * variance) + off * off / variance);
}

/// MacKay 1992, eqs. 4.9 to 4.11: each component is the mean square of what it explains over the number of its well-determined
/// parameters. The slopes across the rim are those of the adjacent faces, plus a tilt with a component of its own. If the next
/// vertices are far, as next to a bevel of long strips, nothing else determines the slopes, and the tilt is almost 0. Starts from
/// no noise, so that coarse but clean meshes are not smoothed.
VarianceComponents estimate_components(const std::array<std::vector<Stencil>, 3>& stencils, double radius, double bend) {
  const Floors floors = {radius, std::max(bend, min_start / (radius * radius)), bends_at_least * bend};
  bend = floors.bend;
  VarianceComponents components;
  components.term = {1, 100, bend, bend * bend, std::pow(bend, 3), std::pow(bend, 4)};
  components.noise = floors.noise();
  components.tilt = bend;
  components.truncation = std::pow(bend, 5) / 720 / 720;
  bool all = false;                                      // every second stencil of a side tells nearly the same
  std::array<std::vector<const Stencil*>, 2> looked_at;  // every second, all
  for (const std::vector<Stencil>& side : stencils)
    for (std::size_t k = 0; k < side.size(); ++k) {
      if (k % 2 == 1) looked_at[0].push_back(&side[k]);
      looked_at[1].push_back(&side[k]);
    }
  std::vector<Explained> explained(looked_at[1].size());
  std::array<FitRoom, 2> rooms;
  const auto explain_some = [&](std::size_t from, std::size_t to, FitRoom& room) {
    for (std::size_t k = from; k < to; ++k) explained[k] = explain(*looked_at[all][k], components, room);
  };
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const std::size_t count = looked_at[all].size();
    both_at_once([&] { explain_some(0, count / 2, rooms[0]); }, [&] { explain_some(count / 2, count, rooms[1]); });
    Explained sum;
    for (std::size_t k = 0; k < count; ++k) sum += explained[k];
    const VarianceComponents before = std::exchange(components, components_of(sum, floors));
    const bool done = have_settled(components, before, radius, all ? settled : nearly);
    if (done && all) break;
    all = all || done || iteration + 1 >= max_with_half;
    go_further(before, floors, components);
  }
  return components;
}

}  // namespace tripatch
