// The planes along a side, each by the neighborhood that predicts best what is near.
#pragma once

#include <array>
#include <vector>

#include "tripatch/estimate/fits_between.h"
#include "tripatch/estimate/stencils.h"
#include "tripatch/estimate/vertex_fit.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {

/// Radians an edge, from which on polynomials of heights say little. Half and twice of it: planes err by 1% less, by 4% more in the mean of
/// 78 rims in meshes of balls, tori, saddles and fillets.
constexpr double coarse_turn = share::three_tenths;

/// What one side's fits tell besides its planes.
struct SideFit {
  std::array<VertexFit, 2> ends;
  std::vector<double> slope_variances;  ///< by vertex
  double turned = 0;                    ///< variance besides, at each
  std::array<bool, 2> flat = {};        ///< at which end it goes over into a plane
  double bend_variance = 0;             ///< of the second derivative across, mean over the side
};

/// The planes and second fundamental forms of a side, as one neighborhood has them, vertex after vertex, for each is looked for from the one
/// before. nearest: what each fit is asked to predict; empty: nobody asks as long as all planes are well known, and there is nothing where
/// one is not; then some are inferred from those around them. What it is made of must outlive it.
class SideFitting {
public:
  SideFitting(const LocalMesh& w, const VarianceComponents& components, SideDraft side, const Neighborhood& near,
              const std::vector<std::vector<Share>>& nearest, SideSearch& search)
      : w_(w),
        components_(components),
        side_(std::move(side)),
        near_(near),
        nearest_(nearest),
        search_(search),
        fits_(side_.vertex.size()) {}

  int left() const { return static_cast<int>(fits_.size()) - next_; }
  /// So many more vertices.
  void go_on(int vertices);
  /// Once none is left.
  std::vector<VertexFit> fits();

private:
  /// Whether a vertex is left to those around it, for now.
  bool is_left_out(int place) const { return nearest_.empty() && is_between(place, side_.edges()); }
  /// False where the plane there is not well known, and nobody asks for the others then.
  bool fit_at(int place);
  void fit_between();
  VertexFit fit(int k);

  const LocalMesh& w_;
  const VarianceComponents& components_;
  SideDraft side_;
  const Neighborhood& near_;
  const std::vector<std::vector<Share>>& nearest_;
  SideSearch& search_;
  std::vector<VertexFit> fits_;
  int next_ = 0;  // place, as vertices are looked at
  Seen seen_;
  FitRoom room_;
};

/// All of them.
std::vector<VertexFit> fit_side(const LocalMesh& w, const VarianceComponents& components, const SideDraft& side,
                                const Neighborhood& near, const std::vector<std::vector<Share>>& nearest, SideSearch& search);

/// The vertices of a side that are nearest to each: in the faces at it, in front of the side.
std::vector<std::vector<Share>> nearest_of(const LocalMesh& w, const SideDraft& side, SideSearch& search);

/// Whether nothing is to be won by looking at less.
bool is_known(const VertexFit& fit);

/// Variance of the noise of the rim's vertices: that of the smoothest side, for a mesh has one noise, but corners may lie within a
/// side: 0 where all are short.
double roughness(const std::array<SideDraft, 3>& drafts);

/// The mean of the normals of the faces at vertex k of a side, by their angles there.
Vec3 mean_of_facets(const LocalMesh& w, const SideDraft& side, int k);

/// The fits used at each vertex of a side, of those by neighborhood, largest first. A smaller one is used if it predicts its
/// surroundings better, the more so the less certain its plane is, or if the larger one is not plausible. rough: variance of the
/// rim's vertices.
SideFit choose(const LocalMesh& w, const std::vector<std::vector<VertexFit>>& fits, SideDraft& side, double rough);

}  // namespace tripatch
