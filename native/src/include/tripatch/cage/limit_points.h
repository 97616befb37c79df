// The limit surface of a subdivision cage, evaluated by OpenSubdiv.
#pragma once

#include "tripatch/types.h"

namespace tripatch {

/// Where the vertices of a Catmull-Clark cage lie on its limit surface: n x 3, row v for vertex v, units of the input. No creases;
/// border edges are sharp and border corners smooth (Blender's boundary smoothing "All"); a vertex of no face stays in place.
/// Throws InvalidArgument for an index that is not a vertex, and Refusal for a cage that OpenSubdiv cannot refine.
Points limit_points(const Mesh& mesh);

}  // namespace tripatch
