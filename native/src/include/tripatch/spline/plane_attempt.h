// One try of a fill over a plane: surroundings and hole are laid out, a field is fitted over them, and the hole is triangulated on it.
#pragma once

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/spline/disc.h"
#include "tripatch/spline/hermite_correction.h"
#include "tripatch/spline/minimize_bending.h"
#include "tripatch/spline/plane_fill.h"
#include "tripatch/spline/plane_rim.h"

namespace tripatch {

/// Surroundings as far as this share of the hole's diameter: with 0.5 the fills of scanned and modelled meshes are no nearer, and cost
/// more.
constexpr double reach_share = share::quarter;
constexpr int rings_followed = count::rings;

/// Where long rims are not seen from above, the fill in their layouts has a third of the rim in so many edges inside: its triangles would be ten times those
/// of the rings. Of six caps of a sphere, 60 degrees, rims of 600 to 1,050 edges that are jagged by 0.01 and 0.02, with 10, 40 and 200
/// five are as far off, one with 10 half as far; with 200 it takes twice as long.
constexpr int edges_in_layouts = count::dozens;

/// Details: what a polynomial of the higher degree leaves, over an edge. With twice as much 84 holes are 0.7% farther, with half 0.8% nearer.
constexpr double detail = share::little;

/// Work on a fill, counted in vertices that are laid out or bent: it ends the same way on every machine.
class Work {
public:
  void add(Index vertices) { done_ += vertices; }
  /// What follows may take so many times what was done up to now, at least once it is called.
  void limit() {
    if (most_ == 0) most_ = std::max(times * done_, least);
  }
  bool is_spent() const { return most_ > 0 && done_ >= most_; }

private:
  /// Of 448 holes of real meshes, and 212 under noise of a tenth and a third of an edge, three are filled otherwise without a limit: one
  /// that folds in any case, two under the most noise.
  static constexpr Index times = count::several, least = count::linear;
  Index done_ = 0, most_ = 0;
};

struct Attempt {
  std::shared_ptr<const PolyharmonicSpline> field;
  SurfacePtr surface;  // the field, its average with a second model, or that which meets points inside
  std::shared_ptr<const HermiteCorrection> met;
  PlanePoints met_uv = PlanePoints(0, 2);
  PlanePoints rim_uv;
  PlaneTriangulation made;
  Points on_field = Points(0, 3);  // its vertices before any is moved, those of the rim where they are
  bool from_above = false;
  bool few = false;              // triangles, for the layouts: it is refined in the end
  double left_by_reference = 0;  // scene units
  std::optional<SecondModel> second;
  double share_of_second = 0;
  Eigen::VectorXd spread;  // variance of both models about their average, of each new vertex; none where there is one model
  double fed_back = 0;     // share of the fill's error that its layout hands on to it
};

double details_in(const Attempt& result);

/// Folds that a fill may have: the rim's own, and one for each face that is turned over and that it does not fold over.
Index max_folds(const PlaneRim& rim, const Attempt& result);
/// Whether an attempt crosses itself where it need not.
bool crosses(const PlaneRim& rim, const Attempt& result);

/// Triangles on the surface, with what is met inside as vertices: none of them finite where that cannot be.
PlaneTriangulation triangulated(PlanePolygon polygon, const std::vector<Through>& through, std::optional<int> resolution,
                                const Attempt& result, const MostTriangles& most = {});

/// Tries until the layout with the fill in it is that of the try before, or more would not help. work: is added to.
std::optional<Attempt> attempts(const Disc& disc, const PlaneRim& rim, const std::vector<Index>& samples,
                                const FieldOptions& fields, const PlaneFillOptions& options, Work& work);
/// A noisy surface without details, from more of it: the layout is that of the try before, with its fill. Whether that changed the result.
bool look_farther(const Mesh& mesh, const Connectivity& around, const std::vector<std::vector<Index>>& loops, const PlaneRim& rim,
                  const FieldOptions& fields, const PlaneFillOptions& options, Disc& disc, Attempt& result);
/// A strongly curved surface without noise, from more samples: the layout is that of the try before, with its fill. Not where it meets points
/// inside, which curve it and of which the samples know nothing, nor where it would fold more. Whether that changed the result.
bool look_closer(const Disc& disc, const PlaneRim& rim, const FieldOptions& fields, const PlaneFillOptions& options,
                 Attempt& result);

}  // namespace tripatch
