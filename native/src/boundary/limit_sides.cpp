#include "tripatch/boundary/limit_sides.h"

#include <Eigen/Dense>
#include <algorithm>
#include <optional>

#include "tripatch/boundary/surroundings.h"
#include "tripatch/math/angle.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {
namespace {

constexpr double kink = 0.1;  ///< degrees between two pieces of the rim's curve: it has a kink, of which a warning tells

struct FaceEdge {
  Index face;
  int edge;
};

/// The surrounding face at a rim edge a -> b (new faces' direction), which holds b -> a.
FaceEdge face_beside(const Connectivity& around, Index a, Index b) {
  const std::optional<Connectivity::Corner> corner = around.edge(b, a);
  if (!corner) throw CodedRefusal(Code::no_face_at_edge, {a, b});
  return {around.face(*corner), static_cast<int>(around.place(*corner))};
}

/// Normal of the limit surface at t of a face's edge; where its two derivatives are parallel, as at an end of the edge, its limit from within
/// the edge: that of the cross product over the way to there.
Vec3 unit_normal(double t, const LimitJet& jet) {
  const Vec3 normal = jet.pu.cross(jet.pv);
  if (spans_plane(jet)) return normal.normalized();
  const Vec3 change = jet.puu.cross(jet.pv) + jet.pu.cross(jet.puv);
  return (t < 0.5 ? 1 : -1) * change.stableNormalized();
}

/// Second derivative in the direction of r, its normal part: the second fundamental form of (r, r) along n.
Vec3 second_across(const LimitJet& j, const Vec3& n, const Vec3& r) {
  const Eigen::Vector2d a = in_frame(j.pu, j.pv, r);
  return n * n.dot(a[0] * a[0] * j.puu + 2 * a[0] * a[1] * j.puv + a[1] * a[1] * j.pvv);
}

void refined_sides(const Mesh& cage, const Connectivity& whole, const Hole& hole, const Subdivision& settings,
                   LimitSides& result) {
  const RefinedCage refined = refine_cage(cage, whole, settings, hole.rim);
  Hole fine;
  for (std::size_t k = 0; k < hole.rim.size(); ++k) {
    for (int corner = 0; corner < 3; ++corner)
      if (static_cast<std::size_t>(hole.corners[corner]) == k) fine.corners[corner] = static_cast<Index>(fine.rim.size());
    fine.rim.insert(fine.rim.end(), refined.along_rim[k].begin(), refined.along_rim[k].end());
  }
  MeshSides estimated = mesh_sides({refined.vertices, refined.faces}, fine);
  result.sides = std::move(estimated.sides);
  result.parameters = std::move(estimated.parameters);
  for (int i = 0; i < 3; ++i) {
    const std::vector<double>& t = result.parameters[i];
    const std::size_t per_edge = (t.size() - 1) / (hole.side(i).size() - 1);
    result.sides[i].rim.clear();  // the refined mesh has more
    for (std::size_t k = 0; k < t.size(); k += per_edge) result.sides[i].rim.push_back(t[k]);
  }
  result.surroundings_error = estimated.surroundings_error;
  result.border.resize(static_cast<Index>(fine.rim.size()), 3);
  for (std::size_t k = 0; k < fine.rim.size(); ++k) result.border.row(static_cast<Index>(k)) = refined.vertices.row(fine.rim[k]);
  result.warnings.push_back({Code::limit_not_used});
}

/// Where an interior vertex has only two edges, both derivatives of the limit vanish: no side can start or end there.
void check_ends(const Side& side, const std::vector<Index>& along) {
  const double length = (side.c(0.5) - side.c(0)).norm() + (side.c(1) - side.c(0.5)).norm();
  for (const auto& [t, v] : {std::pair(0.0, along.front()), std::pair(1.0, along.back())})
    if (side.c.derivative_at(t).norm() < tolerance::same * length) throw CodedRefusal(Code::corner_lacks_planes, {v});
}

}  // namespace

bool spans_plane(const LimitJet& jet) { return jet.pu.cross(jet.pv).norm() > tolerance::same * jet.pu.norm() * jet.pv.norm(); }

