// docs/mathematics/surroundings.md has the formulas and what they reach.
#include "tripatch/boundary/mesh_sides.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <future>
#include <numbers>
#include <utility>

#include "tripatch/boundary/side_curves.h"
#include "tripatch/estimate/corner_planes.h"
#include "tripatch/estimate/side_cylinder.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

constexpr int samples_a_side = 6;  ///< about as many stencils a side tell the variance components

/// How edges farther along a side count where its ends are compared, and the neighbors' edges next to them.
constexpr double next_edge_counts = share::three_tenths;

/// Whether a side is looked at from its end on: the end with the longer edges next to it, of the side and of its neighbors.
bool begins_at_end(const LocalMesh& w, int from, int edges) {
  const int n = static_cast<int>(w.rim.size());
  const auto at = [&](int k) -> const Vec3& { return w.position[w.rim[(from + k + n) % n]]; };
  double start = (at(0) - at(-1)).norm(), end = (at(edges + 1) - at(edges)).norm(), counts = next_edge_counts;
  for (int k = 0; k < edges; ++k, counts *= next_edge_counts) {
    start += counts * (at(k + 1) - at(k)).norm();
    end += counts * (at(edges - k) - at(edges - k - 1)).norm();
  }
  return clearly_more(end, start);
}

/// The three sides with the curves through their vertices and the planes of the faces next to them.
std::array<SideDraft, 3> drafts_of(const LocalMesh& w, const Mesh& mesh, const Hole& hole) {
  const int n = static_cast<int>(w.rim.size());
  std::array<SideDraft, 3> drafts;
  const auto draft = [&](Index i) {
    SideDraft& side = drafts[i];
    const int from = static_cast<int>(hole.corners[(i + 1) % 3]), to = static_cast<int>(hole.corners[(i + 2) % 3]);
    const int edges = (to - from + n) % n;
    if (edges < 1) throw InvalidArgument("the three corners of a hole must be three places of its rim, in its order");
    side.from_end = begins_at_end(w, from, edges);
    std::vector<Vec3> face;  // area vectors next to the edges
    side.t = {0};
    for (int k = 0; k <= edges; ++k) {
      side.vertex.push_back(w.rim[(from + k) % n]);
      side.position.push_back(w.position[side.vertex.back()]);
      side.point.push_back(mesh.vertices.row(w.vertex(side.vertex.back())));
      if (k == 0) continue;
      side.length += (side.position[k] - side.position[k - 1]).norm();
      side.t.push_back(side.length);
      side.face.push_back(w.beside[(from + k - 1) % n]);
      face.push_back(w.area[side.face.back()]);
    }
    side.depth = 0;
    for (int k = 0; k < edges; ++k)  // twice the area over the edge: of triangles the depth, of quads twice the depth
      side.depth += face[k].norm() / (side.position[k + 1] - side.position[k]).squaredNorm() / edges /
                    (w.part[side.face[k]].size() > 3 ? 2 : 1);
    for (double& t : side.t) t /= side.length;
    side.t.back() = 1;
    const PiecewisePolynomial c = curve_through(side);
    for (int k = 0; k <= edges; ++k) {
      side.tangent.push_back(c.derivative_at(side.t[k]).stableNormalized());
      Vec3 sum = Vec3::Zero();
      for (int e = std::max(k - 2, 0); e < std::min(k + 2, edges); ++e) sum += face[e];
      sum -= side.tangent[k] * side.tangent[k].dot(sum);
      const Index v = w.vertex(side.vertex[k]);
      if (!(sum.norm() > 0)) throw CodedRefusal(Code::faces_at_vertex_without_area, {v});
      side.guess.push_back(sum.normalized());
      side.faces.push_back(side.guess.back());
    }
  };
  each_at_once(3, draft, is_long(w.rim.size()));
  return drafts;
}

VarianceComponents components_of(const LocalMesh& w, const std::array<SideDraft, 3>& drafts, const Neighborhood& near, int only,
                                 Searches& searches) {
  std::array<std::vector<Stencil>, 3> samples;
  const auto measure_some = [&](Index i) {
    if (only >= 0 && i != only) return;
    const int n = static_cast<int>(drafts[i].vertex.size()), step = std::max(1, n / ((only < 0 ? 1 : 3) * samples_a_side));
    for (int j = 0; j < n; j += step) {
      Seen seen;
      measure(w, drafts[i], drafts[i].looked_at(j), near, searches[i], seen);
      samples[i].push_back(std::move(seen.stencil));
    }
  };
  each_at_once(3, measure_some, is_long(w.rim.size()));
  double radius = 0, points = 0;
  for (const std::vector<Stencil>& side : samples)
    for (const Stencil& s : side) {
      for (const SampleBlock& of : s.heights)
        for (int k = 0; k < 8; ++k) radius += Vec3(of.x[k], of.y[k], of.z[k]).norm();
      points += static_cast<double>(s.points);
    }
  // the squared curvature that the faces next to the rim show, to start with
  double bend = 0;
  const int n = static_cast<int>(w.rim.size());
  for (int k = 0; k < n; ++k) {
    const Vec3 a = w.area[w.beside[k]].normalized(), b = w.area[w.beside[(k + 1) % n]].normalized();
    bend += (a - b).squaredNorm() / n;
  }
  return estimate_components(samples, radius / points, bend);
}

