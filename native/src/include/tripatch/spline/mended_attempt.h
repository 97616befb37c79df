// Other triangles on the surface of a try, where its own are too few, fold or cross.
#pragma once

#include "tripatch/spline/plane_attempt.h"

namespace tripatch {

/// Whether a resolution asks for more than twice the triangles that the rim's edges do.
bool is_finer(const PlaneRim& rim, const PlaneFillOptions& options);

/// Other triangles on the same surface. False where they will not do.
bool refine(const PlaneRim& rim, std::optional<int> resolution, Attempt& result);

/// Moves vertices of folded edges, and flips edges, until none is folded, or no more than of the rim's own; returns how many are.
Index unfolded(const PlaneRim& rim, Attempt& result);

/// Whether folds cannot be mended, or it crosses itself. Where few triangles on a field are so, many are: of 22 such fields of long rims all.
bool stays_folded(const PlaneRim& rim, Attempt looked_at);
/// Whether an attempt, its folds mended, does no more harm than its rim.
bool serves(const PlaneRim& rim, Attempt& result);

/// The disc, or one of the rings that the second model needs.
Disc with_two_rings(const Mesh& mesh, const Connectivity& continued, const std::vector<std::vector<Index>>& loops,
                    const Disc& disc);

/// The second model alone, if the field folds. If the noise of a mesh is a third of an edge, the field passes the vertices of the
/// rim so far off that its triangles fold back over the mesh. So may those that keep the planes next to the rim, which are noise.
/// False, and as it was, where this folds more than the rim too, or no work is left. work: is added to.
bool second_alone(const Disc& disc, const PlaneRim& rim, Work& work, Attempt& result);
/// The same with the few triangles of long rims' layouts, and a surface through their vertices: many triangles take minutes to bend, and
/// those on a field that folds over itself are no good.
bool few_alone(const Disc& disc, const PlaneRim& rim, std::optional<int> resolution, Work& work, Attempt& result);

}  // namespace tripatch
