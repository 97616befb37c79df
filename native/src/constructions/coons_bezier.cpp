#include "tripatch/constructions/coons_bezier.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <numbers>
#include <string>
#include <utility>

#include "tripatch/math/linear.h"
#include "tripatch/math/places.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

using Exponents = std::array<int, 3>;

/// Degree up to which the extremals' gradient is zero to 1e-13 of the net; the condition of their systems grows to 3e11 at degree 20.
constexpr int well_conditioned_degree = count::dozen;

/// All (i, j, k) of a degree in the order of a net.
std::vector<Exponents> exponents(int degree) {
  std::vector<Exponents> all;
  for (int r = 0; r <= degree; ++r)
    for (int k = 0; k <= r; ++k) all.push_back({degree - r, r - k, k});
  return all;
}

bool interior(const Exponents& e) { return e[0] > 0 && e[1] > 0 && e[2] > 0; }
Index row(const Exponents& e) { return BezierTriangle::row(e[0], e[1], e[2]); }

double factorial(int n) { return std::tgamma(n + 1.0); }
double multinomial(const Exponents& e) {
  return factorial(e[0] + e[1] + e[2]) / (factorial(e[0]) * factorial(e[1]) * factorial(e[2]));
}

/// Inner products of the Bernstein polynomials of one degree over the unit triangle (of area 1/2).
Eigen::MatrixXd bernstein_gram(int degree) {
  const std::vector<Exponents> all = exponents(degree);
  Eigen::MatrixXd gram(all.size(), all.size());
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = 0; b < all.size(); ++b) {
      const Exponents sum = {all[a][0] + all[b][0], all[a][1] + all[b][1], all[a][2] + all[b][2]};
      gram(a, b) = multinomial(all[a]) * multinomial(all[b]) / multinomial(sum) / ((2 * degree + 1) * (2 * degree + 2));
    }
  return gram;
}

/// The net of x_uv as a matrix on the net of x: the derivatives in the directions e_p - e_s and e_q - e_s, where s is the vertex
/// at which both u and v vanish.
Eigen::MatrixXd mixed_derivative(int degree, int p, int q, int s) {
  const std::vector<Exponents> rows = exponents(degree - 2);
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(rows.size(), BezierTriangle::net_size(degree));
  const double factor = degree * (degree - 1.0);
  for (std::size_t a = 0; a < rows.size(); ++a) {
    const auto add = [&](int first, int second, double weight) {
      Exponents e = rows[a];
      ++e[first];
      ++e[second];
      d(a, row(e)) += factor * weight;
    };
    add(p, q, 1);
    add(p, s, -1);
    add(q, s, -1);
    add(s, s, 1);
  }
  return d;
}

struct Split {
  std::vector<Index> inside, rim;  // rows of the net
};
Split split(int degree) {
  Split s;
  for (const Exponents& e : exponents(degree)) (interior(e) ? s.inside : s.rim).push_back(row(e));
  return s;
}

/// What the interior of the extremals of one degree solves: inside x + rim y = 0, y the points of the rim. Made once.
struct Extremal {
  Split points;
  Eigen::MatrixXd inside, rim;
};

const Extremal& extremal(int degree, bool symmetric) {
  static std::mutex mutex;
  static std::map<std::pair<int, bool>, Extremal> cache;
  const std::lock_guard<std::mutex> lock(mutex);
  auto [place, is_new] = cache.try_emplace({degree, symmetric});
  if (is_new) {
    Extremal& e = place->second;
    e.points = split(degree);
    const Eigen::MatrixXd form = coons_form(degree, symmetric);
    e.inside = submatrix(form, e.points.inside, e.points.inside);
    e.rim = submatrix(form, e.points.inside, e.points.rim);
  }
  return place->second;
}

