#include "tripatch/output/shaped.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "tripatch/math/plane.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/messages.h"
#include "tripatch/report/dihedrals.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/plane_patch.h"

namespace tripatch {
namespace {

/// Of the hole's size, and times the slopes' own length: beyond, too few digits are left for the rim. A choice; what looks like a fill
/// at all is within ten.
constexpr double farthest = 1e6;
/// Degree of the polynomial that is multiplied by the squared distance from the rim, and its terms.
constexpr int shape_degree = 4, shape_terms = jet_size(shape_degree);
/// Places of the domain's bounding box, a side, at which energies are summed up.
constexpr int shape_grid = count::dozens;

using Terms = Eigen::Matrix<double, shape_terms, 1>;
using TermPoints = Eigen::Matrix<double, shape_terms, 3>;

/// A displacement over a plane domain: near the rim d B(rim) for the distance d from it, plus the squared distance times a polynomial.
struct Displacement {
  PlanePoints rim;                ///< places, loop after loop
  std::vector<std::size_t> next;  ///< row of the next vertex in the loop
  Points slopes;                  ///< B, by row of the rim
  TermPoints polynomial = TermPoints::Zero();
  Vec2 middle = Vec2::Zero();  ///< origin of the polynomial, and its unit
  double unit = 1;
  double sign = 1;  ///< of the rim's orientation

