// Which way a fill without folds faces.
#pragma once

#include <algorithm>

#include "tripatch/boundary/side.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/side_weights.h"

namespace tripatch {

/// The rim's normals, looked up between samples: near enough to tell the side that a fill faces, and much cheaper than exact ones.
class RimNormals {
public:
  explicit RimNormals(const Sides& sides) {
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k <= samples; ++k) normals_[i][k] = sides[i].normal(static_cast<double>(k) / samples);
  }
  /// The side-weight blend of the rim's normals at b. Zero where the rim's normals cancel. b must not be a vertex.
  Vec3 at(const double* b) const {
    const Barycentric<0> jet(b);
    const std::array<Jet<0>, 3> weight = side_weights(jet);
    Vec3 n = Vec3::Zero();
    for (int i = 0; i < 3; ++i) {
      if (!(weight[i].value() > 0)) continue;
      const double t = samples * std::clamp(ray_parameter(jet, i).value(), 0.0, 1.0);
      const int k = std::min(static_cast<int>(t), samples - 1);
      n += weight[i].value() * ((k + 1 - t) * normals_[i][k] + (t - k) * normals_[i][k + 1]);
    }
    return n;
  }

private:
  static constexpr int samples = count::block;
  std::array<std::array<Vec3, samples + 1>, 3> normals_;
};

}  // namespace tripatch