/// The fits along side i by neighborhood: the first alone where it knows all planes well, as it does on most smooth meshes.
std::vector<std::vector<VertexFit>> fits_of(const LocalMesh& w, const VarianceComponents& components,
                                            const std::array<SideDraft, 3>& drafts, int i, Searches& searches,
                                            std::vector<VertexFit> known) {
  if (!known.empty()) return {std::move(known)};
  const std::vector<std::vector<Share>> nearest = nearest_of(w, drafts[i], searches[i]);
  std::vector<std::vector<VertexFit>> fits;
  for (const Neighborhood& near : neighborhoods) {
    const VarianceComponents own = near.all_sides ? components : components_of(w, drafts, near, i, searches);
    fits.push_back(fit_side(w, own, drafts[i], near, nearest, searches[i]));
  }
  return fits;
}

/// complete(i) for each side once its fits are there, on two threads that take as long: one begins with the middle side and leaves the rest
/// of it to the other (McNaughton 1959, "Scheduling with deadlines and loss functions").
template <class Complete>
void fit_sides(std::vector<SideFitting>& sides, const Complete& complete) {
  const auto finish = [&](int i) {
    sides[i].go_on(sides[i].left());
    complete(i);
  };
  const int last = sides[2].left(), all = sides[0].left() + sides[1].left() + last;
  if (!is_long(all)) {
    for (int i = 0; i < 3; ++i) finish(i);
    return;
  }
  std::promise<void> begun;
  std::future<void> is_begun = begun.get_future();
  both_at_once(
      [&] {
        const SerialScope serial;
        std::promise<void> kept_or_broken = std::move(begun);  // whatever is thrown
        sides[1].go_on(std::max(all / 2 - last, 0));
        kept_or_broken.set_value();
        finish(2);
      },
      [&] {
        const SerialScope serial;
        finish(0);
        is_begun.get();
        finish(1);
      });
}

/// Planes that are known before anything is estimated.
void take_known(const LocalMesh& w, const VertexPlanes& planes, std::array<SideDraft, 3>& drafts) {
  if (planes.empty()) return;
  for (SideDraft& side : drafts)
    for (std::size_t k = 0; k < side.vertex.size(); ++k)
      if (const auto known = planes.find(w.vertex(side.vertex[k])); known != planes.end()) side.normal[k] = known->second;
}

}  // namespace

MeshSides mesh_sides(const Mesh& mesh, const Connectivity& around, const Hole& hole, const VertexPlanes& planes) {
  const LocalMesh w = local_mesh(mesh, around, hole);
  std::array<SideDraft, 3> drafts = drafts_of(w, mesh, hole);
  Searches searches = {SideSearch(w, drafts, 0), SideSearch(w, drafts, 1), SideSearch(w, drafts, 2)};
  const VarianceComponents components = components_of(w, drafts, neighborhoods[0], -1, searches);
  const std::array<SideDraft, 3> guessed = drafts;  // what all threads read, while each completes its own side of the drafts
  std::array<SideFit, 3> fits;
  const double rough = roughness(guessed);
  const std::vector<std::vector<Share>> nobody_asks;
  std::vector<SideFitting> fittings;
  for (int i = 0; i < 3; ++i) fittings.emplace_back(w, components, guessed[i], neighborhoods[0], nobody_asks, searches[i]);
  fit_sides(fittings, [&](int i) {
    const std::vector<std::vector<VertexFit>> by_neighborhood = fits_of(w, components, guessed, i, searches, fittings[i].fits());
    fits[i] = choose(w, by_neighborhood, drafts[i], rough);
    take_cylinder(w, fits[i], drafts[i]);
  });
  take_flat_corners(w, fits, hole.alone, drafts);
  MeshSides result;
  const auto error = [](double variances, double vertices) {
    return vertices > 0 ? std::atan(std::sqrt(variances / vertices)) * 180 / std::numbers::pi : 0;
  };
  double variances = 0, vertices = 0;
  for (int i = 0; i < 3; ++i) {
    if (hole.alone[i]) continue;
    const double own = sum_of_variances(fits[i]);
    variances += own;
    vertices += static_cast<double>(drafts[i].vertex.size());
    result.side_error[i] = error(own, static_cast<double>(drafts[i].vertex.size()));
  }
  result.surroundings_error = error(variances, vertices);
  settle_corners(fits, hole.alone, drafts);
  take_known(w, planes, drafts);
  result.sides = side_curves(drafts, w.scale, components.noise);
  for (int i = 0; i < 3; ++i) {
    result.sides[i].curvature_error = std::sqrt(fits[i].bend_variance) / w.scale;
    result.parameters[i] = drafts[i].t;
    result.slope_variances[i] = std::move(fits[i].slope_variances);
  }
  return result;
}

MeshSides mesh_sides(const Mesh& mesh, const Hole& hole, const std::vector<Index>& replaced) {
  return mesh_sides(mesh, Connectivity::around(mesh, hole.rim, max_rings, replaced), hole);
}

}  // namespace tripatch
