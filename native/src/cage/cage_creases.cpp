#include "tripatch/cage/cage_creases.h"

#include <algorithm>
#include <set>
#include <utility>

namespace tripatch {
namespace {

/// A crease from the rim into a fill: the vertices that it passes, and its value outside.
struct CreaseRun {
  std::vector<Index> path;
  double value = 0;
};

/// The vertex straight on where four quads meet, else -1.
Index straight_across(const Connectivity& whole, Index from, Index to) {
  std::vector<Index> beside;  // of the two faces at the edge
  for (const Index f : whole.faces_at_edge(from, to))
    beside.insert(beside.end(), whole.faces()[f].begin(), whole.faces()[f].end());
  if (whole.at(to).size() != 4) return -1;
  for (const Connectivity::Corner c : whole.at(to)) {
    if (whole.faces()[whole.face(c)].size() != 4) return -1;
    if (std::ranges::find(beside, whole.next(c)) == beside.end()) return whole.next(c);
  }
  return -1;
}

}  // namespace

std::vector<InnerCrease> creases_through(const ClosedCage& cage, const Connectivity& whole, const CageHole& hole, std::size_t h,
                                         const Subdivision& settings) {
  const std::set<Index> rim(hole.hole.rim.begin(), hole.hole.rim.end());
  const auto is_inside = [&](Index a, Index b) {
    const std::vector<Index> faces = whole.faces_at_edge(a, b);
    return !faces.empty() &&
           std::ranges::all_of(faces, [&](Index f) { return cage.first_face[h] <= f && f < cage.first_face[h + 1]; });
  };
  std::vector<CreaseRun> runs;
  for (std::size_t k = 0; k < settings.crease_edges.size() && !settings.loop; ++k)
    for (const bool backwards : {false, true}) {
      Index from = settings.crease_edges[k][backwards ? 1 : 0], to = settings.crease_edges[k][backwards ? 0 : 1];
      if (!rim.contains(to) || rim.contains(from) || !(settings.edge_creases[k] > 0)) continue;
      CreaseRun run = {{to}, settings.edge_creases[k]};
      for (Index next = straight_across(whole, from, to); next >= 0 && is_inside(to, next);) {
        run.path.push_back(next);
        if (rim.contains(next)) break;
        from = std::exchange(to, next);
        next = straight_across(whole, from, to);
      }
      if (run.path.size() > 1) runs.push_back(std::move(run));
    }
  std::vector<InnerCrease> creases;
  for (const CreaseRun& run : runs) {
    const auto goes_on_as = [&](const CreaseRun& other) {
      return &other != &run &&
             (rim.contains(run.path.back()) ? other.path.back() == run.path.front() && other.path.front() == run.path.back()
                                            : other.path.back() == run.path.back());
    };
    const auto ends = std::ranges::count_if(runs, goes_on_as);
    if (ends == 0) continue;
    const CreaseRun& other = *std::ranges::find_if(runs, goes_on_as);
    const bool is_whole = rim.contains(run.path.back());
    if (is_whole && run.path.back() < run.path.front()) continue;  // the other is the same
    const double edges = static_cast<double>(run.path.size() - 1 + (is_whole ? 0 : other.path.size() - 1));
    for (std::size_t k = 0; k + 1 < run.path.size(); ++k) {
      const double at = (static_cast<double>(k) + 0.5) / edges;
      creases.push_back({{run.path[k], run.path[k + 1]}, ends == 1 ? run.value + at * (other.value - run.value) : run.value});
    }
  }
  return creases;
}

}  // namespace tripatch
