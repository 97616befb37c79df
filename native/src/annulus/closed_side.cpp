#include "tripatch/annulus/closed_side.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/estimate/meridian.h"
#include "tripatch/estimate/vertex_fit.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/polygon/round.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

/// Vertices beyond the first that a spline round a rim continues to: what its ends do has died away to rounding then.
constexpr Index wrapped = 28;
/// Three corners are put in so many ways that every vertex is far from them in one, and in the same way each.
constexpr Index max_placements = count::dozens;

/// Waves round the rim that are taken for what they are, the rest is a spline: a share of the number of vertices, and so many at most.
/// A spline alone is no circle through twelve vertices, by 4e-4 of the diameter.
constexpr Index vertices_a_wave = count::several;
constexpr Index max_fitted_waves = count::octet;

/// A field round the rim through values at its vertices; t: of these.
PiecewisePolynomial closed_spline(const std::vector<double>& t, std::vector<Vec3> values) {
  const Index n = static_cast<Index>(values.size());
  const int order = static_cast<int>(std::min(n / vertices_a_wave, max_fitted_waves));
  Eigen::MatrixXd waves(n, 2 * order + 1), given(n, 3);
  for (Index k = 0; k < n; ++k) {
    given.row(k) = values[k];
    waves(k, 0) = 1;
    for (int m = 1; m <= order; ++m) waves.row(k).segment<2>(2 * m - 1) = on_circle(m * t[k]).transpose();
  }
  const Harmonic fitted = least_squares(waves, given);
  const Eigen::MatrixXd rest = given - waves * fitted;
  for (Index k = 0; k < n; ++k) values[k] = rest.row(k);
  std::vector<double> at, flat;
  for (Index k = -wrapped; k <= n + wrapped; ++k) {
    const Index own = (k % n + n) % n, turns = (k - own) / n;
    at.push_back(t[own] + static_cast<double>(turns));
    flat.insert(flat.end(), values[own].data(), values[own].data() + 3);
  }
  const double first = at.front(), length = at.back() - first;
  for (double& x : at) x = (x - first) / length;
  at.back() = 1;
  return around_circle(fitted) + PiecewisePolynomial::spline(at, flat, 3).part(-first / length, (1 - first) / length);
}

std::vector<Vec3> points_of(const Mesh& mesh, const std::vector<Index>& rim) {
  std::vector<Vec3> points;
  for (Index v : rim) points.emplace_back(mesh.vertices.row(v));
  return points;
}

/// What is seen across the rim at its vertices.
struct AcrossRim {
  std::vector<Vec3> normal;
  std::vector<double> t, bend;  // places along it; bend: normal curvature across
};

/// Corners put in many ways, each vertex seen where it is far from them: in the middle of the first side, or of each if they are alike.
/// backwards: what is read together, and where it begins, as of the same rim in a mirror.
AcrossRim seen_in_sides(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, bool backwards,
                        ClosedSide& out) {
  const Index n = static_cast<Index>(rim.size());
  std::vector<SideForm> seen(n);
  const Index third = n / 3, sides = n % 3 == 0 ? 3 : 1, own = n / sides, ways = std::min(own, max_placements / sides);
  for (Index p = 0; p < ways; ++p) {
    // the vertices from `first` on in the middle of the side from corner 0 to 1
    const Index first = p * own / ways, last = (p + 1) * own / ways, before = (third - (last - first)) / 2;
    const Index corner = backwards ? before - first - third : first - before;
    Hole hole;
    for (Index j = 0; j < n; ++j) hole.rim.push_back(rim[(corner + j + 2 * n) % n]);
    hole.corners = {0, third, backwards ? third + n - 2 * n / 3 : 2 * n / 3};
    const MeshSides three = mesh_sides(mesh, around, hole);
    out.surroundings_error = std::max(out.surroundings_error, three.surroundings_error);
    for (Index side = 0; side < sides; ++side) {
      const Index opposite = backwards ? 2 - side : (side + 2) % 3;
      out.side.curvature_error = std::max(out.side.curvature_error, three.sides[opposite].curvature_error);
      for (Index k = first; k < last; ++k) {
        const Index place = before + k - first;  // from where the side begins, in a mirror from where it ends
        const Index at = k + side * third;
        seen[backwards ? (n - at) % n : at] =
            side_form(three.sides[opposite], three.parameters[opposite][backwards ? third - place : place]);
      }
    }
  }
  AcrossRim across;
  double length = 0;
  for (Index k = 0; k < n; ++k) {
    across.t.push_back(length);
    length += (mesh.vertices.row(rim[(k + 1) % n]) - mesh.vertices.row(rim[k])).norm();
  }
  for (double& t : across.t) t /= length;
  out.side.c = closed_spline(across.t, points_of(mesh, rim));
  for (Index k = 0; k < n; ++k) {
    across.normal.push_back(seen[k].n);
    across.bend.push_back(seen[k](out.side.c.derivative_at(across.t[k]).cross(seen[k].n).normalized()));
  }
  return across;
}

/// A meridian is taken unless it says that its curvature is less well known than the sides do by more than this: these are this many times
/// as far off as they say at a tenth of 653 rims of 12 to 64 edges.
constexpr double sides_say_too_little = factor::strong;

