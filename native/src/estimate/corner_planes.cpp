#include "tripatch/estimate/corner_planes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

namespace {

// Half and twice of these numbers were tried on 78 rims in meshes of balls, tori, saddles and fillets, of 1 to 16 edges a side, with noise
// of 0 to 2% of an edge. Two percentages tell by how much planes err more in the mean: with half, with twice of it.
/// Degrees between the planes of two sides at their corner: each keeps its own (0%, -3%).
constexpr double never_one_plane = angle::steep;
constexpr double one_plane = angle::slight;    ///< also from so many degrees on (0%, -2%),
constexpr double apart = deviations::certain;  ///< where they are so many standard deviations apart (2%, -3%)
/// Faces in one plane at a corner, as wide as so many edges of the rim, are looked at: no needles. Any width between half and twice of it
/// does for all 78.
constexpr double wide = share::three_tenths;
/// Of the turn from face to face: sides whose turns differ by no more are even, an arc between two planes.
constexpr double even_turns = share::little;
/// By how much planes along a side between two planes are off, of what its turns differ by: arcs of ellipses, of axes of 1.3 to 2, in
/// two to four faces.
constexpr double expected_error_uneven = 0.4;
/// Shares of a side's turn at its last inner vertex by which the plane behind its end may lean against its last face; half in a fillet
/// whose facets are even.
constexpr double min_lean = share::quarter, greatest_lean = share::most;
/// Of that turn: an edge between a side and the plane, clearly; up to it there may be none.
constexpr double clear_edge = factor::clear;

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

/// A flat side between the planes behind its ends, seen so that what is left of both up to their common line is equally long: what was the
/// arc of a circle, and was stretched, is one again.
class ArcFrame {
public:
  static std::optional<ArcFrame> of(const SideDraft& side, const Vec3& start_plane, const Vec3& end_plane) {
    const std::vector<Vec3>& p = side.position;
    if (p.size() < 3) return {};
    ArcFrame frame;
    const Vec3 chord = p.back() - p.front();
    Vec3 about = Vec3::Zero();
    for (std::size_t k = 1; k + 1 < p.size(); ++k) about += (p[k] - p.front()).cross(chord);
    about.normalize();
    for (const Vec3& q : p)
      if (!(std::abs((q - p.front()).dot(about)) <= tolerance::slight * chord.norm())) return {};
    Eigen::Matrix<double, 3, 2> legs;  // along which the planes are left
    legs << start_plane.cross(about).normalized(), end_plane.cross(about).normalized();
    const Eigen::Vector2d x = (legs.transpose() * legs).inverse() * (legs.transpose() * chord);
    frame.apex_ = p.front() + x[0] * legs.col(0);
    frame.legs_ << p.front() - frame.apex_, p.back() - frame.apex_;
    const double angle = angle_between(frame.legs_.col(0), frame.legs_.col(1));
    frame.shape_ << 1, std::cos(angle), 0, std::sin(angle);
    frame.back_ = (frame.legs_.transpose() * frame.legs_).inverse() * frame.legs_.transpose();
    for (std::size_t k = 0; k < p.size(); ++k) {
      frame.place_.emplace_back(frame.back_ * (p[k] - frame.apex_));
      const bool inner = k > 0 && k + 1 < p.size();
      if (inner && !(frame.place_[k].minCoeff() > 0 && frame.place_[k].sum() < 1)) return {};
    }
    for (std::size_t k = 0; k + 1 < p.size(); ++k)
      frame.way_.emplace_back(frame.shape_ * (frame.place_[k + 1] - frame.place_[k]));
    return frame;
  }

  /// Radians between its edges at an inner vertex, and of its first or last one against the plane behind it.
  double turn(int k) const { return angle_in_plane(way_[k - 1], way_[k]); }
  double lean(bool end) const {
    return end ? angle_in_plane(way_.back(), shape_.col(1)) : angle_in_plane(-shape_.col(0), way_.front());
  }

