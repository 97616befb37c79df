#include "tripatch/creases/rim_labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tripatch/creases/edge_angles.h"
#include "tripatch/math/angle.h"

namespace tripatch {
namespace {

/// Between edges of the rim that tell the plane of a wall that has no face left, at least.
constexpr double least_turn = 20 * std::numbers::pi / 180;
/// Planes that may be those of walls without faces.
constexpr std::size_t most_unseen = 8;

constexpr double not_possible = std::numeric_limits<double>::infinity();

}  // namespace

RimLabels::RimLabels(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, const PiecesFound& found)
    : around_(around), rim_(rim), found_(found), points_(mesh.vertices(rim, Eigen::all)), n_(rim.size()) {
  for (const SmoothPiece& piece : found.pieces) seen_.push_back(rows(piece));
  for (std::size_t k = 0; k < n_; ++k)
    for (const Connectivity::Corner c : around.at(rim[k]))
      if (const auto piece = found.of_face.find(around.face(c)); piece != found.of_face.end()) seen_[piece->second].in[k] = 1;
}

RimLabels::Rows RimLabels::rows(const SmoothPiece& piece) const {
  Rows out{std::vector<char>(n_, 0), Points()};
  if (!piece.continues()) return out;
  SmoothPiece::At at = piece.at(points_);
  for (std::size_t k = 0; k < n_; ++k) out.in[k] = std::abs(at.distance[static_cast<Index>(k)]) < piece.tolerance();
  out.normals = std::move(at.normal);
  return out;
}

std::vector<SmoothPiece> RimLabels::unseen(double across) const {
  std::vector<SmoothPiece> planes;
  for (std::size_t k = 0; k < n_; ++k) {
    const std::array<std::size_t, 3> places = {(k + n_ - 1) % n_, k, (k + 1) % n_};
    const Vec3 before = at(k) - at(places[0]), after = at(places[2]) - at(k), normal = before.cross(after);
    if (!(normal.norm() > std::sin(least_turn) * before.norm() * after.norm())) continue;
    const auto has_all = [&](const Rows& rows) {
      return std::ranges::all_of(places, [&](std::size_t p) { return rows.in[p] != 0; });
    };
    if (std::ranges::any_of(seen_, has_all)) continue;
    if (std::ranges::any_of(planes, [&](const SmoothPiece& plane) { return has_all(rows(plane)); })) continue;
    if (planes.size() == most_unseen) return {};
    planes.emplace_back(normal.stableNormalized(), at(k), across);
  }
  return planes;
}

std::vector<std::size_t> RimLabels::labels(const std::vector<SmoothPiece>& lost) const {
  std::vector<Rows> all = seen_;
  for (const SmoothPiece& plane : lost) all.push_back(rows(plane));
  const std::size_t pieces = all.size();
  const auto change = [&](std::size_t k, std::size_t from, std::size_t to) {
    return from == to ? 0 : may_change(all, k, from, to) ? 1 : not_possible;
  };
  double least = not_possible;
  std::vector<std::size_t> best;
  for (std::size_t begin = 0; begin < pieces; ++begin) {
    std::vector<double> sum(pieces, not_possible);
    sum[begin] = cost(all, 0, begin);
    if (sum[begin] == not_possible) continue;
    std::vector<std::vector<std::size_t>> before(n_, std::vector<std::size_t>(pieces, 0));
    for (std::size_t k = 1; k < n_; ++k) {
      std::vector<double> next(pieces, not_possible);
      for (std::size_t p = 0; p < pieces; ++p) {
        const double own = cost(all, k, p);
        for (std::size_t q = 0; q < pieces && own < not_possible; ++q)
          if (sum[q] < not_possible)
            if (const double with = sum[q] + own + change(k, q, p); with < next[p]) next[p] = with, before[k][p] = q;
      }
      sum = std::move(next);
    }
    for (std::size_t p = 0; p < pieces; ++p) {
      if (!(sum[p] < least)) continue;
      const double with = sum[p] + change(0, p, begin);
      if (!(with < least)) continue;
      least = with;
      best.assign(n_, p);
      for (std::size_t k = n_ - 1; k > 0; --k) best[k - 1] = before[k][best[k]];
    }
  }
  for (std::size_t k = 0; k < best.size(); ++k)
    if (best[k] != best[(k + n_ - 1) % n_] && !has_lost_something(all, best, k)) return {};
  return best;
}

double RimLabels::cost(const std::vector<Rows>& all, std::size_t edge, std::size_t piece) const {
  const Rows& rows = all[piece];
  if (rows.normals.rows() == 0) return not_possible;
  if (piece == found_.beside[edge]) return 0;
  if (!rows.in[edge] || !rows.in[(edge + 1) % n_]) return not_possible;
  return (piece < seen_.size() ? 1.0 : 2.0) / (4 * static_cast<double>(n_));  // all together less than a change
}

bool RimLabels::has_edge_between(Index vertex, std::size_t a, std::size_t b) const {
  const auto piece_of = [&](std::optional<Connectivity::Corner> c) {
    const auto found = c ? found_.of_face.find(around_.face(*c)) : found_.of_face.end();
    return found == found_.of_face.end() ? found_.pieces.size() : found->second;
  };
  return std::ranges::any_of(around_.at(vertex), [&](Connectivity::Corner c) {
    const Index w = around_.next(c);
    const std::size_t one = piece_of(around_.edge(vertex, w)), other = piece_of(around_.edge(w, vertex));
    return (one == a && other == b) || (one == b && other == a);
  });
}

/// Whether the crease between two pieces that meet at a place of the rim can be seen there.
bool RimLabels::may_change(const std::vector<Rows>& all, std::size_t place, std::size_t before, std::size_t here) const {
  const Index row = static_cast<Index>(place);
  const double turn = angle_between(all[before].normals.row(row), all[here].normals.row(row));
  const bool unseen = std::max(before, here) >= seen_.size();
  if (turn < least_crease_angle || (unseen && turn > std::numbers::pi - least_crease_angle)) return false;
  const std::size_t beside = found_.beside[place], last = found_.beside[(place + n_ - 1) % n_];
  if (beside == last && beside != here && beside != before) return true;  // a third piece, which has both edges
  // where the border of one leaves the other, no face of which is left
  if (here >= seen_.size() && beside == before && !all[here].in[(place + n_ - 1) % n_]) return true;
  if (before >= seen_.size() && last == here && !all[before].in[(place + 1) % n_]) return true;
  for (const std::size_t one : {before, last})
    for (const std::size_t other : {here, beside})
      if (one != other && has_edge_between(rim_[place], one, other)) return true;
  return false;
}

/// Of the piece whose run begins at a place. Not where its border is straight between two of its corners; nor where it is nowhere next to its run.
bool RimLabels::has_lost_something(const std::vector<Rows>& all, const std::vector<std::size_t>& labels,
                                   std::size_t first) const {
  const std::size_t piece = labels[first];
  if (piece >= seen_.size()) return true;
  std::size_t end = first;
  bool is_beside = false;
  for (; end == first || labels[end % n_] == piece; ++end) is_beside = is_beside || found_.beside[end % n_] == piece;
  const auto turn =
      [&](std::size_t place) {  // to the left as the rim continues around the piece; none where it does not pass there
        const std::size_t k = place % n_, last = (k + n_ - 1) % n_;
        if (found_.beside[k] != piece || found_.beside[last] != piece) return 0.0;
        const Vec3 before = at(k) - at(last), after = at(k + 1) - at(k);
        return std::atan2(before.cross(after).dot(all[piece].normals.row(static_cast<Index>(k))), before.dot(after));
      };
  double turned = 0;
  for (std::size_t k = first + 1; k < end; ++k) turned += turn(k);
  const bool between_corners = turn(first) < -least_turn && turn(end) < -least_turn && turned < least_turn;
  return is_beside && !between_corners;
}

}  // namespace tripatch
