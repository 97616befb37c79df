#include "tripatch/cage/cage_fit.h"

#include <algorithm>
#include <utility>

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/cage/cage_fair.h"
#include "tripatch/cage/cage_terms.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

/// A few new vertices cannot hold the surroundings where these slide along long faces: then they leave their place for a spike, and what
/// was to be made fair is bent more than before. There the surroundings may move so many times as far, so many times at most. Of 23 cages
/// between bevels of one to ten segments three ask for it, once; with two or eight times as far their limit is the same to 1e-3.
constexpr double widening = factor::large;
constexpr int max_widenings = count::few;

/// Stencils need patches, and the fit their limit.
Subdivision with_stencils(Subdivision settings) {
  if (!settings.quality) settings.quality = stencil_quality;
  settings.use_limit_surface = true;
  return settings;
}

void sort_unique(std::vector<Index>& v) {
  std::sort(v.begin(), v.end());
  v.erase(std::unique(v.begin(), v.end()), v.end());
}

std::vector<std::array<std::vector<Index>, 2>> rings_of(const ClosedCage& closed, const Connectivity& whole,
                                                        const std::vector<CageHole>& holes) {
  std::vector<std::array<std::vector<Index>, 2>> rings;
  for (const CageHole& hole : holes) rings.push_back(rings_around(closed, whole, hole.hole));
  return rings;
}

std::vector<Index> with_inside(std::vector<Index> around, const ClosedCage& closed) {
  for (Index v = closed.first_vertex.front(); v < closed.first_vertex.back(); ++v) around.push_back(v);
  return around;
}

/// The sides of a rim on a limit surface of the cage without the `missing` faces.
CageSides limit_sides_of(const LimitSurface& surface, const Mesh& cage, const SidedRim& rim, const std::vector<Index>& missing) {
  const Connectivity around = Connectivity::around(cage, rim.rim, 0, missing);
  CageSides sides;
  for (int i = 0; i < rim.sides(); ++i) sides.push_back(side_on(surface, around, rim.side(i), tolerance::same));
  return sides;
}

/// Of all faces sampled.
std::vector<const Sums*> sums_of(const std::vector<HoleSamples>& holes) {
  std::vector<const Sums*> together;
  for (const HoleSamples& hole : holes)
    for (const auto* faces : {&hole.inside, &hole.outside})
      for (const SampledFace& face : *faces) together.push_back(&face.limit);
  return together;
}

}  // namespace

CageFit::CageFit(const Mesh& mesh, std::vector<CageHole> holes, const Subdivision& settings, const std::vector<Index>& replaced,
                 const CageOptions& options)
    : mesh_(mesh),
      holes_(std::move(holes)),
      settings_(with_stencils(settings)),
      replaced_(replaced),
      options_(options),
      closed_(close_holes(mesh_, holes_, replaced_)),
      whole_(closed_.mesh()),
      rings_(rings_of(closed_, whole_, holes_)),
      edges_(rim_edges(whole_, holes_)),
      around_(around_holes()),
      was_(mesh_, settings_, around_),
      limit_(closed_.mesh(), creased(), with_inside(around_, closed_)),
      system_(closed_.vertices, free_vertices()),
      free_(closed_.vertices(system_.free(), Eigen::all)) {
  for (std::size_t h = 0; h < holes_.size(); ++h) {
    check_interruption();
    samples_.push_back(
        sample_hole(surfaces(), holes_[h], closed_.first_face[h], rings_[h], replaces(holes_[h].hole), options_.corner));
  }
}

/// With the rim edges of an exact rim creased.
Subdivision CageFit::creased() const {
  Subdivision creased = settings_;
  for (std::size_t h = 0; h < holes_.size(); ++h)
    for (const InnerCrease& crease : creases(h)) {
      creased.crease_edges.push_back(crease.edge);
      creased.edge_creases.push_back(crease.value);
    }
  for (std::size_t h = 0; exact() && h < holes_.size(); ++h) {
    const std::vector<Index>& rim = holes_[h].hole.rim;
    for (std::size_t k = 0; k < rim.size(); ++k) {
      creased.crease_edges.push_back({rim[k], rim[(k + 1) % rim.size()]});
      creased.edge_creases.push_back(1.0);
    }
  }
  return creased;
}

/// Of the mesh: where the limit surface is asked for.
std::vector<Index> CageFit::around_holes() const {
  std::vector<Index> around;
  for (std::size_t h = 0; h < holes_.size(); ++h) {
    const std::vector<Index>& rim = holes_[h].hole.rim;
    around.insert(around.end(), rim.begin(), rim.end());
    for (Index f : rings_[h][0]) around.insert(around.end(), closed_.faces[f].begin(), closed_.faces[f].end());
  }
  sort_unique(around);
  return around;
}

std::vector<Index> CageFit::free_vertices() const {
  std::vector<Index> free = with_inside({}, closed_);
  if (options_.rim == CageRim::move)
    for (const CageHole& hole : holes_) free.insert(free.end(), hole.hole.rim.begin(), hole.hole.rim.end());
  sort_unique(free);
  return free;
}

/// Whether one of the replaced faces lies at the rim's first edge, on its inner side.
bool CageFit::replaces(const SidedRim& hole) const {
  return std::any_of(replaced_.begin(), replaced_.end(), [&](Index f) {
    const auto face = mesh_.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k)
      if (face[k] == hole.rim[0] && face[(k + 1) % face.size()] == hole.rim[1]) return true;
    return false;
  });
}

void CageFit::take() {
  const std::vector<Index>& free = system_.free();
  for (std::size_t k = 0; k < free.size(); ++k) closed_.vertices.row(free[k]) = free_.row(static_cast<Index>(k));
  limit_.move(closed_.vertices);
}

