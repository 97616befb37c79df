#include "tripatch/hole/hole.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

namespace tripatch {
namespace {

using Loop = std::vector<Index>;

std::string name(Index v) { return std::to_string(v); }

std::string list(const std::vector<Index>& vertices) {
  std::string text;
  for (std::size_t k = 0; k < vertices.size(); ++k)
    text += (k == 0 ? "" : k + 1 == vertices.size() ? " and " : ", ") + name(vertices[k]);
  return text;
}

// ------------------------------------------------------------------------------------------------ border loops

/// An edge with exactly one face, in the direction that a new face takes: against that of its face.
struct BorderEdge {
  Index from, to;
  auto operator<=>(const BorderEdge&) const = default;
};

/// Sorted. The edges are put in one bucket per lower vertex and matched there: linear, and no hashing.
std::vector<BorderEdge> border_edges(const Faces& faces) {
  Index n = 0;
  for (Index v : faces.corners) {
    if (v < 0) throw InvalidArgument("Vertex indices must not be negative, got " + name(v));
    n = std::max(n, v + 1);
  }
  const auto each_edge = [&](auto&& use) {
    for (Index f = 0; f < faces.size(); ++f) {
      const auto face = faces[f];
      if (face.empty()) continue;
      Index a = face.back();
      for (Index b : face) {
        if (a != b) use(a, b);
        a = b;
      }
    }
  };
  std::vector<Index> start(n + 1, 0);
  each_edge([&](Index a, Index b) { ++start[std::min(a, b)]; });
  std::exclusive_scan(start.begin(), start.end(), start.begin(), Index{0});
  std::vector<std::uint64_t> bucket(n > 0 ? start[n] : 0);  // the higher vertex, and in the lowest bit whether it comes first
  each_edge([&](Index a, Index b) {
    bucket[start[std::min(a, b)]++] = static_cast<std::uint64_t>(std::max(a, b)) << 1 | static_cast<std::uint64_t>(a > b);
  });
  std::vector<BorderEdge> border;
  std::size_t first = 0;
  for (Index v = 0; v < n; ++v) {
    const std::size_t last = start[v];  // moved to the end by the filling above
    std::sort(bucket.begin() + first, bucket.begin() + last);
    for (std::size_t k = first; k < last;) {
      std::size_t end = k + 1;
      while (end < last && bucket[end] >> 1 == bucket[k] >> 1) ++end;
      if (end == k + 1) {
        const Index w = static_cast<Index>(bucket[k] >> 1);
        border.push_back(bucket[k] & 1 ? BorderEdge{v, w} : BorderEdge{w, v});
      }
      k = end;
    }
    first = last;
  }
  std::sort(border.begin(), border.end());
  return border;
}

/// Which border edge follows each one, -1 where none does. At a vertex where several border loops touch, the loops are
/// parted by the gaps between the fans of faces there: the edge at which a fan starts leads on along the edge at which its
/// neighbour fan ends.
std::vector<Index> following_edges(const Faces& faces, const std::vector<BorderEdge>& border) {
  const Index m = static_cast<Index>(border.size());
  const auto out_of = [&](Index v) {
    const auto before = [](const BorderEdge& e, Index x) { return e.from < x; };
    const auto first = std::lower_bound(border.begin(), border.end(), v, before);
    return std::pair<Index, Index>(first - border.begin(), std::lower_bound(first, border.end(), v + 1, before) - border.begin());
  };
  std::vector<Index> next(m, -1);
  std::vector<char> taken(m, 0);
  std::vector<std::pair<Index, Index>> touching;  // (vertex, border edge that arrives there)
  for (Index e = 0; e < m; ++e) {
    const auto [first, last] = out_of(border[e].to);
    if (last == first) continue;
    if (last == first + 1 && !taken[first]) {
      next[e] = first;
      taken[first] = 1;
    } else if (last > first + 1) {
      touching.emplace_back(border[e].to, e);
    }
  }
  if (touching.empty()) return next;
  std::sort(touching.begin(), touching.end());

  // the faces at the touching vertices: (vertex, next corner, previous corner)
  struct Wedge {
    Index at, next, previous;
    auto operator<=>(const Wedge&) const = default;
  };
  std::vector<char> wanted(std::max(border.back().from, touching.back().first) + 1, 0);
  for (const auto& [v, e] : touching) wanted[v] = 1;
  std::vector<Wedge> wedges;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    const std::size_t size = face.size();
    for (std::size_t k = 0; k < size; ++k)
      if (face[k] < static_cast<Index>(wanted.size()) && wanted[face[k]])
        wedges.push_back({face[k], face[(k + 1) % size], face[(k + size - 1) % size]});
  }
  std::sort(wedges.begin(), wedges.end());
  std::vector<char> crossed(wedges.size(), 0);
  /// The last edge of the fan of faces around v whose first edge leads to u: the border edge that leaves along it, -1: none.
  const auto fan_end = [&](Index v, Index u, Index first, Index last) -> Index {
    while (true) {
      const auto w = std::lower_bound(wedges.begin(), wedges.end(), Wedge{v, u, -1});
      if (w == wedges.end() || w->at != v || w->next != u || crossed[w - wedges.begin()]) return -1;
      crossed[w - wedges.begin()] = 1;
      u = w->previous;
      const auto found = std::lower_bound(border.begin() + first, border.begin() + last, BorderEdge{v, u});
      if (found != border.begin() + last && found->to == u) return found - border.begin();
    }
  };
  for (std::size_t k = 0; k < touching.size();) {
    const Index v = touching[k].first;
    const auto [first, last] = out_of(v);
    std::vector<std::pair<Index, Index>> fans;  // (arriving edge, leaving edge) of each
    Loop arriving;                              // whose fan has no end: non-manifold or flipped faces
    for (; k < touching.size() && touching[k].first == v; ++k) {
      const Index e = touching[k].second, end = fan_end(v, border[e].from, first, last);
      if (end >= 0 && !taken[end]) {
        taken[end] = 1;
        fans.emplace_back(e, end);
      } else {
        arriving.push_back(e);
      }
    }
    for (std::size_t i = 0; i < fans.size(); ++i) next[fans[i].first] = fans[(i + fans.size() - 1) % fans.size()].second;
    Index leaving = first;
    for (Index e : arriving) {
      while (leaving < last && taken[leaving]) ++leaving;
      if (leaving == last) break;
      taken[leaving] = 1;
      next[e] = leaving;
    }
  }
  return next;
}

/// Vertices on the way so far; coming back to one of them closes a loop, which is handed out and taken off the way.
class Way {
public:
  explicit Way(Index n) : place_(n, -1) {}
  bool empty() const { return way_.empty(); }
  Index top() const { return way_.back(); }
  void pop() {
    place_[way_.back()] = -1;
    way_.pop_back();
  }
  void clear() {
    while (!empty()) pop();
  }
  void go(Index v, std::vector<Loop>& loops) {
    if (place_[v] < 0) {
      place_[v] = static_cast<Index>(way_.size());
      way_.push_back(v);
      return;
    }
    loops.emplace_back(way_.begin() + place_[v], way_.end());
    while (way_.back() != v) pop();
  }

private:
  Loop way_, place_;
};

/// What is left where neighbouring faces disagree in orientation: loops whatever the direction of the edges, each in the
/// direction of the most of its edges.
void undirected_loops(const std::vector<BorderEdge>& border, std::vector<char>& used, Way& way, std::vector<Loop>& loops) {
  std::vector<std::array<Index, 3>> half;  // from, to, edge
  for (Index e = 0; e < static_cast<Index>(border.size()); ++e)
    if (!used[e]) {
      half.push_back({border[e].from, border[e].to, e});
      half.push_back({border[e].to, border[e].from, e});
    }
  std::sort(half.begin(), half.end());
  std::vector<Index> unread(half.size());  // at the first half edge out of a vertex: how far its half edges have been read
  std::iota(unread.begin(), unread.end(), Index{0});
  const auto first_out_of = [&](Index v) {
    return std::lower_bound(half.begin(), half.end(), std::array<Index, 3>{v, -1, -1}) - half.begin();
  };
  std::vector<Loop> found;
  for (const auto& start : half) {
    if (used[start[2]]) continue;
    way.go(start[0], found);
    while (!way.empty()) {
      const Index v = way.top();
      Index& k = unread[first_out_of(v)];
      while (k < static_cast<Index>(half.size()) && half[k][0] == v && used[half[k][2]]) ++k;
      if (k == static_cast<Index>(half.size()) || half[k][0] != v) {
        way.pop();
      } else {
        used[half[k][2]] = 1;
        way.go(half[k][1], found);
      }
    }
  }
  for (Loop& loop : found) {
    std::size_t along = 0;
    for (std::size_t k = 0; k < loop.size(); ++k)
      along += std::binary_search(border.begin(), border.end(), BorderEdge{loop[k], loop[(k + 1) % loop.size()]});
    if (2 * along < loop.size()) std::reverse(loop.begin(), loop.end());
    loops.push_back(std::move(loop));
  }
}

// ------------------------------------------------------------------------------------------------ faces around a rim

/// The faces that touch marked vertices, but for the replaced ones.
class FacesAround {
public:
  struct Corner {
    Index face;
    Index place;  ///< of the vertex in the face
  };

