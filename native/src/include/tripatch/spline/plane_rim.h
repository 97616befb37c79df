// The rim of a fill over a plane, and what is known next to it.
#pragma once

#include "tripatch/math/plane.h"
#include "tripatch/output/remesh.h"
#include "tripatch/patch/through.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/triangulation/min_weight_triangulation.h"

namespace tripatch {

struct PlaneRim {
  Points points;
  Triangles rough;
  RimSurroundings surroundings;
  std::vector<AdjacentFace> beyond;
  std::vector<Through> through;  // what shall be met inside
  Index folds = 0;               // so many a fill may have
  Index own_folds = 0;           // of its own triangles, which do not cross themselves: those of triangles that do may be fewer
  std::vector<AdjacentFace> flipped;  // those beyond that nothing folds over, as they are
  Index folds_of_plain = 0;           // between the triangles of plain() alone, not over the faces beyond
  bool doubles_edges = false;         // of the mesh, which the rough triangles do
  bool may_cross = false;             // its fill itself, for plain() does too
  double edge = 0, diameter = 0, area = 0;
  double of_hole = 0;  // the diameter of the hole that this is the rim of a part of, or less
};

PlaneRim plane_rim(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops);

double area_of(const Points& p, const Triangles& triangles);

/// Triangles of the rim's polygon in the plane, none turned over: the rough ones where they are that.
Triangles domain_triangles(const PlanePoints& uv, const PlaneRim& rim);
PlanePolygon polygon_of(const PlaneRim& rim, const PlanePoints& uv);

/// Whether points stay nearer to the rim, or to what shall be met, than a hole's diameter.
bool stays_near(const Points& points, const PlaneRim& rim);

}  // namespace tripatch
