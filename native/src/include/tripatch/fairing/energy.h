// Fairness energies of a surface over the triangle, with the corner weight w of quadrature.h.
#pragma once

#include "tripatch/choices.h"
#include "tripatch/fairing/curvature_variation.h"
#include "tripatch/math/quadrature.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/patch/surface.h"

namespace tripatch {

/// The soft minimum of two energies, minimum_variation and ten times quadric_variation: (a^-4 + b^-4)^(-1/4). On surfaces at
/// large the second is a quarter to a half of the first, so it wins only where a surface is a quadric or near one.
constexpr double quadric_ratio = share::tenth;
double soft_minimum(double variation, double quadric);

/// Quadratic in the surface, so that their minimum is one linear solve: thin_plate and third_derivative.
bool is_quadratic(Fairing energy);

/// thin_plate, third_derivative: integral of w |D^2 P|^2, w |D^3 P|^2 over the unit equilateral triangle (units: length squared).
/// minimum_variation, quadric_variation: size^2 times the integral of w |grad h|^2 over the surface, whole and what is left of it
/// (no units). automatic: soft_minimum of these.
double energy(const Surface& surface, Fairing of, double size, int nodes_per_direction = 16);

/// The largest distance between points of the sides.
double size_of(const Surface& surface);

}  // namespace tripatch
