#include "tripatch/fairing/kinks.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "tripatch/fairing/curvature.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/smoothstep.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

bool apart(const Vec3& left, const Vec3& right) {
  return (right - left).norm() > tolerance::slight * std::max(left.norm(), right.norm());
}

/// The quintic with the field's own values and first two derivatives at both ends, over [0, 1]: where it has breaks there, those outside.
PiecewisePolynomial bridge(const PiecewisePolynomial& field, double from, double to) {
  const double h = to - from;
  std::array<Vec3, 6> net;
  for (int end = 0; end < 2; ++end) {
    const PiecewisePolynomial outside = end ? field.part(to, 1) : field.part(0, from);
    const double t = end ? 0 : 1, s = (end ? -h : h) / (end ? 1 - to : from);  // of `outside`
    const Vec3 f = outside(t), d = s * outside.derivative_at(t), dd = s * s * outside.derivative_at(t, 2);
    net[end ? 5 : 0] = f;
    net[end ? 4 : 1] = f + d / 5;
    net[end ? 3 : 2] = f + 2 * d / 5 + dd / 20;
  }
  return PiecewisePolynomial::bezier({net[0].data(), 18}, 3);
}

/// What a patch of rounded sides lacks next to one kink.
struct Strip {
  int side;
  double from, to;        ///< parameters on the side
  double depth;           ///< in b_i
  PiecewisePolynomial e;  ///< position, over [0, 1] from `from` to `to`
  PiecewisePolynomial g;  ///< derivative along delta_i
};

class Strips final : public JetSurface<Strips> {
public:
  explicit Strips(std::vector<Strip> strips) : strips_(std::move(strips)) {}

  Vec3 corner(int) const override { return Vec3::Zero(); }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p;
    for (const Strip& strip : strips_) {
      const int i = strip.side;
      if (b[i].value() >= strip.depth) continue;
      const Jet<N> t = b[(i + 2) % 3] + 0.5 * b[i];
      if (!(t.value() > strip.from && t.value() < strip.to)) continue;
      const Jet<N> u = (1 / (strip.to - strip.from)) * (t - strip.from), x = (1 / strip.depth) * b[i], y = 1.0 - x;
      // 1 - x^3 (10 - 15 x + 6 x^2)
      const Jet<N> phi = y * square(y) * (1.0 + 3.0 * x + 6 * square(x));
      p += phi * (compose(strip.e, u) + b[i] * compose(strip.g, u));
    }
    return p;
  }

private:
  std::vector<Strip> strips_;
};

Vec3 in_plane(const Vec3& v, const Vec3& n) { return v - n.dot(v) * n; }

/// Cosine: a line that leaves the side at less than some 12 degrees is no crease to be followed.
constexpr double min_slant = share::fifth;

/// A derivative across that is in the planes of both sides of a kink and goes as far inwards as v: where they differ, along the line
/// where they meet, which is the crease that ends there. None where that line runs along the side.
std::optional<Vec3> in_both_planes(const Vec3& v, const Side& before, const Side& after) {
  const Vec3 n0 = before.normal(1), n1 = after.normal(0), line = n0.cross(n1);
  if (line.norm() < tolerance::same) return in_plane(v, (n0 + n1).normalized());
  const Vec3 inward = -(before.r(1).normalized() + after.r(0).normalized()).normalized();
  const double slant = inward.dot(line.normalized());
  if (std::abs(slant) < min_slant) return std::nullopt;
  return inward.dot(v) / slant * line.normalized();
}

}  // namespace

std::vector<double> kinks_of(const Side& side) {
  std::vector<double> breaks = side.c.breaks(), at;
  breaks.insert(breaks.end(), side.r.breaks().begin(), side.r.breaks().end());
  std::sort(breaks.begin(), breaks.end());
  for (double t : breaks) {
    if (t < tolerance::same || t > 1 - tolerance::same || (!at.empty() && t < at.back() + tolerance::same)) continue;
    const double before = t - tolerance::solved;
    if (apart(side.c.derivative_at(before), side.c.derivative_at(t)) || apart(side.r(before), side.r(t))) at.push_back(t);
  }
  return at;
}

double planes_apart(const Side& side, double kink) {
  const Vec3 a = side.normal(kink - tolerance::solved), b = side.normal(kink);
  return degrees_between(a, b);
}

