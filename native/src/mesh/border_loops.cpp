#include "tripatch/mesh/border_loops.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

using Loop = std::vector<Index>;
using Corner = Connectivity::Corner;

/// An edge with exactly one face, in the direction that a new face takes: against that of its face.
struct BorderEdge {
  Index from, to;
  auto operator<=>(const BorderEdge&) const = default;
};

/// Whether every neighbor of v is before it in a face and behind it in another: no border edge ends there.
bool inside(const Connectivity& mesh, std::span<const Corner> corners) {
  constexpr std::size_t few = count::places;  // corners that are compared each with each
  if (corners.size() > few) return false;
  std::array<Index, few> next{}, previous{};
  for (std::size_t k = 0; k < corners.size(); ++k) {
    next[k] = mesh.next(corners[k]);
    previous[k] = mesh.previous(corners[k]);
  }
  const auto all_in = [n = corners.size()](const std::array<Index, few>& some, const std::array<Index, few>& others) {
    return std::all_of(some.begin(), some.begin() + n,
                       [&](Index v) { return std::find(others.begin(), others.begin() + n, v) != others.begin() + n; });
  };
  return all_in(next, previous) && all_in(previous, next);
}

/// Sorted. Every edge is looked at from its lower vertex.
std::vector<BorderEdge> border_edges(const Connectivity& mesh) {
  std::vector<BorderEdge> border;
  std::vector<std::pair<Index, bool>> ends;  // of the edges of a vertex to higher ones, and whether a face holds them from here
  for (Index v = 0; v < mesh.vertices(); ++v) {
    const auto corners = mesh.at(v);
    if (inside(mesh, corners)) continue;
    ends.clear();
    for (Corner c : corners) {
      if (const Index w = mesh.next(c); w > v) ends.emplace_back(w, true);
      if (const Index w = mesh.previous(c); w > v) ends.emplace_back(w, false);
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t k = 0, end = 0; k < ends.size(); k = end) {
      const auto [w, outgoing] = ends[k];
      for (end = k; end < ends.size() && ends[end].first == w; ++end) continue;
      if (end == k + 1) border.push_back(outgoing ? BorderEdge{w, v} : BorderEdge{v, w});
    }
  }
  std::sort(border.begin(), border.end());
  return border;
}

/// The border edges out of a vertex: places in `border`, from the first to before the last.
std::pair<Index, Index> out_of(const std::vector<BorderEdge>& border, Index v) {
  const auto before = [](const BorderEdge& e, Index x) { return e.from < x; };
  const auto first = std::lower_bound(border.begin(), border.end(), v, before);
  return {first - border.begin(), std::lower_bound(first, border.end(), v + 1, before) - border.begin()};
}

/// The fans of faces around a vertex where border loops touch.
class Fans {
public:
  Fans(const Connectivity& mesh, Index v) {
    for (Corner c : mesh.at(v)) wedges_.push_back({mesh.next(c), mesh.previous(c)});
    std::sort(wedges_.begin(), wedges_.end());
    crossed_.assign(wedges_.size(), 0);
  }
  /// The last edge of the fan whose first edge leads to u: the one of the sorted `border` that leaves along it; its end: none.
  std::span<const BorderEdge>::iterator end_of(Index u, std::span<const BorderEdge> border) {
    while (true) {
      const auto w = std::lower_bound(wedges_.begin(), wedges_.end(), Wedge{u, -1});
      if (w == wedges_.end() || w->next != u || crossed_[w - wedges_.begin()]) return border.end();
      crossed_[w - wedges_.begin()] = 1;
      u = w->previous;
      const auto found = std::lower_bound(border.begin(), border.end(), u, [](const BorderEdge& e, Index x) { return e.to < x; });
      if (found != border.end() && found->to == u) return found;
    }
  }

private:
  struct Wedge {
    Index next, previous;
    auto operator<=>(const Wedge&) const = default;
  };
  std::vector<Wedge> wedges_;
  std::vector<char> crossed_;
};

