// Holes of a subdivision cage, filled with cages: a few quads each whose limit surface is the patch.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "tripatch/cage/cage_fit.h"
#include "tripatch/cage/cage_layout.h"
#include "tripatch/cage/cage_options.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Cages for holes whose surroundings may overlap, fitted together. Phases: made, with layouts of quads as large as those around;
/// (but for an exact rim) the fairest cage on them, or placed; patches on `sides`, which may follow `points`; `fit` to them; `complete`.
class CageFill {
public:
  /// mesh, left: outlive this. left: of the mesh without the faces in the holes, which are `replaced`.
  CageFill(const Mesh& mesh, const Connectivity& left, std::vector<SidedRim> holes, const Subdivision& settings,
           std::vector<Index> replaced, const LayoutOptions& layout_options, const CageOptions& options);

  /// The fairest cages of the layouts, and what an exact rim is made on.
  void make_fair();

  std::size_t size() const { return holes_.size(); }
  /// Of a hole: what its patch is to be made on.
  const CageSides& sides(std::size_t hole) const { return sides_[hole]; }
  /// Of a hole of other than three sides: what its patch is to be over.
  const PolygonDomain& domain(std::size_t hole) const { return domains_[hole]; }
  /// Points of the fair cage; none for an exact rim of three sides.
  const SurfacePoints& points(std::size_t hole) const { return points_[hole]; }

  /// The vertices inside the first layout of a hole, in its order, and the layout.
  Points inside(std::size_t hole) const { return fit_->inside(hole); }
  const CageHole& laid_out(std::size_t hole) const { return laid_out_[hole]; }
  double tolerance(std::size_t hole) const { return tolerance_[hole]; }
  /// Puts the vertices of a hole that is alone where they shall be, in place of the fairest: no fit moves them. What its patch is to be
  /// made on it has from `take_sides`.
  void place(const Points& inside);
  void take_sides();

  /// To a patch for each hole, with more rows where the tolerance asks for them. fair: by hole, whether
  /// it keeps to the fairest cage itself, as far as its rows are that one's; as long as no rows are asked for it needs no patch.
  void fit(const std::vector<SurfacePtr>& patches, const std::vector<bool>& fair);

  /// Of a cage that is fitted.
  const CageHarm& harm(std::size_t hole);
  Index triangles_folded(std::size_t hole) const { return fit_->triangles_folded(hole); }
  /// Of a fill: vertices, faces, and what changes around them.
  void deliver(std::size_t hole, Fill& fill) const;
  /// That and the rest of a fill that has its patch, and the numbers of the report, whose seam is the one between the limit surfaces.
  void complete(std::size_t hole, Fill& fill);
  /// The energies of the fairest cage, where it is what is made fair and not the patch.
  void report_energies(std::size_t hole, Report& report) const;

private:
  std::unique_ptr<CageFit> lay_out(int rows);
  QuadLayout layout_of(std::size_t hole, int rows) const;
  std::vector<std::optional<SurfacePoints>> points_to_follow(const std::vector<bool>& fair) const;
  std::vector<Index> numbering(std::size_t hole) const;
  void take_smooth_rims();
  void report(std::size_t hole, const Surface& patch, Report& report);
  void report_poles(std::size_t hole, Report& report) const;

  const Mesh mesh_;
  const Connectivity& left_;
  const std::vector<SidedRim> holes_;  ///< as they were given
  std::vector<PolygonDomain> domains_;
  const std::vector<Index> replaced_;
  const LayoutOptions layout_options_;
  const CageOptions options_;
  const SplitMesh split_;
  std::vector<double> tolerance_;
  std::vector<CageHole> laid_out_;
  int rows_ = 0;            ///< extra rows of quads of the present layout
  bool placed_ = false;     ///< its vertices are where they shall be
  bool cross_ = false;      ///< more of them would cross each other
  std::vector<char> open_;  ///< asks for another layout
  std::unique_ptr<CageFit> fit_;
  std::vector<CageSides> sides_, seams_;  ///< what the patch is made on, and what the fill is to be tangent to
  std::vector<SurfacePoints> points_;
  std::vector<CageEnergies> energies_;
  std::vector<std::optional<CageHarm>> harm_;
};

/// Holes in groups: those that share faces of their first two rings belong together. mesh: without the faces in them.
std::vector<std::vector<std::size_t>> cage_groups(const Connectivity& mesh, const std::vector<SidedRim>& holes);

}  // namespace tripatch
