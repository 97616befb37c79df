#include "tripatch/cage/cage_fill.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/interruption.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

/// The largest valences of poles in most layouts of quads and triangles; only those beyond are worth a warning. Between three sides of 3 to
/// 14 edges, none twice as long as another, 113 of 194 layouts of triangles have none beyond, and all of quads a single one of 3.
constexpr Index ordinary_quad_pole = 5, ordinary_triangle_pole = 7;

/// Border edges at a vertex; two where one border passes.
Index border_edges_at(const Connectivity& left, Index v) {
  std::vector<Index> beside;
  for (Connectivity::Corner c : left.at(v)) beside.insert(beside.end(), {left.next(c), left.previous(c)});
  std::sort(beside.begin(), beside.end());
  beside.erase(std::unique(beside.begin(), beside.end()), beside.end());
  return std::count_if(beside.begin(), beside.end(), [&](Index w) { return left.faces_at_edge(v, w).size() == 1; });
}

void report_seam(const CageMeasures& measures, const SidedRim& hole, Report& report) {
  report.seam_angle_max_by_side.assign(hole.sides(), 0);
  report.seam_angle_rms_by_side.assign(hole.sides(), 0);
  std::vector<double> all;
  double squares = 0;
  for (int i = 0; i < hole.sides(); ++i) {
    double sum = 0;
    const std::vector<double>& angles = measures.seam_angles[i];
    const std::size_t edges = hole.side(i).size() - 1, per = angles.size() / edges, before = all.size();
    for (std::size_t k = 0; k < angles.size(); ++k) {
      if (angles[k] < 0) continue;
      report.seam_angle_max_by_side[i] = std::max(report.seam_angle_max_by_side[i], angles[k]);
      if (k >= per && k < (edges - 1) * per) report.seam_angle_max_inside = std::max(report.seam_angle_max_inside, angles[k]);
      sum += angles[k] * angles[k];
      all.push_back(angles[k]);
    }
    squares += sum;
    report.seam_angle_rms_by_side[i] = std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, all.size() - before)));
    report.seam_angle_max = std::max(report.seam_angle_max, report.seam_angle_max_by_side[i]);
  }
  if (all.empty()) return;
  report.seam_angle_rms = std::sqrt(squares / static_cast<double>(all.size()));
  std::nth_element(all.begin(), all.begin() + static_cast<Index>(all.size() / 2), all.end());
  report.seam_angle_median = all[all.size() / 2];
}

}  // namespace

CageFill::CageFill(const Mesh& mesh, const Connectivity& left, std::vector<SidedRim> holes, const Subdivision& settings,
                   std::vector<Index> replaced, const LayoutOptions& layout_options, const CageOptions& options)
    : mesh_(mesh),
      left_(left),
      holes_(std::move(holes)),
      replaced_(std::move(replaced)),
      layout_options_(layout_options),
      options_(options),
      split_(split_odd_rims(mesh_, holes_, settings, layout_options.split_odd && !settings.loop)),
      laid_out_(holes_.size()),
      open_(holes_.size(), 1),
      sides_(holes_.size()),
      seams_(holes_.size()),
      points_(holes_.size()),
      energies_(holes_.size()),
      harm_(holes_.size()) {
  if (settings.loop && layout_options_.rows.value_or(0) > 0)
    throw CodedArgument(Code::triangle_cage_has_no_rows, {{"option", "resolution"}});
  if (settings.loop)
    for (const SidedRim& hole : holes_)
      if (!hole.is_triangle()) throw CodedRefusal(Code::loop_cage_needs_three_corners);
  for (const SidedRim& hole : holes_)
    domains_.push_back(hole.is_triangle() ? PolygonDomain() : cage_domain(hole, mesh_.vertices, left_));
  for (const SidedRim& hole : split_.holes)
    tolerance_.push_back(layout_options_.tolerance.value_or(default_tolerance * diameter(split_.mesh(), hole.rim)));
  fit_ = lay_out(rows_to_try(layout_options_, settings.loop, options_.rim == CageRim::exact)[0]);
}

