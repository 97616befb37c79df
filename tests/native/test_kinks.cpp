#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

#include "test_surfaces.h"
#include "tripatch/fairing/folds.h"
#include "tripatch/fairing/kinks.h"
#include "tripatch/fill.h"

using namespace tripatch;
using namespace tripatch::testing;

namespace {

using Vec2 = Eigen::Vector2d;

/// A graph over the plane: z and its derivatives by x and y.
using Height = std::function<Vec3(const Vec2&)>;

/// The side on a graph above a polyline, each leg with its share of t; r is the derivative to the right of the way.
Side above(const Height& height, const std::vector<Vec2>& way) {
  std::vector<PiecewisePolynomial> c, r;
  for (std::size_t k = 0; k + 1 < way.size(); ++k) {
    const Vec2 a = way[k], d = way[k + 1] - a;
    const auto field = [&](bool across) {
      return PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> out) {
            for (std::size_t m = 0; m < t.size(); ++m) {
              // not on a crease itself, which is at the ends of legs
              const Vec2 p = a + std::clamp(t[m], 1e-12, 1 - 1e-12) * d;
              const Vec3 z = height(p);
              Vec3::Map(&out[3 * m]) = across ? Vec3(d[1], -d[0], z[1] * d[1] - z[2] * d[0]) : Vec3(p[0], p[1], z[0]);
            }
          },
          3);
    };
    c.push_back(field(false));
    r.push_back(field(true));
  }
  return {PiecewisePolynomial::joined(c), PiecewisePolynomial::joined(r), {}};
}

/// Three sides over a triangle whose side 2 bulges to a point in the middle and whose side 0 has two kinks.
Sides kinked(const Height& height) {
  const Vec2 a(0, 0), b(1, 0), c(0.5, 0.9);
  return {above(height, {b, Vec2(0.95, 0.2), Vec2(0.75, 0.4), Vec2(0.64, 0.66), c}), above(height, {c, a}),
          above(height, {a, Vec2(0.5, -0.15), b})};
}

const Height hills = [](const Vec2& p) {
  return Vec3(0.3 * std::sin(2 * p[0]) * std::cos(1.5 * p[1]), 0.6 * std::cos(2 * p[0]) * std::cos(1.5 * p[1]),
              -0.45 * std::sin(2 * p[0]) * std::sin(1.5 * p[1]));
};
/// Hills with a crease along x = 1/2, which runs into side 2 at its kink.
const Height roof = [](const Vec2& p) { return Vec3(hills(p) - Vec3(0.4 * std::abs(p[0] - 0.5), p[0] < 0.5 ? -0.4 : 0.4, 0)); };

/// The largest gap across the lines that end at kinks, along delta (the strips) and along rays from the opposite vertex (the
/// constructions), and the largest angle between the normals on both sides of them.
std::pair<double, double> tear(const Surface& patch) {
  double gap = 0, angle = 0;
  for (const auto& [side, kink] : {std::pair{2, 0.5}, {0, 0.25}, {0, 0.5}, {0, 0.75}})
    for (bool ray : {false, true})
      for (int k = 1; k < 40; ++k) {
        const double s = k / 40.0;
        Points b(2, 3);
        for (int end = 0; end < 2; ++end) {
          const double t = kink + (end ? 1e-9 : -1e-9);
          b(end, side) = s;
          b(end, (side + 1) % 3) = ray ? (1 - s) * (1 - t) : 1 - t - 0.5 * s;
          b(end, (side + 2) % 3) = ray ? (1 - s) * t : t - 0.5 * s;
        }
        if (!(b.minCoeff() > 0)) continue;
        const auto [p, n] = patch.positions_and_normals(b);
        gap = std::max(gap, (p.row(0) - p.row(1)).norm());
        angle = std::max(angle, degrees_between(n.row(0), n.row(1)));
      }
  return {gap, angle};
}

/// A flat triangle, but that its normal on side 0 points down between two parameters.
class DownBetween final : public Surface {
public:
  DownBetween(double from, double to) : from_(from), to_(to) {}
  void evaluate(const double* b, Index n, int order, double* out) const override {
    for (Index k = 0; k < n; ++k, b += 3, out += 3 * jet_size(order)) {
      const double t = b[2] / (b[1] + b[2]);
      std::fill_n(out, 3 * jet_size(order), 0.0);
      Vec3::Map(out) = Vec3(b[0], b[1], 0);
      if (order < 1) continue;
      Vec3::Map(out + 3) = Vec3::UnitX();
      Vec3::Map(out + 6) = Vec3(0, b[0] == 0 && t > from_ && t < to_ ? -1 : 1, 0);
    }
  }

private:
  double from_, to_;
};

}  // namespace

TEST_CASE("a patch that folds on one side of a kink folds, whichever way the side runs") {
  const Sides sides = kinked(hills);
  CHECK(count_folds(DownBetween(0, 0), sides) == 0);
  for (const double kink : {0.25, 0.5, 0.75}) {
    const Index before = count_folds(DownBetween(kink - 1e-4, kink), sides);
    CHECK(before > 0);
    CHECK(count_folds(DownBetween(kink, kink + 1e-4), sides) == before);
    CHECK(count_folds(DownBetween(kink + 1e-4, kink + 2e-4), sides) == 0);  // farther off it is seen only at points of the grid
  }
}

