#include "tripatch/output/fill_result.h"

#include "tripatch/messages.h"

namespace tripatch {

bool is_finite(const Fill& fill) {
  // what is not finite less itself is no number, and no sum with it: several at a time, where allFinite() looks at each
  const auto finite = [](const Points& points) { return (points.array() - points.array()).sum() == 0; };
  return finite(fill.vertices) && finite(fill.normals) && finite(fill.rim_normals) && finite(fill.moved_to);
}

void refuse_infinite(const Fill& fill, const std::vector<Index>& rim) {
  if (is_finite(fill)) return;
  throw CodedRefusal(Code::coordinates_out_of_range, {rim[0]});
}

}  // namespace tripatch