void CageFill::make_fair() {
  const bool exact = options_.rim == CageRim::exact;
  if (!exact) energies_ = fit_->make_fair();
  for (std::size_t h = 0; h < size(); ++h) {
    check_interruption();
    sides_[h] = seams_[h] = fit_->sides(h);
    if (!exact) points_[h] = fit_->points(h);
  }
  if (exact) take_smooth_rims();
}

/// The border of an open cage rounds its corners off: its sides run into each other in one line there, and no patch over a polygon lies
/// between them. An exact rim's fill is fitted to the patch of a smooth one, and keeps to its own seam.
void CageFill::take_smooth_rims() {
  if (std::all_of(holes_.begin(), holes_.end(), [](const SidedRim& hole) { return hole.is_triangle(); })) return;
  CageOptions options = options_;
  options.rim = CageRim::smooth;
  CageFit smooth(split_.mesh(), laid_out_, split_.settings, replaced_, options);
  smooth.make_fair();
  for (std::size_t h = 0; h < size(); ++h) {
    if (holes_[h].is_triangle()) continue;
    sides_[h] = smooth.sides(h);
    points_[h] = smooth.points(h);
  }
}

QuadLayout CageFill::layout_of(std::size_t h, int rows) const {
  const SidedRim& rim = split_.holes[h];
  if (!rim.is_triangle()) return polygon_cage_layout(rim, split_.vertices, domains_[h], left_, rows);
  return cage_layout(rim.hole(), split_.vertices, split_.settings.loop, rows, layout_options_.pole_offset);
}

/// The holes that are still open get other layouts.
std::unique_ptr<CageFit> CageFill::lay_out(int rows) {
  for (std::size_t h = 0; h < size(); ++h) {
    check_interruption();
    if (open_[h]) laid_out_[h] = {split_.holes[h], layout_of(h, rows)};
  }
  try {
    return std::make_unique<CageFit>(split_.mesh(), laid_out_, split_.settings, replaced_, options_);
  } catch (const CodedRefusal& refusal) {  // of the closed cage, which has vertices that the mesh has not
    const auto own = [&](Index v) { return v < mesh_.vertices.rows() ? v : -1; };
    throw CodedRefusal(with_vertices(refusal.message(), own));
  }
}

/// Of the holes where the fairest cage is kept.
std::vector<std::optional<SurfacePoints>> CageFill::points_to_follow(const std::vector<bool>& fair) const {
  std::vector<std::optional<SurfacePoints>> points(size());
  for (std::size_t h = 0; h < size(); ++h)
    if (fair[h]) points[h] = points_[h];
  return points;
}

void CageFill::place(const Points& inside) {
  fit_->place(0, inside);
  energies_[0] = {};
  placed_ = true;
  open_[0] = 0;
}

void CageFill::take_sides() {
  sides_[0] = seams_[0] = fit_->sides(0);
  points_[0] = fit_->points(0);
}

