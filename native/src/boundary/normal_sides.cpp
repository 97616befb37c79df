#include "tripatch/boundary/normal_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/math/places.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// A vector polynomial of u = t - 1/2, coefficient k of u^k.
template <int Degree>
using Series = std::array<Vec3, Degree + 1>;

template <int Degree>
PiecewisePolynomial field(const Series<Degree>& a) {
  std::vector<double> coefficients;
  for (const Vec3& v : a) coefficients.insert(coefficients.end(), v.begin(), v.end());
  return {{0.0, 1.0}, Degree, 3, std::move(coefficients)};
}

/// In the middle of an edge the derivative across is at most so many times what the mean of the end normals makes it: reached where these
/// are 120 degrees apart. A choice, for between opposite normals there is no bound.
constexpr double max_bulge = factor::large;

/// theta / sin(theta) for the angle between a chord and a tangent: the arc of a circle over its chord.
double arc_over_chord(double sine) {
  const double theta = std::asin(std::min(std::abs(sine), 1.0));
  return theta < tolerance::close ? 1 + theta * theta / 6 : theta / std::sin(theta);
}

template <int Degree>
Side make_side(const Series<Degree>& c, const Vec3& mean, const Vec3& difference) {
  // r = c' x m for the mixed normal m = mean + u difference: then r x c' is m less its part along c', up to |c'|^2. Its length is
  // free; divided by |m|^2 (1 at the ends; here the parabola through the middle) it is right for spheres to a higher order: rms on
  // icospheres falls to a third, and on saddles, waves, tori and cylinders it does not rise.
  const double bulge = std::min(1 / mean.squaredNorm(), max_bulge) - 1;
  Series<Degree + 2> r;
  r.fill(Vec3::Zero());
  for (int k = 1; k <= Degree; ++k) {
    const Vec3 even = k * c[k].cross(mean), odd = k * c[k].cross(difference);
    r[k - 1] += (1 + bulge) * even;
    r[k] += (1 + bulge) * odd;
    r[k + 1] -= 4 * bulge * even;
    r[k + 2] -= 4 * bulge * odd;
  }
  return {field<Degree>(c), field<Degree + 2>(r), {}};
}

bool before(const Vec3& a, const Vec3& b) { return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end()); }

Vec3 unit_normal(const Vec3& n, Index vertex) {
  if (!n.allFinite()) throw CodedRefusal(Code::normal_not_finite, {vertex});
  if (!(n.stableNorm() >= std::numeric_limits<double>::min())) throw CodedRefusal(Code::normal_zero, {vertex});
  return n.stableNormalized();
}

}  // namespace

Side side_from_normals(const Vec3& p, const Vec3& normal_p, const Vec3& q, const Vec3& normal_q, NormalCurve curve) {
  if (!p.allFinite()) throw CodedRefusal(Code::position_not_finite, {0});
  if (!q.allFinite()) throw CodedRefusal(Code::position_not_finite, {1});
  if (before(q, p)) {  // one direction for both triangles, so that they get the same bits
    try {
      const Side other = side_from_normals(q, normal_q, p, normal_p, curve);
      return {other.c.reversed(), -1.0 * other.r.reversed(), {}};
    } catch (const CodedRefusal& refusal) {
      Message message = with_vertices(refusal.message(), [](Index w) { return 1 - w; });
      std::sort(message.where.begin(), message.where.end());
      throw CodedRefusal(std::move(message));
    }
  }
  const Vec3 np = unit_normal(normal_p, 0), nq = unit_normal(normal_q, 1);
  const Vec3 d = q - p;
  const double length = d.norm();
  if (!(length > 0)) throw CodedRefusal(Code::edge_without_length, {0, 1});
  const Vec3 to_p = d - np.dot(d) * np, to_q = d - nq.dot(d) * nq;  // the chord in the vertices' planes
  if (!(to_p.norm() > tolerance::same * length)) throw CodedRefusal(Code::normal_along_edge, {0});
  if (!(to_q.norm() > tolerance::same * length)) throw CodedRefusal(Code::normal_along_edge, {1});
  const Vec3 mean = 0.5 * (np + nq), difference = nq - np;

  Side side;
  if (curve == NormalCurve::smits) {
    // eqs. 4 and 7 about the middle: h = (1/4 - u^2) (h0 - h1 u), c = chord + h (mean + u difference)
    const double a = -np.dot(d), b = -nq.dot(d), h0 = 0.5 * (a - b), h1 = a + b;
    const std::array<double, 4> h = {0.25 * h0, -0.25 * h1, -h0, h1};
    Series<4> c = {0.5 * (p + q), d, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (int k = 0; k < 4; ++k) {
      c[k] += h[k] * mean;
      c[k + 1] += h[k] * difference;
    }
    side = make_side<4>(c, mean, difference);
  } else {
    const double arc = 0.5 * length * (arc_over_chord(np.dot(d) / length) + arc_over_chord(nq.dot(d) / length));
    const Vec3 tp = arc * to_p.normalized(), tq = arc * to_q.normalized();
    side = make_side<3>({0.5 * (p + q) + (tp - tq) / 8, 1.5 * d - 0.25 * (tp + tq), 0.5 * (tq - tp), tp + tq - 2 * d}, mean,
                        difference);
  }
  for (const double t : evenly(8))  // a normal field everywhere: neither opposite normals nor a curve that stands still
    if (!(side.r(t).norm() > tolerance::same * length)) throw CodedRefusal(Code::normals_disagree, {0, 1});
  return side;
}

Sides sides_from_normals(const std::array<Vec3, 3>& points, const std::array<Vec3, 3>& normals, NormalCurve curve) {
  Sides sides;
  for (int i = 0; i < 3; ++i) {
    const int a = (i + 1) % 3, b = (i + 2) % 3;
    try {
      sides[i] = side_from_normals(points[a], normals[a], points[b], normals[b], curve);
    } catch (const CodedRefusal& refusal) {
      throw CodedRefusal(with_vertices(refusal.message(), [a = a, b = b](Index w) -> Index { return w == 0 ? a : b; }));
    }
  }
  return sides;
}

}  // namespace tripatch
