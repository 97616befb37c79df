#include "tripatch/hole/rim_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "tripatch/math/tolerances.h"

namespace tripatch {
namespace {

using Loop = std::vector<Index>;
using Corner = Connectivity::Corner;

/// The edges of a rim by how the faces next to them hold them: as given, or reversed.
struct RimEdges {
  std::vector<std::array<Index, 2>> along, against;
};

/// Every edge has one face, and not all of them the same: the back of a face is no hole.
RimEdges check_edges(const Connectivity& around, const Loop& rim) {
  const std::size_t n = rim.size();
  RimEdges edges;
  std::optional<Index> first;  // face next to the rim
  bool one_face = true;
  for (std::size_t k = 0; k < n; ++k) {
    const Index a = rim[k], b = rim[(k + 1) % n];
    int forward = 0, backward = 0;
    for (const Corner c : around.at(a)) {
      if (around.next(c) != b && around.previous(c) != b) continue;
      forward += around.next(c) == b;
      backward += around.previous(c) == b;
      if (!first) first = around.face(c);
      one_face = one_face && around.face(c) == *first;
    }
    if (forward + backward == 0) throw CodedRefusal(Code::no_face_at_edge, {a, b});
    if (forward + backward > 2) throw CodedRefusal(Code::non_manifold_edge, {{"faces", forward + backward}}, {a, b});
    if (forward + backward == 2) throw CodedRefusal(Code::faces_on_both_sides, {a, b});
    (forward ? edges.along : edges.against).push_back({a, b});
  }
  if (one_face && around.faces()[*first].size() == n) throw CodedRefusal(Code::loose_face, rim);
  return edges;
}

void check_orientation(const RimEdges& edges) {
  const auto& [along, against] = edges;
  if (along.empty() || against.empty()) return;
  Loop where;
  for (const auto& edge : std::min(along, against, [](auto& x, auto& y) { return x.size() < y.size(); }))
    where.insert(where.end(), edge.begin(), edge.end());
  std::sort(where.begin(), where.end());
  where.erase(std::unique(where.begin(), where.end()), where.end());
  throw CodedRefusal(Code::faces_flipped, where);
}

/// Memory of check_fan.
struct FanEnds {
  std::vector<Index> out, in, all;  // of edges from a vertex, once for every face
};

/// The faces at a vertex of the rim agree in orientation, and no more than two share an edge between rim vertices.
void check_fan(const Connectivity& around, Index v, const Loop& sorted_rim, FanEnds& room) {
  auto& [out, in, ends] = room;
  out.clear(), in.clear(), ends.clear();
  for (const Corner c : around.at(v)) {
    out.push_back(around.next(c));
    in.push_back(around.previous(c));
  }
  std::sort(out.begin(), out.end());
  std::sort(in.begin(), in.end());
  for (const auto& [side, other] : {std::pair(&out, &in), std::pair(&in, &out)})
    for (auto k = side->begin(); (k = std::adjacent_find(k, side->end())) != side->end(); ++k)
      if (!std::binary_search(other->begin(), other->end(), *k) && std::count(side->begin(), side->end(), *k) == 2)
        throw CodedRefusal(Code::face_flipped, {v, *k});
  std::merge(out.begin(), out.end(), in.begin(), in.end(), std::back_inserter(ends));
  for (auto k = ends.begin(); k != ends.end();) {
    const auto end = std::upper_bound(k, ends.end(), *k);
    if (end - k > 2 && std::binary_search(sorted_rim.begin(), sorted_rim.end(), *k))
      throw CodedRefusal(Code::non_manifold_edge, {{"faces", end - k}}, {v, *k});
    k = end;
  }
}

}  // namespace

void refuse_several(const std::vector<std::vector<Index>>& rims, Code code) {
  Loop where;
  for (const Loop& rim : rims) where.push_back(*std::min_element(rim.begin(), rim.end()));
  std::sort(where.begin(), where.end());
  throw CodedRefusal(code, {{"count", rims.size()}}, where);
}

void check_vertices(std::span<const Index> named, Index vertices, const char* option) {
  for (Index v : named)
    if (v < 0 || v >= vertices)
      throw CodedArgument(Code::no_such_vertex, {{"option", option}, {"vertex", v}, {"count", vertices}});
}

void check_distinct(std::span<const Index> named, const char* option) {
  for (std::size_t k = 0; k < named.size(); ++k)
    if (std::ranges::count(named.subspan(0, k), named[k]) > 0)
      throw CodedArgument(Code::given_twice, {{"option", option}, {"vertex", named[k]}});
}

std::vector<Index> check_topology(const Connectivity& around, const std::vector<Index>& rim) {
  check_vertices(rim, around.vertices(), "rim");
  if (rim.size() < 3) throw CodedRefusal(Code::rim_too_short, rim);
  Loop sorted = rim;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
    throw CodedRefusal(Code::rim_passes_twice, {*twice});
  const RimEdges edges = check_edges(around, rim);
  check_orientation(edges);
  FanEnds room;
  for (Index v : rim) check_fan(around, v, sorted, room);
  Loop turned = rim;
  if (!edges.along.empty()) std::reverse(turned.begin(), turned.end());
  return turned;
}

void check_finite(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  for (Index v : rim)
    for (const Connectivity::Corner c : around.at(v))
      for (Index w : around.faces()[around.face(c)])
        if (!mesh.vertices.row(w).allFinite()) throw CodedRefusal(Code::vertex_not_finite, {w});
}

void check_positions(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim) {
  check_finite(mesh, around, rim);
  double length = 0;
  const std::size_t n = rim.size();
  const auto edge_length = [&](std::size_t k) {
    return (mesh.vertices.row(rim[(k + 1) % n]) - mesh.vertices.row(rim[k])).stableNorm();
  };
  for (std::size_t k = 0; k < n; ++k) length += edge_length(k);
  if (!std::isfinite(length)) throw CodedRefusal(Code::rim_too_large, {rim[0]});
  for (std::size_t k = 0; k < n; ++k)
    if (!(edge_length(k) > tolerance::fit * length)) {
      const Index a = rim[k], b = rim[(k + 1) % n];
      throw CodedRefusal(Code::edge_without_length, {a, b});
    }
  Loop by_place = rim;
  const auto key = [&](Index v) { return std::array{mesh.vertices(v, 0), mesh.vertices(v, 1), mesh.vertices(v, 2)}; };
  std::sort(by_place.begin(), by_place.end(), [&](Index a, Index b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  const auto same = std::adjacent_find(by_place.begin(), by_place.end(), [&](Index a, Index b) { return key(a) == key(b); });
  if (same != by_place.end()) throw CodedRefusal(Code::vertices_at_one_place, {same[0], same[1]});
}

}  // namespace tripatch
