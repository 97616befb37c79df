// Where the vertices of a layout of quads go: first in a plane domain, then on the surface over it.
#pragma once

#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/math/thresholds.h"
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

/// Moves the inside vertices towards quads whose corners are right angles and whose sides are as the rows' ends on the rim, by Newton
/// steps of one vertex after the other; then sweeps in which the least angle leads. surface: in the metric of that over the domain;
/// none: in the plane. border: where the rim is in space (rim x 3), with a surface. held: inside vertices that stay.
void smooth_quads(PlaneLayout& layout, int sweeps, int sharpening = 0, const Surface* surface = nullptr,
                  const Points* border = nullptr, const std::vector<Index>& held = {});

/// Smooths a layout on a surface over its plane, as far as that helps the least angle. Returns the vertices, of which the border's are given;
/// held: those inside that stay.
Points smoothed_on(PlaneLayout& layout, const Surface& surface, const Points& border, const std::vector<Index>& held = {});
/// The sine of the least angle of a quad that is still good. Of two places nearer and nearer to each other in a square of quads, where vertices
/// are moved to them, it is 0.38 or more, or quads are stuck, turned over or nearly (0.03): nothing lies between. Quads that grow in from
/// a rim have it where those around do: in sheared grids.
constexpr double min_sine = share::fifth;

/// Smooths a layout a few sweeps in its plane, as far as layouts are that are tried.
void smooth_trial(PlaneLayout& layout);
/// The same of one that is tried. Returns what it is worth next to others: its least scaled Jacobian, and a share of the mean, less what its
/// irregular vertices cost.
double score_of_trial(PlaneLayout& layout, double irregular);

}  // namespace tripatch