  /// The direction at an inner vertex of the conic through it that leaves both planes: with places a, b along the legs and c = 1 - a - b all
  /// these conics are c^2 = k a b. Turned by so much, as it is seen.
  Vec3 tangent(int k, double turned = 0) const {
    const double a = place_[k][0], b = place_[k][1], c = 1 - a - b, of = c * c / (a * b);
    const Vec2 way = (shape_ * Vec2(-(2 * c + of * a), 2 * c + of * b)).normalized();
    return (legs_ * (shape_.inverse() * (way + turned * Vec2(-way[1], way[0])))).normalized();
  }

private:
  Vec3 apex_;
  Eigen::Matrix<double, 3, 2> legs_;
  Eigen::Matrix<double, 2, 3> back_;
  Eigen::Matrix2d shape_;    // the legs as they are seen
  std::vector<Vec2> place_;  // of the vertices, by the legs
  std::vector<Vec2> way_;    // the edges as they are seen
};

/// Whether the faces next to a side, but for those next to each other, have none beyond them that bends by so much (radians).
bool is_strip(const LocalMesh& w, const SideDraft& side, double bend) {
  const auto beside = [&](int f) { return std::find(side.face.begin(), side.face.end(), f) != side.face.end(); };
  for (std::size_t k = 0; k < side.face.size(); ++k)
    for (int f = side.face[k], c = w.part.offsets[f]; c < w.part.offsets[f + 1]; ++c) {
      const int v = w.part.corners[c], next = w.part.corners[c + 1 < w.part.offsets[f + 1] ? c + 1 : w.part.offsets[f]];
      const bool along =
          v == side.vertex.front() || next == side.vertex.front() || v == side.vertex.back() || next == side.vertex.back();
      const int g = w.across[c];
      if (g >= 0 && !along && !beside(g) && angle_between(w.area[f], w.area[g]) > bend) return false;
    }
  return true;
}

/// How a side comes to the plane behind its end.
struct EndOfSide {
  double lean = 0, turn = 0;    // radians: of its last face against the plane, and against the one before it
  bool from_within = false;     // the face before it leans more
  bool seen_stretched = false;  // in an ArcFrame: the side bends towards the plane all along
  /// Whether it is the plane there, as where a fillet ends.
  bool is_smooth() const { return from_within && (seen_stretched || min_lean * turn < lean) && lean < greatest_lean * turn; }
  /// Whether it may be or not, one as likely as the other: of strips. Where rows of faces follow each other fits know better.
  bool is_doubtful(const LocalMesh& w, const SideDraft& side) const {
    return seen_stretched && !is_smooth() && lean < clear_edge * turn && is_strip(w, side, min_lean * turn);
  }
  /// How far the plane may be off, by what it leans otherwise than by half of a turn.
  double off() const { return expected_error_uneven * (lean - turn / 2); }
};

EndOfSide end_of(const LocalMesh& w, const SideDraft& side, bool end, const Vec3& plane, const std::optional<ArcFrame>& frame) {
  const int edges = side.edges();
  if (edges < 2) return {};
  if (frame) return {frame->lean(end), frame->turn(end ? edges - 1 : 1), true, true};
  const Vec3 last = w.area[side.face[end ? edges - 1 : 0]], before = w.area[side.face[end ? edges - 2 : 1]];
  const double turn = angle_between(before, last);
  return {angle_between(last, plane), turn, angle_between(before, plane) > turn, false};
}

/// The edge between the faces next to a side at an inner vertex, along which a strip is straight; none where more faces meet there.
std::optional<Vec3> ruling_at(const LocalMesh& w, const SideDraft& side, int k) {
  const int v = side.vertex[k];
  if (w.part.faces_at(v).size() != 2) return {};
  for (int a : w.part[side.face[k - 1]])
    for (int b : w.part[side.face[k]])
      if (a == b && a != v) return w.position[a] - w.position[v];
  return {};
}

/// Planes along a side that begins and ends in a plane: those of conics, and of the rulings of its strip where that has one row. On stretched
/// arcs they are exact. What its turns differ by, as it is seen, is what they may be off.
void take_planes_of_conics(const LocalMesh& w, const ArcFrame& frame, SideFit& fit, SideDraft& side) {
  const int edges = side.edges();
  double least = INFINITY, most = 0;
  for (int k = 1; k < edges; ++k) {
    least = std::min(least, frame.turn(k));
    most = std::max(most, frame.turn(k));
  }
  const double ends = std::max(fit.slope_variances.front(), fit.slope_variances.back());
  for (int k = 1; k < edges; ++k) {
    const Vec3 along = frame.tangent(k), mean = mean_of_facets(w, side, k);
    const double off = angle_between(along, frame.tangent(k, expected_error_uneven * (most - least))),
                 variance = std::max(off * off, ends);
    if (!(variance < fit.slope_variances[k] || most - least <= even_turns * most)) continue;
    const std::optional<Vec3> ruling = ruling_at(w, side, k);
    Vec3 normal = ruling ? along.cross(*ruling) : Vec3(mean - along * along.dot(mean));
    if (normal.dot(mean) < 0) normal = -normal;
    if (!(normal.norm() > 0)) continue;
    side.normal[k] = normal.normalized();
    fit.slope_variances[k] = std::min(fit.slope_variances[k], variance);
  }
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
      std::max({std::pow(expected_error_uneven * (most - least), 2), fit.slope_variances.front(), fit.slope_variances.back()});
  for (int k = 1; k < edges; ++k) {
    if (even) side.normal[k] = mean_of_facets(w, side, k).stableNormalized();
    fit.slope_variances[k] = std::min(fit.slope_variances[k], uneven);
  }
}

}  // namespace

