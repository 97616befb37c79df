#include "tripatch/constructions/smits_patch.h"

namespace tripatch {
namespace {

class SmitsPatch final : public JetSurface<SmitsPatch> {
public:
  SmitsPatch(const std::array<Vec3, 3>& points, const std::array<Vec3, 3>& normals) : points_(points) {
    for (int i = 0; i < 3; ++i) normals_[i] = normals[i].stableNormalized();
  }

  Vec3 corner(int i) const { return points_[i]; }

  template <int N>
  JetPoint<N> at(const Barycentric<N>& b) const {
    JetPoint<N> p, m;
    Jet<N> height;
    for (int i = 0; i < 3; ++i) {
      p += b[i] * JetPoint<N>(points_[i]);
      m += b[i] * JetPoint<N>(normals_[i]);
      // The line on which b_i is constant, from side j to side k. The vertices have no height, so eq. 1's last term is zero.
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      const Jet<N> sum = b[j] + b[k];
      if (sum.value() > 0) height += (0.5 / sum) * (b[k] * edge_height(j, b[i]) + b[j] * edge_height(k, 1.0 - b[i]));
    }
    return p + (height / length(m)) * m;
  }

private:
  template <int N>
  static Jet<N> length(const JetPoint<N>& m) {
    return sqrt(square(m.x[0]) + square(m.x[1]) + square(m.x[2]));
  }

  /// Height of side s at t along the unit blend of the normals: that of eqs. 4-6, which is along the blend itself, times its length.
  template <int N>
  Jet<N> edge_height(int s, const Jet<N>& t) const {
    const int from = (s + 1) % 3, to = (s + 2) % 3;
    const Vec3 chord = points_[from] - points_[to];
    const Jet<N> u = 1.0 - t;
    return u * t * (normals_[from].dot(chord) * u - normals_[to].dot(chord) * t) *
           length(u * JetPoint<N>(normals_[from]) + t * JetPoint<N>(normals_[to]));
  }

  std::array<Vec3, 3> points_, normals_;
};

}  // namespace

SurfacePtr smits_patch(const std::array<Vec3, 3>& points, const std::array<Vec3, 3>& normals) {
  sides_from_normals(points, normals, NormalCurve::smits);  // refuses what has no curves
  return std::make_shared<SmitsPatch>(points, normals);
}

}  // namespace tripatch