void CageFill::fit(const std::vector<SurfacePtr>& patches, const std::vector<bool>& fair) {
  const std::vector<bool> none(size(), false);
  if (placed_) return;
  const bool exact = options_.rim == CageRim::exact;
  const std::vector<int> all_rows = rows_to_try(layout_options_, split_.settings.loop, exact);
  if (layout_options_.rows && all_rows.size() > 1) {  // the first layout was for what the patches are made on
    rows_ = all_rows.back();
    fit_ = lay_out(rows_);
    return fit_->fit(patches, seams_, true);
  }
  std::vector<double> farthest;  // for each number of rows, of the holes that are open with it: over the tolerance
  std::vector<Index> crossed;    // likewise: their faces
  for (std::size_t k = 0; k < all_rows.size(); ++k) {
    if (k > 0) fit_ = lay_out(all_rows[k]);
    rows_ = all_rows[k];
    const std::vector<std::optional<SurfacePoints>> points = points_to_follow(k == 0 ? fair : none);
    fit_->fit(patches, seams_, exact || k > 0, points);
    farthest.push_back(0);
    crossed.push_back(0);
    for (std::size_t h = 0; h < size(); ++h) {
      check_interruption();
      const double off = points[h] || layout_options_.rows ? 0 : fit_->deviation_rms(h, *patches[h]) / tolerance_[h];
      const Index own = fit_->faces_crossed(h);
      if (open_[h]) farthest.back() = std::max(farthest.back(), off);
      if (open_[h]) crossed.back() += own;
      open_[h] = layout_options_.rows || off > 1 || (k > 0 && own > crossed.front());
    }
    if (std::find(open_.begin(), open_.end(), 1) == open_.end()) return;
  }
  // The limit surface next to the rim is bound to the surroundings and may follow the less, the more rows there are: distorted rows
  // that do not reach the tolerance either are worse than few. Rows that cross each other are worse than any distance.
  for (std::size_t k = 1; k < crossed.size(); ++k) {
    if (crossed[k] <= crossed[0]) continue;
    farthest[k] = std::numeric_limits<double>::infinity();
    cross_ = true;
  }
  const auto nearest = std::min_element(farthest.begin(), farthest.end()) - farthest.begin();
  if (layout_options_.rows || all_rows[nearest] == rows_) return;
  rows_ = all_rows[nearest];
  fit_ = lay_out(rows_);
  if (!exact && nearest == 0) fit_->make_fair();
  fit_->fit(patches, seams_, exact || nearest > 0, points_to_follow(nearest == 0 ? fair : none));
}

const CageHarm& CageFill::harm(std::size_t h) {
  if (!harm_[h]) harm_[h] = fit_->harm(h);
  return *harm_[h];
}

void CageFill::complete(std::size_t h, Fill& fill) {
  check_interruption();
  deliver(h, fill);
  fill.normals = fill.patch->normals(fill.barycentric);
  fill.rim_normals = fill.patch->normals(fill.rim_barycentric);
  if (laid_out_[h].layout.in_plane) {
    fill.uv = fill.barycentric.leftCols(2);
    fill.rim_uv = fill.rim_barycentric.leftCols(2);
    fill.barycentric.resize(0, 3);
    fill.rim_barycentric.resize(0, 3);
  }
  fill.sides = seams_[h];
  report(h, *fill.patch, fill.report);
}

/// Of the rows of a layout in the mesh with the fill: n .. are the new vertices, that of a split edge first.
std::vector<Index> CageFill::numbering(std::size_t h) const {
  const auto& [hole, layout] = laid_out_[h];
  const auto& split = split_.split[h];
  const Index n = mesh_.vertices.rows();
  std::vector<Index> index;
  for (Index v : hole.rim) index.push_back(split && v == split->middle ? n : v);
  for (Index k = layout.rim; k < layout.barycentric.rows(); ++k) index.push_back(n + (split ? 1 : 0) + k - layout.rim);
  return index;
}

