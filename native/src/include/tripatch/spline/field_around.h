// The field through more of a hole's surroundings than are laid out: by where they are nearest to a surface through some of them.
#pragma once

#include <memory>
#include <vector>

#include "tripatch/spline/disc.h"
#include "tripatch/spline/polyharmonic_spline.h"

namespace tripatch {

/// Where points (n x 3) are nearest to a surface, by Gauss-Newton from these places: foot_at's steps, for all points at once.
PlanePoints closest_points(const Surface& surface, const Points& points, PlanePoints uv);

/// Rows of a disc's vertices that a field is fitted to: its centers and some thousands more, spread over all.
std::vector<Index> fitted_rows(const Disc& disc, const std::vector<Index>& centers);

/// Where a disc's vertices are on a surface, of which the places of the rim are known; not finite where none are found.
PlanePoints places_on(const Surface& surface, const PlanePoints& rim_uv, const Disc& disc, const std::vector<Index>& rows);

/// Through or near points (n x 3) at places of the plane, the first of which are its centers. edge: scene units, an edge of the rim.
/// Nothing where there is no such field.
std::shared_ptr<const PolyharmonicSpline> field_through(const Points& points, const PlanePoints& uv, Index centers, double edge);

}  // namespace tripatch
