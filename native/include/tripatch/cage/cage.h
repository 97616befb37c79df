// A fill that stays a subdivision cage: a few quads whose limit surface is the patch. The limit surface of a Catmull-Clark cage is
// linear in its vertices, so the new ones follow from least squares on limit stencils.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/boundary/side.h"
#include "tripatch/fairing/fairing.h"
#include "tripatch/hole/hole.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// What happens along the rim.
enum class CageRim {
  smooth,  ///< the whole cage is smooth; the surroundings move as little as possible
  exact,   ///< rim edges are creased: the surroundings of an open hole do not move at all, the fill is made tangent to them
  move,    ///< as smooth, and the rim's vertices are free too
};

/// Weights are against 1 for distances across the patch.
struct CageOptions {
  CageRim rim = CageRim::smooth;
  double tangential = 0.1;               ///< distances along the patch: where on it a point lies matters little
  double surroundings = 0.15;            ///< distances across the old limit surface around an open hole
  double surroundings_tangential = 0.5;  ///< and along it
  double corner = 0.1;       ///< times these on faces at a corner, where an open border is round and a closed one is not
  double whole = 1;          ///< around a region to be replaced, where the old limit surface is that of the whole cage
  double seam = 5;           ///< exact: tangent planes along the rim, radians times the size of the hole
  double seam_width = 0.05;  ///< exact: times `seam`: how far the first row reaches inwards
  double lines = 0.01;       ///< third derivatives in the faces' parameters: where along the patch the lines run
  int rounds = 3;            ///< how often it is fitted, each time to the points of the patch that have become the nearest
  /// Movements of the old limit surface (rms, over the hole's size) that weigh as much as an energy of the fair cage e times as
  /// large: around an open hole, and around a region to be replaced.
  double fair_open = 6e-3, fair_whole = 6e-4;
};

/// A hole, and what is to close it.
struct CageHole {
  Hole hole;
  Points barycentric;  ///< of the layout; the first hole.rim.size() rows are the rim's
  Faces layout;        ///< by row
  /// The patch on given sides; with points (none for an exact rim), of those that meet the sides the one that is nearest to them.
  std::function<SurfacePtr(const Sides&, const SurfacePoints&)> build;
};

struct CageFit {
  Points vertices;           ///< of the inside rows of the layout
  std::vector<Index> moved;  ///< rim vertices of the mesh that moved (rim `move`)
  Points moved_to;
  std::vector<std::array<Index, 2>> creases;          ///< rim edges creased infinitely sharp (rim `exact`)
  SurfacePtr patch;                                   ///< the last patch that was fitted
  Sides sides;                                        ///< what it was built on
  double deviation_max = 0, deviation_rms = 0;        ///< fill's limit surface to the patch, scene units
  double surroundings_max = 0, surroundings_rms = 0;  ///< movement of the old limit surface, first two rings, scene units
  Index surroundings_where = -1;                      ///< a vertex of the face that moved most
  double corners_moved = 0;                           ///< largest movement of the limit at the three corners
  Index triangles_folded = 0;                         ///< edges of the fill's limit surface, see count_folded_edges
  double fair_before = 0, fair_after = 0;             ///< energy of the fair cage that the patch follows, see fair_cage
  std::array<std::vector<double>, 3>
      seam_angles;  ///< degrees, between the limit normals of the two faces along each rim edge; -1: none there
};

/// Cages for holes whose surroundings may overlap, fitted together. replaced: faces in the holes; there the limit of the whole cage
/// is the truth. coarser: the fits of the same holes with fewer rows, whose patches are kept (empty: none).
std::vector<CageFit> fit_cages(const Mesh& mesh, const std::vector<CageHole>& holes, const Subdivision& settings,
                               const std::vector<Index>& replaced, const CageOptions& options = {},
                               const std::vector<CageFit>& coarser = {});

}  // namespace tripatch
