#include "tripatch/estimate/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tripatch {
namespace {

using Square = PlaneFit::Square;
using Column = PlaneFit::Column;

constexpr int most_iterations = 14;   ///< of the variance components; the second half of them with all stencils
constexpr double settled = 0.03;      ///< relative change of a variance: no more iterations;
constexpr double nearly = 0.1;        ///< with half of the stencils, which only begin
constexpr double least_noise = 1e-7;  ///< of the stencil radius, as a deviation: keeps the normal equations solvable
/// Of the points or parameters: the least number that a component is an average over, for a number near 0 may come out below it.
constexpr double least_count = 1e-3;
/// Of the squared curvature that the faces beside the rim show: the least variance of second derivatives.
constexpr double bends_at_least = 0.3;

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

/// Weights of the rows of a fit, heaviest first, and which rows they are of. Between the fits of one stencil the order hardly changes:
/// what is in it already is put right by insertion.
class HeaviestFirst {
public:
  void sort(const Eigen::VectorXd& points, const PlaneFit::Column& prior) {
    const Index n = points.size();
    const auto weight = [&](Index k) { return k < n ? points[k] : prior[k - n]; };
    const bool known = !rows_.empty();
    if (!known) rows_.resize(n + fit_terms);
    for (Index k = 0; k < n + fit_terms; ++k) {
      if (!known) rows_[k].second = k;
      rows_[k].first = -weight(rows_[k].second);
    }
    if (!known || !insert(8 * rows_.size())) std::sort(rows_.begin(), rows_.end());
  }
  const std::vector<std::pair<double, Index>>& rows() const { return rows_; }  ///< minus the weight, row

private:
  /// False where that takes more moves than `most`.
  bool insert(std::size_t most) {
    for (std::size_t k = 1, moves = 0; k < rows_.size(); ++k) {
      const std::pair<double, Index> row = rows_[k];
      std::size_t at = k;
      for (; at > 0 && row < rows_[at - 1]; --at) rows_[at] = rows_[at - 1];
      rows_[at] = row;
      moves += k - at;
      if (moves > most) return false;
    }
    return true;
  }

