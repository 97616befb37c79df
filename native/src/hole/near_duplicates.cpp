#include "tripatch/hole/near_duplicates.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>

#include "tripatch/math/box_tree.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/edge_key.h"

namespace tripatch {
namespace {

/// Of an edge's length: what lies farther off is a gap, however near by the mesh's size.
constexpr double near_share = share::hundredth;

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

/// Which segments are near a point.
class NearSegments {
public:
  explicit NearSegments(const std::vector<BorderSegment>& segments) : segments_(segments), tree_(boxes_of(segments)) {}

  /// Calls take(number of the segment) for each within `distance` of a point.
  template <class Take>
  void near(const Vec3& point, double distance, const Take& take) const {
    const Vec3 reach = Vec3::Constant(distance);
    tree_.each_meeting({point - reach, point + reach}, [&](std::size_t k) {
      if (distance_to(segments_[k], point) <= distance) take(k);
    });
  }

private:
  static std::vector<BoxTree::Box> boxes_of(const std::vector<BorderSegment>& segments) {
    std::vector<BoxTree::Box> boxes;
    for (const BorderSegment& each : segments) boxes.push_back(BoxTree::Box(each.p).extend(each.q));
    return boxes;
  }

  const std::vector<BorderSegment>& segments_;
  BoxTree tree_;
};

constexpr std::size_t no_partner = static_cast<std::size_t>(-1);

/// For each segment the one that lies on it and runs the other way, if that is one clearly.
std::vector<std::size_t> partners(const std::vector<BorderSegment>& segments, const NearSegments& tree, double distance) {
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

/// A segment that lies along another and runs the other way, and the part of that, in lengths from its start, where it does.
struct EdgeOverlap {
  std::size_t own, other;
  double first, last;
};

/// The ends of a segment that lie on another, in lengths from the start of that.
std::vector<double> ends_on(const BorderSegment& other, const BorderSegment& own, double distance) {
  std::vector<double> found;
  const Vec3 way = (own.q - own.p).normalized();
  for (const Vec3& end : {other.p, other.q})
    if (distance_to(own, end) <= distance) found.push_back(std::clamp((end - own.p).dot(way), 0.0, own.length()));
  return found;
}

/// Where segments without partners lie along each other, of each pair both ways. A segment along which two lie at one place has none.
std::vector<EdgeOverlap> overlaps(const std::vector<BorderSegment>& segments, const NearSegments& tree,
                                  const std::vector<std::size_t>& partner, double distance) {
  const auto is_free = [&](std::size_t e) { return partner[e] == no_partner && segments[e].length() > 2 * distance; };
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t e = 0; e < segments.size(); ++e) {
    if (!is_free(e)) continue;
    for (const Vec3& end : {segments[e].p, segments[e].q})
      tree.near(end, distance, [&](std::size_t f) {
        if (f != e && is_free(f)) pairs.push_back({std::min(e, f), std::max(e, f)});
      });
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<EdgeOverlap> found;
  for (const auto& [e, f] : pairs) {
    const BorderSegment &own = segments[e], &other = segments[f];
    if ((own.q - own.p).dot(other.q - other.p) >= 0) continue;
    for (const auto& [a, b] : {std::array{e, f}, std::array{f, e}}) {
      std::vector<double> at = ends_on(segments[b], segments[a], distance);
      if (distance_to(segments[b], segments[a].p) <= distance) at.push_back(0);
      if (distance_to(segments[b], segments[a].q) <= distance) at.push_back(segments[a].length());
      const auto [first, last] = std::ranges::minmax(at);
      if (last - first > 2 * distance) found.push_back({a, b, first, last});
    }
  }
  std::ranges::sort(found, [](const EdgeOverlap& a, const EdgeOverlap& b) {
    return std::tie(a.own, a.first, a.other) < std::tie(b.own, b.first, b.other);
  });
  std::vector<char> unclear(segments.size(), 0);
  for (std::size_t k = 1; k < found.size(); ++k)
    if (found[k].own == found[k - 1].own && found[k].first < found[k - 1].last - 2 * distance) unclear[found[k].own] = 1;
  std::erase_if(found, [&](const EdgeOverlap& each) { return unclear[each.own] || unclear[each.other]; });
  return found;
}

/// Vertices that lie within edges of faces, by the corners of these in the order of the faces; with the part of the way from the first.
using EdgeVertices = std::map<std::array<Index, 2>, std::vector<std::pair<double, Index>>>;

/// Unites ends that lie at ends of other segments, and gives those that lie within them.
EdgeVertices vertices_within(const Mesh& mesh, const std::vector<BorderSegment>& segments, const std::vector<EdgeOverlap>& along,
                             double distance, std::vector<Index>& stands) {
  EdgeVertices within;
  for (const EdgeOverlap& each : along) {
    const BorderSegment &own = segments[each.own], &other = segments[each.other];
    for (const auto& [v, at] : {std::pair{other.from, other.p}, std::pair{other.to, other.q}}) {
      if (distance_to(own, at) > distance) continue;
      if ((at - own.p).norm() <= distance) {
        unite(stands, v, own.from);
      } else if ((at - own.q).norm() <= distance) {
        unite(stands, v, own.to);
      } else {
        const Vec3 back = own.p - own.q;
        within[{own.to, own.from}].emplace_back((at - own.q).dot(back) / back.squaredNorm(), v);
      }
    }
  }
  for (auto& [edge, vertices] : within) {
    std::sort(vertices.begin(), vertices.end());
    const double length = (mesh.vertices.row(edge[0]) - mesh.vertices.row(edge[1])).norm();
    for (std::size_t k = 1; k < vertices.size(); ++k)
      if ((vertices[k].first - vertices[k - 1].first) * length <= distance)
        unite(stands, vertices[k - 1].second, vertices[k].second);
  }
  return within;
}

/// The faces with vertices in their edges; where a face has one at that place already, it gets none.
Faces split_faces(const FacesRef& faces, const EdgeVertices& within, JoinedBorders& joined) {
  if (within.empty()) return Faces(faces);
  Faces made;
  std::vector<Index> face;
  for (Index f = 0; f < faces.size(); ++f) {
    face.clear();
    std::vector<Index> seen;
    for (const Index v : faces[f]) seen.push_back(joined.stands[v]);
    for (std::size_t k = 0; k < faces[f].size(); ++k) {
      face.push_back(faces[f][k]);
      const auto found = within.find({faces[f][k], faces[f][(k + 1) % faces[f].size()]});
      if (found == within.end()) continue;
      for (const auto& [t, vertex] : found->second) {
        const Index v = joined.stands[vertex];
        if (std::ranges::find(seen, v) != seen.end()) continue;
        seen.push_back(v);
        face.push_back(v);
        joined.splits.push_back({f, static_cast<Index>(k), v, t});
      }
    }
    made.add(face);
  }
  return made;
}

}  // namespace

double size_of(const Mesh& mesh) {
  Eigen::AlignedBox3d box;
  for (Index v = 0; v < mesh.vertices.rows(); ++v)
    if (mesh.vertices.row(v).allFinite()) box.extend(Vec3(mesh.vertices.row(v)));
  return box.isEmpty() ? 0 : box.diagonal().norm();
}

JoinedBorders join_borders(const Mesh& mesh, std::span<const std::vector<Index>> loops, double distance, bool junctions) {
  const std::vector<BorderSegment> segments = segments_of(mesh, loops);
  const NearSegments tree(segments);
  const std::vector<std::size_t> partner = partners(segments, tree, distance);
  std::vector<EdgeOverlap> along;
  if (junctions) along = overlaps(segments, tree, partner, distance);
  if (along.empty() && std::ranges::all_of(partner, [](std::size_t p) { return p == no_partner; })) return {};
  JoinedBorders joined;
  joined.stands.resize(mesh.vertices.rows());
  std::iota(joined.stands.begin(), joined.stands.end(), Index{0});
  for (std::size_t e = 0; e < segments.size(); ++e) {
    if (partner[e] == no_partner) continue;
    unite(joined.stands, segments[e].from, segments[partner[e]].to);
    unite(joined.stands, segments[e].to, segments[partner[e]].from);
  }
  const EdgeVertices within = vertices_within(mesh, segments, along, distance, joined.stands);
  for (std::size_t v = 0; v < joined.stands.size(); ++v) joined.stands[v] = root(joined.stands, static_cast<Index>(v));
  joined.faces = split_faces(mesh.faces, within, joined);
  part_within_faces(joined.faces, joined.stands);
  joined.own = joined.faces.corners;
  for (Index& v : joined.faces.corners) v = joined.stands[v];
  return joined;
}

std::vector<Contact> contacts(const Mesh& mesh, std::span<const std::vector<Index>> loops) {
  const double reach = tolerance::close * size_of(mesh);
  const std::vector<BorderSegment> segments = segments_of(mesh, loops);
  const NearSegments tree(segments);
  std::vector<Contact> found(loops.size());
  for (std::size_t e = 0; e < segments.size(); ++e) {
    const BorderSegment& own = segments[e];
    const double within = std::min(reach, near_share * own.length());
    bool on_any = true, on_others = true;
    for (int k = 1; k < 4; ++k) {
      bool any = false, others = false;
      tree.near(own.p + k / 4.0 * (own.q - own.p), within, [&](std::size_t f) {
        any |= f != e;
        others |= segments[f].loop != own.loop;
      });
      on_any &= any;
      on_others &= others;
    }
    if (!on_any) continue;
    Contact& contact = found[own.loop];
    if (contact.on_others + contact.on_itself == 0) contact.edge = edge_key(own.from, own.to);
    ++(on_others ? contact.on_others : contact.on_itself);
  }
  return found;
}

}  // namespace tripatch