/// Which border edge follows each one, -1 where none does. At a vertex where several border loops touch, the loops are
/// parted by the gaps between the fans of faces there: the edge at which a fan starts leads on along the edge at which its
/// neighbor fan ends.
std::vector<Index> following_edges(const Connectivity& mesh, const std::vector<BorderEdge>& border) {
  const Index m = static_cast<Index>(border.size());
  std::vector<Index> next(m, -1);
  std::vector<char> taken(m, 0);
  std::vector<std::pair<Index, Index>> touching;  // (vertex, border edge that arrives there)
  for (Index e = 0; e < m; ++e) {
    const auto [first, last] = out_of(border, border[e].to);
    if (last == first) continue;
    if (last == first + 1 && !taken[first]) {
      next[e] = first;
      taken[first] = 1;
    } else if (last > first + 1) {
      touching.emplace_back(border[e].to, e);
    }
  }
  std::sort(touching.begin(), touching.end());
  for (std::size_t k = 0; k < touching.size();) {
    const Index v = touching[k].first;
    const auto [first, last] = out_of(border, v);
    const std::span<const BorderEdge> leaving_edges(&border[first], last - first);
    Fans around(mesh, v);
    std::vector<std::pair<Index, Index>> fans;  // (arriving edge, leaving edge) of each
    Loop arriving;                              // whose fan has no end: non-manifold or flipped faces
    for (; k < touching.size() && touching[k].first == v; ++k) {
      const Index e = touching[k].second;
      const auto end = around.end_of(border[e].from, leaving_edges);
      const Index leaving = first + (end - leaving_edges.begin());
      if (end != leaving_edges.end() && !taken[leaving]) {
        taken[leaving] = 1;
        fans.emplace_back(e, leaving);
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

/// What is left where neighboring faces disagree in orientation: loops whatever the direction of the edges, each in the
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

/// The border edges that no loop holds, in chains. They form no cycle, as loops have been taken off wherever a way came back.
std::vector<Loop> unclosed_borders(const std::vector<BorderEdge>& border, const std::vector<Loop>& loops) {
  std::set<BorderEdge> held;
  for (const Loop& loop : loops)
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Index a = loop[k], b = loop[(k + 1) % loop.size()];
      held.insert({a, b});
      held.insert({b, a});
    }
  std::map<Index, std::set<Index>> neighbors;
  for (const BorderEdge& e : border)
    if (!held.contains(e)) {
      neighbors[e.from].insert(e.to);
      neighbors[e.to].insert(e.from);
    }
  std::vector<Loop> chains;
  while (!neighbors.empty()) {
    const auto end = std::ranges::find_if(neighbors, [](const auto& each) { return each.second.size() == 1; });
    Loop& chain = chains.emplace_back(1, end->first);
    for (auto at = end; at != neighbors.end(); at = neighbors.find(chain.back())) {
      const Index from = at->first, to = *at->second.begin();
      at->second.erase(to);
      if (at->second.empty()) neighbors.erase(at);
      neighbors[to].erase(from);
      if (neighbors[to].empty()) neighbors.erase(to);
      chain.push_back(to);
    }
  }
  return chains;
}

}  // namespace

std::vector<std::vector<Index>> border_loops(const Connectivity& mesh, std::vector<std::vector<Index>>* unclosed) {
  const std::vector<BorderEdge> border = border_edges(mesh);
  if (border.empty()) return {};
  const std::vector<Index> next = following_edges(mesh, border);
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
  if (std::find(open.begin(), open.end(), 1) != open.end()) {
    undirected_loops(border, used, way, loops);
    if (unclosed) *unclosed = unclosed_borders(border, loops);
  }

  for (Loop& loop : loops) std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
  std::sort(loops.begin(), loops.end(),
            [](const Loop& a, const Loop& b) { return a.size() != b.size() ? a.size() < b.size() : a < b; });
  return loops;
}

}  // namespace tripatch
