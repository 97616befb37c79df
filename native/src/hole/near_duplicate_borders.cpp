#include "tripatch/hole/near_duplicate_borders.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

#include "tripatch/mesh/edge_key.h"

namespace tripatch {
namespace {

using Place = std::array<double, 3>;
constexpr Index nowhere = -1;

struct PlaceHash {
  std::size_t operator()(const Place& p) const {
    const auto bits = [&](int k) { return std::bit_cast<std::uint64_t>(p[k]); };
    const std::uint64_t mixed =
        bits(0) * 0x9E3779B97F4A7C15ull ^ bits(1) * 0xC2B2AE3D27D4EB4Full ^ bits(2) * 0x165667B19E3779F9ull;
    return mixed ^ mixed >> 32;  // the last bits of coordinates are mostly zero
  }
};

/// Of vertices that lie where a rim passes: the lowest vertex of a rim there; else `nowhere`.
std::vector<Index> rim_vertices_at(const Mesh& mesh, std::span<const std::vector<Index>> rims) {
  const Index n = mesh.vertices.rows();
  const auto place = [&](Index v) {
    return Place{mesh.vertices(v, 0) + 0.0, mesh.vertices(v, 1) + 0.0, mesh.vertices(v, 2) + 0.0};
  };
  std::unordered_map<Place, Index, PlaceHash> first;
  std::size_t count = 0;
  for (const std::vector<Index>& rim : rims) count += rim.size();
  first.reserve(4 * count);  // so that most other places are distinguished from them by an empty bucket
  Place low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (const std::vector<Index>& rim : rims)
    for (Index v : rim) {
      if (v < 0 || v >= n) continue;
      const Place p = place(v);
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
      Index& lowest = first.try_emplace(p, v).first->second;
      lowest = std::min(lowest, v);
    }
  std::vector<Index> found(n, nowhere);
  for (Index v = 0; v < n; ++v) {
    const Place p = place(v);
    if (p[0] < low[0] || p[0] > high[0] || p[1] < low[1] || p[1] > high[1] || p[2] < low[2] || p[2] > high[2]) continue;
    if (const auto at = first.find(p); at != first.end()) found[v] = at->second;
  }
  return found;
}

using Edge = std::array<Index, 2>;        ///< the lower vertex first
using PlacedEdge = std::array<Index, 2>;  ///< likewise, by the vertices that stand for the places of its ends

/// The edges of the border between places on rims.
std::map<PlacedEdge, std::vector<Edge>> border_between(const FacesRef& faces, const std::vector<Index>& at) {
  std::map<PlacedEdge, std::vector<Edge>> all, border;
  const auto passed = [&](Index v) { return v >= 0 && std::cmp_less(v, at.size()) && at[v] != nowhere; };  // any file's faces
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < faces[f].size(); ++k) {
      const Index a = faces[f][k], b = faces[f][(k + 1) % faces[f].size()];
      if (!passed(a) || !passed(b) || a == b) continue;
      all[edge_key(at[a], at[b])].push_back(edge_key(a, b));
    }
  for (auto& [between, edges] : all) {
    std::sort(edges.begin(), edges.end());
    for (const Edge& edge : edges)
      if (std::count(edges.begin(), edges.end(), edge) == 1) border[between].push_back(edge);
  }
  return border;
}

}  // namespace

std::vector<std::optional<Message>> told_of_near_duplicate_borders(const Mesh& mesh, std::span<const std::vector<Index>> rims) {
  std::vector<std::optional<Message>> told(rims.size());
  const std::vector<Index> at = rim_vertices_at(mesh, rims);
  std::vector<int> count(at.size());
  for (Index v : at)
    if (v != nowhere) ++count[v];
  if (std::none_of(count.begin(), count.end(), [](int each) { return each > 1; })) return told;
  const std::map<PlacedEdge, std::vector<Edge>> border = border_between(mesh.faces, at);
  for (std::size_t r = 0; r < rims.size(); ++r) {
    const std::vector<Index>& rim = rims[r];
    std::size_t upon = 0;
    Edge one = {};
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const Edge edge = edge_key(rim[k], rim[(k + 1) % rim.size()]);
      if (edge[0] < 0 || edge[1] >= mesh.vertices.rows()) continue;
      const auto found = border.find(edge_key(at[edge[0]], at[edge[1]]));
      if (found == border.end() || found->second.size() < 2) continue;
      if (std::find(found->second.begin(), found->second.end(), edge) == found->second.end()) continue;
      if (upon++ == 0) one = edge;
    }
    if (upon == 0) continue;
    const bool is_all = upon == rim.size();
    told[r] = Message{is_all ? Code::rim_on_borders : Code::edges_on_borders,
                      {{"count", upon}, {"edges", rim.size()}, {"edge", std::vector<Index>{one[0], one[1]}}},
                      {one[0], one[1]}};
  }
  return told;
}

}  // namespace tripatch
