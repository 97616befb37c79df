#include "tripatch/fairing/center.h"

namespace tripatch {
namespace {

class Bubble final : public Surface {
public:
  Bubble(const Vec3& lift, int power) : lift_(lift), power_(power) {}

  void evaluate(const double* b, Index n, int order, double* out) const override {
    with_order<0, max_order>(order, [&](auto constant) {
      for (Index k = 0; k < n; ++k) {
        const Barycentric<constant.value> at(b + 3 * k);
        const auto bubble = 27 * (at[0] * at[1] * at[2]);
        auto f = bubble;
        for (int p = 1; p < power_; ++p) f *= bubble;
        out = store(f * JetPoint<constant.value>(lift_), out);
      }
    });
  }

private:
  Vec3 lift_;
  int power_;
};

Points center() { return Points::Constant(1, 3, 1.0 / 3); }

}  // namespace

std::pair<Vec3, Vec3> center_of(const Surface& patch) {
  const auto [position, normal] = patch.positions_and_normals(center());
  return {position.row(0), normal.row(0)};
}

SurfacePtr with_center(const SurfacePtr& patch, const Vec3& position, int power) {
  const Vec3 lift = position - patch->positions(center()).row(0).transpose();
  return sum(patch, std::make_shared<Bubble>(lift, power));
}

}  // namespace tripatch