/// Definition 1 read on the polygons: with shift 1 the net of degree n + 1 of the transfinite Coons patch of curves of degree n;
/// with shift 0 a net of degree n, the Coons interpolant of the boundary polygons themselves.
Points coons_net(const BoundaryCurves& boundary, int shift) {
  const int n = static_cast<int>(boundary[0].rows()) - 1, degree = n + shift;
  // P_(n-k,k,0) and so on: the control point on side s that lies `k` steps from corner s + 1.
  const auto on = [&](int s, int k) -> Vec3 { return boundary[s].row(k); };
  const std::array<Vec3, 3> corner = {on(2, 0), on(0, 0), on(1, 0)};
  Points net(BezierTriangle::net_size(degree), 3);
  for (const Exponents& e : exponents(degree)) {
    Vec3 p = Vec3::Zero();
    for (int c = 0; c < 3; ++c) {
      if (e[c] == 0) continue;
      const int next = (c + 1) % 3, previous = (c + 2) % 3;
      // corner c's term: the point with exponent e[next] on the side from c to next, and the same on the side to previous
      p += e[c] * (on(previous, e[next]) + on(next, n - e[previous]) - corner[c]);
    }
    net.row(row(e)) = p / std::max(degree, 1);
  }
  for (int i = 0; i < 3; ++i) {  // the curves themselves, free of rounding
    const Points curve = shift == 1 ? elevated_curve(boundary[i]) : boundary[i];
    for (int k = 0; k < degree || k == 0; ++k) net.row(side_row(degree, i, k)) = curve.row(k);
  }
  return net;
}

BezierTriangle solve_mask(const BoundaryCurves& boundary, CoonsKind kind, double alpha, Messages* warnings) {
  const int n = static_cast<int>(boundary[0].rows()) - 1;
  Points net = coons_net(boundary, 0);
  const Split points = split(n);
  if (points.inside.empty()) return BezierTriangle(std::move(net));
  const Eigen::MatrixXd equations = mask_equations(n, kind, alpha);
  Eigen::MatrixXd inside(equations.rows(), points.inside.size());
  for (Index k = 0; k < inside.cols(); ++k) inside.col(k) = equations.col(points.inside[k]);
  // Unknown: the distance from the Coons net of the polygons. Where the system is singular the decomposition gives the shortest.
  const Points right = -Points(equations * net);
  const auto [correction, rank_found] = minimum_norm_least_squares(inside, right, tolerance::rounding);
  if (rank_found < inside.cols()) {
    std::vector<Parameter> parameters = {{"degree", n}, {"rank", rank_found}, {"unknowns", inside.cols()}};
    if (kind != CoonsKind::mask) parameters.push_back({"alpha", alpha});
    const double left = (Points(inside * correction) - right).cwiseAbs().maxCoeff();
    const double size = (net.rowwise() - net.row(0)).cwiseAbs().maxCoeff();
    if (left > tolerance::solved * size) throw CodedRefusal(Code::coons_without_solution, std::move(parameters));
    if (warnings) warnings->push_back({Code::coons_singular, std::move(parameters)});
  }
  for (Index k = 0; k < correction.rows(); ++k) net.row(points.inside[k]) += correction.row(k);
  return BezierTriangle(std::move(net));
}

/// Of the curve through a side's rim vertices: through even ones of more it would swing between them (Runge).
constexpr int max_side_degree = count::dozen;

/// Bernstein polynomials of a degree at parameters t, one a column.
Eigen::MatrixXd bernstein(int degree, const std::vector<double>& t) {
  Eigen::MatrixXd values(t.size(), degree + 1);
  for (std::size_t r = 0; r < t.size(); ++r)
    for (int k = 0; k <= degree; ++k)
      values(r, k) = multinomial({degree - k, k, 0}) * std::pow(1 - t[r], degree - k) * std::pow(t[r], k);
  return values;
}

/// Least-squares Bezier curve of a degree through samples of a side; the largest distance that is left.
double fit_curve(const PiecewisePolynomial& c, const std::vector<double>& t, int degree, Points& curve) {
  Points samples(t.size(), 3);
  for (std::size_t k = 0; k < t.size(); ++k) samples.row(k) = c(t[k]);
  const Vec3 origin = samples.colwise().mean();  // far from the origin digits would be lost
  samples.rowwise() -= origin.transpose();
  const Eigen::MatrixXd basis = bernstein(degree, t);
  curve = least_squares(basis, samples);
  const double left = (Points(basis * curve) - samples).rowwise().norm().maxCoeff();
  curve.rowwise() += origin.transpose();
  return left;
}

