#include "tripatch/polygon/joined.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include "tripatch/boundary/side.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/quadrature.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// For arc length along a piece: the speed of a cubic that doubles several times is even to 3e-11 with so many nodes, with half of them
/// to 5e-7; of the rounds half would do.
constexpr int length_nodes = count::dozen, newton_rounds = count::half_dozen;
/// Where a curve ends without speed Newton's steps only halve what is left: the halvings behind them.
constexpr int halvings = count::halvings;
/// To which a parameter is known: pieces of a side with kinks are so short that its last digit is more than that part of their length.
constexpr double parameter_rounds = 4 * std::numeric_limits<double>::epsilon();

/// A side whose speed falls below this share of its length somewhere is run through by length: the derivative across it that its ends
/// ask for counts in its speed. Between three and four sides of spheres and saddles, one of which slows down evenly, patches are up to
/// 1e-5 of the size off from 0.3 on, 1e-4 at 0.1, the size itself at 0.01 and ten thousand times the size at 0.0001.
constexpr double min_speed = share::quarter;
constexpr int speed_places = count::many_places;  ///< where speeds are looked at; the ends are two of them
/// The logarithm of a side's speed may change at this rate (over the whole side) at most, else all sides of a patch are run through by
/// length. Of 29 faces of CAD files, with the faces' own planes, the 18 with faster sides came 0.4 to 290 times as near by length, 3.4 times
/// in the geometric mean; quadrangles on known surfaces between lines of their charts, which are slower, 0.9 times.
constexpr double max_change = share::half;

std::array<double, speed_places + 1> speeds(const PiecewisePolynomial& c) {
  std::array<double, speed_places + 1> speed;
  for (int k = 0; k <= speed_places; ++k) speed[k] = c.derivative_at(static_cast<double>(k) / speed_places).norm();
  return speed;
}

bool nearly_stands_still(const PiecewisePolynomial& c) { return std::ranges::min(speeds(c)) < min_speed * arc_length(c); }

bool changes_speed(const PiecewisePolynomial& c) {
  const auto speed = speeds(c);
  for (int k = 0; k < speed_places; ++k)
    if (!(std::abs(std::log(speed[k + 1] / speed[k])) * speed_places <= max_change)) return true;
  return false;
}

/// To what, of the largest value, fields by length are met, and how often a piece is halved for that at most.
struct Digits {
  double position = tolerance::fit, across = tolerance::fit, bend = tolerance::fit;
  int halved = 9, bend_halved = 9;
  bool all = true;  ///< of lengths too, however long that takes
};

/// Sides with kinks are polynomials on pieces as short as can be, fitted to 1e-13 of what may be rounded to 1e-12; what is made of their
/// derivatives has fewer digits (1e-10 of a plane is 1e-8 degrees), and no polynomial of length follows noise. width: of the piece; the
/// shorter, the less often it is halved.
Digits digits_of_kinked(double width) {
  return {tolerance::rounding, tolerance::solved, tolerance::solved, std::max(2, 9 + std::ilogb(width)), 2, false};
}

constexpr int fit_degree = count::degree;  ///< of the fits: the usual one

/// Arc length along a part of a side on which it is a polynomial.
class Stretch {
public:
  Stretch(const Side& side, double from, double to, const Digits& digits = {})
      : side_(side), from_(from), to_(to), length_(upto(to)), digits_(digits) {}
  double length() const { return length_; }
  double upto(double t) const {
    static const GaussNodes rule = gauss(length_nodes);
    double sum = 0;
    for (int k = 0; k < length_nodes; ++k) sum += rule.w[k] * side_.c.derivative_at(from_ + rule.x[k] * (t - from_)).norm();
    return sum * (t - from_);
  }
  /// The parameter where a share of the length is reached.
  double at(double share) const {
    double t = from_ + share * (to_ - from_);
    for (int k = 0; k < newton_rounds; ++k) {
      const double speed = side_.c.derivative_at(t).norm(), off = upto(t) - share * length_;
      if (!digits_.all && std::abs(off) <= tolerance::fit * length_ + parameter_rounds * speed) return t;
      if (!(speed > 0)) break;
      t = std::clamp(t - off / speed, from_, to_);
    }
    return std::abs(upto(t) - share * length_) <= tolerance::fit * length_ ? t : halved(share);
  }

