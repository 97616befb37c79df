#include "tripatch/patch/vertex_ray.h"

namespace tripatch {

VertexRay::VertexRay(const Boundary& boundary, int i, RayDegree degree) : i_(i), degree_(degree), ribbon_(boundary.ribbons[i]) {
  const auto& ribbons = boundary.ribbons;
  for (int k = 0; k < 3; ++k) corner_[k] = ribbons[(k + 2) % 3].c(0);
  // towards corner i + 1 along side i + 2, towards corner i + 2 back along side i + 1
  to_next_ = ribbons[(i + 2) % 3].c.derivative_at(0) + boundary.inward[i];
  to_previous_ = -ribbons[(i + 1) % 3].c.derivative_at(1) + boundary.inward[i];
}

}  // namespace tripatch
