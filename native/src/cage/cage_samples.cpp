#include "tripatch/cage/cage_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/smoothstep.h"
#include "tripatch/math/thresholds.h"

namespace tripatch {
namespace {

constexpr int samples = count::several;  ///< a row of each face: what face_shape takes its polynomials from
/// Times as long across the rim as the fill's own faces: from there on a face of the surroundings is a strip, by twice that for certain.
constexpr double uneven = factor::strong;

Points unit_normals(const Points& pu, const Points& pv) {
  Points normals(pu.rows(), 3);
  for (Index k = 0; k < pu.rows(); ++k) normals.row(k) = Vec3(pu.row(k)).cross(Vec3(pv.row(k))).stableNormalized();
  return normals;
}

void sample_inside(const CageSurfaces& surfaces, const QuadLayout& layout, Index first_face, HoleSamples& hole) {
  std::vector<Vec3> coordinates;
  for (Index f = 0; f < layout.faces.size(); ++f) {
    check_interruption();
    const std::vector<FacePlace> places = spread_places(layout.faces[f].size(), surfaces.loop);
    const LimitStencils& stencils = hole.stencils.emplace_back(surfaces.limit.stencils(first_face + f, places));
    hole.inside.push_back({first_face + f, surfaces.system.sums(stencils.vertices, stencils.p), {}, {}});
    for (const FacePlace& place : places)
      coordinates.push_back(layout.in_plane ? mean_at(place, layout.faces[f], layout.barycentric, surfaces.loop)
                                            : barycentric_at(place, layout.faces[f], layout.barycentric, surfaces.loop));
  }
  hole.coordinates.resize(static_cast<Index>(coordinates.size()), 3);
  for (std::size_t k = 0; k < coordinates.size(); ++k) hole.coordinates.row(static_cast<Index>(k)) = coordinates[k];
}

/// The surroundings as they would be if none of their faces were longer across the rim than the fill's are: a uniform B-spline knows no
/// other spacing, and its least third derivatives would carry strips of the length of a bevel on into the hole.
class EvenSurroundings {
public:
  EvenSurroundings(const CageSurfaces& surfaces, const SidedRim& hole, const std::vector<Index>& ring)
      : vertices_(surfaces.closed.vertices) {
    const Points& given = surfaces.closed.vertices;
    const std::size_t n = hole.rim.size();
    std::map<Index, double> depth;  // of the fill's faces at a vertex of the rim: the layout's are as long as its edges
    for (std::size_t k = 0; k < n; ++k) {
      const auto edge = [&](std::size_t e) { return (given.row(hole.rim[e % n]) - given.row(hole.rim[(e + 1) % n])).norm(); };
      depth[hole.rim[k]] = std::max(edge(k), edge(k + n - 1));
    }
    for (Index f : ring) {
      const auto face = surfaces.closed.faces[f];
      for (Index v : face) {
        if (depth.contains(v)) continue;
        Index near = -1;
        double distance = INFINITY;
        for (Index r : face)
          if (depth.contains(r) && (given.row(v) - given.row(r)).norm() < distance) {
            near = r;
            distance = (given.row(v) - given.row(r)).norm();
          }
        if (near < 0) continue;
        const double ratio = distance / depth[near];
        longest_[f] = std::max(longest_[f], ratio);
        if (ratio > uneven) vertices_.row(v) = given.row(near) + (given.row(v) - given.row(near)) / ratio;
      }
    }
  }

  /// From 1 for a face of the ring that is about as long as the fill's to 0 for one that is much longer.
  double evenness(Index face) const {
    const auto found = longest_.find(face);
    return found == longest_.end() ? 1 : 1 - smoothstep(found->second / uneven - 1);
  }

