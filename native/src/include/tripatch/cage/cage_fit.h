// Cages on one layout each, fitted together. The limit surface of a Catmull-Clark cage is linear in its vertices, so the new ones
// follow from least squares on limit stencils.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/boundary/side.h"
#include "tripatch/cage/cage_creases.h"
#include "tripatch/cage/cage_options.h"
#include "tripatch/cage/cage_samples.h"
#include "tripatch/cage/closed_cage.h"
#include "tripatch/cage/limit_mesh.h"
#include "tripatch/fairing/follow.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// Energies of the fair cage, see fair_cage.
struct CageEnergies {
  double before = 0, after = 0;
};

/// The numbers of the report on one fit; lengths in scene units.
struct CageMeasures {
  double deviation_max = 0, deviation_rms = 0;        ///< fill's limit surface to the patch
  double surroundings_max = 0, surroundings_rms = 0;  ///< movement of the old limit surface, first two rings
  Index surroundings_where = -1;                      ///< a vertex of the face that moved most
  double corners_moved = 0;                           ///< largest movement of the limit at the corners
  std::vector<std::vector<double>>
      seam_angles;  ///< by side, degrees, between the limit normals of the two faces along each rim edge; -1: none there
};

/// What speaks against a cage, whatever its patch.
struct CageHarm {
  Index triangles_folded = 0;          ///< edges of the fill's limit surface, see count_folded_edges
  std::optional<Vec3> crossing;        ///< where the fill's limit surface goes through itself
  bool faces_turned = false;           ///< whether a corner of the fill's own quads turns back
  std::optional<Vec3> faces_crossing;  ///< where the fill's own faces go through themselves
};

/// Phases: made; on a first layout `make_fair` (but for an exact rim), then patches on `sides`; `fit`; what it became.
class CageFit {
public:
  /// mesh: outlives this. replaced: faces in the holes; there the limit of the whole cage is the truth.
  CageFit(const Mesh& mesh, std::vector<CageHole> holes, const Subdivision& settings, const std::vector<Index>& replaced,
          const CageOptions& options);
  CageFit(const CageFit&) = delete;
  CageFit& operator=(const CageFit&) = delete;

  /// Moves the free vertices to the fairest cage.
  std::vector<CageEnergies> make_fair();
  /// Moves those inside a fill, in the order of its layout.
  void place(std::size_t hole, const Points& inside);
  /// What the patch in a hole is to meet: the limit surface that the fill continues.
  CageSides sides(std::size_t hole) const;
  /// Creases that continue across a hole, and the first vertex of the closed cage that is inside it.
  std::vector<InnerCrease> creases(std::size_t hole) const {
    return creases_through(closed_, whole_, holes_[hole], hole, settings_);
  }
  Index first_inside(std::size_t hole) const { return closed_.first_vertex[hole]; }
  /// Points of the limit surface inside, which a patch may follow.
  SurfacePoints points(std::size_t hole) const { return samples_[hole].points(closed_.vertices); }

  /// To the patches made on `sides`, or where there are `points` (of the samples inside) to those. from_patches: starts with the vertices
  /// on the patches, else where they are.
  void fit(const std::vector<SurfacePtr>& patches, const std::vector<CageSides>& sides, bool from_patches,
           const std::vector<std::optional<SurfacePoints>>& points = {});

  const CageHole& hole(std::size_t hole) const { return holes_[hole]; }
  /// Inside the fill, in the order of its layout.
  Points inside(std::size_t hole) const;
  /// Of rim vertices, where the rim moves.
  Points rim(std::size_t hole) const;
  /// Root mean square of the distances of the limit surface from the patch.
  double deviation_rms(std::size_t hole, const Surface& patch) const;
  /// Faces of the cage's fill that cross themselves or are bent inwards: a corner of theirs turns against the others.
  Index faces_crossed(std::size_t hole) const;
  CageMeasures measures(std::size_t hole, const Surface& patch) const;
  CageHarm harm(std::size_t hole) const;
  /// Its folded triangles alone.
  Index triangles_folded(std::size_t hole) const;

private:
  bool exact() const { return options_.rim == CageRim::exact; }
  CageSurfaces surfaces() const { return {mesh_, closed_, was_, limit_, system_, settings_.loop}; }
  Subdivision creased() const;
  std::vector<Index> around_holes() const;
  std::vector<Index> free_vertices() const;
  bool replaces(const SidedRim& hole) const;
  Eigen::VectorXd deviation(std::size_t hole, const Surface& patch) const;
  LimitMesh sampled(std::size_t hole) const;
  void measure_surroundings(std::size_t hole, CageMeasures& measures) const;
  void measure_rim(std::size_t hole, CageMeasures& measures) const;
  void move_to_patch(std::size_t hole, const Surface& patch);
  void set_inside(std::size_t hole, const Points& inside);
  void take();

  const Mesh mesh_;
  const std::vector<CageHole> holes_;
  const Subdivision settings_;
  const std::vector<Index> replaced_;
  const CageOptions options_;
  ClosedCage closed_;
  const Connectivity whole_;                                    ///< of closed_
  const std::vector<std::array<std::vector<Index>, 2>> rings_;  ///< of each hole
  const DirectedEdges edges_;
  const std::vector<Index> around_;
  const LimitSurface was_;  ///< what the surroundings were: with the faces being replaced, where there are any, else open
  LimitSurface limit_;
  CageSystem system_;
  Points free_;  ///< positions of the system's free vertices
  std::vector<HoleSamples> samples_;
};

}  // namespace tripatch