void CageFill::deliver(std::size_t h, Fill& fill) const {
  const auto& [hole, layout] = laid_out_[h];
  fill.rim = holes_[h].rim;
  const Points inside = fit_->inside(h), rim = fit_->rim(h);  // the rim's as they are now: they may have moved
  const std::vector<Index> index = numbering(h);
  const Index n = mesh_.vertices.rows(), own = split_.split[h] ? 1 : 0;
  fill.vertices.resize(inside.rows() + own, 3);
  fill.barycentric.resize(inside.rows() + own, 3);
  fill.rim_barycentric.resize(layout.rim - own, 3);
  Index on_rim = 0;
  for (Index k = 0; k < layout.rim; ++k) {
    if (index[k] == n) {
      fill.vertices.row(0) = rim.row(k);
      fill.barycentric.row(0) = layout.barycentric.row(k);
    } else {
      fill.rim_barycentric.row(on_rim++) = layout.barycentric.row(k);
    }
  }
  fill.vertices.bottomRows(inside.rows()) = inside;
  fill.barycentric.bottomRows(inside.rows()) = layout.barycentric.bottomRows(inside.rows());
  fill.faces = layout.faces;
  for (Index& v : fill.faces.corners) v = index[v];

  if (own > 0) {
    fill.split_edges.push_back(split_.split[h]->edge);
    fill.split_t.push_back(0.5);
  }
  const Index around = layout.rim;
  if (options_.rim == CageRim::move) {
    fill.moved = fill.rim;
    fill.moved_to.resize(around - own, 3);
    for (Index k = 0, row = 0; k < around; ++k)
      if (index[k] != n) fill.moved_to.row(row++) = rim.row(k);
  }
  if (options_.rim == CageRim::exact)
    for (Index k = 0; k < around; ++k) fill.creases.push_back({index[k], index[(k + 1) % around]});
  fill.crease_values.assign(fill.creases.size(), 1.0);
  const Index first = fit_->first_inside(h);
  const auto row_of = [&](Index v) {
    return v < first ? std::ranges::find(hole.rim, v) - hole.rim.begin() : v - first + layout.rim;
  };
  for (const InnerCrease& crease : fit_->creases(h)) {
    fill.creases.push_back({index[row_of(crease.edge[0])], index[row_of(crease.edge[1])]});
    fill.crease_values.push_back(crease.value);
  }
}

void CageFill::report(std::size_t h, const Surface& patch, Report& report) {
  const CageMeasures measures = fit_->measures(h, patch);
  const CageHarm& against = harm(h);
  report.cage_deviation_max = measures.deviation_max;
  report.cage_deviation_rms = measures.deviation_rms;
  report.surroundings_moved_max = measures.surroundings_max;
  report.surroundings_moved_rms = measures.surroundings_rms;
  report.surroundings_moved_where = measures.surroundings_where;
  report.corners_moved_max = measures.corners_moved;
  report.triangles_folded = against.triangles_folded;
  report.crosses_itself = against.crossing.has_value();
  if (against.crossing)
    tell_crossing(mesh_.vertices, holes_[h].rim, *against.crossing, report, Code::crosses_itself);
  else if (against.faces_crossing)
    tell_crossing(mesh_.vertices, holes_[h].rim, *against.faces_crossing, report, Code::cage_faces_cross);
  if (report.triangles_folded == 0 && against.faces_turned) report.warnings.push_back({Code::cage_corner_turns_back});
  report.rows = rows_;
  report_seam(measures, laid_out_[h].hole, report);
  report_poles(h, report);
  for (Index v : holes_[h].rim)
    if (border_edges_at(left_, v) > 2) report.warnings.push_back({Code::border_touches_rim, {}, {v}});
  if (layout_options_.rows || split_.settings.loop || !open_[h]) return;
  if (!cross_) report.warnings.push_back({Code::tolerance_out_of_reach});
  if (cross_ && layout_options_.tolerance) report.warnings.push_back({Code::rows_would_cross});
}

void CageFill::report_energies(std::size_t h, Report& report) const {
  if (!(energies_[h].before > 0)) return;
  report.fairing = "minimum_variation";
  report.energy_before = energies_[h].before;
  report.energy_after = energies_[h].after;
}

void CageFill::report_poles(std::size_t h, Report& report) const {
  const QuadLayout& layout = laid_out_[h].layout;
  const std::vector<Index> index = numbering(h);
  const Index ordinary = layout.faces[0].size() == 3 ? ordinary_triangle_pole : ordinary_quad_pole;
  for (Index pole : layout.poles) {
    const Index valence = std::count(layout.faces.corners.begin(), layout.faces.corners.end(), pole);
    report.poles.push_back({index[pole], valence});
    if (valence > ordinary)
      report.warnings.push_back(
          {Code::high_valence_pole, {{"valence", valence}, {"new_vertex", index[pole] - mesh_.vertices.rows()}}});
  }
}

}  // namespace tripatch
