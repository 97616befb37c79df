#include "tripatch/output/fill_result.h"

namespace tripatch {

bool is_finite(const Fill& fill) {
  return fill.vertices.allFinite() && fill.normals.allFinite() && fill.rim_normals.allFinite() && fill.moved_to.allFinite();
}

void refuse_infinite(const Fill& fill, const std::vector<Index>& rim) {
  if (is_finite(fill)) return;
  throw Refusal(
      "Coordinates around the hole are too large or too small to compute with: the fill has no finite positions or normals; "
      "move what lies far away, or scale the mesh",
      {rim[0]});
}

}  // namespace tripatch