  FacesAround(const Mesh& mesh, const std::vector<Loop>& rims, const std::vector<Index>& replaced = {})
      : faces_(mesh.faces), slot_(mesh.vertices.rows(), -1) {
    const Index n = mesh.vertices.rows();
    std::vector<char> gone;
    if (!replaced.empty()) gone.assign(faces_.size(), 0);
    for (Index f : replaced) {
      if (f < 0 || f >= faces_.size())
        throw InvalidArgument("Face " + name(f) + " to be replaced does not exist: the mesh has " + name(faces_.size()) +
                              " faces");
      gone[f] = 1;
    }
    Index marked = 0;
    for (const Loop& rim : rims)
      for (Index v : rim) {
        if (v < 0 || v >= n)
          throw InvalidArgument("Rim vertex " + name(v) + " does not exist: the mesh has " + name(n) + " vertices");
        if (slot_[v] < 0) slot_[v] = marked++;
      }
    const auto each_corner = [&](auto&& use) {
      for (Index f = 0; f < faces_.size(); ++f) {
        const auto face = faces_[f];
        for (Index k = 0; k < static_cast<Index>(face.size()); ++k) {
          if (face[k] < 0 || face[k] >= n)
            throw InvalidArgument("Face " + name(f) + " has vertex " + name(face[k]) + ": the mesh has " + name(n) + " vertices");
          if (slot_[face[k]] >= 0 && (gone.empty() || !gone[f])) use(slot_[face[k]], Corner{f, k});
        }
      }
    };
    start_.assign(marked + 1, 0);
    each_corner([&](Index s, const Corner&) { ++start_[s]; });
    std::exclusive_scan(start_.begin(), start_.end(), start_.begin(), Index{0});
    corners_.resize(start_[marked]);
    std::vector<Index> fill(start_.begin(), start_.end() - 1);
    each_corner([&](Index s, const Corner& c) { corners_[fill[s]++] = c; });
  }

