#include "tripatch/polygon/joined.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "tripatch/boundary/side.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/quadrature.h"

namespace tripatch {
namespace {

/// For arc length along a piece: the speed of a cubic that doubles several times is even to 3e-11 with so many nodes, with half of them
/// to 5e-7; of the rounds half would do.
constexpr int length_nodes = 12, newton_rounds = 6;
/// Where a curve ends without speed Newton's steps only halve what is left: of the length, what may be left, and the halvings behind them.
constexpr double length_met = 1e-13;
constexpr int halvings = 50;

/// A side whose speed falls below this share of its length somewhere is run through by length: the derivative across it that its ends
/// ask for counts in its speed. Between three and four sides of spheres and saddles, one of which slows down evenly, patches are up to
/// 1e-5 of the size off from 0.3 on, 1e-4 at 0.1, the size itself at 0.01 and ten thousand times the size at 0.0001.
constexpr double least_speed = 0.25;
constexpr int speed_places = 64;  ///< where speeds are looked at; the ends are two of them
/// Of a piece, from an end without speed, where planes are read instead: by length that is the square of it.
constexpr double beside_still = 1e-6;

bool runs_evenly(const PiecewisePolynomial& c) {
  const double least = least_speed * arc_length(c);
  for (int k = 0; k <= speed_places; ++k)
    if (c.derivative_at(static_cast<double>(k) / speed_places).norm() < least) return false;
  return true;
}

/// Arc length along a part of a curve on which it is a polynomial.
class Stretch {
public:
  Stretch(const Side& side, double from, double to) : side_(side), from_(from), to_(to), length_(upto(to)) {}
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
      const double speed = side_.c.derivative_at(t).norm();
      if (!(speed > 0)) break;
      t = std::clamp(t - (upto(t) - share * length_) / speed, from_, to_);
    }
    return std::abs(upto(t) - share * length_) <= length_met * length_ ? t : halved(share);
  }

  template <class F>
  PiecewisePolynomial field(const F& f) const {
    return PiecewisePolynomial::fit(
        [&](std::span<const double> shares, std::span<double> out) {
          for (std::size_t k = 0; k < shares.size(); ++k) Vec3::Map(&out[3 * k]) = f(at(shares[k]));
        },
        3);
  }
  PiecewisePolynomial position() const {
    return field([&](double t) { return side_.c(t); });
  }
  PiecewisePolynomial across() const {
    return field([&](double t) { return upright_across(side_, moving(t)); });
  }
  PiecewisePolynomial bend() const {
    return field([&](double t) { return upright_bend(side_, moving(t)); });
  }

private:
  double halved(double share) const {
    double low = from_, high = to_;
    for (int k = 0; k < halvings; ++k) (upto(0.5 * (low + high)) < share * length_ ? low : high) = 0.5 * (low + high);
    return 0.5 * (low + high);
  }
  /// t, or beside it where the curve stands still at an end.
  double moving(double t) const {
    if (side_.c.derivative_at(t).norm() > beside_still * length_) return t;
    const double beside = beside_still * (to_ - from_);
    return std::clamp(t, from_ + beside, to_ - beside);
  }

  const Side& side_;
  double from_, to_, length_;
};

void check_joint(const Side& before, const Side& after, std::size_t k, double length) {
  const std::string which = "Pieces " + std::to_string(k) + " and " + std::to_string(k + 1) + " of a side ";
  const double gap = (after.c(0) - before.c(1)).norm();
  if (!(gap <= sides_meet * length)) throw Refusal(which + "do not meet: the gap is " + std::to_string(gap));
  const double turn = degrees_between(before.c.derivative_at(1), after.c.derivative_at(0)),
               plane = degrees_between(before.normal(1), after.normal(0));
  if (turn > still_smooth || plane > still_smooth)
    throw Refusal(which + "meet at an angle of " + std::to_string(std::lround(std::max(turn, plane))) +
                  " degrees: they are two sides");
}

}  // namespace

JoinedSide joined(const SideList& given, const std::vector<std::vector<double>>& parameters) {
  if (given.empty()) throw InvalidArgument("a side has a piece or more");
  if (!parameters.empty() && parameters.size() != given.size()) throw InvalidArgument("parameters are of each piece");
  JoinedSide out;
  if (given.size() == 1 && runs_evenly(given[0].c)) {
    out.side = given[0];
    if (!parameters.empty()) out.parameters = parameters[0];
    return out;
  }
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
    const std::vector<double>& breaks = piece.c.breaks();
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
      const Stretch stretch(piece, breaks[b], breaks[b + 1]);
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

}  // namespace tripatch
