#include "tripatch/hole/joined_mesh.h"

#include <algorithm>
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

/// Leaves out what is not kept.
template <class T>
void keep(std::vector<T>& list, const std::vector<char>& kept) {
  std::size_t k = 0;
  std::erase_if(list, [&](const T&) { return !kept[k++]; });
}

/// Borders inside others become islands of these; so do outer borders, as those of a piece that floats in a hole.
void gather_islands(const Mesh& mesh, const Connectivity& around, Holes& holes) {
  std::vector<std::size_t> free;
  std::vector<Loop> loops;
  for (std::size_t k = 0; k < holes.rims.size(); ++k)
    if (!holes.refused[k]) free.push_back(k), loops.push_back(holes.rims[k]);
  loops.insert(loops.end(), holes.outer.begin(), holes.outer.end());
  const std::vector<std::vector<std::size_t>> inside = islands_of(mesh, around, loops);
  std::vector<char> kept(holes.rims.size(), 1), left(holes.outer.size(), 1);
  for (std::size_t k = 0; k < free.size(); ++k)
    for (const std::size_t island : inside[k]) {
      holes.islands[free[k]].push_back(loops[island]);
      (island < free.size() ? kept[free[island]] : left[island - free.size()]) = 0;
    }
  keep(holes.rims, kept), keep(holes.islands, kept), keep(holes.refused, kept);
  keep(holes.outer, left);
}

}  // namespace

JoinedMesh::JoinedMesh(Faces faces, const std::vector<Index>& own, std::vector<Index> stands)
    : faces_(std::move(faces)), stands_(std::move(stands)) {
  std::vector<char> doubled(stands_.size(), 0);
  for (std::size_t v = 0; v < stands_.size(); ++v)
    if (stands_[v] != static_cast<Index>(v)) doubled[stands_[v]] = 1;
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

void JoinedMesh::bring_edges_back(std::vector<Edge>& edges) const {
  for (Edge& edge : edges)
    if (const auto along = own_.find(edge); along != own_.end())
      edge = along->second;
    else if (const auto against = own_.find({edge[1], edge[0]}); against != own_.end())
      edge = {against->second[1], against->second[0]};
}

void JoinedMesh::bring_back(Fill& fill) const {
  EdgeMap halves;  // of rim edges that were split
  const std::vector<Edge> split = fill.split_edges;
  bring_edges_back(fill.split_edges), bring_edges_back(fill.creases), bring_edges_back(fill.feature_edges);
  for (std::size_t k = 0; k < split.size(); ++k) {
    const auto [a, b] = split[k];
    const auto [own_a, own_b] = fill.split_edges[k];
    const Index middle = std::ssize(stands_) + static_cast<Index>(k);
    halves[{a, middle}] = {own_a, middle}, halves[{middle, a}] = {middle, own_a};
    halves[{b, middle}] = {own_b, middle}, halves[{middle, b}] = {middle, own_b};
  }
  const auto found = [&](Index from, Index to) -> const Edge* {
    for (const EdgeMap* edges : {&own_, &std::as_const(halves)})
      if (const auto edge = edges->find({from, to}); edge != edges->end()) return &edge->second;
    return nullptr;
  };
  for (Index f = 0; f < fill.faces.size(); ++f) {
    const Loop face(fill.faces[f].begin(), fill.faces[f].end());
    for (std::size_t k = 0; k < face.size(); ++k) {
      Index& corner = fill.faces.corners[fill.faces.offsets[f] + static_cast<Index>(k)];
      if (const Edge* const after = found(face[k], face[(k + 1) % face.size()]))
        corner = (*after)[0];
      else if (const Edge* const before = found(face[(k > 0 ? k : face.size()) - 1], face[k]))
        corner = (*before)[1];
    }
  }
  fill.rim = in_mesh(fill.rim);
  if (fill.moved.empty()) return;
  std::map<Index, Vec3> moved_to;
  for (std::size_t k = 0; k < fill.moved.size(); ++k) moved_to[fill.moved[k]] = fill.moved_to.row(static_cast<Index>(k));
  for (Index v = 0; v < std::ssize(stands_); ++v) {
    const auto moved = stands_[v] == v ? moved_to.end() : moved_to.find(stands_[v]);
    if (moved == moved_to.end()) continue;
    fill.moved.push_back(v);
    fill.moved_to.conservativeResize(fill.moved_to.rows() + 1, 3);
    fill.moved_to.row(fill.moved_to.rows() - 1) = moved->second;
  }
}

Holes holes_among(const std::vector<Border>& borders, const std::vector<Loop>& unclosed, const Mesh& mesh,
                  const Connectivity& around, const HoleChoice& choice, bool islands) {
  Holes holes;
  for (const Border& border : borders) holes.borders.push_back(border.loop);
  const std::vector<Contact> touched = contacts(mesh, holes.borders);
  const std::vector<Loop> chosen = chosen_among(borders, mesh, around, choice);  // in the order of the borders
  std::size_t next = 0;
  std::vector<std::pair<Loop, std::optional<Message>>> found;
  for (std::size_t k = 0; k < borders.size(); ++k) {
    const Loop& loop = borders[k].loop;
    const bool touches = touched[k].on_others + touched[k].on_itself > 0, left = borders[k].outer && !choice.outer;
    std::optional<Message> refused;
    if (touches) refused = told_of_contact(loop, touched[k]);
    const bool is_chosen = next < chosen.size() && chosen[next] == loop;
    next += is_chosen ? 1 : 0;
    if (is_chosen || (left && touches))
      found.emplace_back(loop, std::move(refused));
    else if (left)
      holes.outer.push_back(loop);
  }
  for (const Loop& chain : unclosed) {
    found.emplace_back(chain, told_of_unclosed(chain));
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
  const Connectivity around(mesh);
  std::vector<Loop> unclosed;
  std::vector<Loop> loops = border_loops(around, &unclosed);
  JoinedBorders borders = join_borders(mesh, loops, tolerance::same * size_of(mesh), false);
  if (borders.stands.empty()) return holes_among(borders_of(mesh, around, loops), unclosed, mesh, around, choice, islands);
  const auto joined = std::make_shared<const JoinedMesh>(std::move(borders.faces), borders.own, std::move(borders.stands));
  const Mesh whole{mesh.vertices, joined->faces()};
  const Connectivity around_whole(whole);
  unclosed.clear();
  loops = border_loops(around_whole, &unclosed);
  Holes holes = holes_among(borders_of(whole, around_whole, loops), unclosed, whole, around_whole, choice, islands);
  holes.joined = joined;
  return holes;
}

}  // namespace tripatch