Points bezier_side(const Ribbon& ribbon, int i, double size) {
  Points curve;
  std::vector<double> t;
  const std::vector<double>& breaks = ribbon.c.breaks();
  for (std::size_t p = 0; p + 1 < breaks.size(); ++p)
    for (const double s : scattered(7)) t.push_back(breaks[p] + s * (breaks[p + 1] - breaks[p]));
  if (breaks.size() <= 4)  // enough samples for any degree
    for (int k = 0; k < 2 * max_side_degree; ++k)
      t.push_back(0.5 - 0.5 * std::cos(std::numbers::pi * (k + 0.5) / (2 * max_side_degree)));
  const double rounding = tolerance::fit * size + std::numeric_limits<double>::epsilon() * ribbon.c(0.5).norm();
  for (int degree = 1; degree <= max_side_degree; ++degree)
    if (fit_curve(ribbon.c, t, degree, curve) <= rounding) return curve;
  const int degree = static_cast<int>(ribbon.rim.size()) - 1;
  if (degree < 1) throw CodedRefusal(Code::side_is_no_bezier_curve, {{"side", i}, {"degree", max_side_degree}});
  if (degree > max_side_degree)
    throw CodedRefusal(Code::side_has_many_vertices,
                       {{"side", i}, {"vertices", degree + 1}, {"degree", max_side_degree}, {"most", max_side_degree + 1}});
  if (!(fit_curve(ribbon.c, ribbon.rim, degree, curve) <= tolerance::solved * size))
    throw CodedRefusal(Code::no_bezier_curve_through_rim, {{"side", i}, {"degree", degree}});
  return curve;
}

void check(const BoundaryCurves& boundary) {
  double size = 0;
  for (int i = 0; i < 3; ++i) {
    const std::string name = "boundary[" + std::to_string(i) + "]";
    if (boundary[i].rows() == 0)
      throw CodedArgument(Code::out_of_range, {{"name", "len(" + name + ")"}, {"least", 1}, {"value", 0}});
    if (boundary[i].rows() != boundary[0].rows())
      throw CodedArgument(Code::wrong_shape, {{"name", name},
                                              {"shape", "(" + std::to_string(boundary[0].rows()) + ", 3)"},
                                              {"given", "(" + std::to_string(boundary[i].rows()) + ", 3)"}});
    for (Index k = 0; k < boundary[i].rows(); ++k)
      if (!boundary[i].row(k).allFinite())
        throw CodedArgument(Code::not_finite, {{"name", name + "[" + std::to_string(k) + "]"}});
    size = std::max(size, (boundary[i].rowwise() - boundary[0].row(0)).cwiseAbs().maxCoeff());
  }
  const Index n = boundary[0].rows() - 1;
  if (n > max_boundary_degree)
    throw CodedArgument(Code::out_of_range, {{"name", "degree"}, {"from", 0}, {"to", max_boundary_degree}, {"value", n}});
  for (int i = 0; i < 3; ++i) {
    const double gap = (boundary[i].row(n) - boundary[(i + 1) % 3].row(0)).norm();
    if (!(gap <= tolerance::solved * size))
      throw CodedArgument(Code::surfaces_apart, {{"first", "boundary[" + std::to_string(i) + "]"},
                                                 {"second", "boundary[" + std::to_string((i + 1) % 3) + "]"},
                                                 {"corner", (i + 2) % 3},
                                                 {"gap", gap}});
  }
}

}  // namespace

Eigen::MatrixXd coons_form(int degree, bool symmetric) {
  const Index size = BezierTriangle::net_size(degree);
  Eigen::MatrixXd form = Eigen::MatrixXd::Zero(size, size);
  if (degree < 2) return form;
  const Eigen::MatrixXd gram = bernstein_gram(degree - 2);
  for (int s = symmetric ? 0 : 2; s < 3; ++s) {
    const Eigen::MatrixXd d = mixed_derivative(degree, (s + 1) % 3, (s + 2) % 3, s);
    const Eigen::MatrixXd half = d.transpose() * gram;
    form += half * d;
  }
  return form;
}

double coons_energy(const BezierTriangle& triangle, bool symmetric) {
  const int n = triangle.degree();
  if (n < 2) return 0;
  // Through the net of x_uv, not through C: there nothing cancels.
  const Eigen::MatrixXd gram = bernstein_gram(n - 2);
  double energy = 0;
  for (int s = symmetric ? 0 : 2; s < 3; ++s) {
    const Points d = mixed_derivative(n, (s + 1) % 3, (s + 2) % 3, s) * triangle.net();
    energy += (d.transpose() * gram * d).trace();
  }
  return energy;
}

