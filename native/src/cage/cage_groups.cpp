#include <map>
#include <numeric>

#include "tripatch/cage/cage_fill.h"
#include "tripatch/mesh/submesh.h"

namespace tripatch {

std::vector<std::vector<std::size_t>> cage_groups(const Connectivity& mesh, const std::vector<SidedRim>& holes) {
  std::vector<std::size_t> group(holes.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto root = [&](std::size_t h) {
    while (group[h] != h) h = group[h];
    return h;
  };
  Numbering owned;
  std::vector<std::size_t> owner;  // of the faces owned
  for (std::size_t h = 0; h < holes.size(); ++h)
    for (Index f : rings_around(mesh, holes[h].rim, 2).all_faces()) {
      if (owned.add(f)) {
        owner.push_back(h);
      } else {
        group[root(h)] = root(owner[owned.find(f)]);
      }
    }
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (std::size_t h = 0; h < holes.size(); ++h) members[root(h)].push_back(h);
  std::vector<std::vector<std::size_t>> result;
  for (auto& [first, all] : members) result.push_back(std::move(all));
  return result;
}

}  // namespace tripatch
