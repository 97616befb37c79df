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

class Mirrored final : public Surface {
public:
  explicit Mirrored(SurfacePtr surface) : surface_(std::move(surface)) {}

  void evaluate(const double* b, Index n, int order, double* out) const override {
    Points there = Eigen::Map<const Points>(b, n, 3);
    there.col(1) *= -1;
    surface_->evaluate(there.data(), n, order, out);
    for (Index k = 0; k < n; ++k)
      for (int degree = 0; degree <= order; ++degree)
        for (int by_v = 0; by_v <= degree; ++by_v, out += 3) {
          if (by_v % 2 == 1)
            for (int x = 0; x < 3; ++x) out[x] = -out[x];
          out[0] = -out[0];
        }
  }

private:
  SurfacePtr surface_;
};

}  // namespace

SurfacePtr mirrored(SurfacePtr surface) { return std::make_shared<Mirrored>(std::move(surface)); }

SurfacePtr moved(SurfacePtr surface, const Vec3& by) { return std::make_shared<Moved>(std::move(surface), by); }

}  // namespace tripatch
