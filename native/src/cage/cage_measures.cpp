// What the report says of a fitted cage.
#include <algorithm>
#include <cmath>

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/cage/cage_fit.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/places.h"
#include "tripatch/quads/quad_smoothing.h"
#include "tripatch/report/crossings.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

constexpr int folds_level = 3;  ///< of the limit surface whose folds are counted: 8 x 8 quads a face, as Fill.limit gives them

double root_mean_square(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

}  // namespace

Eigen::VectorXd CageFit::deviation(std::size_t h, const Surface& patch) const {
  Points coordinates = samples_[h].coordinates;
  return nearest_on(patch, samples_[h].positions(free_), coordinates);
}

double CageFit::deviation_rms(std::size_t h, const Surface& patch) const { return root_mean_square(deviation(h, patch)); }

Index CageFit::faces_crossed(std::size_t h) const {
  Index crossed = 0;
  for (Index f = closed_.first_face[h]; f < closed_.first_face[h + 1]; ++f) {
    const auto face = closed_.faces[f];
    const std::size_t n = face.size();
    std::vector<Vec3> turns;
    Vec3 mean = Vec3::Zero();
    for (std::size_t k = 0; k < n; ++k) {
      const Vec3 at = closed_.vertices.row(face[k]), ahead = closed_.vertices.row(face[(k + 1) % n]),
                 behind = closed_.vertices.row(face[(k + n - 1) % n]);
      turns.push_back((ahead - at).cross(behind - at));
      mean += turns.back();
    }
    crossed += std::any_of(turns.begin(), turns.end(), [&](const Vec3& turn) { return turn.dot(mean) < 0; });
  }
  return crossed;
}

void CageFit::measure_surroundings(std::size_t h, CageMeasures& measures) const {
  double sum = 0;
  Index count = 0;
  for (const SampledFace& face : samples_[h].outside) {
    const Eigen::VectorXd d = (face.limit.at(free_) - face.target).rowwise().norm();
    if (d.maxCoeff() > measures.surroundings_max) {
      measures.surroundings_max = d.maxCoeff();
      measures.surroundings_where = closed_.faces[face.face][0];
    }
    sum += d.squaredNorm();
    count += d.size();
  }
  if (count > 0) measures.surroundings_rms = std::sqrt(sum / static_cast<double>(count));
}

void CageFit::measure_rim(std::size_t h, CageMeasures& measures) const {
  const SidedRim& hole = holes_[h].hole;
  measures.seam_angles.resize(hole.sides());
  const std::vector<double> t = evenly(8);
  const std::vector<double> reversed(t.rbegin(), t.rend());
  std::vector<LimitJet> in(t.size()), out(t.size());
  for (int i = 0; i < hole.sides(); ++i) {
    const std::vector<Index> side = hole.side(i);
    for (std::size_t e = 0; e + 1 < side.size(); ++e) {
      const FaceEdge mine = edges_.at({side[e], side[e + 1]}), theirs = edges_.at({side[e + 1], side[e]});
      limit_.evaluate_edge(mine.face, mine.edge, t, in);
      limit_.evaluate_edge(theirs.face, theirs.edge, reversed, out);
      for (std::size_t k = 0; k < t.size(); ++k)
        measures.seam_angles[i].push_back(spans_plane(in[k]) && spans_plane(out[k])
                                              ? degrees_between(in[k].pu.cross(in[k].pv), out[k].pu.cross(out[k].pv))
                                              : -1);
    }
    const FaceEdge first = edges_.at({side[1], side[0]});
    LimitJet now, before;
    limit_.evaluate_edge(first.face, first.edge, std::array{1.0}, {&now, 1});
    was_.evaluate_edge(closed_.kept[first.face], first.edge, std::array{1.0}, {&before, 1});
    measures.corners_moved = std::max(measures.corners_moved, (now.p - before.p).norm());
  }
}

CageMeasures CageFit::measures(std::size_t h, const Surface& patch) const {
  CageMeasures measures;
  const Eigen::VectorXd distances = deviation(h, patch);
  measures.deviation_max = distances.maxCoeff();
  measures.deviation_rms = root_mean_square(distances);
  measure_surroundings(h, measures);
  measure_rim(h, measures);
  return measures;
}

LimitMesh CageFit::sampled(std::size_t h) const {
  return sample_limit(limit_, closed_.mesh(), settings_.loop, closed_.first_face[h], closed_.first_face[h + 1], folds_level);
}

Index CageFit::triangles_folded(std::size_t h) const {
  const LimitMesh surface = sampled(h);
  return count_folded_edges(surface.vertices, Points(0, 3), surface.faces);
}

CageHarm CageFit::harm(std::size_t h) const {
  CageHarm harm;
  const LimitMesh surface = sampled(h);
  const Points none(0, 3);
  EdgesByVertex edges = edges_of_triangles(surface.vertices.rows(), 0, surface.faces, {});
  harm.triangles_folded = count_folded_edges(surface.vertices, none, surface.faces, {}, edges);
  for (const Crossing& each : find_crossings(surface.vertices, none, surface.faces, edges, 1)) harm.crossing = each.where;
  Faces own;
  for (Index f = closed_.first_face[h]; f < closed_.first_face[h + 1]; ++f) own.add(closed_.faces[f]);
  harm.faces_turned = quad_quality(closed_.vertices, own).least < 0;
  begin_at_shorter_diagonals(closed_.vertices, none, own);
  for (const Crossing& each : find_crossings(closed_.vertices, none, own, 1)) harm.faces_crossing = each.where;
  return harm;
}

}  // namespace tripatch
