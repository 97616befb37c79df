#include "tripatch/boundary/poles.h"

#include <Eigen/Geometry>
#include <array>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// The last piece of a side, as a share of it, in which a pole of its surroundings is rounding: kernels put corners into poles to 1e-7,
/// and of the normals that they give there those within 1e-4 were off by more than 0.1 degrees.
constexpr double beside_pole = 1.0 / 256;
/// Degrees by which planes turn in that piece, and how many times as much as in the one before, where it is a pole: less is a bend.
constexpr double turned_at_pole = angle::flat, jump_at_pole = factor::huge;

/// The field with the piece next to its start continued from what follows, by the parabola through three places.
PiecewisePolynomial continued_to_start(const PiecewisePolynomial& f) {
  if (f.empty()) return f;
  const double h = beside_pole;
  const Vec3 first = f(h), second = f(2 * h), third = f(3 * h), start = 3 * first - 3 * second + third,
             middle = (15 * first - 10 * second + 3 * third) / 8;
  std::array<double, 9> net;
  Vec3::Map(net.data()) = start;
  Vec3::Map(net.data() + 3) = 2 * middle - 0.5 * (start + first);
  Vec3::Map(net.data() + 6) = first;
  return PiecewisePolynomial::joined({PiecewisePolynomial::bezier(net, 3), f.part(h, 1)}, {h, 1 - h});
}

}  // namespace

Side without_poles(Side side) {
  for (const bool end : {false, true}) {
    const auto normal = [&](int pieces) { return side.normal(end ? 1 - pieces * beside_pole : pieces * beside_pole); };
    const std::array<Vec3, 3> n = {normal(0), normal(1), normal(2)};
    if (!(n[0].norm() > 0 && n[1].norm() > 0)) continue;  // no plane: the corner has that of the other side
    const double last = degrees_between(n[0], n[1]), before = degrees_between(n[1], n[2]);
    if (!(last > turned_at_pole && last > jump_at_pole * before)) continue;
    const auto mended = [&](const PiecewisePolynomial& f) {
      return end ? continued_to_start(f.reversed()).reversed() : continued_to_start(f);
    };
    side.r = mended(side.r);
    if (!side.q.empty()) side.q = mended(side.q);
  }
  return side;
}

}  // namespace tripatch
