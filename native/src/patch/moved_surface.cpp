#include "tripatch/patch/moved_surface.h"

namespace tripatch {
namespace {

class Moved final : public Surface {
public:
  Moved(SurfacePtr surface, const Vec3& by) : surface_(std::move(surface)), by_(by) {}

  void evaluate(const double* b, Index n, int order, double* out) const override {
    surface_->evaluate(b, n, order, out);
    for (Index k = 0; k < n; ++k)
      for (int x = 0; x < 3; ++x) out[k * jet_size(order) * 3 + x] += by_[x];
  }

private:
  SurfacePtr surface_;
  Vec3 by_;
};

}  // namespace

SurfacePtr moved(SurfacePtr surface, const Vec3& by) { return std::make_shared<Moved>(std::move(surface), by); }

}  // namespace tripatch