Side side_on(const LimitSurface& surface, const Connectivity& around, const std::vector<Index>& rim, double tolerance) {
  const int edges = static_cast<int>(rim.size()) - 1;
  std::vector<PiecewisePolynomial> c, r, q;
  LimitJet start;  // the curve is found from here: its tolerance is of its own size, however far from the origin it lies
  const FaceEdge first = face_beside(around, rim[0], rim[1]);
  const double there = 1;
  surface.evaluate_edge(first.face, first.edge, {&there, 1}, {&start, 1});
  for (int e = 0; e < edges; ++e) {
    const FaceEdge place = face_beside(around, rim[e], rim[e + 1]);
    // the face runs against the side: t of the side is 1 - t of the face's edge, and d/dt is -edges d/du
    const auto field = [&](const auto& value) {
      return PiecewisePolynomial::fit(
          [&](std::span<const double> t, std::span<double> out) {
            std::vector<double> face_t(t.size());
            std::vector<LimitJet> jets(t.size());
            for (std::size_t k = 0; k < t.size(); ++k) face_t[k] = 1 - t[k];
            surface.evaluate_edge(place.face, place.edge, face_t, jets);
            for (std::size_t k = 0; k < t.size(); ++k) {
              const Vec3 v = value(face_t[k], jets[k]);
              std::copy_n(v.data(), 3, &out[3 * k]);
            }
          },
          3, tolerance);
    };
    const auto across = [&](double t, const LimitJet& j) { return Vec3(-edges * j.pu.cross(unit_normal(t, j))); };
    c.push_back(field([&](double, const LimitJet& j) { return Vec3(j.p - start.p); }));
    r.push_back(field(across));
    q.push_back(field([&](double t, const LimitJet& j) { return second_across(j, unit_normal(t, j), across(t, j)); }));
  }
  Side side = {PiecewisePolynomial::joined(c) + PiecewisePolynomial::constant(std::span<const double>(start.p.data(), 3)),
               PiecewisePolynomial::joined(r), PiecewisePolynomial::joined(q)};
  for (int e = 0; e <= edges; ++e) side.rim.push_back(static_cast<double>(e) / edges);
  check_ends(side, rim);
  return side;
}

Sides sides_on(const LimitSurface& surface, const Connectivity& around, const Hole& hole, double tolerance) {
  Sides sides;
  for (int i = 0; i < 3; ++i) sides[i] = side_on(surface, around, hole.side(i), tolerance);
  return sides;
}

Sides sides_on(const LimitSurface& surface, const Mesh& cage, const Hole& hole, const std::vector<Index>& replaced,
               double tolerance) {
  return sides_on(surface, Connectivity::around(cage, hole.rim, 0, replaced), hole, tolerance);
}

LimitSides limit_sides(const Mesh& cage, const Connectivity& whole, const Connectivity& around, const Hole& hole,
                       const Subdivision& settings) {
  LimitSides result;
  if (!settings.use_limit_surface) {
    refined_sides(cage, whole, hole, settings, result);
    return result;
  }
  result.sides = sides_on(LimitSurface(cage, whole, settings, hole.rim), around, hole, tolerance::fit);
  const int steps = 1 << settings.level;
  for (int i = 0; i < 3; ++i) {
    const std::vector<Index> rim = hole.side(i);
    const int edges = static_cast<int>(rim.size()) - 1;
    for (int e = 0; e < edges; ++e)
      for (int k = 0; k < steps; ++k) result.parameters[i].push_back((e + static_cast<double>(k) / steps) / edges);
    result.parameters[i].push_back(1.0);
    const PiecewisePolynomial& c = result.sides[i].c;
    for (int e = 1; e < edges; ++e) {
      const double t = static_cast<double>(e) / edges;
      // exactly at the break the piece behind it counts
      if (degrees_between(c.derivative_at(t - tolerance::solved), c.derivative_at(t + tolerance::solved)) > kink)
        result.warnings.push_back({Code::limit_rim_kink, {{"side", i}}, {rim[e]}});
    }
  }
  std::vector<Vec3> border;
  for (int i : {2, 0, 1})
    for (std::size_t k = 0; k + 1 < result.parameters[i].size(); ++k)
      border.push_back(result.sides[i].c(result.parameters[i][k]));
  result.border.resize(static_cast<Index>(border.size()), 3);
  for (std::size_t k = 0; k < border.size(); ++k) result.border.row(static_cast<Index>(k)) = border[k];
  return result;
}

Surroundings surroundings_of(const Mesh& mesh, const Connectivity& whole, const Connectivity& around, const Hole& hole,
                             const Subdivision* limit, const VertexPlanes& planes) {
  if (limit) {
    LimitSides exact = limit_sides(mesh, whole, around, hole, *limit);
    return {std::move(exact.sides), std::move(exact.parameters), std::move(exact.warnings), exact.surroundings_error,
            std::move(exact.border)};
  }
  MeshSides estimated = mesh_sides(mesh, around, hole, planes);
  return {std::move(estimated.sides), std::move(estimated.parameters), {}, estimated.surroundings_error, {}};
}

Points rim_barycentric(const Hole& hole, const Surroundings& surroundings) {
  Points b = Points::Zero(static_cast<Index>(hole.rim.size()), 3);
  Index row = 0;
  for (int i : {2, 0, 1}) {
    const std::vector<double>& t = surroundings.parameters[i];
    const std::size_t edges = hole.side(i).size() - 1, stride = (t.size() - 1) / edges;
    for (std::size_t e = 0; e < edges; ++e, ++row) {
      b(row, (i + 1) % 3) = 1 - t[e * stride];
      b(row, (i + 2) % 3) = t[e * stride];
    }
  }
  return b;
}

}  // namespace tripatch
