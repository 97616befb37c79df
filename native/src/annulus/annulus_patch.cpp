#include "tripatch/annulus/annulus_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tripatch/annulus/match.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/places.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/patch/seam.h"
#include "tripatch/polygon/round.h"

namespace tripatch {
namespace {

constexpr int rib_numbers = 18;  ///< six vectors
/// Sines of angles between chords and ends that count as none, where their ratio is taken.
constexpr double no_bend = share::tenth;

/// Half the quintic whose middle lies on the circular arc between its ends: |P'| at the ends over the chord, by the cosine of the angle
/// between end and chord. 1 on straight ribs.
double length_over_chord(double cosine) { return 16 / ((1 + cosine) * (5 + std::sqrt(25 - 32 * cosine / (1 + cosine)))); }

struct RibMaker {
  const Side &first, &second;
  const RibDirections &out_of_first, &out_of_second;
  const PiecewisePolynomial& match;
  const AnnulusOptions& options;

  double second_at(double u) const {
    double shift = 0;
    match.taylor(u, 0, &shift);
    return wrapped_parameter(shift - u);
  }

  void at(double u, double* out) const;

private:
  Vec3 bent_as_side(const Side& side, double t, const Vec3& slope, const Vec3& bend) const {
    const Vec3 n = side.normal(t);
    return bend - n * n.dot(bend) + side_form(side, t)(slope) * n;
  }
};

bool is_tangent(SideContinuity c) { return c != SideContinuity::free && c != SideContinuity::g0; }

void RibMaker::at(double u, double* out) const {
  const double t = second_at(u);
  const Vec3 p = first.c(u), q = second.c(t), chord = q - p, e = chord.stableNormalized();
  const double length = chord.norm();
  const Vec3 from = is_tangent(options.continuity[0]) ? Vec3(-out_of_first(u)) : e,
             to = is_tangent(options.continuity[1]) ? out_of_second(t) : e;
  // With chords at more than 120 degrees to both ends ribs would grow without bound.
  const double cosine = std::max((from.dot(e) + to.dot(e)) / 2, -share::half);
  const double bend0 = std::hypot(e.cross(from).norm(), no_bend), bend1 = std::hypot(e.cross(to).norm(), no_bend);
  const double over = length_over_chord(cosine), share = 2 / (bend0 + bend1);
  const Vec3 slope0 = options.bulge[0] * length * over * share * bend1 * from,
             slope1 = options.bulge[1] * length * over * share * bend0 * to;
  Vec3 second0 = 2 * over * over * length * (e - e.dot(from) * from), second1 = -2 * over * over * length * (e - e.dot(to) * to);
  if (options.continuity[0] == SideContinuity::g2) second0 = bent_as_side(first, u, slope0, second0);
  if (options.continuity[1] == SideContinuity::g2) second1 = bent_as_side(second, t, slope1, second1);
  Eigen::Map<Eigen::Matrix<double, 3, 6>> all(out);
  all << p, slope0, second0, q, slope1, second1;
}

void measure_patch(const RibMaker& maker, AnnulusPatch& made) {
  std::array<double, 2> squares = {0, 0};
  std::array<double, rib_numbers> rib{};
  for (int k = 0; k < seam_samples; ++k) {
    const double u = (k + 0.5) / seam_samples, t = maker.second_at(u);
    PlanePoints places(2, 2);
    for (int i = 0; i < 2; ++i) places.row(i) = made.patch->place(u, i);
    const Points normals = made.patch->normals(as_rows(places));
    for (int i = 0; i < 2; ++i) {
      const Vec3 known = i == 0 ? maker.first.normal(u) : maker.second.normal(t);
      const double angle = degrees_between(Vec3(normals.row(i)), known);
      made.seam_angle_max[i] = std::max(made.seam_angle_max[i], angle);
      squares[i] += angle * angle / seam_samples;
    }
    maker.at(u, rib.data());
    made.rib_turn += degrees_between(Vec3::Map(&rib[3]), Vec3::Map(&rib[12])) / seam_samples;
    PlanePoints along(9, 2);
    for (int j = 0; const double v : evenly(8)) along.row(j++) = made.patch->place(u, v);
    const Points points = made.patch->positions(as_rows(along));
    for (int j = 0; j < 8; ++j) made.rib_length += (points.row(j + 1) - points.row(j)).norm() / seam_samples;
  }
  for (int i = 0; i < 2; ++i) made.seam_angle_rms[i] = std::sqrt(squares[i]);
}

/// Radius of the inner circle at which the ring in the plane is about as wide, by its length, as in space.
double inner_radius(const RibMaker& maker) {
  double width = 0;
  for (int k = 0; k < seam_samples; ++k) {
    const double u = static_cast<double>(k) / seam_samples;
    width += (maker.second.c(maker.second_at(u)) - maker.first.c(u)).norm() / seam_samples;
  }
  const double around = (arc_length(maker.first.c) + arc_length(maker.second.c)) / 2;
  return around / (around + 2 * std::numbers::pi * width);
}

}  // namespace

Vec2 AnnulusSurface::place(double u, double v) const { return (1 - v * (1 - inner_)) * on_circle(u); }

template <int N>
void AnnulusSurface::evaluate_order(const double* b, Index n, double* out) const {
  std::array<double, rib_numbers*(max_order + 1)> taylor{};
  for (Index row = 0; row < n; ++row) {
    const Vec2 at(b[3 * row], b[3 * row + 1]);
    const double squared = std::max(at.squaredNorm(), tolerance::rounding);
    // log(z / z0) = w - w^2 / 2 + ... of w = (z - z0) / z0: its imaginary part is the angle
    const Jet<N> re = Jet<N>::linear(0, at[0] / squared, at[1] / squared),
                 im = Jet<N>::linear(0, -at[1] / squared, at[0] / squared);
    Jet<N> log_re(0.0), log_im(0.0);
    for (int k = N; k > 0; --k) {
      const double factor = (k % 2 == 1 ? 1.0 : -1.0) / k;
      const Jet<N> sum = log_re + factor, next = sum * re - log_im * im;
      log_im = sum * im + log_im * re;
      log_re = next;
    }
    const Jet<N> u = log_im * (0.5 / std::numbers::pi) + wrapped_parameter(std::atan2(at[1], at[0]) / (2 * std::numbers::pi));
    const Jet<N> x = Jet<N>::linear(at[0], 1, 0), y = Jet<N>::linear(at[1], 0, 1);
    const Jet<N> v = (1.0 - sqrt(x * x + y * y + (squared - at.squaredNorm()))) * (1 / (1 - inner_)), w = 1.0 - v;
    ribs_.taylor(u.value(), N, taylor.data());
    const Jet<N> v2 = v * v, v3 = v2 * v, w2 = w * w, w3 = w2 * w;
    const std::array<Jet<N>, 6> basis = {w3 * (1.0 + 3.0 * v + 6 * v2), w3 * v * (1.0 + 3.0 * v),    0.5 * (w3 * v2),
                                         v3 * (1.0 + 3.0 * w + 6 * w2), -(v3 * w * (1.0 + 3.0 * w)), 0.5 * (v3 * w2)};
    JetPoint<N> p(Vec3::Zero());
    for (int k = 0; k < 6; ++k)
      for (int i = 0; i < 3; ++i) p.x[i] += basis[k] * compose<N>(taylor.data() + 3 * k + i, rib_numbers, u);
    out = store(p, out);
  }
}

void AnnulusSurface::evaluate(const double* b, Index n, int order, double* out) const {
  with_order<0, max_order>(order, [&](auto constant) { evaluate_order<constant.value>(b, n, out); });
}

double AnnulusPatch::u_of_second(double t) const {
  const auto beyond = [&](double u) {  // grows with u
    double shift = 0;
    match.taylor(wrapped_parameter(u), 0, &shift);
    return u - shift + t;
  };
  // where it is 0, on a turn about there
  double low = -beyond(0) - 1, high = low + 2;
  for (int k = 0; k < 60; ++k) (beyond((low + high) / 2) < 0 ? low : high) = (low + high) / 2;
  return wrapped_parameter((low + high) / 2);
}

PlanePoints OverAnnulus::on_side(int side, const std::vector<double>& t) const {
  PlanePoints places(static_cast<Index>(t.size()), 2);
  for (std::size_t k = 0; k < t.size(); ++k)
    places.row(static_cast<Index>(k)) = side == 0 ? made_.patch->place(t[k], 0) : made_.patch->place(made_.u_of_second(t[k]), 1);
  return places;
}

AnnulusPatch annulus_patch(const Side& first, const Side& second, const AnnulusOptions& options) {
  for (const Side* side : {&first, &second})
    if (!((side->c(1) - side->c(0)).norm() <= tolerance::same * arc_length(side->c)))
      throw CodedRefusal(Code::ring_boundary_open);
  for (int i = 0; i < 2; ++i)
    if (options.continuity[i] == SideContinuity::g2 && (i == 0 ? first : second).q.empty())
      throw CodedRefusal(Code::curvature_unknown, {{"side", i}});
  AnnulusPatch made;
  const RibDirections out_of_first(first), out_of_second(second);
  made.match = match_boundaries(first, second, out_of_first, out_of_second);
  const RibMaker maker{first, second, out_of_first, out_of_second, made.match, options};
  const auto ribs = [&](std::span<const double> u, std::span<double> out) {
    for (std::size_t k = 0; k < u.size(); ++k) maker.at(u[k], &out[rib_numbers * k]);
  };
  made.patch = std::make_shared<AnnulusSurface>(PiecewisePolynomial::fit(ribs, rib_numbers, tolerance::fit), inner_radius(maker));
  for (int i = 0; i < 2; ++i) made.continuity[i] = kept_by(options.continuity[i]);
  measure_patch(maker, made);
  return made;
}

}  // namespace tripatch
