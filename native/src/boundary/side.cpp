#include "tripatch/boundary/side.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <sstream>
#include <string>

namespace tripatch {
namespace {

/// Of the size: ends that are nearer count as one point, and are made one. What coordinates in single precision, as files and Blender
/// have them, leave of a common point with some digits to spare.
constexpr double sides_meet = 1e-6;

}  // namespace

Vec3 Side::normal(double t) const { return r(t).cross(c.derivative_at(t)).stableNormalized(); }

Side piece_of(const Side& side, double from, double to) {
  const double low = std::min(from, to), high = std::max(from, to);
  if (!(low >= 0 && low < 1 && high > low && high <= low + 1))
    throw InvalidArgument("A piece of a side needs two different parameters from 0 to 1");
  if (high > 1 && (side.c(1) - side.c(0)).norm() > sides_meet * (side.c(0.5) - side.c(0)).norm())
    throw InvalidArgument("Only a piece of a closed side can go on beyond its end");
  const auto field = [&](const PiecewisePolynomial& f) {
    if (f.empty()) return f;
    const PiecewisePolynomial piece = high <= 1
                                          ? f.part(low, high)
                                          : PiecewisePolynomial::joined({f.part(low, 1), f.part(0, high - 1)},
                                                                        {(1 - low) / (high - low), (high - 1) / (high - low)});
    return to < from ? piece.reversed() : piece;
  };
  return {field(side.c), field(side.r), field(side.q)};
}

Side moved_ends(Side side, const Vec3& start, const Vec3& end) {
  const std::array<double, 6> net = {start[0], start[1], start[2], end[0], end[1], end[2]};
  side.c = side.c + PiecewisePolynomial::bezier(net, 3);
  return side;
}

std::string gap_at_corner(int corner, double gap) {
  std::ostringstream text;
  text.precision(3);
  text << "do not meet at corner " << corner << ": the gap is " << gap;
  return text.str();
}

double check_curves(const std::array<PiecewisePolynomial, 3>& curves) {
  double size = 0;
  for (const PiecewisePolynomial& c : curves) {
    const Vec3 a = c(0);
    for (double t : {0.25, 0.5, 0.75, 1.0}) size = std::max(size, (c(t) - a).norm());
  }
  if (!(size > 0)) throw Refusal("The three sides have no length");
  for (int i = 0; i < 3; ++i) {
    const double gap = (curves[i](1) - curves[(i + 1) % 3](0)).norm();
    if (!(gap <= sides_meet * size))
      throw Refusal("Sides " + std::to_string(i) + " and " + std::to_string((i + 1) % 3) + " " + gap_at_corner((i + 2) % 3, gap));
  }
  return size;
}

double check_sides(const Sides& sides) { return check_curves({sides[0].c, sides[1].c, sides[2].c}); }

}  // namespace tripatch
