#include "tripatch/hole/extra_face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <unordered_map>
#include <utility>

#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/edge_key.h"

namespace tripatch {
namespace {

/// Cosine between the ways from one face to the next across their edge, below which they are no one surface: 60 degrees, more than ears of
/// rough rims bend. A choice.
constexpr double one_surface_cos = share::half;

Vec3 middle_of_corners(const Mesh& mesh, const IndicesRef& face) {
  Vec3 sum = Vec3::Zero();
  for (const Index v : face) sum += Vec3(mesh.vertices.row(v));
  return sum / static_cast<double>(face.size());
}

/// Whether a face continues from one edge as another, on its other side, comes to it.
bool goes_straight_on(const Mesh& mesh, const IndicesRef& face, const IndicesRef& other, Index a, Index b) {
  const Vec3 from = mesh.vertices.row(a), along = (Vec3(mesh.vertices.row(b)) - from).stableNormalized();
  const auto across = [&](const Vec3& way) -> Vec3 { return (way - way.dot(along) * along).stableNormalized(); };
  const Vec3 out = across(middle_of_corners(mesh, face) - from), in = across(from - middle_of_corners(mesh, other));
  return !(out.dot(in) < one_surface_cos);
}

/// A face with all edges but one on a rim.
struct Ear {
  Index face, rim, a, b;  ///< the other edge
};

/// For each vertex whether a rim has it.
std::vector<char> marked_rims(const Mesh& mesh, std::span<const std::vector<Index>> rims) {
  std::vector<char> marked(static_cast<std::size_t>(mesh.vertices.rows()), 0);
  for (const std::vector<Index>& rim : rims)
    for (const Index v : rim)
      if (v >= 0 && std::cmp_less(v, marked.size())) marked[v] = 1;
  return marked;
}

/// Of faces whose vertices a rim has.
std::vector<Ear> ears_of(const Mesh& mesh, std::span<const std::vector<Index>> rims, const std::vector<char>& on_rim) {
  std::unordered_map<Index, std::array<Index, 2>> place;  // the rim, the first of several, and the place in it
  for (std::size_t r = 0; r < rims.size(); ++r)
    for (std::size_t k = 0; k < rims[r].size(); ++k)
      place.try_emplace(rims[r][k], std::array{static_cast<Index>(r), static_cast<Index>(k)});
  std::vector<Ear> ears;
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    const IndicesRef face = mesh.faces[f];
    const auto is_on_rim = [&](Index v) { return v >= 0 && std::cmp_less(v, on_rim.size()) && on_rim[v]; };
    if (face.size() < 3 || !std::ranges::all_of(face, is_on_rim)) continue;
    const auto first = place.find(face[0]);
    const Index rim = first->second[0], count = static_cast<Index>(rims[static_cast<std::size_t>(rim)].size());
    const auto is_there = [&](Index v) { return place.contains(v) && place.at(v)[0] == rim; };
    if (!std::ranges::all_of(face, is_there)) continue;
    Ear ear = {f, rim, -1, -1};
    int others = 0;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()], apart = std::abs(place.at(a)[1] - place.at(b)[1]);
      if (apart != 1 && apart != count - 1) ear.a = a, ear.b = b, ++others;
    }
    if (others == 1) ears.push_back(ear);
  }
  return ears;
}

}  // namespace

std::vector<std::optional<Message>> told_of_extra_faces(const Mesh& mesh, std::span<const std::vector<Index>> rims) {
  std::vector<std::optional<Message>> told(rims.size());
  const std::vector<char> on_rim = marked_rims(mesh, rims);
  const std::vector<Ear> ears = ears_of(mesh, rims, on_rim);
  std::map<EdgeKey, std::vector<const Ear*>> by_edge;
  for (const Ear& ear : ears) by_edge[edge_key(ear.a, ear.b)].push_back(&ear);
  const Index n = mesh.vertices.rows();
  for (Index f = 0; f < mesh.faces.size() && !ears.empty(); ++f) {
    const IndicesRef face = mesh.faces[f];
    if (std::ranges::any_of(face, [&](Index v) { return v < 0 || v >= n; })) continue;
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      if (!on_rim[a] || !on_rim[b]) continue;
      const auto found = by_edge.find(edge_key(a, b));
      if (found == by_edge.end()) continue;
      for (const Ear* ear : found->second) {
        std::optional<Message>& said = told[static_cast<std::size_t>(ear->rim)];
        if (ear->face == f || said || goes_straight_on(mesh, mesh.faces[ear->face], face, a, b)) continue;
        const IndicesRef extra = mesh.faces[ear->face];
        said = Message{Code::extra_face, {}, {extra.begin(), extra.end()}};
      }
    }
  }
  return told;
}

}  // namespace tripatch
