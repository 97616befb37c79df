#include "tripatch/cage/cage_terms.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/interruption.h"

namespace tripatch {
namespace {

/// Distances across a plane and along it, by weights.
Eigen::Matrix3d metric(const Vec3& normal, double across, double along) {
  const Eigen::Matrix3d n = normal * normal.transpose();
  return across * across * n + along * along * (Eigen::Matrix3d::Identity() - n);
}

/// Where on an edge of an exact rim the derivative across is held: denser towards its ends, where the next edge's face continues.
constexpr std::array<double, 7> seam_places = {0.0, 0.15, 0.35, 0.5, 0.65, 0.85, 1.0};
constexpr int seam_trust_power = 3;  ///< how fast the rows next to a corner lose weight, in edges from it

/// Along an edge of a face, in its own u and v: a place, and the direction of the edge that ends where this one starts, backwards.
struct EdgeFrame {
  Eigen::Vector2d at, into;
};
EdgeFrame edge_frame(std::size_t edge, std::size_t corners, double s) {
  const std::array<Eigen::Vector2d, 4> square = {Eigen::Vector2d(0, 0), {1, 0}, {1, 1}, {0, 1}};
  const std::array<Eigen::Vector2d, 3> triangle = {Eigen::Vector2d(0, 0), {1, 0}, {0, 1}};
  const auto corner = [&](std::size_t k) { return corners == 3 ? triangle[k % 3] : square[k % 4]; };
  const Eigen::Vector2d along = corner(edge + 1) - corner(edge);
  return {corner(edge) + s * along, corner(edge + corners - 1) - corner(edge)};
}

}  // namespace

void add_points(const CageSystem& system, const Points& free, const Points& target, const Points& normal, const HoleSamples& hole,
                const CageOptions& options, CageSystem::Term& term) {
  Index row = 0;
  for (const SampledFace& face : hole.inside) {
    check_interruption();
    const Points now = face.limit.at(free);
    for (Index k = 0; k < now.rows(); ++k, ++row)
      system.add(term, face.limit, k, metric(normal.row(row), 1, options.tangential), now.row(k) - target.row(row));
  }
}

void add_surroundings(const CageSystem& system, const Points& free, const HoleSamples& hole, const CageOptions& options,
                      CageSystem::Term& term) {
  const double across = hole.region ? options.whole : options.surroundings,
               along = hole.region ? options.whole : options.surroundings_tangential;
  for (const SampledFace& face : hole.outside) {
    check_interruption();
    if (face.limit.slots.empty()) continue;
    const Points now = face.limit.at(free);
    for (Index k = 0; k < now.rows(); ++k)
      system.add(term, face.limit, k, metric(face.normal.row(k), face.trust * across, face.trust * face.along * along),
                 now.row(k) - face.target.row(k));
  }
}

void hold_surroundings(const CageSystem& system, const Points& free, const HoleSamples& hole, double tolerated,
                       CageSystem::Term& term) {
  double count = 0;
  for (const SampledFace& face : hole.outside)
    if (face.trust == 1) count += static_cast<double>(face.target.rows());
  for (const SampledFace& face : hole.outside) {
    check_interruption();
    if (face.trust < 1 || face.limit.slots.empty()) continue;
    const Points now = face.limit.at(free);
    for (Index k = 0; k < now.rows(); ++k)
      system.add(term, face.limit, k, metric(face.normal.row(k), 1, face.along) / (count * tolerated * tolerated),
                 now.row(k) - face.target.row(k));
  }
}

Seam seam_of(const CageSurfaces& surfaces, const SidedRim& hole, const CageSides& sides, const DirectedEdges& edges) {
  Seam seam;
  seam.size = diameter(surfaces.given, hole.rim);
  for (int i = 0; i < hole.sides(); ++i) {
    const std::vector<Index> side = hole.side(i);
    const double count = static_cast<double>(side.size() - 1);
    for (std::size_t e = 0; e + 1 < side.size(); ++e) {
      const FaceEdge place = edges.at({side[e], side[e + 1]});
      const std::size_t corners = surfaces.closed.faces[place.face].size();
      if (!surfaces.loop && corners != 4) continue;
      for (double s : seam_places) {
        // a smooth rim leaves the quad in its corner no tangent plane there, and little freedom next to it
        const double along_side = static_cast<double>(e) + s, from_corner = std::min(along_side, count - along_side);
        if (from_corner == 0) continue;
        const double trust = std::pow(std::min(1.0, from_corner), seam_trust_power), t = along_side / count;
        const Vec3 normal = sides[i].normal(t), inwards = normal.cross(sides[i].c.derivative_at(t)).normalized();
        const EdgeFrame frame = edge_frame(static_cast<std::size_t>(place.edge), corners, s);
        const FacePlace where = {0, frame.at[0], frame.at[1]};
        const LimitStencils stencil = surfaces.limit.stencils(place.face, {&where, 1});
        const Weights across = frame.into[0] * stencil.pu + frame.into[1] * stencil.pv;
        seam.rows.push_back({surfaces.system.sums(stencil.vertices, across), normal, inwards, trust});
      }
    }
  }
  return seam;
}

void add_seam(const CageSystem& system, const Points& free, const Seam& seam, const CageOptions& options,
              CageSystem::Term& term) {
  for (const Seam::Row& row : seam.rows) {
    const Vec3 now = row.across.at(free).row(0);
    const double width = now.norm();  // of the quad: the row is an angle
    if (width == 0) continue;
    const double weight = row.trust * options.seam * seam.size / width, held = options.seam_width * weight;
    system.add(term, row.across, 0, weight * weight * row.normal * row.normal.transpose(), now);
    // else the quads may turn their first row over: that lies in the plane as well
    system.add(term, row.across, 0, held * held * row.inwards * row.inwards.transpose(), Vec3::Zero());
  }
}

}  // namespace tripatch
