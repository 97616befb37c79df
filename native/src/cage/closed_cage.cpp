#include "tripatch/cage/closed_cage.h"

#include <Eigen/Dense>
#include <algorithm>
#include <set>

namespace tripatch {

ClosedCage close_holes(const Mesh& mesh, const std::vector<CageHole>& holes, const std::vector<Index>& replaced) {
  ClosedCage cage;
  const std::set<Index> gone(replaced.begin(), replaced.end());
  for (Index f = 0; f < mesh.faces.size(); ++f)
    if (!gone.contains(f)) {
      cage.faces.add(mesh.faces[f]);
      cage.kept.push_back(f);
    }
  Index n = mesh.vertices.rows();
  for (const auto& [hole, layout] : holes) {
    cage.first_face.push_back(cage.faces.size());
    cage.first_vertex.push_back(n);
    for (Index f = 0; f < layout.faces.size(); ++f) {
      std::vector<Index> face;
      for (Index v : layout.faces[f]) face.push_back(v < layout.rim ? hole.rim[v] : n + v - layout.rim);
      cage.faces.add(face);
    }
    n += layout.barycentric.rows() - layout.rim;
  }
  cage.first_face.push_back(cage.faces.size());
  cage.first_vertex.push_back(n);
  cage.vertices.resize(n, 3);
  cage.vertices.topRows(mesh.vertices.rows()) = mesh.vertices;
  for (std::size_t k = 0; k < holes.size(); ++k) {
    const auto& [hole, layout] = holes[k];
    Eigen::Matrix3d corners;
    for (int c = 0; c < 3; ++c) corners.row(c) = mesh.vertices.row(hole.rim[hole.corners[c]]);
    const Index inside = cage.first_vertex[k + 1] - cage.first_vertex[k];
    cage.vertices.middleRows(cage.first_vertex[k], inside) = layout.barycentric.bottomRows(inside) * corners;
  }
  return cage;
}

std::array<std::vector<Index>, 2> rings_around(const ClosedCage& cage, const Hole& hole) {
  std::vector<char> near(cage.vertices.rows(), 0), taken(cage.faces.size(), 0);
  for (Index v : hole.rim) near[v] = 1;
  std::array<std::vector<Index>, 2> result;
  for (auto& ring : result) {
    for (Index f = 0; f < static_cast<Index>(cage.kept.size()); ++f) {
      const auto face = cage.faces[f];
      if (!taken[f] && std::any_of(face.begin(), face.end(), [&](Index v) { return near[v]; })) ring.push_back(f);
    }
    for (Index f : ring) {
      taken[f] = 1;
      for (Index v : cage.faces[f]) near[v] = 1;
    }
  }
  return result;
}

DirectedEdges rim_edges(const ClosedCage& cage, const std::vector<CageHole>& holes) {
  std::vector<char> on(cage.vertices.rows(), 0);
  for (const CageHole& h : holes)
    for (Index v : h.hole.rim) on[v] = 1;
  DirectedEdges result;
  for (Index f = 0; f < cage.faces.size(); ++f) {
    const auto face = cage.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      if (on[a] && on[b]) result[{a, b}] = {f, static_cast<int>(k)};
    }
  }
  return result;
}

}  // namespace tripatch
