#include "tripatch/mesh/connectivity.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/changed_faces.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

using Corner = Connectivity::Corner;

Index vertices_named(const FacesRef& faces) {
  return faces.corners.visit([](auto corners) {
    Index n = 0;
    for (Index v : corners) n = std::max(n, v + 1);
    return n;
  });
}

const FacesRef& checked(const FacesRef& faces) {
  const auto& offsets = faces.offsets;
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != std::ssize(faces.corners) || !std::ranges::is_sorted(offsets))
    throw CodedArgument(Code::offsets_not_in_order, {});
  return faces;
}

/// How many corners every face has; 0: they differ.
Corner common_size(const FacesRef& faces) {
  if (faces.size() == 0) return 0;
  const Index size = faces.offsets[1] - faces.offsets[0];
  for (Index f = 0; f < faces.size(); ++f)
    if (faces.offsets[f] != f * size) return 0;
  return faces.offsets[faces.size()] == faces.size() * size ? static_cast<Corner>(size) : 0;
}

[[noreturn]] void refuse_vertex(const FacesRef& faces, std::size_t corner, Index vertices) {
  const auto face = std::upper_bound(faces.offsets.begin(), faces.offsets.end(), static_cast<Index>(corner));
  const Index v = faces.corners[corner];
  throw CodedArgument(
      Code::no_such_vertex,
      {{"option", "faces[" + std::to_string(face - faces.offsets.begin() - 1) + "]"}, {"vertex", v}, {"count", vertices}});
}

/// Of the box around a rim: what is looked at next to it at least, so that a surface that bends away is still seen. Nothing but time
/// depends on it, as long as the rings lie inside.
constexpr double min_margin = share::three_tenths;

/// Vertices in a box around some of them: as wide as they lie apart, and several rings of their edges.
std::vector<char> vertices_near(const Mesh& mesh, std::span<const Index> vertices, int rings) {
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  double longest = 0;  // way from one to the next
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const Vec3 p = mesh.vertices.row(vertices[k]);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    if (k > 0) longest = std::max(longest, (p - Vec3(mesh.vertices.row(vertices[k - 1]))).norm());
  }
  // twice the width of a ring as wide as the longest edge, for the faces behind may be larger
  const double margin = std::max(min_margin * (high - low).norm(), 2 * rings * longest);
  low.array() -= margin;
  high.array() += margin;
  std::vector<char> near(mesh.vertices.rows());
  const double* p = mesh.vertices.data();
  for (char& mark : near) {
    const auto within = [&](int k) { return static_cast<int>(p[k] >= low[k]) & static_cast<int>(p[k] <= high[k]); };
    mark = static_cast<char>(within(0) & within(1) & within(2));
    p += 3;
  }
  return near;
}

}  // namespace

Connectivity::Connectivity(const FacesRef& faces, std::optional<Index> vertices, std::span<const Index> replaced)
    : Connectivity(faces, vertices ? *vertices : vertices_named(faces), replaced, {}) {}

/// A counting sort of the corners by vertex.
Connectivity::Connectivity(const FacesRef& faces, Index vertices, std::span<const Index> replaced, std::vector<char> known)
    : faces_(checked(faces)), vertices_(vertices), start_(vertices + 2, 0), size_(common_size(faces)), known_(std::move(known)) {
  if (faces.corners.size() >= std::numeric_limits<Corner>::max())
    throw InvalidArgument("A mesh of 2^32 corners of faces is too large");
  const IndicesRef corners = faces.corners;
  const Corner all = static_cast<Corner>(corners.size());
  for (Corner c = 0; c < all; ++c)
    if (static_cast<std::uint64_t>(corners[c]) >= static_cast<std::uint64_t>(vertices)) refuse_vertex(faces, c, vertices);
  if (size_ == 0) {
    face_.resize(all);
    for (Index f = 0; f < faces.size(); ++f)
      std::fill(face_.begin() + faces.offsets[f], face_.begin() + faces.offsets[f + 1], static_cast<Corner>(f));
  }
  const std::vector<char> gone = marked_faces(faces, replaced);
  std::vector<Corner> few;  // the corners at known vertices
  for (Corner c = 0; c < all && !known_.empty(); ++c)
    if (known_[corners[c]]) few.push_back(c);
  const auto each_corner = [&](auto&& use) {
    const auto use_left = [&](Corner c) {
      if (gone.empty() || !gone[face(c)]) use(c);
    };
    if (!known_.empty()) {
      for (Corner c : few) use_left(c);
    } else if (gone.empty()) {
      for (Corner c = 0; c < all; ++c) use(c);
    } else {
      for (Corner c = 0; c < all; ++c) use_left(c);
    }
  };
  // counted two places on, summed to starts one place on, which the filling moves to where they belong
  each_corner([&](Corner c) { ++start_[corners[c] + 2]; });
  for (Index v = 0; v < vertices; ++v) start_[v + 2] += start_[v + 1];
  corners_ = std::make_unique_for_overwrite<Corner[]>(start_[vertices + 1]);
  each_corner([&](Corner c) { corners_[start_[corners[c] + 1]++] = c; });
}