  PiecewisePolynomial position() const {
    return field([&](double t) { return side_.c(t); }, digits_.position, digits_.halved);
  }
  PiecewisePolynomial across() const {
    return field([&](double t) { return upright_across(side_, moving(t)); }, digits_.across, digits_.halved);
  }
  PiecewisePolynomial bend() const {
    return field([&](double t) { return upright_bend(side_, moving(t)); }, digits_.bend, digits_.bend_halved);
  }

private:
  template <class F>
  PiecewisePolynomial field(const F& f, double tolerance, int depth) const {
    return PiecewisePolynomial::fit(
        [&](std::span<const double> shares, std::span<double> out) {
          if (!std::ranges::equal(shares, shares_)) {  // all fields begin with the same
            shares_.assign(shares.begin(), shares.end());
            places_.clear();
            for (double share : shares) places_.push_back(at(share));
          }
          for (std::size_t k = 0; k < places_.size(); ++k) Vec3::Map(&out[3 * k]) = f(places_[k]);
        },
        3, tolerance, fit_degree, depth);
  }
  double halved(double share) const {
    double low = from_, high = to_;
    for (int k = 0; k < halvings; ++k) (upto(0.5 * (low + high)) < share * length_ ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }
  /// t, or next to it where the curve stands still at an end.
  double moving(double t) const {
    if (side_.c.derivative_at(t).norm() > tolerance::same * length_) return t;
    const double beside = tolerance::same * (to_ - from_);
    return std::clamp(t, from_ + beside, to_ - beside);
  }

  const Side& side_;
  double from_, to_, length_;
  Digits digits_;
  mutable std::vector<double> shares_, places_;  // where that is, of the last shares that were asked for
};

void check_joint(const Side& before, const Side& after, std::size_t k, double length) {
  const double gap = (after.c(0) - before.c(1)).norm();
  if (!(gap <= tolerance::same * length)) throw CodedRefusal(Code::pieces_apart, {{"first", k}, {"second", k + 1}, {"gap", gap}});
  const double turn = degrees_between(before.c.derivative_at(1), after.c.derivative_at(0)),
               plane = degrees_between(before.normal(1), after.normal(0));
  if (turn > still_smooth || plane > still_smooth)
    throw CodedRefusal(Code::pieces_meet_at_angle,
                       {{"first", k}, {"second", k + 1}, {"angle", std::lround(std::max(turn, plane))}});
}

/// Where c is another polynomial, or r.
std::vector<double> breaks_of(const Side& side) {
  std::vector<double> breaks;
  std::ranges::set_union(side.c.breaks(), side.r.breaks(), std::back_inserter(breaks));
  return breaks;
}

JoinedSide by_length(const SideList& given, const std::vector<std::vector<double>>& parameters, bool kinked) {
  JoinedSide out;
  SideList pieces = given;
  double length = 0;
  for (const Side& piece : pieces) length += arc_length(piece.c);
  bool bends = true, of_mesh = true;
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    bends = bends && !pieces[k].q.empty();
    of_mesh = of_mesh && !pieces[k].rim.empty();
    if (k + 1 == pieces.size()) continue;
    check_joint(pieces[k], pieces[k + 1], k, length);
    const Vec3 half = 0.5 * (pieces[k + 1].c(0) - pieces[k].c(1));
    pieces[k] = moved_ends(pieces[k], Vec3::Zero(), half);
    pieces[k + 1] = moved_ends(pieces[k + 1], -half, Vec3::Zero());
  }
  std::vector<PiecewisePolynomial> c, r, q;
  std::vector<double> shares;
  double reached = 0;
  std::vector<double> rim;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const Side& piece = pieces[p];
    const std::vector<double> breaks = kinked ? breaks_of(piece) : piece.c.breaks();
    const auto place = [&](double t) {  // on the whole, in length
      double sum = reached;
      for (std::size_t b = 0; b + 1 < breaks.size() && breaks[b] < t; ++b)
        sum += Stretch(piece, breaks[b], breaks[b + 1]).upto(std::min(t, breaks[b + 1]));
      return sum;
    };
    for (double t : piece.rim)
      if (of_mesh && (p == 0 || t > 0)) rim.push_back(place(t));
    if (!parameters.empty())
      for (double t : parameters[p])
        if (p == 0 || t > 0) out.parameters.push_back(place(t));
    double own = 0;
    for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
      const Digits digits = kinked ? digits_of_kinked(breaks[b + 1] - breaks[b]) : Digits();
      const Stretch stretch(piece, breaks[b], breaks[b + 1], digits);
      c.push_back(stretch.position());
      r.push_back(stretch.across());
      if (bends) q.push_back(stretch.bend());
      shares.push_back(stretch.length());
      own += stretch.length();
    }
    reached += own;
    out.side.curvature_error = std::max(out.side.curvature_error, piece.curvature_error);
  }
  for (std::vector<double>* places : {&rim, &out.parameters}) {
    for (double& t : *places) t /= reached;
    if (!places->empty()) places->back() = 1;
  }
  for (double& share : shares) share /= reached;
  out.side.c = PiecewisePolynomial::joined(c, shares);
  out.side.r = PiecewisePolynomial::joined(r, shares);
  if (bends) out.side.q = PiecewisePolynomial::joined(q, shares);
  out.side.rim = std::move(rim);
  return out;
}

}  // namespace

bool is_kinked(const Side& side) { return side.rim.empty() && std::max(side.c.pieces(), side.r.pieces()) > smooth_pieces; }

JoinedSide joined(const SideList& given, const std::vector<std::vector<double>>& parameters) {
  if (given.empty()) throw InvalidArgument("a side has a piece or more");
  if (!parameters.empty() && parameters.size() != given.size()) throw InvalidArgument("parameters are of each piece");
  if (given.size() > 1 || nearly_stands_still(given[0].c)) return by_length(given, parameters, false);
  return {given[0], parameters.empty() ? std::vector<double>() : parameters[0]};
}

SideList evenly_run(SideList sides) {
  if (std::ranges::none_of(sides, [](const Side& side) { return changes_speed(side.c); })) return sides;
  for (Side& side : sides) side = by_length({side}, {}, is_kinked(side)).side;
  return sides;
}

}  // namespace tripatch
