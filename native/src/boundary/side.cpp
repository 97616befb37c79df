#include "tripatch/boundary/side.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// Sine of the angle between two tangents up to which they span no plane, 2 degrees: at 100 edges a round rim turns by 3.6.
constexpr double one_direction = share::little;
/// Places between the corners at which the planes of a side that is not continued are set.
constexpr int turned_places = count::places;

/// Twice the area that the chords of the rim enclose, as a vector: which way it is seen from outside where nothing else tells.
Vec3 area_vector(const std::vector<Side>& sides) {
  std::vector<Vec3> points;
  for (const Side& side : sides)
    for (int k = 0; k < turned_places; ++k) points.push_back(side.c(static_cast<double>(k) / turned_places) - sides[0].c(0));
  Vec3 area = Vec3::Zero();
  for (std::size_t k = 0; k < points.size(); ++k) area += points[k].cross(points[(k + 1) % points.size()]);
  return area;
}

/// The normal that the rim has where side `in` ends and `out` begins; a side's own where it is continued.
std::array<Vec3, 2> normals_at_corner(const Side& in, const Side& out, bool in_continued, bool out_continued, const Vec3& area) {
  if (in_continued && out_continued) return {in.normal(1), out.normal(0)};
  const Vec3 before = in.c.derivative_at(1).stableNormalized(), after = out.c.derivative_at(0).stableNormalized();
  Vec3 n = in_continued ? in.normal(1) : out_continued ? out.normal(0) : before.cross(after);
  if (!in_continued && !out_continued) {
    if (!(n.norm() > one_direction)) n = area;
    if (n.dot(area) < 0) n = -n;  // the rim turns back there
  }
  return {n.stableNormalized(), n.stableNormalized()};
}

/// The side of a mesh with the curve that its vertices tell: its own bends between them as the faces next to it do.
void run_by_vertices(Side& side) {
  if (side.rim.empty()) return;
  std::vector<double> points;
  for (double t : side.rim) {
    const Vec3 p = side.c(t);
    points.insert(points.end(), p.data(), p.data() + 3);
  }
  side.c = PiecewisePolynomial::spline(side.rim, points, 3);
}

/// The side with planes that turn from one normal to another.
Side with_planes(Side side, const Vec3& from, const Vec3& to) {
  std::vector<double> t, r;
  for (int k = 0; k <= turned_places; ++k) {
    t.push_back(static_cast<double>(k) / turned_places);
    const Vec3 along = side.c.derivative_at(t.back());
    Vec3 n = (1 - t.back()) * from + t.back() * to;
    n -= along * (n.dot(along) / along.squaredNorm());
    const Vec3 across = along.cross(n.stableNormalized());
    r.insert(r.end(), across.data(), across.data() + 3);
  }
  side.r = PiecewisePolynomial::spline(t, r, 3);
  side.q = {};
  side.curvature_error = 0;
  return side;
}

}  // namespace

Vec3 Side::normal(double t) const { return r(t).cross(c.derivative_at(t)).stableNormalized(); }

Side piece_of(const Side& side, double from, double to) {
  const double low = std::min(from, to), high = std::max(from, to);
  const auto is_closed = [&] { return (side.c(1) - side.c(0)).norm() <= tolerance::same * (side.c(0.5) - side.c(0)).norm(); };
  if (!(low >= 0 && low < 1 && high > low && high <= low + 1) || (high > 1 && !is_closed()))
    throw CodedArgument(Code::not_a_piece, {});
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

std::vector<Side> planes_from_rim(std::vector<Side> sides, const std::vector<bool>& continued) {
  const std::size_t n = sides.size();
  if (std::find(continued.begin(), continued.end(), false) == continued.end()) return sides;
  for (std::size_t k = 0; k < n; ++k)
    if (!continued[k]) run_by_vertices(sides[k]);
  const Vec3 area = area_vector(sides);
  std::vector<std::array<Vec3, 2>> normals;  // where side k ends and the next one begins
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = (k + 1) % n;
    normals.push_back(normals_at_corner(sides[k], sides[next], continued[k], continued[next], area));
  }
  for (std::size_t k = 0; k < n; ++k)
    if (!continued[k]) sides[k] = with_planes(std::move(sides[k]), normals[(k + n - 1) % n][1], normals[k][0]);
  return sides;
}

Sides planes_from_rim(const Sides& sides, const std::array<bool, 3>& continued) {
  if (continued[0] && continued[1] && continued[2]) return sides;
  std::vector<Side> all =
      planes_from_rim(std::vector<Side>(sides.begin(), sides.end()), std::vector<bool>(continued.begin(), continued.end()));
  return {std::move(all[0]), std::move(all[1]), std::move(all[2])};
}

double check_curves(const std::array<PiecewisePolynomial, 3>& curves) {
  double size = 0;
  for (const PiecewisePolynomial& c : curves) {
    const Vec3 a = c(0), b = c(1);
    size = std::max(size, (b - a).norm());
    for (int k = 1; k < 4; ++k) size = std::max({size, (c(k / 4.0) - a).norm(), (c(k / 4.0) - b).norm()});
  }
  if (!(size > 0)) throw CodedRefusal(Code::sides_without_length);
  if (!std::isfinite(size)) throw CodedRefusal(Code::numbers_overflow);
  for (int i = 0; i < 3; ++i) {
    const double gap = (curves[i](1) - curves[(i + 1) % 3](0)).norm();
    if (!(gap <= tolerance::same * size))
      throw CodedRefusal(Code::sides_apart, {{"first", i}, {"second", (i + 1) % 3}, {"corner", (i + 2) % 3}, {"gap", gap}});
  }
  return size;
}

double check_sides(const Sides& sides) { return check_curves({sides[0].c, sides[1].c, sides[2].c}); }

}  // namespace tripatch
