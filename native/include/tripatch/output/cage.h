// A fill that stays a subdivision cage: a few quads whose limit surface is the patch. The limit surface of a Catmull-Clark cage is
// linear in its vertices, so the new ones follow from least squares on limit stencils.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/boundary/side.h"
#include "tripatch/hole/hole.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// What happens along the rim.
enum class CageRim {
  smooth,  ///< the whole cage is smooth; the surroundings move as little as possible
  exact,   ///< rim edges are creased: the surroundings of an open hole do not move at all, the fill is made tangent to them
  move,    ///< as smooth, and the rim's vertices are free too
};

struct CageOptions {
  CageRim rim = CageRim::smooth;
  int samples = 4;  ///< a row of each face, for positions
  double surroundings =
      0.5;           ///< weight of the old limit surface around an open hole: it is that of an open cage, rounded at corners
  double whole = 6;  ///< the same around a region to be replaced, where it is that of the whole cage
  double tangential = 0.3;  ///< weight of distances along the patch against those across it
  double seam = 0.5;        ///< exact: weight of the tangent planes along the rim
  int rounds = 4;           ///< smooth, open hole: how often the patch is rebuilt on the rim that the fitted cage has
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
  std::array<std::vector<double>, 3>
      seam_angles;  ///< degrees, between the limit normals of the two faces along each rim edge; -1: none there
};

/// The cage: `layout` rows (barycentric coordinates, the first hole.rim.size() are the rim's) and faces by row. `build`: the patch on
/// given sides; `coarser`: a fit with fewer rows, whose patch is kept (empty: none). A region to be replaced (`replaced`) has the limit of the whole cage as its truth.
CageFit fit_cage(const Mesh& mesh, const Hole& hole, const Subdivision& settings, const std::vector<Index>& replaced,
                 const Points& barycentric, const Faces& layout, const std::function<SurfacePtr(const Sides&)>& build,
                 const CageOptions& options = {}, const CageFit& coarser = {});

/// The limit surface of a fitted cage's fill: a grid of 2^level quads a side on each face.
void sample_limit(const Mesh& cage, const Subdivision& settings, Index first_face, int level, Points& vertices, Faces& faces);

}  // namespace tripatch