Connectivity Connectivity::around(const Mesh& mesh, std::span<const Index> vertices, int rings, std::span<const Index> replaced) {
  for (Index v : vertices)
    if (v < 0 || v >= mesh.vertices.rows() || !mesh.vertices.row(v).allFinite()) return Connectivity(mesh, replaced);
  Connectivity part(mesh.faces, mesh.vertices.rows(), replaced, vertices_near(mesh, vertices, rings));
  std::vector<Index> front(vertices.begin(), vertices.end()), next;
  std::vector<char> seen(mesh.vertices.rows(), 0),
      taken(mesh.faces.size(), 0);  // a large face is at many vertices, and looked at once
  for (Index v : front) seen[v] = 1;
  for (int ring = 0; ring <= rings; ++ring, front = std::move(next)) {
    next.clear();
    for (Index v : front) {
      if (!part.knows(v)) return Connectivity(mesh, replaced);
      for (Corner c : part.at(v)) {
        const Index f = part.face(c);
        if (std::exchange(taken[f], 1)) continue;
        for (Index w : mesh.faces[f])
          if (!std::exchange(seen[w], 1)) next.push_back(w);
      }
    }
  }
  return part;
}

Index Connectivity::sparser(Index a, Index b) const { return at(a).size() <= at(b).size() ? a : b; }

std::optional<Corner> Connectivity::edge(Index from, Index to) const {
  for (Corner c : at(from))
    if (next(c) == to) return c;
  return {};
}

std::vector<Index> Connectivity::faces_at_edge(Index a, Index b) const {
  std::vector<Index> faces;
  const Index v = sparser(a, b), w = v == a ? b : a;
  for (Corner c : at(v))
    if ((next(c) == w || previous(c) == w) && (faces.empty() || faces.back() != face(c))) faces.push_back(face(c));
  return faces;
}

std::vector<Index> Connectivity::one_ring(Index v) const {
  const std::span<const Corner> corners = at(v);
  if (corners.empty()) return {};
  const auto leaving = [&](Index to) {
    return std::find_if(corners.begin(), corners.end(), [&](Corner c) { return next(c) == to; });
  };
  Corner first = corners[0];  // of the fan: the face before it is missing
  for (Corner c : corners)
    if (std::none_of(corners.begin(), corners.end(), [&](Corner d) { return previous(d) == next(c); })) first = c;
  std::vector<Index> ring = {next(first)};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const auto c = leaving(ring.back());
    if (c == corners.end()) return {};
    const Index beyond = previous(*c);
    const bool closed = beyond == ring[0];
    if (closed) return k + 1 == corners.size() ? ring : std::vector<Index>{};
    if (std::find(ring.begin(), ring.end(), beyond) != ring.end()) return {};
    ring.push_back(beyond);
  }
  return ring;
}

Edges edges_of(const Connectivity& mesh) {
  const FacesRef& faces = mesh.faces();
  Edges edges;
  edges.from_corner.resize(faces.corners.size());
  const auto number = [&](Corner c) {
    const Index a = faces.corners[c], b = mesh.next(c), v = mesh.sparser(a, b), w = v == a ? b : a;
    Corner first = c;  // of those whose edge this is; a lower one has a number
    for (Corner other : mesh.at(v)) {
      if (mesh.next(other) == w) first = std::min(first, other);
      if (mesh.previous(other) != w) continue;
      const Index f = mesh.face(other), before = other > faces.offsets[f] ? other - 1 : faces.offsets[f + 1] - 1;
      first = std::min(first, static_cast<Corner>(before));
    }
    if (first < c) return edges.from_corner[first];
    edges.vertices.push_back({std::min(a, b), std::max(a, b)});
    return static_cast<Corner>(edges.vertices.size() - 1);
  };
  for (std::size_t c = 0; c < faces.corners.size(); ++c) edges.from_corner[c] = number(static_cast<Corner>(c));
  return edges;
}

std::vector<Index> components_of(const Connectivity& mesh) {
  const FacesRef& faces = mesh.faces();
  std::vector<Index> component(faces.size(), -1), stack;
  Index components = 0;
  for (Index first = 0; first < faces.size(); ++first) {
    if (component[first] >= 0) continue;
    component[first] = components;
    stack = {first};
    while (!stack.empty()) {
      const auto face = faces[stack.back()];
      stack.pop_back();
      for (std::size_t k = 0; k < face.size(); ++k) {  // as faces_at_edge, of which there are millions
        const Index a = face[k], b = face[(k + 1) % face.size()], v = mesh.sparser(a, b), w = v == a ? b : a;
        for (const Corner c : mesh.at(v)) {
          const Index f = mesh.face(c);
          if (component[f] >= 0 || (mesh.next(c) != w && mesh.previous(c) != w)) continue;
          component[f] = components;
          stack.push_back(f);
        }
      }
    }
    ++components;
  }
  return component;
}

}  // namespace tripatch