  std::vector<std::pair<double, Index>> rows_;
};

/// The terms at (x, y).
void set_terms(double x, double y, double* out) {
  std::array<double, fit_degree + 1> xs, ys;  // powers
  xs[0] = ys[0] = 1;
  for (int d = 1; d <= fit_degree; ++d) {
    xs[d] = xs[d - 1] * x;
    ys[d] = ys[d - 1] * y;
  }
  [&]<std::size_t... K>(std::index_sequence<K...>) {  // unrolled: the plain loop costs twice as much
    ((out[K] = term[K].over * (xs[term[K].i] * ys[term[K].j])), ...);
  }(std::make_index_sequence<fit_terms>());
}

struct Coefficients {
  Column mean, prior;  // as of PlaneFit
};

/// Orthogonal triangularization of the weighted rows above those of the prior, heaviest first (Powell and Reid 1969), one column at
/// a time by Householder's reflections: `a`. The normal equations would square what the weights differ by, 1e7 and more where there is
/// no noise, and leave to rounding what few points do not tell.
Coefficients fit_weighted(const Stencil& s, const VarianceComponents& components, const Eigen::VectorXd& w, RowsOf24& a,
                          HeaviestFirst& order) {
  Coefficients r;
  for (int k = 0; k < fit_terms; ++k) r.prior[k] = 1 / components.term[term[k].i + term[k].j];
  r.prior[2] = 1 / (components.tilt + components.noise * s.faces_noise);
  r.prior[1] += 1 / (components.noise * s.slope_noise + components.term[s.slope_order] * s.slope_truncation * s.slope_truncation);
  const Index points = w.size(), rows = points + fit_terms;
  order.sort(w, r.prior);
  a.resize(rows, Eigen::NoChange);
  for (Index row = 0; row < rows; ++row) {
    const auto [minus_weight, k] = order.rows()[row];
    const double root = std::sqrt(-minus_weight);
    if (k < points) {
      a.row(row) = root * s.rows.row(k);
      continue;
    }
    a.row(row).setZero();
    a(row, k - points) = root;
    if (k == points + 2) a(row, fit_terms) = root * s.faces;
  }
  triangularize(a, fit_terms);
  for (int i = fit_terms - 1; i >= 0; --i) {
    const double* const row = a.data() + 24 * i;
    double left = row[fit_terms];
    for (int j = i + 1; j < fit_terms; ++j) left -= row[j] * r.mean[j];
    r.mean[i] = left / row[i];
  }
  return r;
}

/// The x with lower x = a.
Column whitened(const PlaneFit& fit, Column a) {
  for (int k = 0; k < fit_terms; ++k) {
    if (a[k] == 0) continue;
    a[k] /= fit.lower(k, k);
    const double entry = a[k];
    const double* const column = fit.lower.data() + k * fit_terms;
    for (int i = k + 1; i < fit_terms; ++i) a[i] -= entry * column[i];
  }
  return a;
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

/// Room for rows that is used again and again.
struct Room {
  RowsOf24 triangular, noisy;
};

Explained explain(const Stencil& s, const VarianceComponents& components, HeaviestFirst& order, Room& room) {
  Explained e;
  const Eigen::ArrayXd v = components.noise + components.truncation * s.g.array(), part = components.noise / v,
                       w = s.share.array() / v;
  const Coefficients fit = fit_weighted(s, components, w, room.triangular, order);
  const SquareOf24 covariance = inverse_of_gram(room.triangular, fit_terms);
  for (int j = 0; j < fit_terms; ++j) {
    const int d = term[j].i + term[j].j;
    if (d == 1) continue;
    e.sum[d] += fit.mean[j] * fit.mean[j];
    e.count[d] += std::max(1 - covariance(j, j) / components.term[d], least_count);
  }
  e.tilt = std::pow(fit.mean[2] - s.faces, 2);
  e.tilt_count = std::max(1 - covariance(2, 2) * fit.prior[2], least_count);
  // The points less the parameters that they determine: all, and those whose error is noise.
  room.noisy = (w * part).sqrt().matrix().asDiagonal() * s.rows;
  SquareOf24 gram = SquareOf24::Zero();
  add_gram(room.noisy, gram);
  double noisy = 0;
  for (int k = 0; k < fit_terms; ++k) {
    noisy += 2 * covariance.row(k).head(k).dot(gram.row(k).head(k));
    noisy += covariance(k, k) * gram(k, k);
  }
  const double points = s.share.sum(), noise_points = (s.share.array() * part).sum();
  const double all = fit_terms - covariance.diagonal().head<fit_terms>().dot(fit.prior);
  e.noise_count = std::max(noise_points - noisy, least_count * noise_points);
  e.truncation_count = std::max(points - noise_points - (all - noisy), least_count * (points - noise_points));
  const Eigen::ArrayXd square =
      s.share.array() * (s.rows.col(fit_terms) - s.rows.leftCols<fit_terms>() * fit.mean).array().square();
  e.noise = (part.square() * square).sum();
  e.truncation = (s.g.array() > 0).select((1 - part).square() * square / s.g.array(), 0.0).sum();
  return e;
}

/// The least that the components can be.
struct Floors {
  double radius, bend, least_bend;  // bend, least_bend: squared curvatures

  double noise() const { return least() * least(); }
  /// The variance of a term of this degree that makes heights of least() at the radius.
  double term(int d) const { return std::pow(least() / std::pow(radius, d), 2); }
  double least() const { return least_noise * radius; }
};

VarianceComponents components_of(const Explained& all, const Floors& floors) {
  const auto ratio = [](double above, double below) { return below > 0 ? above / below : 0; };
  VarianceComponents c;
  c.noise = std::max(ratio(all.noise, all.noise_count), floors.noise());
  c.truncation = std::max(ratio(all.truncation, all.truncation_count), 1e-6 * floors.term(fit_degree + 1));
  for (int d = 2; d <= fit_degree; ++d) c.term[d] = std::max(ratio(all.sum[d], all.count[d]), floors.term(d));
  c.term[2] = std::max(c.term[2], floors.least_bend);
  c.tilt = std::max(ratio(all.tilt, all.tilt_count), 1e-4 * floors.bend);
  return c;
}

bool have_settled(const VarianceComponents& now, const VarianceComponents& before, double radius, double enough) {
  const auto same = [=](double a, double b) { return std::abs(a - b) <= enough * b; };
  bool done = same(now.noise, before.noise) && same(now.truncation, before.truncation);
  for (int d = 2; d <= fit_degree; ++d) {
    const double unseen = 0.1 * now.noise / std::pow(radius, 2 * d);  // makes heights less than the noise
    done = done && same(now.term[d] + unseen, before.term[d] + unseen);
  }
  return done;
}

}  // namespace

void Stencil::set(const Vec3& place, Index k) {
  double* const row = rows.data() + 24 * k;
  set_terms(place[0], place[1], row);
  row[fit_terms] = place[2];
  std::fill(row + fit_terms + 1, row + 24, 0.0);
}

PlaneFit fit_plane(const Stencil& s, const VarianceComponents& components) {
  RowsOf24 triangular;
  HeaviestFirst order;
  const Coefficients fit =
      fit_weighted(s, components, s.share.array() / (components.noise + components.truncation * s.g.array()), triangular, order);
  return {fit.mean, fit.prior, triangular.topLeftCorner<fit_terms, fit_terms>().transpose()};
}

FitVariances variances_of(const PlaneFit& fit) {
  const std::array<Column, 3> half = {whitened(fit, Column::Unit(1)), whitened(fit, Column::Unit(2)),
                                      whitened(fit, Column::Unit(5))};
  FitVariances known;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) known.slopes(i, j) = half[i].dot(half[j]);
  known.bend = half[2].squaredNorm();
  return known;
}

