// The limit surface of a Catmull-Clark cage as Blender draws it: OpenSubdiv's adaptive patches at the modifier's quality, or the
// true limit. Position, first and second derivatives along the edges of faces.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tripatch/mesh/connectivity.h"

namespace tripatch {

/// Of Subdivision::quality, as of the modifier; OpenSubdiv makes no stencils of finer ones.
constexpr int min_quality = 1, max_quality = 10;

/// The settings of a Subdivision modifier, in Blender's own terms.
struct Subdivision {
  bool loop = false;               ///< Loop's scheme, for triangles only, which Blender has not; else Catmull-Clark
  bool preserve_corners = false;   ///< boundary_smooth: false "All", true "Keep Corners"
  std::optional<int> quality = 3;  ///< how far irregular places are isolated, 1 to 10; none: the true limit
  bool use_limit_surface = true;   ///< false: the refined points of `level`, not their limit
  int level = 2;                   ///< of the modifier
  std::vector<std::array<Index, 2>> crease_edges;
  std::vector<double> edge_creases;  ///< 0 .. 1; sharpness is crease^2 x 10
  std::vector<Index> crease_vertices;
  std::vector<double> vertex_creases;  ///< 0 .. 1
  std::vector<Index> loose_vertices;   ///< vertices that a loose edge touches: Blender makes them infinitely sharp
};

/// Position and derivatives, u along the edge in the direction of the face, v into the face, one unit the whole edge.
struct LimitJet {
  Vec3 p, pu, pv, puu, puv, pvv;
};

/// On a quad face (u, v) from its first corner, quarter 0; on an n-gon in the quarter at its corner `quarter`. Loop: on a triangle,
/// u towards its second corner and v towards its third.
struct FacePlace {
  int quarter;
  double u, v;
};

/// Places of one face as weights of the cage's vertices, for the limit surface is linear in them: a row a place, a column one of
/// `vertices`. Derivatives are in the face's own u and v.
struct LimitStencils {
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<Index> vertices;
  Weights p, pu, pv;
};

/// Rings of faces that are refined around the vertices where a limit surface is wanted: that on the first depends on two.
constexpr int limit_rings = 3;

class LimitSurface {
public:
  /// around: only the rings around these vertices are refined (empty: the whole cage). Throws a Refusal with OpenSubdiv's own
  /// message for a cage that it cannot take.
  LimitSurface(const Mesh& cage, const Subdivision& settings, std::span<const Index> around = {});
  LimitSurface(const Mesh& cage, const Connectivity& connectivity, const Subdivision& settings, std::span<const Index> around);
  ~LimitSurface();
  LimitSurface(LimitSurface&&) noexcept;

  /// The same cage with its vertices (all of them) elsewhere.
  void move(const PointsRef& vertices);
  /// Along edge `edge` (from its corner `edge` to the next) of face `face`, which must touch one of `around`; t in [0, 1].
  void evaluate_edge(Index face, int edge, std::span<const double> t, std::span<LimitJet> out) const;
  /// Needs a quality. Not from two threads at once.
  LimitStencils stencils(Index face, std::span<const FacePlace> places) const;
  /// Points of a (steps + 1)^2 grid on every quad face refined; n-gons: on each of their quarters.
  Points grid(int steps) const;

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The cage refined `settings.level` times, on its limit where the settings say so: vertices, faces, and for every vertex of the rim
/// (cage vertices) the refined vertices from it (included) to the next (excluded).
struct RefinedCage {
  Points vertices;
  Faces faces;
  std::vector<std::vector<Index>> along_rim;
};
RefinedCage refine_cage(const Mesh& cage, const Connectivity& connectivity, const Subdivision& settings,
                        std::span<const Index> rim);

}  // namespace tripatch