  /// The distance from the rim, half the reciprocal sum of the mean value weights; and the mean of B with these weights.
  template <int N>
  struct Place {
    Jet<N> distance;
    JetPoint<N> slope;
  };
  /// None on the rim itself, where along and across tell the edge.
  template <int N>
  std::optional<Place<N>> at(const Vec2& p) const;
  template <int N>
  JetPoint<N> displaced(const Vec2& p) const;
  /// Of the displacement on the rim: position does not move.
  template <int N>
  JetPoint<N> displaced_on_rim(const Vec2& p) const;
  /// The factors of the polynomial's coefficients.
  template <int N>
  std::array<Jet<N>, shape_terms> terms(const Vec2& p, const Jet<N>& distance) const;
};

template <int N>
std::optional<Displacement::Place<N>> Displacement::at(const Vec2& p) const {
  const auto x = [&](Index k, int axis) {
    return Jet<N>::linear(rim(k, axis) - p[axis], axis == 0 ? -1 : 0, axis == 0 ? 0 : -1);
  };
  Jet<N> sum;
  JetPoint<N> weighted;
  for (Index k = 0; k < rim.rows(); ++k) {
    const Index j = static_cast<Index>(next[static_cast<std::size_t>(k)]);
    const Jet<N> ax = x(k, 0), ay = x(k, 1), bx = x(j, 0), by = x(j, 1);
    const Jet<N> aa = ax * ax + ay * ay, bb = bx * bx + by * by;
    if (rim.row(k) == rim.row(j)) continue;
    if (aa.value() == 0 || bb.value() == 0) return {};
    const Jet<N> a = sqrt(aa), b = sqrt(bb), below = a * b + ax * bx + ay * by;
    if (below.value() <= tolerance::rounding * a.value() * b.value()) return {};
    const Jet<N> half_tangent = sign * (ax * by - ay * bx) / below;
    const Jet<N> at_first = half_tangent / a, at_second = half_tangent / b;
    sum += at_first + at_second;
    for (int c = 0; c < 3; ++c) weighted.x[c] += slopes(k, c) * at_first + slopes(j, c) * at_second;
  }
  const Jet<N> distance = 2.0 / sum;
  return Place<N>{distance, 0.5 * (distance * weighted)};
}

template <int N>
std::array<Jet<N>, shape_terms> Displacement::terms(const Vec2& p, const Jet<N>& distance) const {
  const Jet<N> u = Jet<N>::linear((p[0] - middle[0]) / unit, 1 / unit, 0),
               v = Jet<N>::linear((p[1] - middle[1]) / unit, 0, 1 / unit);
  std::array<Jet<N>, shape_terms> all;
  const Jet<N> d = distance * (1 / unit);
  all[0] = d * d;
  for (int degree = 1; degree <= shape_degree; ++degree)
    for (int j = 0; j <= degree; ++j)
      all[jet_index(degree - j, j)] = j < degree ? all[jet_index(degree - j - 1, j)] * u : all[jet_index(0, degree - 1)] * v;
  return all;
}

template <int N>
JetPoint<N> Displacement::displaced_on_rim(const Vec2& p) const {
  JetPoint<N> out;
  if constexpr (N > 0) {
    double least = std::numeric_limits<double>::infinity();
    for (Index k = 0; k < rim.rows(); ++k) {
      const Index j = static_cast<Index>(next[static_cast<std::size_t>(k)]);
      const Vec2 a = rim.row(k), way = Vec2(rim.row(j)) - a;
      const double length = way.norm(), t = length > 0 ? std::clamp(way.dot(p - a) / way.squaredNorm(), 0.0, 1.0) : 0;
      const double apart = (a + t * way - p).norm();
      if (!(apart < least) || length == 0) continue;
      least = apart;
      const Vec2 inward = sign * Vec2(-way[1], way[0]) / length;
      const Vec3 slope = (1 - t) * slopes.row(k) + t * slopes.row(j);
      for (int c = 0; c < 3; ++c) out.x[c] = Jet<N>::linear(0, slope[c] * inward[0], slope[c] * inward[1]);
    }
  }
  return out;
}

template <int N>
JetPoint<N> Displacement::displaced(const Vec2& p) const {
  const std::optional<Place<N>> place = at<N>(p);
  if (!place) return displaced_on_rim<N>(p);
  JetPoint<N> out = place->distance * place->slope;
  const std::array<Jet<N>, shape_terms> factors = terms<N>(p, place->distance);
  for (int k = 0; k < shape_terms; ++k)
    for (int c = 0; c < 3; ++c) out.x[c] += polynomial(k, c) * factors[k];
  return out;
}

/// A surface over a plane with a displacement.
class DisplacedSurface final : public Surface {
public:
  DisplacedSurface(SurfacePtr surface, std::shared_ptr<const Displacement> by)
      : surface_(std::move(surface)), by_(std::move(by)) {}
  void evaluate(const double* b, Index n, int order, double* out) const override {
    surface_->evaluate(b, n, order, out);
    with_order<0, max_order>(order, [&](auto constant) {
      constexpr int size = 3 * jet_size(constant.value);
      for (Index k = 0; k < n; ++k) {
        std::array<double, size> own;
        store(by_->displaced<constant.value>(Vec2(b[3 * k], b[3 * k + 1])), own.data());
        for (int c = 0; c < size; ++c) out[k * size + c] += own[c];
      }
    });
  }

private:
  SurfacePtr surface_;
  std::shared_ptr<const Displacement> by_;
};

bool is_inside(const Displacement& in, const Vec2& p) {
  bool inside = false;
  for (Index k = 0; k < in.rim.rows(); ++k) {
    const Vec2 a = in.rim.row(k), b = in.rim.row(static_cast<Index>(in.next[static_cast<std::size_t>(k)]));
    if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
  }
  return inside;
}

/// Loops of a rim, and no displacement.
Displacement over_rim(const Fill& fill, std::span<const std::size_t> islands) {
  Displacement made;
  made.rim = fill.rim_uv;
  made.slopes = Points::Zero(made.rim.rows(), 3);
  made.next.resize(static_cast<std::size_t>(made.rim.rows()));
  std::size_t first = 0, outer = made.next.size();
  for (const std::size_t island : islands) outer -= island;
  const auto add = [&](std::size_t count) {
    for (std::size_t k = 0; k < count; ++k) made.next[first + k] = first + (k + 1) % count;
    first += count;
  };
  add(outer);
  for (const std::size_t island : islands) add(island);
  double twice = 0, around = 0;
  Vec2 sum = Vec2::Zero();
  for (std::size_t k = 0; k < outer; ++k) {
    const Vec2 a = made.rim.row(static_cast<Index>(k)), b = made.rim.row(static_cast<Index>(made.next[k]));
    twice += a[0] * b[1] - a[1] * b[0];
    around += (b - a).norm();
    sum += (b - a).norm() * (a + b) / 2;
  }
  made.sign = twice < 0 ? -1 : 1;
  made.middle = sum / std::max(around, std::numeric_limits<double>::min());
  made.unit = (made.rim.rowwise() - made.middle.transpose()).rowwise().norm().maxCoeff();
  return made;
}

/// How much each vertex of the rim is to bulge, less one, of sides between the corners of the report.
Eigen::VectorXd excess_bulge(const Fill& fill, const BySide<double>& bulge) {
  const Index r = static_cast<Index>(fill.rim.size());
  const std::vector<Index>& corners = fill.report.corners;
  if (bulge.values().size() == 1) return Eigen::VectorXd::Constant(r, bulge[0] - 1);
  Eigen::VectorXd excess = Eigen::VectorXd::Zero(r);
  if (bulge.values().size() != corners.size()) return excess;
  std::vector<Index> places;
  for (Index v : corners) places.push_back(std::ranges::find(fill.rim, v) - fill.rim.begin());
  const std::size_t n = places.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double own = bulge[n == 3 ? (i + 2) % 3 : i] - 1;  // of three, side i is opposite corner i
    const Index count = ((places[(i + 1) % n] - places[i]) % r + r) % r;
    excess[places[i]] += own / 2;
    for (Index k = 1; k < count; ++k) excess[(places[i] + k) % r] = own;
    excess[places[(i + 1) % n]] += own / 2;
  }
  return excess;
}

/// Along the rim into the fill within its tangent planes, as long as the scale of the domain there asks for, times the bulge.
void set_bulge(const Mesh& mesh, const Fill& fill, const BySide<double>& bulge, Displacement& by) {
  const Eigen::VectorXd excess = excess_bulge(fill, bulge);
  std::vector<Index> before(by.next.size());
  for (std::size_t k = 0; k < by.next.size(); ++k) before[by.next[k]] = static_cast<Index>(k);
  for (Index k = 0; k < by.rim.rows(); ++k) {
    const auto row = static_cast<std::size_t>(k);
    const Index a = before[row], b = static_cast<Index>(by.next[row]);
    const auto at = [&](Index j) -> Vec3 { return mesh.vertices.row(fill.rim[static_cast<std::size_t>(j)]); };
    const double world = (at(b) - at(k)).norm() + (at(k) - at(a)).norm();
    const double plane = (by.rim.row(b) - by.rim.row(k)).norm() + (by.rim.row(k) - by.rim.row(a)).norm();
    const Vec3 along = (at(b) - at(k)).normalized() + (at(k) - at(a)).normalized();
    const Vec3 inward = Vec3(fill.rim_normals.row(k)).cross(along).stableNormalized();
    if (plane > 0) by.slopes.row(k) = excess[k] * world / plane * inward;
  }
}

/// Energies of what a polynomial adds: of second derivatives and, `tight` times, of first ones.
Eigen::Matrix<double, shape_terms, shape_terms> energy_of_terms(const Displacement& by, double tight) {
  Eigen::Matrix<double, shape_terms, shape_terms> energy;
  energy.setZero();
  const Vec2 low = by.rim.colwise().minCoeff(), high = by.rim.colwise().maxCoeff();
  for (int i = 0; i < shape_grid; ++i)
    for (int j = 0; j < shape_grid; ++j) {
      const Vec2 p = low + Vec2((i + 0.5) / shape_grid, (j + 0.5) / shape_grid).cwiseProduct(high - low);
      if (!is_inside(by, p)) continue;
      const auto place = by.at<2>(p);
      if (!place) continue;
      const std::array<Jet<2>, shape_terms> factors = by.terms<2>(p, place->distance);
      Eigen::Matrix<double, shape_terms, 5> rows;
      const double first = std::sqrt(tight) * by.unit, second = by.unit * by.unit;
      for (int k = 0; k < shape_terms; ++k) {
        const std::array<double, 6>& c = factors[k].c;
        rows.row(k) << first * c[1], first * c[2], 2 * second * c[3], std::sqrt(2.0) * second * c[4], 2 * second * c[5];
      }
      energy += rows * rows.transpose() * (high - low).prod() / (shape_grid * shape_grid * by.unit * by.unit);
    }
  // rim that leave no place of the grid inside have no energy: they are kept as they are
  energy.diagonal().array() += tolerance::rounding * energy.diagonal().maxCoeff() + std::numeric_limits<double>::min();
  return energy;
}

/// The products of the first derivatives of each term with those of the fill as it is, summed up over its triangles.
TermPoints pull_of_terms(const Mesh& mesh, const Fill& fill, const Displacement& by) {
  const Index n = mesh.vertices.rows();
  std::vector<std::pair<Index, Index>> row_of_rim;
  for (std::size_t k = 0; k < fill.rim.size(); ++k) row_of_rim.emplace_back(fill.rim[k], static_cast<Index>(k));
  std::ranges::sort(row_of_rim);
  const auto uv = [&](Index v) -> Vec2 {
    if (v >= n) return fill.uv.row(v - n);
    return fill.rim_uv.row(std::ranges::lower_bound(row_of_rim, std::pair(v, Index{0}))->second);
  };
  const auto at = [&](Index v) { return place_of(mesh, fill, v); };
  TermPoints pull = TermPoints::Zero();
  for (Index f = 0; f < fill.faces.size(); ++f) {
    const std::span<const Index> face = fill.faces[f];
    for (std::size_t k = 2; k < face.size(); ++k) {
      const std::array<Vec2, 3> q = {uv(face[0]), uv(face[k - 1]), uv(face[k])};
      const Vec2 a = q[1] - q[0], b = q[2] - q[0];
      const double twice = a[0] * b[1] - a[1] * b[0];
      if (!(std::abs(twice) > 0)) continue;
      const Vec3 p = at(face[0]), pa = at(face[k - 1]) - p, pb = at(face[k]) - p;
      const Vec3 by_u = (b[1] * pa - a[1] * pb) / twice, by_v = (a[0] * pb - b[0] * pa) / twice;
      for (int middle = 0; middle < 3; ++middle) {
        const Vec2 there = (q[middle] + q[(middle + 1) % 3]) / 2;
        const auto place = by.at<1>(there);
        if (!place) continue;
        const std::array<Jet<1>, shape_terms> factors = by.terms<1>(there, place->distance);
        for (int t = 0; t < shape_terms; ++t)
          pull.row(t) += std::abs(twice) / 6 * (factors[t].c[1] * by_u + factors[t].c[2] * by_v).transpose();
      }
    }
  }
  return pull;
}

/// Where the middle of a fill is: in the mean of its rim or, if that lies outside, farthest from the rim.
Vec2 middle_of(const Displacement& by) {
  if (is_inside(by, by.middle) && by.at<0>(by.middle)) return by.middle;
  const Vec2 low = by.rim.colwise().minCoeff(), high = by.rim.colwise().maxCoeff();
  Vec2 best = by.middle;
  double most = 0;
  for (int i = 0; i < shape_grid; ++i)
    for (int j = 0; j < shape_grid; ++j) {
      const Vec2 p = low + Vec2((i + 0.5) / shape_grid, (j + 0.5) / shape_grid).cwiseProduct(high - low);
      const auto place = is_inside(by, p) ? by.at<0>(p) : std::nullopt;
      if (!place || !(place->distance.value() > most)) continue;
      most = place->distance.value();
      best = p;
    }
  return best;
}

void displace(const Displacement& by, Fill& fill, const SurfacePtr& surface) {
  if (surface) {
    fill.patch = std::make_shared<PlanePatch>(
        std::make_shared<DisplacedSurface>(surface, std::make_shared<const Displacement>(by)), fill.rim_uv);
  }
  for (Index k = 0; k < fill.vertices.rows(); ++k) {
    const JetPoint<0> moved = by.displaced<0>(fill.uv.row(k));
    for (int c = 0; c < 3; ++c) fill.vertices(k, c) += moved.x[c].value();
  }
}

/// Position and normal at a place: of the patch, else of the vertex nearest to it.
std::pair<Vec3, Vec3> surface_at(const Fill& fill, const Vec2& place) {
  if (fill.patch) {
    const auto [position, normal] = fill.patch->positions_and_normals(as_rows(PlanePoints(place.transpose())));
    return {position.row(0), normal.row(0)};
  }
  Index nearest = 0;
  (fill.uv.rowwise() - place.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return {fill.vertices.row(nearest), fill.normals.row(nearest)};
}

void set_normals(const Mesh& mesh, Fill& fill) {
  if (fill.patch) {
    fill.normals = fill.patch->normals(as_rows(fill.uv));
    return;
  }
  Points all(mesh.vertices.rows() + fill.vertices.rows(), 3);
  all << mesh.vertices, fill.vertices;
  fill.normals = vertex_normals({all, fill.faces}).bottomRows(fill.vertices.rows());
}

}  // namespace

bool is_shaped(const FillOptions& options) {
  return options.tension > 0 || options.center || options.center_offset != 0 || !options.bulge.are_all(1);
}

FillOptions unshaped(FillOptions options) {
  static const FillOptions plain;
  options.bulge = plain.bulge;
  options.tension = plain.tension;
  options.center = plain.center;
  options.center_offset = plain.center_offset;
  return options;
}

bool can_be_shaped(const Fill& fill) {
  const Index r = static_cast<Index>(fill.rim.size());
  return fill.vertices.rows() > 0 && fill.uv.rows() == fill.vertices.rows() && fill.rim_uv.rows() == r &&
         fill.rim_normals.rows() == r;
}

void check_reach(double size, const Vec3& near, const FillOptions& options) {
  for (double bulge : options.bulge)
    if (!(bulge < farthest)) throw CodedArgument(Code::out_of_range, {{"name", "bulge"}, {"below", farthest}, {"value", bulge}});
  const double most = farthest * size;
  if (std::abs(options.center_offset) > most || (options.center && !((*options.center - near).stableNorm() <= most)))
    throw CodedRefusal(Code::center_too_far, {{"option", options.center ? "center" : "center_offset"}});
}

std::vector<std::vector<Index>> loops_of(const std::vector<Index>& rim, std::span<const std::size_t> islands) {
  std::size_t outer = rim.size();
  for (const std::size_t island : islands) outer -= island;
  auto at = rim.begin() + static_cast<std::ptrdiff_t>(outer);
  std::vector<std::vector<Index>> loops = {{rim.begin(), at}};
  for (const std::size_t island : islands) {
    loops.emplace_back(at, at + static_cast<std::ptrdiff_t>(island));
    at += static_cast<std::ptrdiff_t>(island);
  }
  return loops;
}

void shape(const Mesh& mesh, const Connectivity& around, std::span<const std::size_t> islands, const FillOptions& options,
           Fill& fill) {
  if (!is_shaped(options) || !options.through.empty() || !can_be_shaped(fill)) return;
  const SurfacePtr surface = fill.patch;
  Displacement by = over_rim(fill, islands);
  const Points border = mesh.vertices(fill.rim, Eigen::all);
  check_reach((border.colwise().maxCoeff() - border.colwise().minCoeff()).norm(), border.row(0), options);
  if (!options.bulge.are_all(1)) set_bulge(mesh, fill, options.bulge, by);
  const double tight = options.tension * std::numbers::pi * std::numbers::pi;
  if (options.tension > 0 || options.center || options.center_offset != 0) {
    const Eigen::LDLT<Eigen::Matrix<double, shape_terms, shape_terms>> energy(energy_of_terms(by, tight));
    if (options.tension > 0) by.polynomial = -tight * energy.solve(pull_of_terms(mesh, fill, by));
    const Vec2 middle = middle_of(by);
    const auto place = by.at<0>(middle);
    if (place && (options.center || options.center_offset != 0)) {
      Fill tightened = fill;
      displace(by, tightened, surface);
      set_normals(mesh, tightened);
      const auto [position, normal] = surface_at(tightened, middle);
      const Vec3 lift = options.center ? Vec3(*options.center - position) : Vec3(options.center_offset * normal);
      const std::array<Jet<0>, shape_terms> factors = by.terms<0>(middle, place->distance);
      Terms at_middle;
      for (int k = 0; k < shape_terms; ++k) at_middle[k] = factors[k].value();
      const Terms bump = energy.solve(at_middle);
      by.polynomial += bump / at_middle.dot(bump) * lift.transpose();
    }
  }
  displace(by, fill, surface);
  set_normals(mesh, fill);
  measure_faces(mesh, fill.vertices, fill.faces, faces_beyond(mesh, around, loops_of(fill.rim, islands)), fill.report);
}

}  // namespace tripatch