/// What a vertex of a round rim is compared with others by: distances from the middle and, with this weight, how far the face next to it
/// leans, of the vertices from it on, each counting less. Equal ones lie alike, unless only what bends farther off differs.
constexpr double lean_counts = 0.37;

/// Where a plane is off a few waves around the boundary by so many times the median, one of the fits that it comes from has failed: on bent
/// pipes of 24 edges single planes are off by 2.5 degrees, the others by 0.1.
constexpr double planes_off = factor::huge;
/// So few waves that two planes next to each other that are off do not bend them; and rounds after which nothing changes by a tenth: choices.
constexpr Index vertices_a_plane_wave = count::half_dozen;
constexpr int robust_rounds = count::dozen;

}  // namespace

void mend_planes(ClosedSide& closed) {
  const Index n = static_cast<Index>(closed.t.size()) - 1, order = std::min(n / vertices_a_plane_wave, max_fitted_waves);
  if (order < 1) return;
  Eigen::MatrixXd waves(n, 2 * order + 1), normals(n, 3);
  for (Index k = 0; k < n; ++k) {
    normals.row(k) = closed.side.normal(closed.t[k]);
    waves(k, 0) = 1;
    for (Index m = 1; m <= order; ++m)
      waves.row(k).segment<2>(2 * m - 1) = on_circle(static_cast<double>(m) * closed.t[k]).transpose();
  }
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(n), off;
  Eigen::MatrixXd fitted;
  double median = 0;
  for (int round = 0; round < robust_rounds; ++round) {  // least absolute deviations, by weighted squares
    fitted = waves * least_squares(Eigen::MatrixXd(weight.asDiagonal() * waves), Eigen::MatrixXd(weight.asDiagonal() * normals));
    off = (normals - fitted).rowwise().norm();
    std::vector<double> sorted(off.data(), off.data() + n);
    std::ranges::nth_element(sorted, sorted.begin() + n / 2);
    median = sorted[static_cast<std::size_t>(n / 2)];
    if (!(median > tolerance::same)) return;
    weight = off.cwiseMax(share::tenth * median).cwiseSqrt().cwiseInverse();
  }
  if (!(off.maxCoeff() > planes_off * median)) return;
  std::vector<Vec3> across;
  for (Index k = 0; k < n; ++k) {
    const Vec3 normal = off[k] > planes_off * median ? fitted.row(k) : normals.row(k);
    across.push_back(closed.side.c.derivative_at(closed.t[k]).cross(normal).normalized());
  }
  closed.side.r = closed_spline({closed.t.begin(), closed.t.end() - 1}, across);
}

ClosedSide closed_side(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, bool backwards,
                       const VertexPlanes& planes) {
  ClosedSide out;
  Hole hole;
  hole.rim = rim;
  AcrossRim seen;
  std::optional<Meridian> meridian = meridian_at(local_mesh(mesh, around, hole));
  if (!meridian || meridian->slope_deviation > well_known) {
    seen = seen_in_sides(mesh, around, rim, backwards, out);
    if (meridian && meridian->curvature_deviation > sides_say_too_little * out.side.curvature_error) meridian = {};
  }
  if (meridian) {
    seen = {std::move(meridian->normal), std::move(meridian->turn), std::vector<double>(rim.size(), meridian->curvature)};
    out.side.c = closed_spline(seen.t, points_of(mesh, rim));
    out.side.curvature_error = meridian->curvature_deviation;
    out.surroundings_error = meridian->slope_deviation * 180 / std::numbers::pi;
  }
  std::vector<Vec3> across, bend;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    if (const auto known = planes.find(rim[k]); known != planes.end()) seen.normal[k] = known->second;
    across.push_back(out.side.c.derivative_at(seen.t[k]).cross(seen.normal[k]).normalized());
    bend.emplace_back(seen.bend[k] * seen.normal[k]);
  }
  out.side.r = closed_spline(seen.t, across);
  out.side.q = closed_spline(seen.t, bend);
  out.t = std::move(seen.t);
  out.t.push_back(1);
  return out;
}

CanonicalStart beginning_of_closed(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  const Index n = static_cast<Index>(rim.size());
  const Points points = mesh.vertices(rim, Eigen::all);
  const Vec3 middle = points.colwise().mean();
  const std::vector<AdjacentFace> beyond = faces_beyond(mesh, around, {rim});
  std::vector<double> before, after;  // of the edges next to each vertex
  for (Index k = 0; k < n; ++k) {
    const Vec3 from = Vec3(points.row(k)) - middle;
    after.push_back(from.norm() + lean_counts * from.dot(beyond[k].normal.stableNormalized()));
    before.push_back(from.norm() + lean_counts * from.dot(beyond[(k + n - 1) % n].normal.stableNormalized()));
  }
  CanonicalStart best;
  double most = 0;
  for (const bool backwards : {false, true})
    for (Index k = 0; k < n; ++k) {
      double sum = 0;
      for (Index j = 0; j < n; ++j)
        sum += (backwards ? before[(k - j + n) % n] : after[(k + j) % n]) / static_cast<double>(1 + j);
      if ((k > 0 || backwards) && !clearly_more(sum, most)) continue;
      most = sum;
      best = {k, backwards};
    }
  return best;
}

}  // namespace tripatch
