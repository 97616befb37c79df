#include "tripatch/fill/merged_rims.h"

#include <algorithm>
#include <utility>

#include "tripatch/math/tolerances.h"
#include "tripatch/messages.h"

namespace tripatch {

namespace {

/// How near each other vertices of a rim are at one place.
double one_place(const PointsRef& vertices, std::span<const Index> rim) {
  double length = 0;
  for (std::size_t k = 0; k < rim.size(); ++k)
    length += (vertices.row(rim[(k + 1) % rim.size()]) - vertices.row(rim[k])).stableNorm();
  return tolerance::same * length;
}

/// A fill's rows of something at its rim, for the rim with more vertices. row: of each of these.
template <class Rows>
void repeat_rows(Rows& rows, const std::vector<Index>& row) {
  if (rows.rows() > 0) rows = Rows(rows(row, Eigen::all));
}

}  // namespace

bool has_edges_of_no_length(const PointsRef& vertices, std::span<const Index> rim) {
  const double near = one_place(vertices, rim);
  for (std::size_t k = 0; k < rim.size(); ++k)
    if ((vertices.row(rim[(k + 1) % rim.size()]) - vertices.row(rim[k])).stableNorm() <= near) return true;
  return false;
}

MergedRims::MergedRims(const Mesh& mesh, std::span<const std::vector<Index>> rims, const FillOptions& options)
    : mesh_(mesh), replaced_(options.replaced), options_(options) {
  const auto has_none = [&](const std::vector<Index>& rim) { return !has_edges_of_no_length(mesh.vertices, rim); };
  if (std::ranges::all_of(rims, has_none)) return;
  std::unordered_map<Index, int> passed;
  for (const std::vector<Index>& rim : rims)
    for (Index v : rim) ++passed[v];
  for (const std::vector<Index>& rim : rims)
    if (!has_none(rim)) merge(rim, passed);
  if (!any()) return;
  merge_faces();
  if (options_.rim) options_.rim = merged(*options_.rim);
  options_.corners = merged(options_.corners);
  for (std::vector<Index>& island : options_.islands) island = merged(island);
}

void MergedRims::merge(const std::vector<Index>& rim, const std::unordered_map<Index, int>& passed) {
  const std::size_t n = rim.size();
  const double near = one_place(mesh_.vertices, rim);
  const auto joined = [&](Index a, Index b) {
    const bool only_here = passed.at(a) == 1 && passed.at(b) == 1;
    return only_here && (mesh_.vertices.row(b) - mesh_.vertices.row(a)).stableNorm() <= near;
  };
  std::size_t begin = 0;
  while (begin < n && joined(rim[(begin + n - 1) % n], rim[begin])) ++begin;
  if (begin == n) return;
  std::vector<std::vector<Index>> places;
  for (std::size_t k = 0; k < n; ++k) {
    const Index v = rim[(begin + k) % n];
    if (places.empty() || !joined(places.back().front(), v)) places.emplace_back();
    places.back().push_back(v);
  }
  if (places.size() < 3) return;
  std::vector<std::size_t> stands;  // the lowest, wherever the rim was begun
  for (const std::vector<Index>& place : places) {
    stands.push_back(static_cast<std::size_t>(std::min_element(place.begin(), place.end()) - place.begin()));
    for (Index v : place)
      if (v != place[stands.back()]) at_[v] = place[stands.back()];
  }
  for (std::size_t k = 0; k < places.size(); ++k) {
    const std::size_t next = (k + 1) % places.size();
    std::vector<Index> path(places[k].begin() + static_cast<std::ptrdiff_t>(stands[k]) + 1, places[k].end());
    path.insert(path.end(), places[next].begin(), places[next].begin() + static_cast<std::ptrdiff_t>(stands[next]));
    if (path.empty()) continue;
    const Index from = places[k][stands[k]], to = places[next][stands[next]];
    between_[{to, from}] = {path.rbegin(), path.rend()};
    between_[{from, to}] = std::move(path);
  }
}

Index MergedRims::place(Index v) const {
  const auto found = at_.find(v);
  return found == at_.end() ? v : found->second;
}

std::vector<Index> MergedRims::merged(const std::vector<Index>& loop) const {
  std::vector<Index> out;
  for (Index v : loop)
    if (out.empty() || out.back() != place(v)) out.push_back(place(v));
  if (out.size() > 1 && out.front() == out.back()) out.pop_back();
  return out;
}

Corners MergedRims::merged(const Corners& corners) const {
  if (!corners) return {};
  std::vector<Index> out;
  for (Index v : *corners) {
    const auto same = std::ranges::find(out, place(v));
    if (same != out.end() && (*corners)[same - out.begin()] != v)
      throw CodedArgument(Code::corners_at_one_place, {{"first", (*corners)[same - out.begin()]}, {"second", v}});
    out.push_back(place(v));
  }
  return out;
}

void MergedRims::merge_faces() {
  const FacesRef& were = mesh_.faces;
  faces_.offsets.reserve(were.offsets.size());
  faces_.corners.reserve(were.corners.size());
  std::vector<Index> gone, replaced;
  for (Index f = 0; f < were.size(); ++f) {
    const auto is_merged = [&](Index v) { return at_.contains(v); };
    if (std::ranges::none_of(were[f], is_merged)) {
      faces_.add(were[f]);
      continue;
    }
    const std::vector<Index> face = merged({were[f].begin(), were[f].end()});
    if (face.size() > 2)
      faces_.add(face);
    else
      gone.push_back(f);
  }
  for (Index f : replaced_) {
    const auto at = std::lower_bound(gone.begin(), gone.end(), f);
    if (at == gone.end() || *at != f) replaced.push_back(f - (at - gone.begin()));
  }
  options_.replaced = std::move(replaced);
}

/// Between the vertices of a fill; an edge of the rim that it splits becomes that between the two places.
MergedRims::Between MergedRims::between_in(Fill& fill) const {
  Between between = between_;
  for (std::size_t k = 0; k < fill.split_edges.size(); ++k) {
    auto& [from, to] = fill.split_edges[k];
    const auto found = between_.find({from, to});
    if (found == between_.end()) continue;
    const Index at = mesh_.vertices.rows() + static_cast<Index>(k);
    const auto first_of_to = std::ranges::find_if(found->second, [&](Index v) { return place(v) == to; });
    const std::vector<Index> near(found->second.begin(), first_of_to), far(first_of_to, found->second.end());
    between[{from, at}] = near;
    between[{at, from}] = {near.rbegin(), near.rend()};
    between[{at, to}] = far;
    between[{to, at}] = {far.rbegin(), far.rend()};
    if (!near.empty()) from = near.back();
    if (!far.empty()) to = far.front();
  }
  return between;
}

/// The face with all vertices of the rim on its edges: of those at one place the first stays its corner, and each pair that follows is
/// a triangle with the corner behind them.
void MergedRims::add_joined(std::span<const Index> face, const Between& between, Faces& faces,
                            std::vector<std::array<Index, 3>>& flat) const {
  std::vector<Index> all;
  for (std::size_t k = 0; k < face.size(); ++k) {
    all.push_back(face[k]);
    const auto more = between.find({face[k], face[(k + 1) % face.size()]});
    if (more != between.end()) all.insert(all.end(), more->second.begin(), more->second.end());
  }
  const std::size_t n = all.size();
  if (n == face.size()) return faces.add(face);
  const auto starts = [&](std::size_t k) { return place(all[(k + n - 1) % n]) != place(all[k]); };
  std::vector<Index> corners;
  for (std::size_t k = 0; k < n; ++k)
    if (starts(k)) corners.push_back(all[k]);
  faces.add(corners);
  for (std::size_t k = 0; k < n; ++k) {
    const std::size_t next = (k + 1) % n;
    if (starts(next)) continue;
    std::size_t behind = next;
    while (!starts(behind)) behind = (behind + 1) % n;
    flat.push_back({all[k], all[next], all[behind]});
    faces.add(flat.back());
  }
}

bool MergedRims::bring_back(Fill& fill) const {
  Faces faces;
  std::vector<std::array<Index, 3>> flat;
  const Between between = between_in(fill);
  for (Index f = 0; f < fill.faces.size(); ++f) add_joined(fill.faces[f], between, faces, flat);
  std::vector<Index> rim, row;
  const auto walk = [&](std::size_t begin, std::size_t end) {  // one of the loops
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t next = k + 1 < end ? k + 1 : begin;
      rim.push_back(fill.rim[k]);
      row.push_back(static_cast<Index>(k));
      const auto more = between_.find({fill.rim[k], fill.rim[next]});
      if (more == between_.end()) continue;
      for (Index v : more->second) {
        rim.push_back(v);
        row.push_back(static_cast<Index>(place(v) == fill.rim[k] ? k : next));
      }
    }
  };
  std::size_t end = fill.rim.size();  // the islands' vertices follow those of the rim
  for (const std::vector<Index>& island : options_.islands) end -= island.size();
  walk(0, end);
  for (const std::vector<Index>& island : options_.islands) {
    walk(end, end + island.size());
    end += island.size();
  }
  if (flat.size() != rim.size() - fill.rim.size()) return false;
  if (flat.empty()) return true;
  std::vector<Index> ends;
  const auto is_new = [&](Index v) { return v >= mesh_.vertices.rows(); };
  for (const auto& [a, b, behind] : flat) ends.insert(ends.end(), {a, is_new(behind) ? a : behind});
  const Connectivity around = Connectivity::around(mesh_, ends, 0, replaced_);
  for (const auto& [a, b, behind] : flat)
    if (!is_new(behind) && !around.faces_at_edge(a, behind).empty()) return false;
  fill.faces = std::move(faces);
  fill.rim = std::move(rim);
  repeat_rows(fill.rim_normals, row);
  repeat_rows(fill.rim_barycentric, row);
  repeat_rows(fill.rim_uv, row);
  fill.report.warnings.push_back({Code::edges_without_length, {{"edges", flat.size()}}, {flat[0][0], flat[0][1]}});
  return true;
}

}  // namespace tripatch