Eigen::MatrixXd mask_equations(int degree, CoonsKind kind, double alpha) {
  std::vector<std::pair<Exponents, double>> mask;  // weights of the neighbors
  if (kind == CoonsKind::mask) {
    mask = {{{-1, 0, 1}, 0.5}, {{-1, 1, 0}, -0.5}, {{0, -1, 1}, 0.5}, {{0, 1, -1}, 0.5}, {{1, -1, 0}, -0.5}, {{1, 0, -1}, 0.5}};
  } else if (kind == CoonsKind::permanence) {
    const double beta = (1 - 3 * alpha) / 6;
    mask = {{{-1, -1, 2}, alpha}, {{-1, 2, -1}, alpha}, {{2, -1, -1}, alpha}, {{-1, 0, 1}, beta}, {{-1, 1, 0}, beta},
            {{0, -1, 1}, beta},   {{0, 1, -1}, beta},   {{1, -1, 0}, beta},   {{1, 0, -1}, beta}};
  } else {
    throw InvalidArgument("only mask and permanence nets have mask equations");
  }
  const std::vector<Exponents> all = exponents(degree);
  const Index inside = std::count_if(all.begin(), all.end(), interior);
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(inside, static_cast<Index>(all.size()));
  Index r = 0;
  for (const Exponents& e : all) {
    if (!interior(e)) continue;
    equations(r, row(e)) = 1;
    for (const auto& [step, weight] : mask) equations(r, row({e[0] + step[0], e[1] + step[1], e[2] + step[2]})) -= weight;
    ++r;
  }
  return equations;
}

BezierTriangle coons_bezier(const BoundaryCurves& boundary, CoonsKind kind, std::optional<double> alpha, Messages* warnings) {
  check(boundary);
  if (alpha && kind != CoonsKind::permanence)
    throw CodedArgument(Code::option_needs, {{"option", "alpha"}, {"needed", "kind='permanence'"}});
  if (alpha && !std::isfinite(*alpha)) throw CodedArgument(Code::not_finite, {{"name", "alpha"}});
  const int n = static_cast<int>(boundary[0].rows()) - 1;
  switch (kind) {
    case CoonsKind::discrete: return BezierTriangle(coons_net(boundary, 1));
    case CoonsKind::mask:
    case CoonsKind::permanence: return solve_mask(boundary, kind, alpha.value_or(coons_alpha), warnings);
    case CoonsKind::extremal:
    case CoonsKind::extremal_symmetric: break;
  }
  Points net = coons_net(boundary, 0);
  if (n >= 3) {
    const Extremal& e = extremal(n, kind == CoonsKind::extremal_symmetric);
    Eigen::MatrixXd rim(e.points.rim.size(), 3);
    for (Index k = 0; k < rim.rows(); ++k) rim.row(k) = net.row(e.points.rim[k]);
    const Eigen::MatrixXd inside = solve_symmetric(e.inside, -Eigen::MatrixXd(e.rim * rim));
    for (Index k = 0; k < inside.rows(); ++k) net.row(e.points.inside[k]) = inside.row(k);
  }
  if (n > well_conditioned_degree && warnings)
    warnings->push_back({Code::ill_conditioned, {{"degree", n}, {"most", well_conditioned_degree}}});
  return BezierTriangle(std::move(net));
}

BoundaryCurves bezier_sides(const Boundary& boundary) {
  BoundaryCurves curves;
  Index points = 0;
  for (int i = 0; i < 3; ++i) {
    curves[i] = bezier_side(boundary.ribbons[i], i, boundary.size);
    points = std::max(points, curves[i].rows());
  }
  for (int i = 0; i < 3; ++i) {
    while (curves[i].rows() < points) curves[i] = elevated_curve(curves[i]);
    curves[i].row(0) = boundary.ribbons[i].c(0);
  }
  for (int i = 0; i < 3; ++i) curves[i].row(points - 1) = curves[(i + 1) % 3].row(0);
  return curves;
}

SurfacePtr coons_fill(const Boundary& boundary, CoonsKind kind, std::optional<double> alpha, Messages* warnings) {
  BoundaryCurves curves = bezier_sides(boundary);
  if (kind == CoonsKind::mask && curves[0].rows() % 2 == 1)
    for (Points& curve : curves) curve = elevated_curve(curve);
  return std::make_shared<BezierTriangle>(coons_bezier(curves, kind, alpha, warnings));
}

}  // namespace tripatch