  std::span<const Corner> at(Index v) const {
    const Index s = slot_[v];
    return {corners_.data() + start_[s], static_cast<std::size_t>(start_[s + 1] - start_[s])};
  }
  std::span<const Index> face(const Corner& c) const { return faces_[c.face]; }
  Index next(const Corner& c) const { return face(c)[(c.place + 1) % face(c).size()]; }
  Index previous(const Corner& c) const { return face(c)[(c.place + face(c).size() - 1) % face(c).size()]; }

private:
  const Faces& faces_;
  Loop slot_, start_;
  std::vector<Corner> corners_;
};

/// Every vertex once; every edge with one face; the faces around agree in orientation. Returns the rim in the direction of new faces.
Loop check_topology(const FacesAround& around, const Loop& rim) {
  const std::size_t n = rim.size();
  if (n < 3) throw Refusal("A rim needs at least three edges", rim);
  Loop sorted = rim;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
    throw Refusal("The rim passes vertex " + name(*twice) + " twice", {*twice});

  std::vector<std::array<Index, 2>> along, against;  // rim edges whose face holds them as given, or reversed
  const auto sole = around.at(rim[0]);
  bool one_face = !sole.empty() && around.face(sole[0]).size() == n;
  for (std::size_t k = 0; k < n; ++k) {
    const Index a = rim[k], b = rim[(k + 1) % n];
    const auto edge = [&] { return "the rim edge between vertices " + name(a) + " and " + name(b); };
    int forward = 0, backward = 0;
    for (const auto& c : around.at(a)) {
      forward += around.next(c) == b;
      backward += around.previous(c) == b;
      one_face = one_face && c.face == sole[0].face;
    }
    if (forward + backward == 0)
      throw Refusal("There is no face beside " + edge() + "; the surroundings are unknown there", {a, b});
    if (forward + backward > 2)
      throw Refusal("Non-manifold: " + edge() + " has " + std::to_string(forward + backward) + " faces", {a, b});
    if (forward + backward == 2) throw Refusal("There is a face on both sides of " + edge() + ", so no hole", {a, b});
    (forward ? along : against).push_back({a, b});
  }
  if (one_face) throw Refusal("The rim is the border of a single face that is joined to no other, so no hole", rim);
  const std::string advice = "; make the normals consistent first";
  if (!along.empty() && !against.empty()) {
    Loop where;
    for (const auto& edge : std::min(along, against, [](auto& x, auto& y) { return x.size() < y.size(); }))
      where.insert(where.end(), edge.begin(), edge.end());
    std::sort(where.begin(), where.end());
    where.erase(std::unique(where.begin(), where.end()), where.end());
    throw Refusal("The faces around the rim disagree in orientation: at vertices " +
                      (where.size() > 8 ? list({where.begin(), where.begin() + 8}) + " and more" : list(where)) +
                      " they are turned against the others" + advice,
                  where);
  }
  for (Index v : rim) {
    std::vector<Index> out, in;
    for (const auto& c : around.at(v)) {
      out.push_back(around.next(c));
      in.push_back(around.previous(c));
    }
    std::sort(out.begin(), out.end());
    std::sort(in.begin(), in.end());
    for (const auto& [side, other] : {std::pair(&out, &in), std::pair(&in, &out)})
      for (auto k = side->begin(); (k = std::adjacent_find(k, side->end())) != side->end(); ++k)
        if (!std::binary_search(other->begin(), other->end(), *k) && std::count(side->begin(), side->end(), *k) == 2)
          throw Refusal("A face at the rim, at the edge between vertices " + name(v) + " and " + name(*k) +
                            ", is turned against its neighbours" + advice,
                        {v, *k});
    std::vector<Index> ends;  // of edges from v, once for every face
    std::merge(out.begin(), out.end(), in.begin(), in.end(), std::back_inserter(ends));
    for (auto k = ends.begin(); k != ends.end();) {
      const auto end = std::upper_bound(k, ends.end(), *k);
      if (end - k > 2 && std::binary_search(sorted.begin(), sorted.end(), *k))
        throw Refusal("Non-manifold: the edge between vertices " + name(v) + " and " + name(*k) + " of the rim has " +
                          name(end - k) + " faces",
                      {v, *k});
      k = end;
    }
  }
  Loop turned = rim;
  if (!along.empty()) std::reverse(turned.begin(), turned.end());
  return turned;
}

/// Rim edges must have a length, rim vertices places of their own; all positions at the rim must be finite.
void check_positions(const Mesh& mesh, const FacesAround& around, const Loop& rim) {
  for (Index v : rim)
    for (const auto& c : around.at(v))
      for (Index w : around.face(c))
        if (!mesh.vertices.row(w).allFinite()) throw Refusal("Vertex " + name(w) + " at the rim has no finite position", {w});
  double length = 0;
  const std::size_t n = rim.size();
  const auto edge_length = [&](std::size_t k) {
    return (mesh.vertices.row(rim[(k + 1) % n]) - mesh.vertices.row(rim[k])).stableNorm();
  };
  for (std::size_t k = 0; k < n; ++k) length += edge_length(k);
  if (!std::isfinite(length)) throw Refusal("The rim is too large to be measured", {rim[0]});
  for (std::size_t k = 0; k < n; ++k)
    if (!(edge_length(k) > 1e-14 * length)) {
      const Index a = rim[k], b = rim[(k + 1) % n];
      throw Refusal("The rim edge between vertices " + name(a) + " and " + name(b) + " has no length; merge them first", {a, b});
    }
  Loop by_place = rim;
  const auto key = [&](Index v) { return std::array{mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)}; };
  std::sort(by_place.begin(), by_place.end(), [&](Index a, Index b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  const auto same = std::adjacent_find(by_place.begin(), by_place.end(), [&](Index a, Index b) { return key(a) == key(b); });
  if (same != by_place.end())
    throw Refusal("Vertices " + name(same[0]) + " and " + name(same[1]) + " of the rim are at the same place",
                  {same[0], same[1]});
}

// ------------------------------------------------------------------------------------------------ corners

// Seen over the window, a round rim turns by 15 degrees, the ten test holes by 65 to 155 at their corners and by no more than 27
// elsewhere.
constexpr double window_share = 1.0 / 24;       ///< of the rim's length, to either side
constexpr double normal_share = 1.0 / 3;        ///< of the window: where the tangent plane is read
constexpr double clear_turn = 40 * M_PI / 180;  ///< a corner turns by at least this
constexpr double sure_turn = 55 * M_PI / 180;   ///< and is one whatever the number of edges (a hexagon has six corners)
constexpr double over_round = 1.5;              ///< less sure ones: by this many times what a round rim of such edges turns,
constexpr double over_neighbours = 2;           ///< or by this many times what it turns at the vertices next to it
constexpr double crisp_turn = 75 * M_PI / 180;  ///< a single vertex that turns by this is never part of another corner,
constexpr double crisp_share = 1.0 / 12;  ///< given that its edges are this long, in windows: those of no length turn by noise
constexpr std::size_t most_corners = 12;  ///< counted; a rim with more has none that is clear

/// Normals along the rim: those of the vector area of the faces around, summed over the window. That is linear in the vertices, so that
/// noise cancels even where it turns faces over.
Points rim_normals(const Mesh& mesh, const FacesAround& around, const Loop& rim, const std::vector<double>& length,
                   double scale) {
  const Index n = static_cast<Index>(rim.size());
  const double window = normal_share * window_share * std::accumulate(length.begin(), length.end(), 0.0);
  Points area = Points::Zero(n, 3);
  for (Index k = 0; k < n; ++k)
    for (const auto& c : around.at(rim[k])) {
      const auto p = mesh.vertices.row(rim[k]);
      const Vec3 a = (mesh.vertices.row(around.next(c)) - p).transpose() * scale;
      const Vec3 b = (mesh.vertices.row(around.previous(c)) - p).transpose() * scale;
      area.row(k) += a.cross(b);
    }
  // running sums over three rounds
  std::vector<double> s(3 * n, 0);
  Points sum = Points::Zero(3 * n + 1, 3);
  for (Index k = 0; k < 3 * n; ++k) {
    if (k > 0) s[k] = s[k - 1] + length[(k - 1) % n];
    sum.row(k + 1) = sum.row(k) + area.row(k % n);
  }
  Points normals(n, 3);
  Index first = 0, last = 0;
  for (Index k = n; k < 2 * n; ++k) {
    while (s[k] - s[first] >= window) ++first;
    last = std::max(last, k);
    while (s[last + 1] - s[k] < window) ++last;
    normals.row(k - n) = (sum.row(last + 1) - sum.row(first)).transpose().stableNormalized();
  }
  // where all faces are needles without area, the next normal along the rim serves
  for (Index k = 2 * n - 2; k >= 0; --k)
    if (normals.row(k % n).isZero(0)) normals.row(k % n) = normals.row((k + 1) % n);
  return normals;
}

/// How far the rim turns at each vertex, radians, positive at a convex corner of the hole: the angle between the two rim edges in the
/// tangent plane of the faces there.
std::vector<double> turns_at_vertices(const Points& edges, const Points& normals) {
  const Index n = edges.rows();
  std::vector<double> turn(n);
  for (Index k = 0; k < n; ++k) {
    const Vec3 normal = normals.row(k), before = edges.row((k + n - 1) % n), after = edges.row(k);
    const Vec3 a = before - before.dot(normal) * normal, b = after - after.dot(normal) * normal;
    turn[k] = std::atan2(a.cross(b).dot(normal), a.dot(b));
  }
  return turn;
}

/// How far the rim turns around each vertex: the mean direction over a window after it against that before it. That weights
/// the turns at the vertices by a tent, so noise, whose turns cancel, counts little and uneven spacing not at all.
std::vector<double> turns_over_window(const std::vector<double>& turn, const std::vector<double>& length, double total) {
  const Index n = static_cast<Index>(turn.size());
  const double window = window_share * total;
  // direction and its integral at the vertices, over three rounds
  std::vector<double> s(3 * n + 1, 0), direction(3 * n + 1, 0), integral(3 * n + 1, 0);
  for (Index k = 0; k < 3 * n; ++k) {
    if (k > 0) direction[k] = direction[k - 1] + turn[k % n];
    s[k + 1] = s[k] + length[k % n];
    integral[k + 1] = integral[k] + direction[k] * length[k % n];
  }
  const auto integral_at = [&](double x, Index& k) {
    while (s[k + 1] < x) ++k;
    return integral[k] + direction[k] * (x - s[k]);
  };
  std::vector<double> over(n);
  Index behind = 0, ahead = 0;
  for (Index k = 0; k < n; ++k) {
    const Index m = n + k;
    over[k] = (integral_at(s[m] + window, ahead) - 2 * integral[m] + integral_at(s[m] - window, behind)) / window;
  }
  return over;
}

/// Edge lengths (the longest coordinate of an edge is 1) and turns at the vertices, radians.
struct RimShape {
  std::vector<double> length, turn;
  bool without_area = false;  ///< the faces around have none, the turns mean nothing
};

RimShape measure(const Mesh& mesh, const FacesAround& around, const Loop& rim) {
  const Index n = static_cast<Index>(rim.size());
  Points edges(n, 3);
  for (Index k = 0; k < n; ++k) edges.row(k) = mesh.vertices.row(rim[(k + 1) % n]) - mesh.vertices.row(rim[k]);
  const double scale = 1 / edges.cwiseAbs().maxCoeff();
  edges *= scale;
  RimShape shape;
  for (Index k = 0; k < n; ++k) shape.length.push_back(edges.row(k).norm());
  const Points normals = rim_normals(mesh, around, rim, shape.length, scale);
  shape.turn = turns_at_vertices(edges, normals);
  shape.without_area = normals.row(0).isZero(0);
  return shape;
}

bool is_outer(const Mesh& mesh, const FacesAround& around, const Loop& rim) {
  const std::vector<double> turn = measure(mesh, around, rim).turn;
  return std::accumulate(turn.begin(), turn.end(), 0.0) < -M_PI / 2;
}

void check_indices(const Mesh& mesh) {
  for (Index v : mesh.faces.corners)
    if (v >= mesh.vertices.rows())
      throw InvalidArgument("A face has vertex " + name(v) + ": the mesh has " + name(mesh.vertices.rows()) + " vertices");
}

/// Places of the corners in the rim, in rim order; `rim` from its lowest vertex on, so that the same rim gives the same corners.
std::vector<Index> detect_corners(const Mesh& mesh, const FacesAround& around, const Loop& rim) {
  const Index n = static_cast<Index>(rim.size());
  if (n == 3) return {0, 1, 2};
  auto [length, turn, without_area] = measure(mesh, around, rim);
  if (without_area) throw Refusal("The faces around the rim have no area", {rim[0]});
  const double total = std::accumulate(length.begin(), length.end(), 0.0);
  const double window = window_share * total;
  const std::vector<double> at_vertex = turn;

  // the strongest corner first; it takes with it what turns within its window
  std::vector<Index> corners;
  std::vector<char> is_corner(n, 0);
  while (corners.size() <= most_corners) {
    const std::vector<double> over = turns_over_window(turn, length, total);
    Index best = -1;
    for (Index k = 0; k < n; ++k) {
      const Index before = (k + n - 1) % n, after = (k + 1) % n;
      const double round = 2 * M_PI * std::max(window, 0.5 * (length[before] + length[k])) / total;
      const bool clear = over[k] >= clear_turn && (over[k] >= std::min(over_round * round, sure_turn) ||
                                                   over[k] >= over_neighbours * std::max(at_vertex[before], at_vertex[after]));
      if (is_corner[k] || !clear) continue;
      // equally strong ones: the lowest vertex, not the last bit
      const double lead = best < 0 ? 1 : over[k] - over[best];
      if (lead > 1e-6 || (lead > -1e-6 && rim[k] < rim[best])) best = k;
    }
    if (best < 0) break;
    corners.push_back(best);
    is_corner[best] = 1;
    turn[best] = 0;
    for (int step : {1, -1}) {
      double way = 0;
      for (Index k = best; way < window;) {
        way += length[step > 0 ? k : (k + n - 1) % n];
        k = (k + step + n) % n;
        const bool long_enough = 0.5 * (length[k] + length[(k + n - 1) % n]) >= crisp_share * window;
        if (way < window && !(std::abs(turn[k]) >= crisp_turn && long_enough)) turn[k] = 0;
      }
    }
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Where a rim of quads leaves the lines of its grid: three of their faces meet there, two at every other vertex of the rim. Empty
/// where it is not so.
std::vector<Index> grid_corners(const FacesAround& around, const Loop& rim) {
  std::vector<Index> corners;
  for (std::size_t k = 0; k < rim.size(); ++k) {
    const auto faces = around.at(rim[k]);
    if (faces.size() < 2 || faces.size() > 3) return {};
    for (const FacesAround::Corner& c : faces)
      if (around.face(c).size() != 4) return {};
    if (faces.size() == 3) corners.push_back(static_cast<Index>(k));
  }
  return corners;
}

std::array<Index, 3> three_corners(const Mesh& mesh, const FacesAround& around, const Loop& rim) {
  const std::vector<Index> corners = detect_corners(mesh, around, rim);
  if (corners.size() == 3) return {corners[0], corners[1], corners[2]};
  // on a round shape the lines themselves turn, as they do over the edges of a cube made a sphere
  const std::vector<Index> of_grid = grid_corners(around, rim);
  if (of_grid.size() == 3) return {of_grid[0], of_grid[1], of_grid[2]};
  Loop where;
  for (Index k : corners) where.push_back(rim[k]);
  if (corners.empty()) throw Refusal("Rim has no clear corners; select three", {rim[0]});
  if (corners.size() > most_corners)
    throw Refusal("Rim has more than " + std::to_string(most_corners) + " corners; select three", where);
  throw Refusal("Rim has " + std::to_string(corners.size()) + (corners.size() == 1 ? " corner" : " corners") + "; select three",
                where);
}

std::array<Index, 3> places_of(const std::array<Index, 3>& corners, const Loop& rim, Index vertices) {
  std::array<Index, 3> places;
  for (int i = 0; i < 3; ++i) {
    if (corners[i] < 0 || corners[i] >= vertices)
      throw InvalidArgument("Corner vertex " + name(corners[i]) + " does not exist: the mesh has " + name(vertices) +
                            " vertices");
    if (corners[i] == corners[(i + 1) % 3])
      throw InvalidArgument("The corners must be three different vertices; vertex " + name(corners[i]) + " is given twice");
    const auto found = std::find(rim.begin(), rim.end(), corners[i]);
    if (found == rim.end()) throw Refusal("Corner vertex " + name(corners[i]) + " is not on the rim", {corners[i]});
    places[i] = found - rim.begin();
  }
  return places;
}

Hole make_hole(const Mesh& mesh, const FacesAround& around, const Loop& given,
               const std::optional<std::array<Index, 3>>& corners) {
  Hole hole;
  hole.rim = check_topology(around, given);
  check_positions(mesh, around, hole.rim);
  std::rotate(hole.rim.begin(), std::min_element(hole.rim.begin(), hole.rim.end()), hole.rim.end());
  std::array<Index, 3> places =
      corners ? places_of(*corners, hole.rim, mesh.vertices.rows()) : three_corners(mesh, around, hole.rim);
  const Index n = static_cast<Index>(hole.rim.size());
  if (!corners)
    std::rotate(places.begin(),
                std::min_element(places.begin(), places.end(), [&](Index a, Index b) { return hole.rim[a] < hole.rim[b]; }),
                places.end());
  std::rotate(hole.rim.begin(), hole.rim.begin() + places[0], hole.rim.end());
  for (int i = 0; i < 3; ++i) hole.corners[i] = (places[i] - places[0] + n) % n;
  std::sort(hole.corners.begin() + 1, hole.corners.end());
  return hole;
}

}  // namespace

std::vector<Index> Hole::side(int i) const {
  const Index n = static_cast<Index>(rim.size());
  const Index first = corners[(i + 1) % 3], last = corners[(i + 2) % 3];
  std::vector<Index> vertices;
  for (Index k = first; k != last; k = (k + 1) % n) vertices.push_back(rim[k]);
  vertices.push_back(rim[last]);
  return vertices;
}

std::vector<std::vector<Index>> find_holes(const Faces& faces) {
  const std::vector<BorderEdge> border = border_edges(faces);
  if (border.empty()) return {};
  const std::vector<Index> next = following_edges(faces, border);
  const Index m = static_cast<Index>(border.size());
  Index n = 0;
  for (const BorderEdge& e : border) n = std::max({n, e.from + 1, e.to + 1});
  Way way(n);
  std::vector<Loop> loops;

  // ways that end somewhere: not a loop in this direction
  std::vector<char> used(m, 0), open(m, 0), follows(m, 0);
  for (Index e : next)
    if (e >= 0) follows[e] = 1;
  for (Index e = 0; e < m; ++e)
    if (!follows[e])
      for (Index k = e; k >= 0; k = next[k]) open[k] = 1;
  for (Index e = 0; e < m; ++e) {
    if (used[e] || open[e]) continue;
    way.go(border[e].from, loops);
    for (Index k = e; !used[k]; k = next[k]) {
      used[k] = 1;
      way.go(border[k].to, loops);
    }
    way.clear();
  }
  if (std::find(open.begin(), open.end(), 1) != open.end()) undirected_loops(border, used, way, loops);

  for (Loop& loop : loops) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  std::sort(loops.begin(), loops.end(),
            [](const Loop& a, const Loop& b) { return a.size() != b.size() ? a.size() < b.size() : a < b; });
  return loops;
}

Hole make_hole(const Mesh& mesh, const std::vector<Index>& rim, const std::optional<std::array<Index, 3>>& corners,
               const std::vector<Index>& replaced) {
  return make_hole(mesh, FacesAround(mesh, {rim}, replaced), rim, corners);
}

bool is_outer_border(const Mesh& mesh, const std::vector<Index>& rim) {
  check_indices(mesh);
  for (Index v : rim)
    if (v < 0 || v >= mesh.vertices.rows()) throw InvalidArgument("The mesh has no vertex " + name(v));
  if (rim.size() < 3) throw InvalidArgument("A border loop has three vertices or more");
  return is_outer(mesh, FacesAround(mesh, {rim}), rim);
}

Hole find_hole(const Mesh& mesh) {
  check_indices(mesh);
  std::vector<Loop> loops = find_holes(mesh.faces);
  if (loops.empty()) throw Refusal("No hole: the mesh has no border");
  const FacesAround around(mesh, loops);
  const auto outer = [&](const Loop& loop) { return is_outer(mesh, around, loop); };
  if (loops.size() > 1 && !std::all_of(loops.begin(), loops.end(), outer)) std::erase_if(loops, outer);
  std::vector<Hole> found;
  std::optional<Refusal> refusal;  // of the shortest
  for (const Loop& loop : loops) {
    try {
      found.push_back(make_hole(mesh, around, loop, std::nullopt));
    } catch (const Refusal& r) {
      if (!refusal) refusal = r;
    }
  }
  if (found.size() == 1) return found[0];
  if (found.empty()) {
    if (loops.size() == 1) throw *refusal;
    throw Refusal("None of " + std::to_string(loops.size()) + " holes can be filled as they are. The shortest, through vertex " +
                      name(loops[0][0]) + ": " + refusal->what(),
                  refusal->where());
  }
  Loop where;
  for (const Hole& hole : found) where.push_back(*std::min_element(hole.rim.begin(), hole.rim.end()));
  std::sort(where.begin(), where.end());
  const bool many = where.size() > 8;
  throw Refusal(std::to_string(found.size()) + " holes have three corners: rims starting at vertex " +
                    (many ? list({where.begin(), where.begin() + 8}) + " and so on" : list(where)) + "; choose one",
                where);
}

}  // namespace tripatch
