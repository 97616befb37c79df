#include <map>
#include <numeric>
#include <set>

#include "tripatch/cage/cage_fill.h"

namespace tripatch {

std::vector<std::vector<std::size_t>> cage_groups(const Mesh& mesh, const std::vector<Hole>& holes,
                                                  const std::vector<Index>& replaced) {
  std::vector<std::size_t> group(holes.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto root = [&](std::size_t h) {
    while (group[h] != h) h = group[h];
    return h;
  };
  std::vector<std::vector<Index>> faces_at(mesh.vertices.rows());
  const std::set<Index> gone(replaced.begin(), replaced.end());
  for (Index f = 0; f < mesh.faces.size(); ++f)
    if (!gone.contains(f))
      for (Index v : mesh.faces[f]) faces_at[v].push_back(f);
  std::map<Index, std::size_t> owner;
  for (std::size_t h = 0; h < holes.size(); ++h) {
    std::set<Index> front(holes[h].rim.begin(), holes[h].rim.end()), faces;
    for (int ring = 0; ring < 2; ++ring) {
      for (Index v : front) faces.insert(faces_at[v].begin(), faces_at[v].end());
      for (Index f : faces) front.insert(mesh.faces[f].begin(), mesh.faces[f].end());
    }
    for (Index f : faces) {
      const auto [place, fresh] = owner.try_emplace(f, h);
      if (!fresh) group[root(h)] = root(place->second);
    }
  }
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t h = 0; h < holes.size(); ++h) members[root(h)].push_back(h);
  std::vector<std::vector<std::size_t>> result;
  for (auto& [first, all] : members) result.push_back(std::move(all));
  return result;
}

}  // namespace tripatch
