#include "tripatch/mesh/submesh.h"

#include <algorithm>

#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// Numbers between the first and the last of some over how many they are, up to which looking at each takes less than sorting.
constexpr Index at_most_apart = count::dozens;

}  // namespace

/// Where an item stands, or the free place where it would.
std::size_t Numbering::slot(Index item) const {
  const std::size_t mask = place_.size() - 1;
  // multiplied by 2^64 over the golden ratio, so that neighboring numbers come apart (Knuth, vol. 3, 6.4)
  std::size_t k = static_cast<std::uint64_t>(item) * 0x9E3779B97F4A7C15U >> 20 & mask;
  while (place_[k] >= 0 && items_[place_[k]] != item) k = (k + 1) & mask;
  return k;
}

int& Numbering::place_to_add(Index item) {
  if (2 * (items_.size() + 1) > place_.size()) {
    place_.assign(std::max<std::size_t>(64, 2 * place_.size()), -1);
    for (std::size_t k = 0; k < items_.size(); ++k) place_[slot(items_[k])] = static_cast<int>(k);
  }
  return place_[slot(item)];
}

std::vector<Index> Rings::all_faces() const {
  std::vector<Index> all;
  for (const std::vector<Index>& ring : faces) all.insert(all.end(), ring.begin(), ring.end());
  if (all.empty()) return all;
  const auto [first, last] = std::ranges::minmax(all);
  if (last - first > at_most_apart * static_cast<Index>(all.size())) {
    std::sort(all.begin(), all.end());
    return all;
  }
  std::vector<char> there(last - first + 1, 0);
  for (Index f : all) there[f - first] = 1;
  all.clear();
  for (Index f = first; f <= last; ++f)
    if (there[f - first]) all.push_back(f);
  return all;
}

Rings rings_around(const Connectivity& mesh, std::span<const Index> vertices, int rings) {
  Numbering seen(mesh.vertices()), taken(mesh.faces().size());
  for (Index v : vertices) seen.add(v);
  Rings result;
  result.vertices.push_back(seen.items());
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<Index> faces, next;
    for (Index v : result.vertices[ring])
      for (Connectivity::Corner c : mesh.at(v)) {
        const Index f = mesh.face(c);
        if (!taken.add(f)) continue;
        faces.push_back(f);
        for (Index w : mesh.faces()[f])
          if (seen.add(w)) next.push_back(w);
      }
    result.faces.push_back(std::move(faces));
    result.vertices.push_back(std::move(next));
  }
  return result;
}

Submesh submesh(const FacesRef& faces, Index vertices, std::vector<Index> some, std::span<const Index> first) {
  Submesh part{std::move(some), Numbering(vertices), {0}, {}, {}, {}};
  for (Index v : first) part.vertex.add(v);
  part.offsets.reserve(part.face.size() + 1);
  part.corners.reserve(4 * part.face.size());
  for (Index f : part.face) {
    for (Index v : faces[f]) part.corners.push_back(part.vertex.number(v));
    part.offsets.push_back(static_cast<int>(part.corners.size()));
  }
  part.fan_offsets.assign(part.vertex.size() + 1, 0);
  for (int v : part.corners) ++part.fan_offsets[v + 1];
  for (std::size_t v = 0; v < part.vertex.size(); ++v) part.fan_offsets[v + 1] += part.fan_offsets[v];
  part.fan.resize(part.corners.size());
  std::vector<int> place(part.fan_offsets.begin(), part.fan_offsets.end() - 1);
  for (int f = 0; f + 1 < static_cast<int>(part.offsets.size()); ++f)
    for (int v : part[f]) part.fan[place[v]++] = f;
  return part;
}

}  // namespace tripatch
