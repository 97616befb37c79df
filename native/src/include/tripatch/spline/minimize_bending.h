// Triangles that bend least, or whose bending varies least, measured on themselves: Gaussian fields of order 2 and 3 in their Markov
// form, on the surface instead of the plane (Lindgren, Rue and Lindstroem 2011; as a way to fill holes Botsch and Kobbelt 2004).
#pragma once

#include <Eigen/SparseCore>
#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/spline/disc.h"

namespace tripatch {

/// The Laplacian of triangles by cotangents (Pinkall and Polthier 1993).
struct Laplacian {
  Eigen::SparseMatrix<double> stiffness;  ///< positive on its diagonal
  Eigen::VectorXd areas;                  ///< of the vertices
};
Laplacian cotangent_laplacian(const Points& points, const std::vector<std::array<Index, 3>>& triangles);

/// Positions of the rows from `first` on, `count` of points (n x 3), that make an integral of the coordinates least: of the squared
/// gradient (order 1), of the squared Laplacian (2) or of its squared gradient (3). It is computed by cotangents and areas of the
/// triangles as they lie (Pinkall and Polthier 1993). All other rows stay. triangles: whose bending counts; around: those that they are to continue from in one
/// plane across the edges where they meet, as a clamped plate does, and whose Laplacian the one at these edges is to vary little from.
/// The triangles around every vertex that so many edges as the order, less one, lead to from one of these rows must be given; more do not
/// matter. Nothing where no numbers come of it.
std::optional<Points> minimize_bending(const Points& points, const std::vector<std::array<Index, 3>>& triangles,
                                       const std::vector<std::array<Index, 3>>& around, Index first, Index count, int order = 2);

/// How much of what a smooth reference leaves of the samples is details of the surface: 0 where all is noise, to 1 where none is.
double share_of_details(double noise, double left_by_reference);
/// Whether these are so many that, where a field folds, the second model alone is taken before a field through fewer rings.
bool mostly_details(double share);

/// What tells how much of a fill is the second model.
struct FieldFindings {
  double noise = 0;      ///< over an edge
  double roughness = 0;  ///< PolyharmonicSpline::roughness
  double details = 0;    ///< share_of_details
  double mean_order = 0;
  bool strongly_curved = false;
};

/// At most so much of a fill is its second model. Chosen on 216 holes of 25 meshes.
constexpr double max_of_second = share::most;
/// How much of a fill is the second model. Rough surroundings lie off any layout by what their details stretch; this one bends the
/// triangles themselves least, or varies their bending least, and knows of no plane: the most where what reads as noise is a seventh of
/// an edge and more. Half where the noise decides the order altogether and details are much more than noise; some where there is little
/// noise, but the likeliest order is low, or details are faint.
double share_of_second(const FieldFindings& findings);

/// The second model of a rough hole: triangles that bend least and whose bending varies least, which know of no plane.
struct SecondModel {
  Points vertices;  ///< the new ones: an average of the orders
  Points apart;     ///< what these spread about it
};

/// Of a fill's points (the disc's rim first, then the new vertices) and triangles: positions of the new vertices by one or two orders, all
/// of the same measures. The disc has as many rings as the highest order less one, where there are so many. keep_planes: of the disc's
/// triangles next to the rim, as a clamped plate does; else these bend with the fill's.
class SecondModels {
public:
  SecondModels(const Points& points, const std::vector<std::array<Index, 3>>& triangles, const Disc& disc,
               bool keep_planes = true);
  SecondModels(SecondModels&&) noexcept;
  ~SecondModels();

  /// Nothing where no numbers come.
  std::optional<SecondModel> by(const std::vector<int>& orders);

private:
  struct Own;
  std::unique_ptr<Own> own_;
};

std::optional<SecondModel> second_model(const Points& points, const std::vector<std::array<Index, 3>>& triangles,
                                        const Disc& disc, const std::vector<int>& orders, bool keep_planes = true);

}  // namespace tripatch
