#include "tripatch/hole/joined_mesh.h"

#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "tripatch/hole/choose_holes.h"
#include "tripatch/hole/islands.h"
#include "tripatch/hole/near_duplicates.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/mesh/border_loops.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {
namespace {

using Loop = std::vector<Index>;

Message told_of_contact(const Loop& loop, const Contact& contact) {
  const std::size_t count = contact.on_others + contact.on_itself;
  const Code code = count < loop.size()     ? Code::edges_on_borders
                    : contact.on_others > 0 ? Code::rim_on_borders
                                            : Code::slit_without_width;
  return {code, {{"count", count}, {"edges", loop.size()}, {"edge", std::vector<Index>{contact.edge[0], contact.edge[1]}}}, loop};
}

/// Borders inside others become islands of these; so do outer borders, as those of a piece that floats in a hole.
void gather_islands(const Mesh& mesh, const Connectivity& around, Holes& holes) {
  std::vector<std::size_t> free;
  std::vector<Loop> loops;
  for (std::size_t k = 0; k < holes.rims.size(); ++k)
    if (!holes.refused[k]) free.push_back(k), loops.push_back(holes.rims[k]);
  loops.insert(loops.end(), holes.outer.begin(), holes.outer.end());
  const std::vector<std::vector<std::size_t>> inside = islands_of(mesh, around, loops);
  std::vector<char> gone(loops.size(), 0);
  for (std::size_t k = 0; k < free.size(); ++k)
    for (const std::size_t island : inside[k]) {
      holes.islands[free[k]].push_back(loops[island]);
      gone[island] = 1;
    }
  for (std::size_t k = loops.size(); k-- > 0;) {
    if (!gone[k]) continue;
    if (k >= free.size()) {
      holes.outer.erase(holes.outer.begin() + static_cast<std::ptrdiff_t>(k - free.size()));
      continue;
    }
    const auto at = static_cast<std::ptrdiff_t>(free[k]);
    holes.rims.erase(holes.rims.begin() + at);
    holes.islands.erase(holes.islands.begin() + at);
    holes.refused.erase(holes.refused.begin() + at);
  }
}

}  // namespace

JoinedMesh::JoinedMesh(Faces faces, const std::vector<Index>& own, const std::vector<Index>& stands) : faces_(std::move(faces)) {
  std::vector<char> doubled(stands.size(), 0);
  for (std::size_t v = 0; v < stands.size(); ++v)
    if (stands[v] != static_cast<Index>(v)) doubled[stands[v]] = 1;
  for (Index f = 0; f < faces_.size(); ++f) {
    const std::span<const Index> face = faces_[f];
    if (std::ranges::none_of(face, [&](Index v) { return doubled[v]; })) continue;
    const Index* const before = own.data() + faces_.offsets[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      const std::size_t back = (k > 0 ? k : face.size()) - 1;
      own_[{face[k], face[back]}] = {before[k], before[back]};
    }
  }
}

std::vector<Index> JoinedMesh::in_mesh(const Loop& loop) const {
  Loop own = loop;
  for (std::size_t k = 0; k < loop.size(); ++k)
    if (const auto edge = own_.find({loop[k], loop[(k + 1) % loop.size()]}); edge != own_.end()) own[k] = edge->second[0];
  return own;
}

void JoinedMesh::bring_back(Fill& fill) const {
  for (Index f = 0; f < fill.faces.size(); ++f) {
    const Loop face(fill.faces[f].begin(), fill.faces[f].end());
    for (std::size_t k = 0; k < face.size(); ++k) {
      Index& corner = fill.faces.corners[fill.faces.offsets[f] + static_cast<Index>(k)];
      if (const auto after = own_.find({face[k], face[(k + 1) % face.size()]}); after != own_.end())
        corner = after->second[0];
      else if (const auto before = own_.find({face[(k > 0 ? k : face.size()) - 1], face[k]}); before != own_.end())
        corner = before->second[1];
    }
  }
  fill.rim = in_mesh(fill.rim);
}

Holes holes_among(const std::vector<Border>& borders, const std::vector<Loop>& unclosed, const Mesh& mesh,
                  const Connectivity& around, const HoleChoice& choice, bool islands) {
  Holes holes;
  for (const Border& border : borders) holes.borders.push_back(border.loop);
  const std::vector<Contact> touched = contacts(mesh, holes.borders);
  std::set<Loop> chosen;
  for (Loop& loop : chosen_among(borders, mesh, around, choice)) chosen.insert(std::move(loop));
  std::vector<std::pair<Loop, std::optional<Message>>> found;
  for (std::size_t k = 0; k < borders.size(); ++k) {
    const Loop& loop = borders[k].loop;
    const bool touches = touched[k].on_others + touched[k].on_itself > 0, left = borders[k].outer && !choice.outer;
    std::optional<Message> refused;
    if (touches) refused = told_of_contact(loop, touched[k]);
    if (chosen.contains(loop) || (left && touches))
      found.emplace_back(loop, std::move(refused));
    else if (left)
      holes.outer.push_back(loop);
  }
  for (const Loop& chain : unclosed) {
    const std::vector<Index> ends{chain.front(), chain.back()};
    found.emplace_back(chain, Message{Code::border_not_closed, {{"edges", chain.size() - 1}, {"ends", ends}}, chain});
    holes.borders.push_back(chain);
  }
  std::ranges::sort(found, [](const auto& a, const auto& b) {
    return a.first.size() != b.first.size() ? a.first.size() < b.first.size() : a.first < b.first;
  });
  for (auto& [loop, refused] : found) {
    holes.rims.push_back(std::move(loop));
    holes.refused.push_back(std::move(refused));
  }
  holes.islands.resize(holes.rims.size());
  if (islands && holes.rims.size() + holes.outer.size() > 1) gather_islands(mesh, around, holes);
  return holes;
}

std::vector<Index> Holes::in_mesh(const Loop& loop) const { return joined ? joined->in_mesh(loop) : loop; }

Holes find_all_holes(const Mesh& mesh, const HoleChoice& choice, bool islands) {
  const auto found_in = [&](const Mesh& of, const Connectivity& around) {
    std::vector<Loop> unclosed;
    const std::vector<Loop> loops = border_loops(around, &unclosed);
    return holes_among(borders_of(of, around, loops), unclosed, of, around, choice, islands);
  };
  const Connectivity around(mesh);
  JoinedBorders borders = join_borders(mesh, border_loops(around), tolerance::same * size_of(mesh), false);
  if (borders.stands.empty()) return found_in(mesh, around);
  const auto joined = std::make_shared<const JoinedMesh>(std::move(borders.faces), borders.own, borders.stands);
  const Mesh whole{mesh.vertices, joined->faces()};
  Holes holes = found_in(whole, Connectivity(whole));
  holes.joined = joined;
  return holes;
}

}  // namespace tripatch
