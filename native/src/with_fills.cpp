#include <map>

#include "tripatch/fill.h"
#include "tripatch/mesh/changed_faces.h"

namespace tripatch {
namespace {

OwnMesh with(const Mesh& mesh, std::span<const Fill* const> fills, std::span<const Index> replaced) {
  const Index n = mesh.vertices.rows();
  Index count = n;
  for (const Fill* fill : fills) count += fill->vertices.rows();
  OwnMesh made;
  made.vertices.resize(count, 3);
  made.vertices.topRows(n) = mesh.vertices;
  std::map<EdgeKey, Index> split;
  Index first = n;
  for (const Fill* fill : fills) {
    made.vertices.middleRows(first, fill->vertices.rows()) = fill->vertices;
    for (std::size_t k = 0; k < fill->moved.size(); ++k)
      made.vertices.row(fill->moved[k]) = fill->moved_to.row(static_cast<Index>(k));
    for (std::size_t k = 0; k < fill->split_edges.size(); ++k)
      split.emplace(edge_key(fill->split_edges[k][0], fill->split_edges[k][1]), first + static_cast<Index>(k));
    first += fill->vertices.rows();
  }
  made.faces = changed_faces(mesh.faces, replaced, split);
  std::vector<Index> face;
  first = n;
  for (const Fill* fill : fills) {
    for (Index f = 0; f < fill->faces.size(); ++f) {
      const std::span<const Index> corners = fill->faces[f];
      face.assign(corners.begin(), corners.end());
      for (Index& v : face) v += v < n ? 0 : first - n;
      made.faces.add(face);
    }
    first += fill->vertices.rows();
  }
  return made;
}

}  // namespace

OwnMesh with_fill(const Mesh& mesh, const Fill& fill, std::span<const Index> replaced) {
  const Fill* const only = &fill;
  return with(mesh, {&only, 1}, replaced);
}

OwnMesh with_fills(const Mesh& mesh, const std::vector<std::variant<Fill, Refused>>& results, std::span<const Index> replaced) {
  std::vector<const Fill*> fills;
  for (const std::variant<Fill, Refused>& result : results)
    if (const Fill* fill = std::get_if<Fill>(&result)) fills.push_back(fill);
  return with(mesh, fills, replaced);
}

}  // namespace tripatch
