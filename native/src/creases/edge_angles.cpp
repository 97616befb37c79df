#include "tripatch/creases/edge_angles.h"

#include <algorithm>

#include "tripatch/math/angle.h"
#include "tripatch/math/ties.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/vertex_normals.h"

namespace tripatch {
namespace {

using EdgePair = std::array<Index, 2>;

/// Of the edges around (share of 0.38: 3%).
constexpr double ordinary_share = 0.75;
/// Between smooth faces a crease that is sharp at the rim is followed to half of that: where two pipes meet it gets blunt by and by
/// (0%, 3%).
constexpr double still_crease = 0.5;

EdgePair edge_pair(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

}  // namespace

Vec3 face_normal(const Mesh& mesh, Index face) { return area_vector(mesh, face).stableNormalized(); }

EdgeAngles::EdgeAngles(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& vertices) {
  std::vector<double> all;
  Numbering faces(mesh.faces.size());
  std::vector<Vec3> normals;  // of these
  const auto normal = [&](Index f) {
    if (faces.add(f)) normals.push_back(face_normal(mesh, f));
    return normals[static_cast<std::size_t>(faces.find(f))];
  };
  for (Index v : vertices)
    for (Connectivity::Corner c : around.at(v)) {
      const Index w = around.next(c);
      const auto across = around.edge(w, v);
      if (!across || (v > w && std::binary_search(vertices.begin(), vertices.end(), w))) continue;
      const double angle = angle_between(normal(around.face(c)), normal(around.face(*across)));
      edges_.push_back({edge_pair(v, w), angle});
      all.push_back(angle);
    }
  std::sort(edges_.begin(), edges_.end());
  if (all.empty()) return;
  const auto ordinary = all.begin() + static_cast<std::ptrdiff_t>(ordinary_share * static_cast<double>(all.size() - 1));
  std::nth_element(all.begin(), ordinary, all.end());
  ordinary_ = *ordinary;
  threshold_ = std::max(least_crease_angle, above_noise * ordinary_);
}

double EdgeAngles::at(Index a, Index b) const {
  const auto found = std::lower_bound(edges_.begin(), edges_.end(), std::pair(edge_pair(a, b), -1.0));
  return found != edges_.end() && found->first == edge_pair(a, b) ? found->second : -1;
}

bool EdgeAngles::sharp(Index a, Index b) const { return clearly_more(at(a, b), threshold_); }

bool EdgeAngles::still_sharp(Index a, Index b) const {
  const double least =
      ordinary_ < smooth_angle ? std::max(still_crease * least_crease_angle, above_noise * ordinary_) : threshold_;
  return clearly_more(at(a, b), least);
}

std::vector<EdgePair> EdgeAngles::all_sharp() const {
  std::vector<EdgePair> out;
  for (const auto& [edge, angle] : edges_)
    if (clearly_more(angle, threshold_)) out.push_back(edge);
  return out;
}

}  // namespace tripatch
