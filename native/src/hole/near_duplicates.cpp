#include "tripatch/hole/near_duplicates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "tripatch/math/ties.h"
#include "tripatch/mesh/border_loops.h"

namespace tripatch {
namespace {

/// Of an edge's length: what lies farther off is a gap, however near by the mesh's size.
constexpr double near_share = 0.01;

/// An edge of a border, in the direction of new faces.
struct BorderSegment {
  Index from, to;
  std::size_t loop;
  Vec3 p, q;
  double length() const { return (q - p).norm(); }
};

std::vector<BorderSegment> segments_of(const Mesh& mesh, std::span<const std::vector<Index>> loops) {
  std::vector<BorderSegment> segments;
  for (std::size_t l = 0; l < loops.size(); ++l)
    for (std::size_t k = 0; k < loops[l].size(); ++k) {
      const Index a = loops[l][k], b = loops[l][(k + 1) % loops[l].size()];
      const Vec3 p = mesh.vertices.row(a), q = mesh.vertices.row(b);
      if (p.allFinite() && q.allFinite()) segments.push_back({a, b, l, p, q});
    }
  return segments;
}

double distance_to(const BorderSegment& segment, const Vec3& point) {
  const Vec3 way = segment.q - segment.p;
  const double square = way.squaredNorm();
  const double t = square > 0 ? std::clamp((point - segment.p).dot(way) / square, 0.0, 1.0) : 0;
  return (segment.p + t * way - point).norm();
}

/// Segments in boxes, each halved across its longest side.
class SegmentTree {
public:
  explicit SegmentTree(const std::vector<BorderSegment>& segments) : segments_(segments), order_(segments.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    if (!order_.empty()) build(0, order_.size());
  }

  /// Calls take(number of the segment) for each within `distance` of a point.
  template <class Take>
  void near(const Vec3& point, double distance, const Take& take) const {
    std::vector<std::size_t> open;
    if (!nodes_.empty()) open.push_back(0);
    while (!open.empty()) {
      const std::size_t at = open.back();
      const Node& node = nodes_[at];
      open.pop_back();
      if (node.box.squaredExteriorDistance(point) > distance * distance) continue;
      if (node.second > 0) {
        open.push_back(at + 1);
        open.push_back(node.second);
        continue;
      }
      for (std::size_t k = node.first; k < node.end; ++k)
        if (distance_to(segments_[order_[k]], point) <= distance) take(order_[k]);
    }
  }

private:
  static constexpr std::size_t few = 4;
  struct Node {
    Eigen::AlignedBox3d box;
    std::size_t first, end, second = 0;  // the nodes after this one, and that; 0: a leaf
  };

  std::size_t build(std::size_t first, std::size_t end) {
    const std::size_t at = nodes_.size();
    Eigen::AlignedBox3d box;
    for (std::size_t k = first; k < end; ++k) box.extend(segments_[order_[k]].p).extend(segments_[order_[k]].q);
    nodes_.push_back({box, first, end});
    if (end - first <= few) return at;
    Index axis = 0;
    box.sizes().maxCoeff(&axis);
    const std::size_t middle = (first + end) / 2;
    const auto place = [&](std::size_t k) { return segments_[k].p[axis] + segments_[k].q[axis]; };
    const auto begin = order_.begin();
    std::nth_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(middle),
                     begin + static_cast<std::ptrdiff_t>(end), [&](std::size_t a, std::size_t b) { return place(a) < place(b); });
    build(first, middle);
    const std::size_t second = build(middle, end);
    nodes_[at].second = second;
    return at;
  }