void take_flat_corners(const LocalMesh& w, std::array<SideFit, 3>& fits, const std::array<bool, 3>& alone,
                       std::array<SideDraft, 3>& drafts) {
  std::array<std::optional<Vec3>, 3> planes;
  for (int corner = 0; corner < 3; ++corner) {
    const int in = (corner + 1) % 3, out = (corner + 2) % 3;
    if (alone[in] || alone[out]) continue;
    const SideDraft &a = drafts[in], &b = drafts[out];
    const double edge =
        std::max((a.position.back() - a.position[a.position.size() - 2]).norm(), (b.position[1] - b.position[0]).norm());
    planes[corner] = flat_at(w, b.vertex.front(), {a.face.back(), b.face.front()}, edge);
  }
  std::array<std::optional<ArcFrame>, 3> frames;
  for (int i = 0; i < 3; ++i)
    if (const auto &start = planes[(i + 1) % 3], &end = planes[(i + 2) % 3]; start && end)
      frames[i] = ArcFrame::of(drafts[i], *start, *end);
  for (int corner = 0; corner < 3; ++corner) {
    const int in = (corner + 1) % 3, out = (corner + 2) % 3;
    const std::optional<Vec3>& plane = planes[corner];
    if (!plane) continue;
    const SideDraft &a = drafts[in], &b = drafts[out];
    const EndOfSide x = end_of(w, a, true, *plane, frames[in]), y = end_of(w, b, false, *plane, frames[out]);
    double &x_variance = fits[in].slope_variances.back(), &y_variance = fits[out].slope_variances.front();
    if (!x.is_smooth() || !y.is_smooth()) {
      if (x.is_doubtful(w, a)) x_variance = std::max(x_variance, std::pow(angle_between(a.normal.back(), *plane), 2) / 2);
      if (y.is_doubtful(w, b)) y_variance = std::max(y_variance, std::pow(angle_between(b.normal.front(), *plane), 2) / 2);
      continue;
    }
    // where facets are small the fits know better than that they turn evenly
    const auto is_known = [](const EndOfSide& end, double variance) {
      return end.turn < coarse_turn && end.off() * end.off() > variance;
    };
    if (is_known(x, x_variance + fits[in].turned) || is_known(y, y_variance + fits[out].turned)) continue;
    drafts[in].normal.back() = drafts[out].normal.front() = *plane;
    fits[in].flat[1] = fits[out].flat[0] = true;
    x_variance = x.off() * x.off();
    y_variance = y.off() * y.off();
  }
  for (int i = 0; i < 3; ++i) {  // between two planes nothing is left of a turn that was not seen
    if (!fits[i].flat[0] || !fits[i].flat[1]) continue;
    fits[i].turned = 0;
    if (frames[i])
      take_planes_of_conics(w, *frames[i], fits[i], drafts[i]);
    else
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

bool is_one_plane(double degrees, double deviations) {
  return degrees <= never_one_plane && (degrees <= one_plane || deviations <= apart);
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
    if (!is_one_plane(degrees, deviations)) continue;
    const Vec3 n = (mean + across * (x - own * share)).normalized();
    drafts[in].normal.back() = n;
    drafts[out].normal.front() = n;
  }
}

}  // namespace tripatch