Kinks::Kinks(const Sides& sides) : sides_(sides), rounded_(sides) {
  for (int i = 0; i < 3; ++i) {
    const Side& side = sides[i];
    const std::vector<double> at = kinks_of(side);
    if (at.empty()) continue;
    std::vector<PiecewisePolynomial> c, r, q;
    std::vector<double> shares;
    double done = 0;
    const auto keep = [&](double to) {
      if (!(to > done)) return;
      c.push_back(side.c.part(done, to));
      r.push_back(side.r.part(done, to));
      if (!side.q.empty()) q.push_back(side.q.part(done, to));
      shares.push_back(to - done);
      done = to;
    };
    for (std::size_t k = 0; k < at.size(); ++k) {
      const double before = k ? at[k - 1] : 0, after = k + 1 < at.size() ? at[k + 1] : 1;
      const double reach = 0.5 * std::min(at[k] - before, after - at[k]);
      kinks_[i].push_back({at[k], reach});
      keep(at[k] - reach);
      done = at[k] + reach;
      c.push_back(bridge(side.c, at[k] - reach, done));
      r.push_back(bridge(side.r, at[k] - reach, done));
      if (!side.q.empty()) q.push_back(bridge(side.q, at[k] - reach, done));
      shares.push_back(2 * reach);
    }
    keep(1);
    rounded_[i].c = PiecewisePolynomial::joined(c, shares);
    rounded_[i].r = PiecewisePolynomial::joined(r, shares);
    if (!side.q.empty()) rounded_[i].q = PiecewisePolynomial::joined(q, shares);
  }
}

std::array<std::vector<double>, 3> Kinks::parameters() const {
  std::array<std::vector<double>, 3> all;
  for (int i = 0; i < 3; ++i)
    for (const Kink& kink : kinks_[i]) all[i].push_back(kink.t);
  return all;
}

SurfacePtr Kinks::restored(const SurfacePtr& patch, const std::array<bool, 3>& tangent) const {
  std::vector<Strip> strips;
  for (int i = 0; i < 3; ++i)
    for (const Kink& kink : kinks_[i]) {
      Strip strip;
      strip.side = i;
      strip.from = kink.t - kink.reach;
      strip.to = kink.t + kink.reach;
      // The strip keeps clear of the other sides, which are at t = b_i / 2 and 1 - b_i / 2, and of the center.
      strip.depth = std::min(2 * kink.reach, 1.0 / 3);
      strip.e = (sides_[i].c - rounded_[i].c).part(strip.from, strip.to);
      std::array<Side, 2> halves;
      for (int h = 0; h < 2; ++h) {
        const double from = h ? kink.t : strip.from, to = h ? strip.to : kink.t;
        halves[h].c = sides_[i].c.part(from, to);
        halves[h].r = sides_[i].r.part(from, to);
      }
      const Vec3 at_kink = -derivatives_across(*patch, i, {&kink.t, 1}, 1)[0].first;
      const std::optional<Vec3> common = in_both_planes(at_kink, halves[0], halves[1]);
      std::vector<PiecewisePolynomial> g;
      for (int h = 0; h < 2; ++h) {
        const Vec3 own = in_plane(at_kink, halves[h].normal(h ? 0 : 1)), turn = common.value_or(own) - own;
        g.push_back(PiecewisePolynomial::fit(
            [&](std::span<const double> u, std::span<double> out) {
              std::vector<double> t;
              for (double v : u) t.push_back((h ? kink.t : strip.from) + kink.reach * v);
              const std::vector<Across> across = derivatives_across(*patch, i, t, 1);
              for (std::size_t k = 0; k < u.size(); ++k) {
                const double near = h ? 1 - u[k] : u[k];
                const Vec3 n = halves[h].normal(u[k]), d = -across[k].first;
                const Vec3 wanted = in_plane(d + smoothstep(near) * turn, n);
                Vec3::Map(&out[3 * k]) = tangent[i] ? Vec3(wanted - d) : Vec3(Vec3::Zero());
              }
            },
            3, tolerance::rounding));
      }
      strip.g = PiecewisePolynomial::joined(g);
      strips.push_back(std::move(strip));
    }
  return sum(patch, std::make_shared<Strips>(std::move(strips)));
}

}  // namespace tripatch