  const std::vector<BorderSegment>& segments_;
  std::vector<std::size_t> order_;
  std::vector<Node> nodes_;
};

constexpr std::size_t no_partner = static_cast<std::size_t>(-1);

/// For each segment the one that lies on it and runs the other way, if that is one clearly.
std::vector<std::size_t> partners(const std::vector<BorderSegment>& segments, double distance) {
  const SegmentTree tree(segments);
  std::vector<std::size_t> nearest(segments.size(), no_partner);
  for (std::size_t e = 0; e < segments.size(); ++e) {
    const BorderSegment& own = segments[e];
    if (own.length() <= 2 * distance) continue;
    double least = INFINITY;
    bool clear = true;
    tree.near(0.5 * (own.p + own.q), distance, [&](std::size_t f) {
      const BorderSegment& other = segments[f];
      if (f == e || other.length() <= 2 * distance) return;
      const double off = std::max((own.p - other.q).norm(), (own.q - other.p).norm());
      if (off > distance) return;
      const double better = least - off;
      if (std::abs(better) <= tie * own.length()) clear = false;
      if (better > tie * own.length()) least = off, nearest[e] = f, clear = true;
    });
    if (!clear) nearest[e] = no_partner;
  }
  for (std::size_t e = 0; e < segments.size(); ++e)
    if (nearest[e] != no_partner && nearest[nearest[e]] != e) nearest[e] = no_partner;
  return nearest;
}

Index root(std::vector<Index>& stands, Index v) {
  while (stands[v] != v) v = stands[v] = stands[stands[v]];
  return v;
}

void unite(std::vector<Index>& stands, Index a, Index b) {
  a = root(stands, a), b = root(stands, b);
  stands[std::max(a, b)] = std::min(a, b);
}

/// Vertices that a face would have twice stand for themselves again, and so do those that stood with them.
void part_within_faces(const FacesRef& faces, std::vector<Index>& stands) {
  std::vector<char> parted(stands.size(), 0);
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t i = 0; i < faces[f].size(); ++i)
      for (std::size_t k = i + 1; k < faces[f].size(); ++k)
        if (faces[f][i] != faces[f][k] && stands[faces[f][i]] == stands[faces[f][k]]) parted[stands[faces[f][i]]] = 1;
  for (std::size_t v = 0; v < stands.size(); ++v)
    if (parted[stands[v]]) stands[v] = static_cast<Index>(v);
}

}  // namespace

double size_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices.row(v).allFinite()) box.extend(Vec3(mesh.vertices.row(v)));
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

JoinedBorders join_borders(const Mesh& mesh, double distance) {
  const std::vector<std::vector<Index>> loops = border_loops(Connectivity(mesh));
  const std::vector<BorderSegment> segments = segments_of(mesh, loops);
  const std::vector<std::size_t> partner = partners(segments, distance);
  if (std::ranges::all_of(partner, [](std::size_t p) { return p == no_partner; })) return {};
  JoinedBorders joined;
  joined.stands.resize(mesh.vertices.rows());
  std::iota(joined.stands.begin(), joined.stands.end(), Index{0});
  for (std::size_t e = 0; e < segments.size(); ++e) {
    if (partner[e] == no_partner) continue;
    unite(joined.stands, segments[e].from, segments[partner[e]].to);
    unite(joined.stands, segments[e].to, segments[partner[e]].from);
  }
  for (std::size_t v = 0; v < joined.stands.size(); ++v) joined.stands[v] = root(joined.stands, static_cast<Index>(v));
  part_within_faces(mesh.faces, joined.stands);
  joined.faces = Faces(mesh.faces);
  for (Index& v : joined.faces.corners) v = joined.stands[v];
  return joined;
}

std::vector<Contact> contacts(const Mesh& mesh, std::span<const std::vector<Index>> loops) {
  const double reach = near_place * size_of(mesh);
  const std::vector<BorderSegment> segments = segments_of(mesh, loops);
  const SegmentTree tree(segments);
  std::vector<Contact> found(loops.size());
  for (std::size_t e = 0; e < segments.size(); ++e) {
    const BorderSegment& own = segments[e];
    const double within = std::min(reach, near_share * own.length());
    bool on_any = true, on_others = true;
    for (const double t : {0.25, 0.5, 0.75}) {
      bool any = false, others = false;
      tree.near(own.p + t * (own.q - own.p), within, [&](std::size_t f) {
        any |= f != e;
        others |= segments[f].loop != own.loop;
      });
      on_any &= any;
      on_others &= others;
    }
    if (!on_any) continue;
    Contact& contact = found[own.loop];
    if (contact.on_others + contact.on_itself == 0) contact.edge = {std::min(own.from, own.to), std::max(own.from, own.to)};
    ++(on_others ? contact.on_others : contact.on_itself);
  }
  return found;
}

}  // namespace tripatch
