#include "tripatch/cage/limit_points.h"

#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>

#include <memory>
#include <numeric>
#include <vector>

#include "tripatch/boundary/osd_error_scope.h"

namespace tripatch {
namespace {

namespace far = OpenSubdiv::Far;
namespace sdc = OpenSubdiv::Sdc;

/// A point as OpenSubdiv's templates want it, with their names.
// NOLINTBEGIN(readability-identifier-naming)
struct LimitPoint {
  Vec3 position = Vec3::Zero();
  void Clear() { position.setZero(); }
  void AddWithWeight(const LimitPoint& p, double weight) { position += weight * p.position; }
};
// NOLINTEND(readability-identifier-naming)

std::unique_ptr<far::TopologyRefiner> refiner_of(const Mesh& mesh) {
  const Index vertex_count = mesh.vertices.rows();
  std::vector<int> face_sizes, corners;
  face_sizes.reserve(mesh.faces.size());
  corners.reserve(mesh.faces.corners.size());
  for (Index f = 0; f < mesh.faces.size(); ++f) {
    if (mesh.faces[f].size() < 3) throw InvalidArgument("face " + std::to_string(f) + " has fewer than three corners");
    face_sizes.push_back(static_cast<int>(mesh.faces[f].size()));
  }
  for (Index v : mesh.faces.corners) {
    if (v < 0 || v >= vertex_count)
      throw InvalidArgument("a face names vertex " + std::to_string(v) + " of " + std::to_string(vertex_count) + " vertices");
    corners.push_back(static_cast<int>(v));
  }
  far::TopologyDescriptor topology;
  topology.numVertices = static_cast<int>(vertex_count);
  topology.numFaces = static_cast<int>(face_sizes.size());
  topology.numVertsPerFace = face_sizes.data();
  topology.vertIndicesPerFace = corners.data();

  using Factory = far::TopologyRefinerFactory<far::TopologyDescriptor>;
  sdc::Options options;
  options.SetVtxBoundaryInterpolation(sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
  const OsdErrorScope complaint;
  std::unique_ptr<far::TopologyRefiner> refiner(Factory::Create(topology, Factory::Options(sdc::SCHEME_CATMARK, options)));
  if (!refiner) {
    std::vector<Index> all(mesh.faces.size());
    std::iota(all.begin(), all.end(), Index{0});
    throw not_subdivided(Subdivided::mesh, mesh.faces, all, complaint);
  }
  return refiner;
}

}  // namespace

Points limit_points(const Mesh& mesh) {
  if (mesh.faces.size() == 0) return mesh.vertices;
  const std::unique_ptr<far::TopologyRefiner> refiner = refiner_of(mesh);
  // The limit masks hold where all faces around are quads: after one refinement.
  far::TopologyRefiner::UniformOptions once(1);
  once.fullTopologyInLastLevel = true;  // the masks need the neighbors
  refiner->RefineUniform(once);

  std::vector<LimitPoint> cage(mesh.vertices.rows());
  for (Index v = 0; v < mesh.vertices.rows(); ++v) cage[v].position = mesh.vertices.row(v);
  std::vector<LimitPoint> refined(refiner->GetLevel(1).GetNumVertices()), limit(refined.size());
  const far::PrimvarRefinerReal<double> primvars(*refiner);
  primvars.Interpolate(1, cage, refined);
  primvars.Limit(refined, limit);

  Points result(mesh.vertices.rows(), 3);
  const far::TopologyLevel level = refiner->GetLevel(0);
  for (int v = 0; v < level.GetNumVertices(); ++v) result.row(v) = limit[level.GetVertexChildVertex(v)].position;
  return result;
}

}  // namespace tripatch
