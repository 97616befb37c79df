#include "tripatch/boundary/surroundings.h"

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/boundary/mesh_sides.h"

namespace tripatch {

Surroundings surroundings_of(const Mesh& mesh, const Connectivity& whole, const Connectivity& around, const Hole& hole,
                             const Subdivision* limit, const VertexPlanes& planes) {
  if (limit) {
    LimitSides exact = limit_sides(mesh, whole, around, hole, *limit);
    return {std::move(exact.sides), std::move(exact.parameters), std::move(exact.warnings), exact.surroundings_error,
            std::move(exact.border)};
  }
  MeshSides estimated = mesh_sides(mesh, around, hole, planes);
  return {std::move(estimated.sides), std::move(estimated.parameters), {}, estimated.surroundings_error, {}};
}

Points rim_barycentric(const Hole& hole, const Surroundings& surroundings) {
  Points b = Points::Zero(static_cast<Index>(hole.rim.size()), 3);
  Index row = 0;
  for (int i : {2, 0, 1}) {
    const std::vector<double>& t = surroundings.parameters[i];
    const std::size_t edges = hole.side(i).size() - 1, stride = (t.size() - 1) / edges;
    for (std::size_t e = 0; e < edges; ++e, ++row) {
      b(row, (i + 1) % 3) = 1 - t[e * stride];
      b(row, (i + 2) % 3) = t[e * stride];
    }
  }
  return b;
}

}  // namespace tripatch