  FaceShape shape(const CageSystem& system, const LimitStencils& stencils, bool loop) const {
    return face_shape(system.sums(stencils.vertices, stencils.p, vertices_), loop);
  }

private:
  Points vertices_;
  std::map<Index, double> longest_;
};

void sample_outside(const CageSurfaces& surfaces, const SidedRim& hole, const std::array<std::vector<Index>, 2>& rings,
                    const EvenSurroundings& even, double corner_trust, HoleSamples& samples) {
  std::set<Index> corners;
  for (Index c : hole.corners) corners.insert(hole.rim[c]);
  samples.first_ring = rings[0].size();
  for (const std::vector<Index>& faces : rings)
    for (Index f : faces) {
      check_interruption();
      const auto face = surfaces.closed.faces[f];
      const bool corner = std::any_of(face.begin(), face.end(), [&](Index v) { return corners.contains(v); });
      const std::vector<FacePlace> places = spread_places(face.size(), surfaces.loop);
      const LimitStencils before = surfaces.was.stencils(surfaces.closed.kept[f], places),
                          now = surfaces.limit.stencils(f, places);
      const Points vertices = surfaces.given.vertices(before.vertices, Eigen::all);
      samples.outside.push_back({f, surfaces.system.sums(now.vertices, now.p), before.p * vertices,
                                 unit_normals(before.pu * vertices, before.pv * vertices),
                                 corner && !samples.region ? corner_trust : 1, even.evenness(f)});
    }
}

/// The shape of the faces that the scheme knows as its own: quads, with Loop's triangles.
FairHole shape_of(const CageSurfaces& surfaces, const SidedRim& hole, const EvenSurroundings& even, const HoleSamples& samples) {
  FairHole shape;
  shape.size = diameter(surfaces.given, hole.rim);
  const std::size_t corners = surfaces.loop ? 3 : 4;
  for (std::size_t k = 0; k < samples.inside.size(); ++k) {
    check_interruption();
    if (surfaces.closed.faces[samples.inside[k].face].size() != corners) continue;
    shape.inside.push_back(face_shape(samples.inside[k].limit, surfaces.loop));
    shape.even.push_back(even.shape(surfaces.system, samples.stencils[k], surfaces.loop));
  }
  for (std::size_t k = 0; k < samples.first_ring; ++k) {
    const SampledFace& face = samples.outside[k];
    if (surfaces.closed.faces[face.face].size() == corners && even.evenness(face.face) == 1)
      shape.even.push_back(face_shape(face.limit, surfaces.loop));
  }
  return shape;
}

}  // namespace

std::vector<FacePlace> spread_places(std::size_t corners, bool loop) {
  std::vector<FacePlace> places;
  if (loop) {  // the corners' thirds of the small triangles
    for (int i = 0; i < samples; ++i)
      for (int j = 0; i + j < samples; ++j) places.push_back({0, (i + 1.0 / 3) / samples, (j + 1.0 / 3) / samples});
    return places;
  }
  const int per = corners == 4 ? samples : (samples + 1) / 2;
  for (int q = 0; q < (corners == 4 ? 1 : static_cast<int>(corners)); ++q)
    for (int i = 0; i < per; ++i)
      for (int j = 0; j < per; ++j) places.push_back({q, (i + 0.5) / per, (j + 0.5) / per});
  return places;
}

Vec3 mean_at(const FacePlace& s, std::span<const Index> face, const Points& rows, bool loop) {
  const auto row = [&](std::size_t k) { return Vec3(rows.row(face[k % face.size()])); };
  if (loop) return (1 - s.u - s.v) * row(0) + s.u * row(1) + s.v * row(2);
  std::array<Vec3, 4> q;
  if (face.size() == 4) {
    q = {row(0), row(1), row(2), row(3)};
  } else {
    Vec3 center = Vec3::Zero();
    for (std::size_t k = 0; k < face.size(); ++k) center += row(k) / static_cast<double>(face.size());
    const std::size_t k = static_cast<std::size_t>(s.quarter);
    q = {row(k), 0.5 * (row(k) + row(k + 1)), center, 0.5 * (row(k) + row(k + face.size() - 1))};
  }
  return (1 - s.u) * (1 - s.v) * q[0] + s.u * (1 - s.v) * q[1] + s.u * s.v * q[2] + (1 - s.u) * s.v * q[3];
}

Vec3 barycentric_at(const FacePlace& place, std::span<const Index> face, const Points& rows, bool loop) {
  const Vec3 b = mean_at(place, face, rows, loop).cwiseMax(0);
  return b / b.sum();
}

Points HoleSamples::positions(const Points& free) const {
  Points all(coordinates.rows(), 3);
  Index row = 0;
  for (const SampledFace& face : inside) {
    all.middleRows(row, face.limit.rest.rows()) = face.limit.at(free);
    row += face.limit.rest.rows();
  }
  return all;
}

SurfacePoints HoleSamples::points(const Points& all) const {
  SurfacePoints points = {coordinates, Points(coordinates.rows(), 3), Points(coordinates.rows(), 3)};
  Index row = 0;
  for (const LimitStencils& face : stencils) {
    const Points vertices = all(face.vertices, Eigen::all);
    const Points p = face.p * vertices, pu = face.pu * vertices, pv = face.pv * vertices;
    points.points.middleRows(row, p.rows()) = p;
    points.normals.middleRows(row, p.rows()) = unit_normals(pu, pv);
    row += p.rows();
  }
  return points;
}

HoleSamples sample_hole(const CageSurfaces& surfaces, const CageHole& hole, Index first_face,
                        const std::array<std::vector<Index>, 2>& rings, bool region, double corner_trust) {
  HoleSamples samples;
  samples.region = region;
  sample_inside(surfaces, hole.layout, first_face, samples);
  const EvenSurroundings even(surfaces, hole.hole, rings[0]);
  sample_outside(surfaces, hole.hole, rings, even, corner_trust, samples);
  samples.shape = shape_of(surfaces, hole.hole, even, samples);
  return samples;
}

}  // namespace tripatch
