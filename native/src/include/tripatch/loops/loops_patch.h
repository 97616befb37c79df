// A patch in an outline of any shape, concave too, with any number of loops of sides inside it.
//
// Sources: a surface through points of the sides with their normals (a polyharmonic spline and HermiteCorrection), and what it lacks between
// these, blended as by K. Kato, Generation of n-sided surface patches with holes, Computer-Aided Design 23 (1991).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/mesh/triangles.h"
#include "tripatch/patch/seam.h"
#include "tripatch/patch/surface.h"
#include "tripatch/polygon/boundary.h"

namespace tripatch {

/// Over polygons of a plane, one inside the other. Rows of evaluate are (u, v, not read), derivatives are by (u, v).
class LoopsSurface final : public Surface {
public:
  /// A side, or a part of one that is all but straight, over an edge of the domain.
  struct Edge {
    Vec2 from, to;  ///< the inside is on the left
    Vec3 corner;    ///< the point at `from`
    PiecewisePolynomial
        lacks;  ///< of the base: position over `size`, then its derivative to the inside along the normal; each plus 1
  };
  struct Span {
    std::size_t first = 0, count = 0;  ///< edges
  };
  /// sides: the edges of each. loops: how many sides each loop has, the outer one first.
  LoopsSurface(SurfacePtr base, std::vector<Edge> edges, std::vector<Span> sides, std::vector<std::size_t> loops, double size)
      : base_(std::move(base)), edges_(std::move(edges)), sides_(std::move(sides)), loops_(std::move(loops)), size_(size) {}

  void evaluate(const double* b, Index n, int order, double* out) const override;
  std::size_t sides() const { return sides_.size(); }
  const std::vector<std::size_t>& loops() const { return loops_; }
  Vec2 on_side(std::size_t side, double t) const;

private:
  template <int N>
  JetPoint<N> at(const Vec2& place) const;

  SurfacePtr base_;
  std::vector<Edge> edges_;
  std::vector<Span> sides_;
  std::vector<std::size_t> loops_;
  double size_;
};

struct LoopsPatch {
  std::shared_ptr<const LoopsSurface> patch;
  std::vector<SeamOfSide> seams;  ///< by side, of all loops
  Index folds = 0;                ///< edges of a triangulation that are folded
  double size = 0;
};
/// Sides run in the direction of new faces, those of loops inside too. Throws a Refusal where the loops cross or touch each other, seen along
/// the normal of the first one's area.
LoopsPatch loops_patch(const std::vector<SideList>& loops);

struct LoopsTriangles {
  PlanePoints uv;
  Triangles triangles;
};
/// parameters: by side, from 0 to 1. resolution: edges a side inside; none: as the sides.
LoopsTriangles triangulate_loops(const LoopsSurface& patch, const std::vector<std::vector<double>>& parameters,
                                 std::optional<int> resolution);

}  // namespace tripatch