std::vector<CageEnergies> CageFit::make_fair() {
  system_.prepare(sums_of(samples_));
  std::vector<int> waiting;  // the rim's own vertices, for the fit
  for (std::size_t k = 0; k < system_.free().size(); ++k)
    if (system_.free()[k] < mesh_.vertices.rows()) waiting.push_back(static_cast<int>(k));
  const Points start = free_;
  std::vector<double> wider(holes_.size(), 1);
  std::vector<FairHole> fair;  // of thousands of faces: not copied, but lent
  for (HoleSamples& hole : samples_) fair.push_back(std::move(hole.shape));
  for (int attempt = 0;; ++attempt) {
    CageSystem::Term held = system_.zero();
    for (std::size_t h = 0; h < holes_.size(); ++h) {
      const HoleSamples& hole = samples_[h];
      hold_surroundings(system_, start, hole, wider[h] * (hole.region ? options_.fair_whole : options_.fair_open) * fair[h].size,
                        held);
    }
    free_ = fair_cage(system_, start, fair, held, waiting);
    bool bent = false;
    for (std::size_t h = 0; h < holes_.size(); ++h)
      if (fair[h].after > fair[h].before) wider[h] *= widening, bent = true;
    if (!bent || attempt == max_widenings) break;
  }
  take();
  std::vector<CageEnergies> energies;
  for (std::size_t h = 0; h < holes_.size(); ++h) {
    energies.push_back({fair[h].before, fair[h].after});
    samples_[h].shape = std::move(fair[h]);
  }
  return energies;
}

CageSides CageFit::sides(std::size_t h) const {
  const SidedRim& hole = holes_[h].hole;
  if (exact() && !replaced_.empty()) {  // what an exact rim leaves them: the creased border of an open hole
    Faces left;
    for (Index f : closed_.kept) left.add(mesh_.faces[f]);
    const Mesh open = {mesh_.vertices, left};
    return limit_sides_of(LimitSurface(open, settings_, around_), open, hole, {});
  }
  if (exact() || samples_[h].region) return limit_sides_of(was_, mesh_, hole, replaced_);
  std::vector<Index> fill;
  for (Index f = closed_.first_face[h]; f < closed_.first_face[h + 1]; ++f) fill.push_back(f);
  return limit_sides_of(limit_, closed_.mesh(), hole, fill);
}

void CageFit::set_inside(std::size_t h, const Points& inside) {
  const Index first = closed_.first_vertex[h], end = closed_.first_vertex[h + 1];
  const std::vector<Index>& free = system_.free();
  for (std::size_t k = 0; k < free.size(); ++k)
    if (free[k] >= first && free[k] < end) free_.row(static_cast<Index>(k)) = inside.row(free[k] - first);
}

void CageFit::place(std::size_t h, const Points& inside) {
  set_inside(h, inside);
  take();
}

void CageFit::move_to_patch(std::size_t h, const Surface& patch) {
  const Index inside = closed_.first_vertex[h + 1] - closed_.first_vertex[h];
  set_inside(h, patch.positions(holes_[h].layout.barycentric.bottomRows(inside)));
}

void CageFit::fit(const std::vector<SurfacePtr>& patches, const std::vector<CageSides>& sides, bool from_patches,
                  const std::vector<std::optional<SurfacePoints>>& points) {
  const auto given = [&](std::size_t h) { return h < points.size() && points[h] ? &*points[h] : nullptr; };
  std::vector<Seam> seams;
  std::vector<const Sums*> together = sums_of(samples_);
  for (std::size_t h = 0; h < holes_.size(); ++h) {
    if (from_patches && !given(h)) move_to_patch(h, *patches[h]);
    if (exact()) seams.push_back(seam_of(surfaces(), holes_[h].hole, sides[h], edges_));
  }
  for (const Seam& seam : seams)
    for (const Seam::Row& row : seam.rows) together.push_back(&row.across);
  system_.prepare(together);

  for (int round = 0; round < options_.rounds; ++round) {
    CageSystem::Term term = system_.zero();
    for (std::size_t h = 0; h < holes_.size(); ++h) {
      check_interruption();
      HoleSamples& hole = samples_[h];
      // the targets go to the points of the patch that are nearest to where the samples are: along it nothing holds them
      if (const SurfacePoints* there = given(h)) {
        add_points(system_, free_, there->points, there->normals, hole, options_, term);
      } else {
        if (round > 0 || !exact()) nearest_on(*patches[h], hole.positions(free_), hole.coordinates);
        const auto [target, normal] = patches[h]->positions_and_normals(hole.coordinates);
        add_points(system_, free_, target, normal, hole, options_, term);
      }
      add_surroundings(system_, free_, hole, options_, term);
      if (exact()) {
        CageOptions seam = options_;
        if (given(h)) {
          seam.seam = options_.seam_of_points;
          seam.seam_width = options_.seam_width_of_points;
        }
        add_seam(system_, free_, seams[h], seam, term);
      }
      add_third_derivatives(system_, hole.shape, free_, options_.lines * options_.lines, term);
    }
    const Eigen::VectorXd y = system_.step(term, Eigen::VectorXd::Zero(free_.size()), anchor);
    free_ += Eigen::Map<const Points>(y.data(), free_.rows(), 3);
  }
  take();
}

Points CageFit::inside(std::size_t h) const {
  return closed_.vertices.middleRows(closed_.first_vertex[h], closed_.first_vertex[h + 1] - closed_.first_vertex[h]);
}

Points CageFit::rim(std::size_t h) const { return closed_.vertices(holes_[h].hole.rim, Eigen::all); }

}  // namespace tripatch
