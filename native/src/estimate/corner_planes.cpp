#include "tripatch/estimate/corner_planes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "tripatch/math/angle.h"

namespace tripatch {

namespace {

// Half and twice of these numbers were tried on 78 rims in meshes of balls, tori, saddles and fillets, of 1 to 16 edges a side, with noise
// of 0 to 2% of an edge. Two percentages tell by how much planes err more in the mean: with half, with twice of it.
constexpr double never_one_plane =
    60;                          ///< degrees between the planes of two sides at their corner: each keeps its own (0%, -3%);
constexpr double one_plane = 5;  ///< also from so many degrees on (0%, -2%),
constexpr double apart = 5;      ///< where they are so many standard deviations apart (2%, -3%)
/// Faces in one plane at a corner, as wide as so many edges of the rim, are looked at: no needles. Any width between half and twice of it
/// does for all 78.
constexpr double wide = 0.5;
/// Of the turn from face to face: sides whose turns differ by no more are even, an arc between two planes.
constexpr double even_turns = 0.05;
/// By how much planes along a side between two planes are off, of what its turns differ by: arcs of ellipses, of axes of 1.3 to 2, in
/// two to four faces.
constexpr double off_by_uneven = 0.4;
/// Shares of a side's turn at its last inner vertex by which the plane behind its end may lean against its last face; half in a fillet
/// whose facets are even.
constexpr double least_lean = 0.25, greatest_lean = 0.75;

/// The covariance of a fit's normal, seen in another frame.
Eigen::Matrix2d covariance_in(const Eigen::Matrix<double, 3, 2>& across, const VertexFit& fit) {
  const Eigen::Matrix2d back = (fit.frame.transpose() * across).inverse();
  return back * fit.covariance * back.transpose();
}

/// The plane of the faces at a vertex besides two, if they lie in one and are wide.
std::optional<Vec3> flat_at(const LocalMesh& w, int v, const std::array<int, 2>& besides, double edge) {
  std::vector<int> faces;
  for (int f : w.part.faces_at(v))
    if (f != besides[0] && f != besides[1]) faces.push_back(f);
  if (faces.empty()) return {};
  const Vec3 n = w.area[faces[0]];
  double twice_area = 0;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    if (degrees_between(w.area[faces[k]], n) > coplanar) return {};
    twice_area += w.area[faces[k]].norm();
  }
  if (!(0.5 * twice_area > wide * wide * edge * edge)) return {};
  return n.normalized();
}

/// How far a plane behind the end of a side may be off, radians, by what it leans against its last face otherwise than by half of what the
/// side turns by from face to face, as where a fillet ends; nothing where it leans otherwise altogether.
std::optional<double> off_half_turn(const LocalMesh& w, const SideDraft& side, bool end, const Vec3& plane) {
  const std::size_t edges = side.face.size();
  if (edges < 2) return {};
  const Vec3 last = w.area[side.face[end ? edges - 1 : 0]], before = w.area[side.face[end ? edges - 2 : 1]];
  const double turn = angle_between(before, last), lean = angle_between(last, plane);
  if (!(least_lean * turn < lean && lean < greatest_lean * turn) || !(angle_between(before, plane) > turn)) return {};
  return off_by_uneven * (lean - turn / 2);
}

/// The facets' means along a side that begins and ends in a plane, where it turns evenly: on an arc they are exact. Where it does not, what
/// its turns differ by is what they say too little.
void take_even_facets(const LocalMesh& w, SideFit& fit, SideDraft& side) {
  const int edges = side.edges();
  double least = INFINITY, most = 0;
  for (int k = 1; k < edges; ++k) {
    const double turn = angle_between(w.area[side.face[k - 1]], w.area[side.face[k]]);
    least = std::min(least, turn);
    most = std::max(most, turn);
  }
  const bool even = most - least <= even_turns * most;
  const double uneven =
      std::max({std::pow(off_by_uneven * (most - least), 2), fit.slope_variances.front(), fit.slope_variances.back()});
  for (int k = 1; k < edges; ++k) {
    if (even) side.normal[k] = mean_of_facets(w, side, k).stableNormalized();
    fit.slope_variances[k] = std::min(fit.slope_variances[k], uneven);
  }
}

}  // namespace

