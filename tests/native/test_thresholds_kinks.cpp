// Kinks inside sides, on both sides of what decides about them; how large a jump is one is in test_kinks.
#include <Eigen/Geometry>
#include <cmath>

#include "test_surfaces.h"
#include "tripatch/constructions/side_vertex.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/kinks.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

/// A straight side whose derivative across jumps at these parameters.
Side jumping(const std::vector<double>& at) {
  std::vector<PiecewisePolynomial> pieces;
  std::vector<double> shares;
  double before = 0;
  for (std::size_t k = 0; k <= at.size(); ++k) {
    const Vec3 across(0, -1, 0.1 * static_cast<double>(k));
    pieces.push_back(line(across, across));
    shares.push_back((k < at.size() ? at[k] : 1) - before);
    before += shares.back();
  }
  return {line(Vec3::Zero(), Vec3::UnitX()), PiecewisePolynomial::joined(pieces, shares), {}};
}

/// A triangle whose side 2 turns in its middle, and whose planes before and behind meet in a line at an angle of such a sine; slant: the
/// cosine between that line and the way inwards.
Sides ridge(double sine, double slant) {
  const Vec3 up = Vec3::UnitZ(), inward = Vec3::UnitY(), crease = slant * inward + std::sqrt(1 - slant * slant) * Vec3::UnitX();
  const Vec3 lean = std::tan(0.5 * std::asin(sine)) * crease.cross(up);
  std::array<Vec3, 2> leg, across;
  for (int h = 0; h < 2; ++h) {
    const Vec3 n = (up + (h ? -1 : 1) * lean).normalized(), flat(0.5, h ? 0.15 : -0.15, 0), out(flat[1], -flat[0], 0);
    const auto into = [&](const Vec3& v) { return Vec3(v - n.dot(v) / n[2] * up); };
    leg[h] = into(flat);
    across[h] = into(out);
  }
  const Vec3 kink(0.5, -0.15, 0), a = kink - leg[0], b = kink + leg[1], c(0.5, 0.9, 0);
  const auto flat_side = [&](const Vec3& p, const Vec3& q) {
    const Vec3 out = (q - p).cross(up);
    return Side{line(p, q), line(out, out), {}};
  };
  return {flat_side(b, c), flat_side(c, a),
          Side{PiecewisePolynomial::joined({line(a, kink), line(kink, b)}),
               PiecewisePolynomial::joined({line(across[0], across[0]), line(across[1], across[1])}),
               {}}};
}

/// The derivative across side 2 just before and behind the kink.
std::array<Vec3, 2> at_kink(const Sides& sides) {
  const Kinks kinks(sides);
  const SurfacePtr patch = kinks.restored(side_vertex(make_boundary(kinks.rounded())), {true, true, true});
  const std::array<double, 2> t = {0.5 - 1e-9, 0.5 + 1e-9};
  const std::vector<Across> across = derivatives_across(*patch, 2, t, 1);
  return {across[0].first, across[1].first};
}

}  // namespace

TEST_CASE("kinks that are a millionth of the side from an end or from each other are one with it", "[thresholds]") {
  CHECK(kinks_of(jumping({0.97e-6})).empty());
  CHECK(kinks_of(jumping({1.03e-6})).size() == 1);
  CHECK(kinks_of(jumping({1 - 0.97e-6})).empty());
  CHECK(kinks_of(jumping({1 - 1.03e-6})).size() == 1);
  CHECK(kinks_of(jumping({0.5, 0.5 + 0.97e-6})).size() == 1);
  CHECK(kinks_of(jumping({0.5, 0.5 + 1.03e-6})).size() == 2);
}

TEST_CASE("a side that turns smoothly has no kink unless it does so within a millionth of itself", "[thresholds]") {
  // one direction at a billionth before the break, another at it
  for (const double bend : {0.97e6, 1.03e6}) {
    const auto across = [&](double t) { return Vec3(0, -1, bend * t); };
    const Side side = {line(Vec3::Zero(), Vec3::UnitX()),
                       PiecewisePolynomial::joined({line(across(-1e-8), across(0)), line(across(0), across(1e-8))}),
                       {}};
    Side in_place = side;
    in_place.r = PiecewisePolynomial::joined({line(across(-0.5), across(0)), line(across(0), across(0.5))});
    CHECK(kinks_of(side).empty());
    CHECK(kinks_of(in_place).size() == (bend > 1e6 ? 1 : 0));
  }
}

TEST_CASE("planes before and behind a kink meet in a line from a hundred-thousandth between them on", "[thresholds]") {
  const Vec3 crease(std::sqrt(0.5), std::sqrt(0.5), 0);
  for (const double sine : {0.97e-5, 1.03e-5}) {
    const Vec3 across = at_kink(ridge(sine, std::sqrt(0.5)))[0];
    CHECK((across.cross(crease).norm() < 1e-3 * across.norm()) == (sine > 1e-5));
  }
}

TEST_CASE("a crease is followed that leaves the side at a cosine of a fifth from the way inwards", "[thresholds]") {
  for (const double slant : {0.195, 0.205}) {
    const auto [before, behind] = at_kink(ridge(0.3, slant));
    CHECK(((before - behind).norm() < 1e-6 * before.norm()) == (slant > 0.2));
  }
}