TEST_CASE("patches of sides with kinks are whole and keep the sides") {
  const Sides sides = kinked(hills);
  REQUIRE(!Kinks(sides).empty());
  for (const char* method :
       {"side_vertex", "quintic", "gregory", "nielson_blend", "szilvasi_nagy_c1", "barnhill_birkhoff_gordon"}) {
    for (const std::optional<Fairing> fairing : {std::optional<Fairing>(), std::optional(Fairing::automatic)}) {
      INFO(method << ", fairing " << (fairing ? name_of(*fairing) : "none"));
      FillOptions options;
      options.method = method;
      options.fairing = fairing;
      const MadePatch made = patch_from_sides(sides, options);
      CHECK(side_error(*made.patch, sides) < 1e-13);
      CHECK(seam_error(*made.patch, sides) < 1e-6);
      const auto [gap, angle] = tear(*made.patch);
      CHECK(gap < 1e-7);
      CHECK(angle < 8);  // where the two planes of the kink's neighborhood come apart; the kinks turn by 33, 32 and 22 degrees
      CHECK(made.report.folds == 0);
    }
  }
}

TEST_CASE("at a kink where a crease ends the derivative across runs along the crease") {
  const Sides sides = kinked(roof);
  const MadePatch made = patch_from_sides(sides, {});
  CHECK(side_error(*made.patch, sides) < 1e-13);
  CHECK(seam_error(*made.patch, sides) < 1e-6);
  CHECK(tear(*made.patch).first < 1e-7);
  CHECK(made.report.folds == 0);
  CHECK(planes_apart(sides[2], 0.5) > 30);  // so the fill has a crease there, which is no fold
}

TEST_CASE("rounded sides have no kinks and are the sides elsewhere") {
  const Sides sides = kinked(roof);
  const Kinks kinks(sides);
  CHECK(Kinks(kinks.rounded()).empty());
  for (double t : {0.0, 0.1, 0.24, 0.76, 0.9, 1.0}) {
    CHECK((kinks.rounded()[2].c(t) - sides[2].c(t)).norm() < 1e-14);
    CHECK((kinks.rounded()[2].r(t) - sides[2].r(t)).norm() < 1e-14);
  }
  CHECK((kinks.rounded()[2].c(0.5) - sides[2].c(0.5)).norm() > 1e-3);
  CHECK(Kinks(sides_of(wave())).empty());
}

TEST_CASE("a turn by more than a thousandth is a kink, less is none") {
  const auto line = [](const Vec3& a, const Vec3& b) {
    const std::array<double, 6> net = {a[0], a[1], a[2], b[0], b[1], b[2]};
    return PiecewisePolynomial::bezier(net, 3);
  };
  for (double turn : {0.9e-3, 1.1e-3}) {
    INFO(turn);
    Side side;
    side.c = PiecewisePolynomial::joined({line(Vec3(-1, 0, 0), Vec3::Zero()), line(Vec3::Zero(), Vec3(1, 0, 0))});
    side.r = PiecewisePolynomial::joined({line(Vec3(0, -1, 0), Vec3(0, -1, 0)), line(Vec3(0, -1, turn), Vec3(0, -1, turn))});
    CHECK(kinks_of(side).size() == (turn > 1e-3 ? 1 : 0));
    side.c = PiecewisePolynomial::joined({line(Vec3(-1, 0, 0), Vec3::Zero()), line(Vec3::Zero(), Vec3(1, 0, turn))});
    side.r = line(Vec3(0, -1, 0), Vec3(0, -1, 0));
    CHECK(kinks_of(side).size() == (turn > 1e-3 ? 1 : 0));
  }
}

namespace {

/// A side of six edges with a kink at the end of the second, so that it is rounded from the end of the first to that of the third, where
/// second derivatives jump; or the same side backwards.
Side bent_at_edges(bool backwards) {
  const auto bent = [](double t, double at) { return t > at ? (t - at) * (t - at) : 0.0; };
  std::vector<PiecewisePolynomial> c, r;
  for (int k = 0; k < 6; ++k)
    for (bool across : {false, true})
      (across ? r : c)
          .push_back(PiecewisePolynomial::fit(
              [&](std::span<const double> u, std::span<double> out) {
                for (std::size_t m = 0; m < u.size(); ++m) {
                  const double at = (k + u[m]) / 6, t = backwards ? 1 - at : at;
                  const double bends = bent(t, 1.0 / 6) - 2 * bent(t, 0.5), kinked = std::abs(t - 1.0 / 3);
                  Vec3::Map(&out[3 * m]) = across ? Vec3(0.2 * bends, -1, bends + 0.1 * kinked) : Vec3(at, bends, 0.3 * kinked);
                }
              },
              3));
  return {PiecewisePolynomial::joined(c), PiecewisePolynomial::joined(r), {}};
}

}  // namespace

TEST_CASE("what rounds a kink goes on where the side goes on outside, though second derivatives jump there; backwards, too") {
  const Vec2 a(0, 0), b(1, 0), top(0.5, 0.9);
  const auto rounded = [&](bool backwards) {
    const Sides sides = {above(hills, {b, top}), above(hills, {top, a}), bent_at_edges(backwards)};
    REQUIRE(kinks_of(sides[2]).size() == 1);
    return Kinks(sides).rounded()[2];
  };
  const Side there = rounded(false), back = rounded(true);
  for (double end : {1.0 / 6, 0.5})
    for (const PiecewisePolynomial* f : {&there.c, &there.r})
      for (int order : {1, 2}) CHECK((f->derivative_at(end - 1e-9, order) - f->derivative_at(end + 1e-9, order)).norm() < 1e-5);
  for (int k = 0; k <= 60; ++k) {
    const double t = (k + 0.5) / 61;
    const Vec3 p = back.c(1 - t);
    CHECK((there.c(t) - Vec3(1 - p[0], p[1], p[2])).norm() < 1e-9);
    CHECK((there.r(t) - back.r(1 - t)).norm() < 1e-9);
  }
}
