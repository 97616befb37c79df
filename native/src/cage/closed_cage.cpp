#include "tripatch/cage/closed_cage.h"

#include <Eigen/Dense>
#include <algorithm>
#include <set>

#include "tripatch/mesh/submesh.h"
#include "tripatch/messages.h"
#include "tripatch/quads/spread.h"

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
    const Index inside = cage.first_vertex[k + 1] - cage.first_vertex[k];
    if (layout.in_plane) {
      Points rows = Points::Zero(layout.rim + inside, 3);
      rows.topRows(layout.rim) = mesh.vertices(hole.rim, Eigen::all);
      spread_inside(layout.faces, layout.rim, rows);
      cage.vertices.middleRows(cage.first_vertex[k], inside) = rows.bottomRows(inside);
      continue;
    }
    Eigen::Matrix3d corners;
    for (int c = 0; c < 3; ++c) corners.row(c) = mesh.vertices.row(hole.rim[hole.corners[c]]);
    cage.vertices.middleRows(cage.first_vertex[k], inside) = layout.barycentric.bottomRows(inside) * corners;
  }
  for (std::size_t k = 0; k < holes.size(); ++k)
    if (!cage.vertices.middleRows(cage.first_vertex[k], cage.first_vertex[k + 1] - cage.first_vertex[k]).allFinite())
      throw CodedRefusal(Code::coordinates_out_of_range, {holes[k].hole.rim[0]});
  return cage;
}

std::array<std::vector<Index>, 2> rings_around(const ClosedCage& cage, const Connectivity& whole, const SidedRim& hole) {
  std::vector<Index> front = hole.rim;
  Numbering near, taken;
  for (Index v : front) near.add(v);
  std::array<std::vector<Index>, 2> result;
  for (auto& ring : result) {
    for (Index v : front)
      for (Connectivity::Corner c : whole.at(v))
        if (whole.face(c) < static_cast<Index>(cage.kept.size()) && taken.add(whole.face(c))) ring.push_back(whole.face(c));
    std::sort(ring.begin(), ring.end());
    front.clear();
    for (Index f : ring)
      for (Index v : cage.faces[f])
        if (near.add(v)) front.push_back(v);
  }
  return result;
}

DirectedEdges rim_edges(const Connectivity& whole, const std::vector<CageHole>& holes) {
  DirectedEdges result;
  for (const CageHole& hole : holes) {
    const std::vector<Index>& rim = hole.hole.rim;
    for (std::size_t k = 0; k < rim.size(); ++k) {
      const Index a = rim[k], b = rim[(k + 1) % rim.size()];
      for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
        if (const auto c = whole.edge(from, to)) result[{from, to}] = {whole.face(*c), static_cast<int>(whole.place(*c))};
    }
  }
  return result;
}

}  // namespace tripatch
