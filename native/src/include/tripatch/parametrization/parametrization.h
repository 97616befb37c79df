// Lays a triangulated disc in space into the plane with little distortion.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "tripatch/math/plane.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {

struct PlaneLayoutOptions {
  int iterations = 40;                  ///< at most; five times as many where the start has an energy of more than 100
  double tolerance = tolerance::close;  ///< stop where a step takes less than this share off the energy; there a thousandth of it
  /// Steps times vertices, as many where there are more than `iterations`: at 10,000 vertices 120 steps.
  int vertex_steps = 1'200'000;
};

struct Parametrization {
  PlanePoints uv;  ///< in the units of the points, as large in area as the triangles in space; NaN where no triangle is laid out
  /// Mean symmetric Dirichlet energy over the area (|J|^2 + |J^-1|^2: 4 where isometric) at the start and after each step; falls.
  std::vector<double> energies;
  Index holes_filled = 0;  ///< further loops of the border: closed by triangles that weigh little
};

/// Lays the triangles (by row of the points, n x 3) that are connected across edges with the first of them into the plane, none
/// flipped, with the least symmetric Dirichlet energy (Smith and Schaefer 2015, "Bijective parameterization with free
/// boundaries"). It is Newton's method with the definite part of each triangle's Hessian (Smith, de Goes and Kim 2019, "Analytic
/// eigensystems for isotropic distortion energies"). It starts from `start` (n x 2) if that flips no triangle, else from Tutte's
/// embedding on a circle. Triangles without area are given some. None where it is no disc even with its inner holes filled: an
/// edge of three triangles or of two that disagree on its direction, a border that touches itself, a handle, no border at all; or
/// where doubles do not suffice for Tutte's embedding. The same input gives the same bits; turned and scaled it is the same but
/// for rounding.
std::optional<Parametrization> parametrize(const PointsRef& points, const std::vector<std::array<Index, 3>>& triangles,
                                           const PlaneLayoutOptions& options = {}, const PlanePoints* start = nullptr);

}  // namespace tripatch