double predicted_density(const PlaneFit& fit, const VarianceComponents& components, const Vec3& at, double share) {
  Column row;
  set_terms(at[0], at[1], row.data());
  const double square = at.squaredNorm(), cube = square * square * square;
  const double own = components.noise + components.truncation * (cube * cube);
  const double known = whitened(fit, row).squaredNorm();
  // of the sum of the weights at the point, what is left without it
  const double left = std::max(1 - share * known / own, 1e-9);
  const double off = (at[2] - row.dot(fit.mean)) / left, variance = own + known / left;
  return -0.5 * (std::log(2 * M_PI * variance) + off * off / variance);
}

/// MacKay 1992, eqs. 4.9 to 4.11: each component is the mean square of what it explains over the number of its well-determined
/// parameters. The slopes across the rim are those of the faces beside it but for a tilt of a component of its own: where the next
/// vertices are far, as beside a bevel of long strips, that is all there is to know them by, and its likeliest size is next to
/// nothing. Starts from no noise, so that coarse but clean meshes are not smoothed.
VarianceComponents estimate_components(const std::array<std::vector<Stencil>, 3>& stencils, double radius, double bend) {
  const Floors floors = {radius, std::max(bend, 0.01 / (radius * radius)), bends_at_least * bend};
  bend = floors.bend;
  VarianceComponents components;
  components.term = {1, 100, bend, bend * bend, std::pow(bend, 3), std::pow(bend, 4)};
  components.noise = floors.noise();
  components.tilt = bend;
  components.truncation = std::pow(bend, 5) / 720 / 720;
  std::array<std::vector<HeaviestFirst>, 3> orders;
  for (int i = 0; i < 3; ++i) orders[i].resize(stencils[i].size());
  Room room;
  bool all = false;  // every second stencil of a side tells nearly the same
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    Explained sum;
    for (int i = 0; i < 3; ++i)
      for (std::size_t k = all ? 0 : 1; k < stencils[i].size(); k += all ? 1 : 2)
        sum += explain(stencils[i][k], components, orders[i][k], room);
    const VarianceComponents before = std::exchange(components, components_of(sum, floors));
    const bool done = have_settled(components, before, radius, all ? settled : nearly);
    if (done && all) break;
    all = all || done || iteration >= most_iterations / 2;
  }
  return components;
}

}  // namespace tripatch
