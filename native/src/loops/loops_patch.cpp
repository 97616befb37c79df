#include "tripatch/loops/loops_patch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "tripatch/math/angle.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/output/remesh.h"
#include "tripatch/patch/seam.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/hermite_correction.h"
#include "tripatch/spline/polyharmonic_spline.h"
#include "tripatch/triangulation/plane_triangles.h"

namespace tripatch {
namespace {

/// Points at which the base meets the sides, all loops together.
constexpr double base_points = count::cubic;
constexpr int least_base_points = count::few;  ///< of an edge
/// The kernel r^5, as that of HermiteCorrection: its sums keep all but a few digits.
constexpr double base_order = 3.5;
/// An edge of the domain turns by no more degrees than this; a choice: its ends are corners of the domain, where the patch has none.
constexpr double edge_turn = angle::bend;
/// Of the size, or of a unit vector: how well polynomials fit what the base lacks. Far below what is seen, above rounding.
constexpr double lack_tolerance = 1e-11;
constexpr int lack_degree = count::degree, lack_depth = count::few;
/// Edges a side on which folds are looked for.
constexpr int fold_edges = count::dozens;

Vec2 left_of(const Vec2& from, const Vec2& to) {
  const Vec2 way = (to - from).normalized();
  return {-way[1], way[0]};
}

/// A part of a side before there is a base.
struct Part {
  Side side;
  Vec2 from, to;
  int points = least_base_points;  ///< at which the base meets it, at equal steps
};

/// A plane, its normal on the outer side of the patch.
struct Frame {
  Vec3 origin, u, v;
  Vec2 operator()(const Vec3& p) const { return {u.dot(p - origin), v.dot(p - origin)}; }
};

Frame frame_of(const SideList& outline) {
  std::vector<Vec3> points;
  for (const Side& side : outline)
    for (int k = 0; k < fold_edges; ++k) points.push_back(side.c(static_cast<double>(k) / fold_edges));
  Vec3 area = Vec3::Zero(), middle = Vec3::Zero();
  for (const Vec3& p : points) middle += p / static_cast<double>(points.size());
  for (std::size_t k = 0; k < points.size(); ++k) area += (points[k] - middle).cross(points[(k + 1) % points.size()] - middle);
  const Vec3 normal = area.stableNormalized(), along = outline[0].c(1) - outline[0].c(0);
  const Vec3 u = (along - along.dot(normal) * normal).stableNormalized();
  return {middle, u, normal.cross(u)};
}

/// By how many degrees a side turns in the plane.
double turn_in(const Frame& frame, const Side& side) {
  double turn = 0;
  const auto way = [&](double t) -> Vec3 {
    return as_rows(PlanePoints(frame(frame.origin + side.c.derivative_at(t)).transpose())).row(0);
  };
  for (int k = 0; k < fold_edges; ++k) {
    const double t = static_cast<double>(k) / fold_edges;
    turn += degrees_between(way(t), way(t + 1.0 / fold_edges));
  }
  return turn;
}

std::vector<Part> parts_of(const Frame& frame, const Side& side) {
  const int count = std::max(1, static_cast<int>(std::ceil(turn_in(frame, side) / edge_turn - tolerance::same)));
  std::vector<Part> parts;
  for (int k = 0; k < count; ++k) {
    const Side piece = count == 1 ? side : piece_of(side, static_cast<double>(k) / count, (k + 1.0) / count);
    parts.push_back({.side = piece, .from = frame(piece.c(0)), .to = frame(piece.c(1))});
  }
  return parts;
}

/// How many points each part has; returns the step between them.
double set_points(std::vector<Part>& parts) {
  double around = 0;
  for (const Part& part : parts) around += (part.to - part.from).norm();
  for (Part& part : parts)
    part.points = std::max(part.points, static_cast<int>(std::ceil(base_points * (part.to - part.from).norm() / around)));
  return around / base_points;
}

/// A surface through points of the parts that has their normals. step: between the points.
SurfacePtr base_of(const std::vector<Part>& parts, double step) {
  Index n = 0, row = 0;
  for (const Part& part : parts) n += part.points;
  PlanePoints uv(n, 2);
  Points points(n, 3), normals(n, 3);
  for (const Part& part : parts)
    for (int k = 0; k < part.points; ++k, ++row) {
      const double t = static_cast<double>(k) / part.points;
      uv.row(row) = part.from + t * (part.to - part.from);
      points.row(row) = part.side.c(t);
      normals.row(row) = part.side.normal(t);
    }
  const FieldOptions options = {.orders = {base_order}, .unit = step, .centers = n};
  const SurfacePtr field = std::make_shared<PolyharmonicSpline>(uv, points, options);
  return sum(field, std::make_shared<HermiteCorrection>(*field, uv, PlanePoints(0, 2), std::vector<Through>(), normals));
}

/// What LoopsSurface::Edge says, at parameters of a part.
void lacks_at(const Surface& base, const Part& part, double size, std::span<const double> t, std::span<double> out) {
  const Vec2 inside = left_of(part.from, part.to);
  const Index n = static_cast<Index>(t.size());
  PlanePoints places(n, 2);
  for (Index k = 0; k < n; ++k) places.row(k) = part.from + t[static_cast<std::size_t>(k)] * (part.to - part.from);
  std::vector<double> jets(static_cast<std::size_t>(9 * n));
  base.evaluate(as_rows(places).data(), n, 1, jets.data());
  for (Index k = 0; k < n; ++k) {
    const double* jet = &jets[static_cast<std::size_t>(9 * k)];
    const double at = t[static_cast<std::size_t>(k)];
    const Vec3 off = (part.side.c(at) - Vec3::Map(jet)) / size, normal = part.side.normal(at);
    const Vec3 slope = inside[0] * Vec3::Map(jet + 3) + inside[1] * Vec3::Map(jet + 6);
    Vec3::Map(&out[static_cast<std::size_t>(6 * k)]) = off.array() + 1;
    Vec3::Map(&out[static_cast<std::size_t>(6 * k + 3)]) = (-slope.dot(normal) * normal).array() + 1;
  }
}

/// The base is smooth between the points that it goes through.
PiecewisePolynomial lacking(const Surface& base, const Part& part, double size) {
  std::vector<PiecewisePolynomial> pieces;
  for (int k = 0; k < part.points; ++k)
    pieces.push_back(PiecewisePolynomial::fit(
        [&](std::span<const double> t, std::span<double> out) {
          std::vector<double> own(t.begin(), t.end());
          for (double& each : own) each = (k + each) / part.points;
          lacks_at(base, part, size, own, out);
        },
        6, lack_tolerance, lack_degree, lack_depth));
  return PiecewisePolynomial::joined(pieces);
}

/// Rows of the first vertex of each loop after the first.
std::vector<Index> starts_of(const std::vector<Index>& sizes) {
  std::vector<Index> starts;
  Index row = 0;
  for (std::size_t k = 0; k + 1 < sizes.size(); ++k) starts.push_back(row += sizes[k]);
  return starts;
}

/// Twice the area that loops enclose together.
double area_within(const PlanePoints& uv, const std::vector<Index>& starts) {
  double area = 0;
  Index first = 0;
  for (std::size_t k = 0; k <= starts.size(); ++k) {
    const Index end = k < starts.size() ? starts[k] : uv.rows();
    for (Index a = first; a < end; ++a) {
      const Index b = a + 1 < end ? a + 1 : first;
      area += uv(a, 0) * uv(b, 1) - uv(a, 1) * uv(b, 0);
    }
    first = end;
  }
  return area;
}

bool is_over_plane(const PlanePoints& uv, const std::vector<Index>& starts) {
  const Triangles triangles = triangulate_bridged(uv, starts);
  double area = 0;
  for (const std::array<Index, 3>& t : triangles) {
    const Eigen::RowVector2d a = uv.row(t[1]) - uv.row(t[0]), b = uv.row(t[2]) - uv.row(t[0]);
    area += a[0] * b[1] - a[1] * b[0];
  }
  const double whole = area_within(uv, starts);
  return all_positive(uv, triangles) && std::abs(area - whole) < tolerance::solved * whole;
}

void check_domain(const std::vector<Part>& parts, const std::vector<Index>& sizes) {
  PlanePoints corners(static_cast<Index>(parts.size()), 2);
  for (Index k = 0; k < corners.rows(); ++k) corners.row(k) = parts[static_cast<std::size_t>(k)].from;
  if (!is_over_plane(corners, starts_of(sizes))) throw CodedRefusal(Code::loops_not_over_plane);
}

}  // namespace

Vec2 LoopsSurface::on_side(std::size_t side, double t) const {
  const auto [first, count] = sides_[side];
  const double along = t * static_cast<double>(count);
  const std::size_t part = std::min(static_cast<std::size_t>(along), count - 1);
  const Edge& edge = edges_[first + part];
  return edge.from + (along - static_cast<double>(part)) * (edge.to - edge.from);
}

template <int N>
JetPoint<N> LoopsSurface::at(const Vec2& place) const {
  Vec2 p = place;
  const Edge* corner = nullptr;
  for (const Edge& edge : edges_)
    if ((place - edge.from).norm() < tolerance::solved * size_) {
      corner = &edge;
      p = edge.from + tolerance::solved * size_ * (edge.to - edge.from).normalized();
    }
  const std::array<double, 3> row = {p[0], p[1], 0};
  std::array<double, 3 * jet_size(N)> jet;
  base_->evaluate(row.data(), 1, N, jet.data());
  JetPoint<N> sum, base;
  for (int c = 0; c < jet_size(N); ++c)
    for (int x = 0; x < 3; ++x) base.x[x].c[c] = jet[3 * c + x];

  const std::size_t n = edges_.size();
  const Jet<N> u = Jet<N>::linear(p[0], 1, 0), v = Jet<N>::linear(p[1], 0, 1);
  std::vector<Jet<N>> share(n), distance(n), before(n + 1, Jet<N>(1.0));  // distance: zero on the edge only, squared
  for (std::size_t k = 0; k < n; ++k) {
    const Edge& edge = edges_[k];
    const auto to = [&](const Vec2& end) { return sqrt(square(u - end[0]) + square(v - end[1])); };
    const Jet<N> first = to(edge.from), both = first + to(edge.to);
    share[k] = first / both;
    distance[k] = (square(both) - (edge.to - edge.from).squaredNorm()) * (1 / (size_ * size_));
    before[k + 1] = before[k] * distance[k];
  }
  Jet<N> after(1.0), weights;
  for (std::size_t k = n; k-- > 0;) {
    const Edge& edge = edges_[k];
    const Jet<N> weight = before[k] * after;
    after *= distance[k];
    weights += weight;
    const Vec2 inside = left_of(edge.from, edge.to);
    const Jet<N> in = inside[0] * (u - edge.from[0]) + inside[1] * (v - edge.from[1]);
    std::array<double, 6 * (N + 1)> lacks;
    edge.lacks.taylor(share[k].value(), N, lacks.data());
    for (int x = 0; x < 3; ++x) {
      const Jet<N> off = size_ * (compose<N>(&lacks[x], 6, share[k]) - 1.0), slope = compose<N>(&lacks[3 + x], 6, share[k]) - 1.0;
      sum.x[x] += weight * (off + in * slope);
    }
  }
  JetPoint<N> made = base + reciprocal(weights) * sum;
  if (corner)
    for (int x = 0; x < 3; ++x) made.x[x].c[0] = corner->corner[x];
  return made;
}

void LoopsSurface::evaluate(const double* b, Index n, int order, double* out) const {
  with_order<0, max_order>(order, [&](auto constant) {
    double* next = out;
    for (Index k = 0; k < n; ++k) next = store(at<constant.value>({b[3 * k], b[3 * k + 1]}), next);
  });
}

LoopsTriangles triangulate_loops(const LoopsSurface& patch, const std::vector<std::vector<double>>& parameters,
                                 std::optional<int> resolution) {
  std::vector<Vec2> places;
  std::vector<Index> sizes;
  std::size_t side = 0;
  for (const std::size_t count : patch.loops()) {
    const std::size_t first = places.size();
    for (std::size_t k = 0; k < count; ++k, ++side)
      for (std::size_t j = 0; j + 1 < parameters[side].size(); ++j) places.push_back(patch.on_side(side, parameters[side][j]));
    sizes.push_back(static_cast<Index>(places.size() - first));
  }
  PlanePolygon polygon;
  polygon.uv.resize(static_cast<Index>(places.size()), 2);
  for (Index k = 0; k < polygon.uv.rows(); ++k) polygon.uv.row(k) = places[static_cast<std::size_t>(k)];
  polygon.points = patch.positions(as_rows(polygon.uv));
  polygon.rim = polygon.uv.rows();
  polygon.sides = static_cast<int>(patch.sides());
  polygon.triangles = triangulate_bridged(polygon.uv, starts_of(sizes));
  if (polygon.triangles.empty()) throw CodedRefusal(Code::loops_not_over_plane);
  PlaneTriangulation made = remesh(polygon, resolution, patch);
  return {std::move(made.uv), std::move(made.triangles)};
}

LoopsPatch loops_patch(const std::vector<SideList>& loops) {
  LoopsPatch made;
  std::vector<SideList> given;
  for (const SideList& loop : loops) given.push_back(loop.size() == 1 ? loop : closed(loop));
  const Frame frame = frame_of(given[0]);
  std::vector<Part> parts;
  std::vector<LoopsSurface::Span> sides;
  std::vector<std::size_t> counts;
  std::vector<Index> sizes;
  for (const SideList& loop : given) {
    const std::size_t before = parts.size();
    for (const Side& side : loop) {
      const std::vector<Part> own = parts_of(frame, side);
      sides.push_back({parts.size(), own.size()});
      parts.insert(parts.end(), own.begin(), own.end());
    }
    counts.push_back(loop.size());
    sizes.push_back(static_cast<Index>(parts.size() - before));
    for (std::size_t k = before; k < parts.size(); ++k)  // to the last bit
      parts[k].to = parts[k + 1 < parts.size() ? k + 1 : before].from;
  }
  check_domain(parts, sizes);
  for (const Part& part : parts) made.size = std::max(made.size, (part.side.c(0) - parts[0].side.c(0)).norm());
  const double step = set_points(parts);
  const SurfacePtr base = base_of(parts, step);
  std::vector<LoopsSurface::Edge> edges;
  for (const Part& part : parts) edges.push_back({part.from, part.to, part.side.c(0), lacking(*base, part, made.size)});
  made.patch = std::make_shared<LoopsSurface>(base, std::move(edges), sides, counts, made.size);

  std::vector<std::vector<double>> parameters(sides.size());
  std::size_t number = 0;
  for (const SideList& loop : given)
    for (const Side& side : loop) {
      PlanePoints places(seam_samples, 2);
      Points points(seam_samples, 3), normals(seam_samples, 3);
      for (int k = 0; k < seam_samples; ++k) {
        const double t = static_cast<double>(k) / (seam_samples - 1);
        places.row(k) = made.patch->on_side(number, t);
        points.row(k) = side.c(t);
        normals.row(k) = side.normal(t);
      }
      made.seams.push_back(seam_of(*made.patch, as_rows(places), points, normals));
      for (int k = 0; k <= fold_edges; ++k) parameters[number].push_back(static_cast<double>(k) / fold_edges);
      ++number;
    }
  const LoopsTriangles cover = triangulate_loops(*made.patch, parameters, {});
  made.folds = count_folded_edges(made.patch->positions(as_rows(cover.uv)), cover.triangles, {});
  return made;
}

}  // namespace tripatch
