// Where the vertices of a layout of quads go: first in a plane domain, then on the surface over it.
#pragma once

#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/patch/surface.h"
#include "tripatch/types.h"

namespace tripatch {

/// A layout over a plane domain: rows of places, the first `rim` of them around, counterclockwise.
struct PlaneLayout {
  PlanePoints uv;
  Index rim = 0;
  Faces faces;               ///< traverse the rim forwards: quads, and one triangle where the rim is odd
  std::vector<Index> poles;  ///< inside vertices whose valence is not 4
};

/// Scaled Jacobians of all corners of the quads: the sine of the corner's angle, negative where it is turned over as seen along the
/// normal of its quad.
struct QuadQuality {
  double least = 1, mean = 1;
};
QuadQuality quad_quality(const PointsRef& points, const Faces& faces);

/// Inside vertices at weighted means of their neighbors (Tutte 1963), so that in a convex domain no face is turned over. Edges across
/// the same row of quads weigh the same, the less the longer the row's ends on the rim are.
void embed(PlaneLayout& layout);
/// The same in space: the first `rim` rows stay.
void spread_inside(const Faces& faces, Index rim, Points& rows);

/// Moves the inside vertices towards quads whose corners are right angles and whose sides are as the rows' ends on the rim, by Newton
/// steps of one vertex after the other; then sweeps in which the least angle leads. surface: in the metric of that over the domain;
/// none: in the plane. border: where the rim is in space (rim x 3), with a surface. held: inside vertices that stay.
void smooth_quads(PlaneLayout& layout, int sweeps, int sharpening = 0, const Surface* surface = nullptr,
                  const Points* border = nullptr, const std::vector<Index>& held = {});

/// Smooths a layout a few sweeps in its plane, as far as layouts are that are tried.
void smooth_trial(PlaneLayout& layout);
/// The same of one that is tried. Returns what it is worth next to others: its least scaled Jacobian, and a share of the mean, less what its
/// irregular vertices cost.
double score_of_trial(PlaneLayout& layout, double irregular);

}  // namespace tripatch