void take_flat_corners(const LocalMesh& w, std::array<SideFit, 3>& fits, const std::array<bool, 3>& alone,
                       std::array<SideDraft, 3>& drafts) {
  for (int corner = 0; corner < 3; ++corner) {
    const int in = (corner + 1) % 3, out = (corner + 2) % 3;
    if (alone[in] || alone[out]) continue;
    const SideDraft &a = drafts[in], &b = drafts[out];
    const double edge =
        std::max((a.position.back() - a.position[a.position.size() - 2]).norm(), (b.position[1] - b.position[0]).norm());
    const std::optional<Vec3> plane = flat_at(w, b.vertex.front(), {a.face.back(), b.face.front()}, edge);
    if (!plane) continue;
    const std::optional<double> x = off_half_turn(w, a, true, *plane), y = off_half_turn(w, b, false, *plane);
    if (!x || !y) continue;
    // where facets are small the fits know better than that they turn evenly
    if (*x * *x > fits[in].slope_variances.back() + fits[in].turned ||
        *y * *y > fits[out].slope_variances.front() + fits[out].turned)
      continue;
    drafts[in].normal.back() = drafts[out].normal.front() = *plane;
    fits[in].flat[1] = fits[out].flat[0] = true;
    fits[in].slope_variances.back() = *x * *x;
    fits[out].slope_variances.front() = *y * *y;
  }
  for (int i = 0; i < 3; ++i) {  // between two planes nothing is left of a turn that was not seen
    if (!fits[i].flat[0] || !fits[i].flat[1]) continue;
    fits[i].turned = 0;
    take_even_facets(w, fits[i], drafts[i]);
  }
}

double sum_of_variances(const SideFit& fit) {
  double sum = 0;
  const std::size_t n = fit.slope_variances.size();
  for (std::size_t k = 0; k < n; ++k) {
    const bool flat = (k == 0 && fit.flat[0]) || (k + 1 == n && fit.flat[1]);
    sum += fit.slope_variances[k] + (flat ? 0 : fit.turned);
  }
  return sum;
}

void settle_corners(const std::array<SideFit, 3>& fits, const std::array<bool, 3>& alone, std::array<SideDraft, 3>& drafts) {
  for (int corner = 0; corner < 3; ++corner) {
    const int in = (corner + 1) % 3, out = (corner + 2) % 3;
    if (alone[in] || alone[out] || fits[in].flat[1]) continue;
    const VertexFit &a = fits[in].ends[1], &b = fits[out].ends[0];
    const double degrees = degrees_between(a.normal, b.normal);
    if (degrees > never_one_plane) continue;
    const Vec3 mean = (a.normal + b.normal).normalized();
    Eigen::Matrix<double, 3, 2> across;
    across.col(0) = mean.unitOrthogonal();
    across.col(1) = mean.cross(across.col(0));
    // By covariances: what is known of a plane along its side may be known 1e12 times as well as across it, and the sum of two
    // informations would leave the rest to rounding.
    const Eigen::Matrix2d own = covariance_in(across, a), both = own + covariance_in(across, b);
    const Eigen::Vector2d x = across.transpose() * a.normal, y = across.transpose() * b.normal;
    const Eigen::Vector2d share = both.inverse() * (x - y);
    const double deviations = std::sqrt((x - y).dot(share));
    if (degrees > one_plane && deviations > apart) continue;
    const Vec3 n = (mean + across * (x - own * share)).normalized();
    drafts[in].normal.back() = n;
    drafts[out].normal.front() = n;
  }
}

}  // namespace tripatch
