#include "tripatch/patch/moved_surface.h"

#include "tripatch/patch/point_formula.h"

namespace tripatch {
namespace {

class Moved final : public Surface, public FormulaSurface {
public:
  Moved(SurfacePtr surface, const Vec3& by) : surface_(std::move(surface)), by_(by) {
    if (const PointFormula* const formula = formula_of(*surface_))
      formula_ = std::make_unique<const PointFormula>([formula, by] {
        PointTerms terms = formula->terms();
        terms.moved_by += by;
        return terms;
      });
  }

  const PointFormula* formula() const override { return formula_.get(); }

  void evaluate(const double* b, Index n, int order, double* out) const override {
    surface_->evaluate(b, n, order, out);
    for (Index k = 0; k < n; ++k)
      for (int x = 0; x < 3; ++x) out[k * jet_size(order) * 3 + x] += by_[x];
  }

private:
  SurfacePtr surface_;
  Vec3 by_;
  std::unique_ptr<const PointFormula> formula_;
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
