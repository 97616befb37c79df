#include "tripatch/output/fill_result.h"

namespace tripatch {

bool is_finite(const Fill& fill) {
  // what is not finite less itself is no number, and no sum with it: several at a time, where allFinite() looks at each
  const auto finite = [](const Points& points) { return (points.array() - points.array()).sum() == 0; };
  return finite(fill.vertices) && finite(fill.normals) && finite(fill.rim_normals) && finite(fill.moved_to);
}

void refuse_infinite(const Fill& fill, const std::vector<Index>& rim) {
  if (is_finite(fill)) return;
  throw Refusal(
      "Coordinates around the hole are too large or too small to compute with: the fill has no finite positions or normals; "
      "move what lies far away, or scale the mesh",
      {rim[0]});
}

}  // namespace tripatch
