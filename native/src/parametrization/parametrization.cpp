#include "tripatch/parametrization/parametrization.h"

#include <Eigen/Dense>
#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "tripatch/math/block_ldlt.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/parametrization/layout_mesh.h"
#include "tripatch/parametrization/tutte_system.h"

namespace tripatch {
namespace {

using Triangle = LayoutMesh::Triangle;
using Matrix2 = Eigen::Matrix2d;
using Sparse = Eigen::SparseMatrix<double>;

/// Of a triangle that closes an inner hole, times its area: as good as free to deform, within 1% of what a tube's end is without it.
constexpr double weight_of_filled = 1e-2;
/// Of the weights of Tutte's embedding, which must be positive. Only where the layout begins depends on it, and on the next four.
constexpr double min_cotangent = 0.05;
/// Of the mean edge of the border: shorter ones are that long on the circle of the embedding, where none has no length.
constexpr double min_border_edge = share::hundredth;
/// Of the embedding. A finger six radii long begins at an energy of 395 without any, 20 with two and 13 with these; it ends at 10.
constexpr int reweightings = count::several;
/// Of the energy before: a reweighting that leaves more is the last.
constexpr double enough_gained = 0.99;
/// Of a step, until it gains that: after so many it is rounding.
constexpr int halvings = count::halvings;
/// A step of Newton's that leaves more than rounding is refined, so many times at most. Next to thin triangles the matrix has
/// lost the digits of how they move as a whole, and later steps enlarge the rounding of a step up to a million times. On meshes
/// stretched by 1000 two refinements leave 1e-13; others need none, or one.
constexpr int max_refinements = count::several;
/// Of what was left before: more, and it is the rounding of what is left itself.
constexpr double still_refines = share::half;
/// Energy of a start from which the way to the end is long: rounding grows on it up to a million times, and stays where it is left early. To the
/// end of such layouts the tolerance is smaller, and there are so many times more steps. Of 1,658 layouts in even, bumpy and
/// noisy meshes 2% begin with more, of 155 in known surfaces and scanned meshes none.
constexpr double hard = factor::extreme;
constexpr int hard_iterations = count::half_dozen;
/// Of the energy before: steps that take less, of such a layout, are made with the Hessian as it is, where that is definite. Without its
/// indefinite parts the last steps each leave a part of what was left: 120 of them end where 200 did not.
constexpr double near_its_end = share::tenth;
/// Of the way to where the first triangle loses its area: as far as a step goes. With 0.54 of it 72 fills (reference.cpp) are 1.5% farther.
constexpr double to_barrier = share::nearly_all;

/// A triangle in space: gradients of its three hat functions in its own plane, and its share of the energy.
struct Shape {
  std::array<Vec2, 3> gradient;
  std::array<double, 3> cotangent;  // at its corners
  double weight;
};

Shape shape_of(const Vec3& a, const Vec3& b, const Vec3& c, double shortest) {
  const std::array<Vec3, 3> x = {a, b, c};
  int base = 0;
  double length = -1;
  for (int k = 0; k < 3; ++k)
    if (const double l = (x[(k + 1) % 3] - x[k]).norm(); clearly_more(l, length)) length = l, base = k;
  const Vec3 e = x[(base + 1) % 3] - x[base], u = x[(base + 2) % 3] - x[base];
  double foot = length > 0 ? std::clamp(e.dot(u) / length, 0.0, length) : 0, height = length > 0 ? e.cross(u).norm() / length : 0;
  if (length < shortest) {
    length = shortest;
    foot = std::min(foot, length);
  }
  height = std::max(height, tolerance::slight * length);
  Shape shape;
  shape.weight = length * height / 2;
  shape.gradient[base] = Vec2(-1 / length, (foot / length - 1) / height);
  shape.gradient[(base + 1) % 3] = Vec2(1 / length, -foot / length / height);
  shape.gradient[(base + 2) % 3] = Vec2(0, 1 / height);
  for (int k = 0; k < 3; ++k)  // grad_i . grad_j = -cot(k) / (2 area)
    shape.cotangent[k] = -2 * shape.weight * shape.gradient[(k + 1) % 3].dot(shape.gradient[(k + 2) % 3]);
  return shape;
}

class Problem {
public:
  Problem(const PointsRef& points, const LayoutMesh& disc) : disc_(disc), n_(disc.count) {
    const int known = static_cast<int>(disc.vertices.size());
    std::vector<Vec3> x(n_, Vec3::Zero());
    const Vec3 origin = points.row(disc.vertices[0]);
    for (int v = 0; v < known; ++v) x[v] = Vec3(points.row(disc.vertices[v])) - origin;
    for (std::size_t l = 0; l < disc.filled.size(); ++l) {
      for (int v : disc.filled[l]) x[known + l] += x[v];
      x[known + l] /= static_cast<double>(disc.filled[l].size());
    }
    double area = 0, squares = 0;
    for (std::size_t t = 0; t < disc.real; ++t) {
      const auto& [a, b, c] = disc.triangles[t];
      area += (x[b] - x[a]).cross(x[c] - x[a]).norm() / 2;
      squares += (x[b] - x[a]).squaredNorm() + (x[c] - x[b]).squaredNorm() + (x[a] - x[c]).squaredNorm();
    }
    area_ = area;
    const double whole = std::max(area, tolerance::slight * squares);
    scale_ = whole > 0 ? std::sqrt(whole) : 1;
    for (Vec3& p : x) p /= scale_;
    const double shortest = tolerance::close / std::sqrt(static_cast<double>(disc.triangles.size()));
    double weights = 0;
    for (std::size_t t = 0; t < disc.triangles.size(); ++t) {
      const auto& [a, b, c] = disc.triangles[t];
      shapes_.push_back(shape_of(x[a], x[b], x[c], shortest));
      if (t >= disc.real) shapes_.back().weight *= weight_of_filled;
      weights += shapes_.back().weight;
    }
    for (Shape& s : shapes_) s.weight /= weights;
    border_angles(x);
    order();
  }

  double scale() const { return scale_; }
  double area() const { return area_; }

  Matrix2 jacobian(std::size_t t, const PlanePoints& uv) const {
    Matrix2 J = Matrix2::Zero();
    for (int k = 0; k < 3; ++k) J += uv.row(disc_.triangles[t][k]).transpose() * shapes_[t].gradient[k].transpose();
    return J;
  }

  /// Infinite where a triangle is turned over or has lost its area.
  double energy(const PlanePoints& uv) const {
    check_interruption();
    double sum = 0;
    for (std::size_t t = 0; t < shapes_.size(); ++t) {
      const Matrix2 J = jacobian(t, uv);
      const double det = J.determinant(), square = J.squaredNorm();
      if (!(det > 0)) return std::numeric_limits<double>::infinity();
      sum += shapes_[t].weight * square * (1 + 1 / (det * det));
    }
    return std::isfinite(sum) ? sum : std::numeric_limits<double>::infinity();
  }

  /// Scales uv to the least energy of all sizes; false where that is infinite.
  bool resize(PlanePoints& uv) const {
    double squares = 0, inverse = 0;
    for (std::size_t t = 0; t < shapes_.size(); ++t) {
      const Matrix2 J = jacobian(t, uv);
      const double det = J.determinant(), square = shapes_[t].weight * J.squaredNorm();
      if (!(det > 0)) return false;
      squares += square;
      inverse += square / (det * det);
    }
    if (!std::isfinite(squares + inverse)) return false;
    uv *= std::pow(inverse / squares, 0.25);
    return true;
  }

  /// Tutte's embedding, its weights made again some times so that triangles that come out small get larger; of those that turn
  /// nothing over the one of the least energy.
  std::optional<PlanePoints> tutte() const {
    std::vector<double> conductance(shapes_.size(), 1);
    TutteSystem system(disc_, angle_, rank_);
    std::optional<PlanePoints> best;
    double least = std::numeric_limits<double>::infinity(), previous = least;
    for (int round = 0; round <= reweightings; ++round) {
      PlanePoints uv = system.solved(
          [&](std::size_t t, int k) { return conductance[t] * std::max(shapes_[t].cotangent[(k + 2) % 3], min_cotangent); });
      const double found = resize(uv) ? energy(uv) : std::numeric_limits<double>::infinity();
      if (found < least) least = found, best = uv;
      if (round > 0 && best && !(found < enough_gained * previous)) break;
      previous = found;
      for (std::size_t t = 0; t < shapes_.size(); ++t)
        conductance[t] *= std::sqrt(std::max(std::abs(jacobian(t, uv).determinant()), tolerance::rounding));
    }
    return best;
  }

  /// One step of Newton's method; false where nothing is gained. whole: with the Hessian as it is, if that is definite.
  bool step(PlanePoints& uv, double& now, bool whole) {
    assemble(uv, whole);
    bool is_regular = hessian_.factorize();
    if (whole && !(is_regular && hessian_.is_definite())) {
      assemble(uv, false);
      is_regular = hessian_.factorize();
    }
    if (!is_regular) return false;
    Eigen::VectorXd way = -hessian_.solve(gradient_);
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < max_refinements; ++round) {
      const Eigen::VectorXd left = gradient_ + times_hessian(way);
      const double size = left.norm();
      if (size <= tolerance::fit * gradient_.norm() || size > still_refines * before) break;
      before = size;
      way -= hessian_.solve(left);
    }
    PlanePoints d(n_, 2);
    for (int v = 0; v < n_; ++v) d.row(v) = way.segment<2>(2 * rank_[v]);
    hold_still(uv, d);
    const double slope = gradient_.dot(way);
    if (!(slope < 0)) return false;
    const double limit = to_barrier * to_first_flip(uv, d);
    double length = std::min(1.0, limit), then = now;
    PlanePoints moved;
    for (int attempt = 0;; ++attempt, length *= 0.5) {
      if (attempt == halvings) return false;
      moved = uv + length * d;
      then = energy(moved);
      if (then < now && then <= now + tolerance::close * length * slope) break;
    }
    // Where the indefinite parts that were left out are large, Newton's step is too short.
    while (length >= 1 && 2 * length <= limit) {
      const PlanePoints farther = uv + 2 * length * d;
      const double there = energy(farther);
      if (!(there < then)) break;
      moved = farther;
      then = there;
      length *= 2;
    }
    uv = moved;
    now = then;
    return true;
  }

private:
  /// Takes shifts and turns of the whole out of a step: the Hessian does not see them, and they are all rounding.
  static void hold_still(const PlanePoints& uv, PlanePoints& d) {
    d.rowwise() -= Eigen::RowVector2d(d.colwise().mean());
    const PlanePoints about = uv.rowwise() - Eigen::RowVector2d(uv.colwise().mean());
    const double turn =
        (about.col(0).dot(d.col(1)) - about.col(1).dot(d.col(0))) / std::max(about.squaredNorm(), tolerance::tiny);
    d.col(0) += turn * about.col(1);
    d.col(1) -= turn * about.col(0);
  }

  void border_angles(const std::vector<Vec3>& x) {
    const std::size_t n = disc_.border.size();
    std::vector<double> length(n);
    for (std::size_t k = 0; k < n; ++k) length[k] = (x[disc_.border[(k + 1) % n]] - x[disc_.border[k]]).norm();
    const double all = std::accumulate(length.begin(), length.end(), 0.0);
    for (double& l : length) l = std::max(l, min_border_edge * all / static_cast<double>(n));
    const double sum = std::accumulate(length.begin(), length.end(), 0.0);
    const double turn = sum > 0 ? 2 * EIGEN_PI / sum : 0;
    double along = 0;
    for (std::size_t k = 0; k < n; ++k) {
      angle_.push_back(sum > 0 ? turn * along : 2 * EIGEN_PI * static_cast<double>(k) / static_cast<double>(n));
      along += length[k];
    }
  }

  /// An order of elimination for the vertices, and the pattern of the Hessian in it: a 2 x 2 block for each edge.
  void order() {
    std::vector<Eigen::Triplet<double>> ones;
    ones.reserve(3 * disc_.triangles.size() + disc_.border.size() + static_cast<std::size_t>(n_));
    for (const Triangle& t : disc_.triangles)  // of two next to an edge each takes it in its own direction
      for (int k = 0; k < 3; ++k) ones.emplace_back(t[k], t[(k + 1) % 3], 1);
    for (std::size_t k = 0; k < disc_.border.size(); ++k)
      ones.emplace_back(disc_.border[(k + 1) % disc_.border.size()], disc_.border[k], 1);
    for (int v = 0; v < n_; ++v) ones.emplace_back(v, v, 1);
    Sparse pattern(n_, n_);
    pattern.setFromTriplets(ones.begin(), ones.end());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> inverse;
    Eigen::AMDOrdering<int>()(pattern, inverse);
    rank_.resize(n_);
    for (int k = 0; k < n_; ++k) rank_[inverse.indices()[k]] = k;
    std::vector<std::vector<int>> before(n_);
    for (int c = 0; c < n_; ++c) {
      const int k = rank_[c];
      before[k].reserve(static_cast<std::size_t>(pattern.col(c).nonZeros()));
      for (Sparse::InnerIterator it(pattern, c); it; ++it)
        if (const int other = rank_[static_cast<int>(it.row())]; other < k) before[k].push_back(other);
    }
    for (std::vector<int>& columns : before) std::sort(columns.begin(), columns.end());
    hessian_ = BlockLdlt(before);
    for (const Triangle& t : disc_.triangles)
      for (int k = 0; k < 3; ++k) {
        const int p = rank_[t[k]], q = rank_[t[(k + 1) % 3]];
        block_.push_back(hessian_.place(std::max(p, q), std::min(p, q)));
      }
  }

  void assemble(const PlanePoints& uv, bool whole) {
    hessian_.clear();
    gradient_.setZero(2 * n_);
    modes_.resize(shapes_.size());
    for (std::size_t t = 0; t < shapes_.size(); ++t) {
      modes_[t] = modes_of(t, uv, whole);
      const Local local = local_of(t);
      for (int k = 0; k < 3; ++k) {
        const int p = rank_[disc_.triangles[t][k]];
        gradient_.segment<2>(2 * p) += local.gradient[k];
        Eigen::Map<Matrix2>(hessian_.diagonal(p)) += local.own[k];
        Eigen::Map<Matrix2>(hessian_.block(block_[3 * t + k])) += local.beside[k];
      }
    }
    double trace = 0;
    for (int v = 0; v < n_; ++v) trace += hessian_.diagonal(v)[0] + hessian_.diagonal(v)[3];
    shift_ = tolerance::solved * trace / (2 * n_);
    for (int v = 0; v < n_; ++v) {
      hessian_.diagonal(v)[0] += shift_;
      hessian_.diagonal(v)[3] += shift_;
    }
  }

  /// The definite part of a triangle's second derivative by J = U diag(s) V', as a sum of squares: of the two stretches, the turn and the
  /// mirrored turn; and the slopes along the first two.
  struct Modes {
    std::array<Matrix2, 4> mode;
    std::array<double, 4> value;
    std::array<double, 2> slope;
  };

  Modes modes_of(std::size_t t, const PlanePoints& uv, bool whole) const {
    const Matrix2 J = jacobian(t, uv);
    // J = [e -q; q e] + [f p; p -f]: lengths and directions of the two tell its singular values, and all that its singular vectors do here
    const double e = (J(0, 0) + J(1, 1)) / 2, f = (J(0, 0) - J(1, 1)) / 2, p = (J(1, 0) + J(0, 1)) / 2,
                 q = (J(1, 0) - J(0, 1)) / 2;
    const double alike = Vec2(e, q).norm(), unlike = Vec2(f, p).norm();
    const double s1 = alike + unlike, s2 = J.determinant() / s1;
    const Vec2 turn_to = Vec2(e, q) / alike, mirror_to = unlike > 0 ? Vec2(Vec2(f, p) / unlike) : Vec2(1, 0);
    Matrix2 turned, flipped;
    turned << turn_to[0], -turn_to[1], turn_to[1], turn_to[0];
    flipped << mirror_to[0], mirror_to[1], mirror_to[1], -mirror_to[0];
    const auto slope = [](double s) { return 2 * s - 2 / (s * s * s); };
    const auto bend = [](double s) { return 2 + 6 / (s * s * s * s); };
    const double w = shapes_[t].weight, half = std::sqrt(0.5);
    const double s = s1 * s2, turn = (slope(s1) + slope(s2)) / (s1 + s2),
                 mirrored = 2 + 2 * (s1 * s1 + s + s2 * s2) / (s * s * s);
    Matrix2 across_turned, across_flipped;
    across_turned << -turn_to[1], -turn_to[0], turn_to[0], -turn_to[1];
    across_flipped << -mirror_to[1], mirror_to[0], mirror_to[0], mirror_to[1];
    return {{(turned + flipped) / 2, (turned - flipped) / 2, half * across_turned, half * across_flipped},
            {w * bend(s1), w * bend(s2), w * (whole ? turn : std::max(turn, 0.0)), w * mirrored},
            {w * slope(s1), w * slope(s2)}};
  }

  /// One triangle's gradient and Hessian by (u, v) of its corners: blocks on the diagonal, and those below it for each edge.
  struct Local {
    std::array<Vec2, 3> gradient;
    std::array<Matrix2, 3> own, beside;
  };

  Local local_of(std::size_t t) const {
    const Modes& modes = modes_[t];
    Local local;
    local.gradient.fill(Vec2::Zero());
    local.own.fill(Matrix2::Zero());
    local.beside.fill(Matrix2::Zero());
    for (std::size_t m = 0; m < 4; ++m) {
      std::array<Vec2, 3> d, weighed;
      for (int k = 0; k < 3; ++k) {
        d[k] = modes.mode[m] * shapes_[t].gradient[k];
        weighed[k] = modes.value[m] * d[k];
        local.own[k] += weighed[k] * d[k].transpose();
        if (m < 2) local.gradient[k] += modes.slope[m] * d[k];
      }
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        const bool is_later = rank_[disc_.triangles[t][k]] > rank_[disc_.triangles[t][next]];
        local.beside[k] += weighed[is_later ? k : next] * d[is_later ? next : k].transpose();
      }
    }
    return local;
  }

  /// The Hessian times a step, triangle by triangle: from how each is deformed by it, of which the matrix has lost digits where thin
  /// triangles move as a whole.
  Eigen::VectorXd times_hessian(const Eigen::VectorXd& way) const {
    Eigen::VectorXd out = shift_ * way;
    for (std::size_t t = 0; t < shapes_.size(); ++t) {
      const Triangle& corner = disc_.triangles[t];
      const auto& gradient = shapes_[t].gradient;
      const auto at = [&](int k) -> Vec2 { return way.segment<2>(2 * rank_[corner[k]]); };
      const Vec2 from = at(0);
      const Matrix2 deformed = (at(1) - from) * gradient[1].transpose() + (at(2) - from) * gradient[2].transpose();
      Matrix2 force = Matrix2::Zero();
      for (std::size_t m = 0; m < 4; ++m)
        force += modes_[t].value[m] * modes_[t].mode[m].cwiseProduct(deformed).sum() * modes_[t].mode[m];
      for (int k = 0; k < 3; ++k) out.segment<2>(2 * rank_[corner[k]]) += force * gradient[k];
    }
    return out;
  }

  /// How far along d the first triangle loses its area.
  double to_first_flip(const PlanePoints& uv, const PlanePoints& d) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& [i, j, k] : disc_.triangles) {
      const Vec2 a = uv.row(j) - uv.row(i), b = uv.row(k) - uv.row(i), da = d.row(j) - d.row(i), db = d.row(k) - d.row(i);
      const double c0 = a[0] * b[1] - a[1] * b[0], c2 = da[0] * db[1] - da[1] * db[0];
      const double c1 = a[0] * db[1] - a[1] * db[0] + da[0] * b[1] - da[1] * b[0];
      const double root = c1 * c1 - 4 * c0 * c2;  // the least positive x of c0 + c1 x + c2 x^2 = 0
      if (root < 0) continue;
      if (c1 < 0)
        least = std::min(least, 2 * c0 / (std::sqrt(root) - c1));
      else if (c2 < 0)
        least = std::min(least, (-c1 - std::sqrt(root)) / (2 * c2));
    }
    return least;
  }

  const LayoutMesh& disc_;
  int n_;
  double scale_ = 1, area_ = 0;
  std::vector<Shape> shapes_;
  std::vector<double> angle_;  // of the border's vertices on the circle
  std::vector<int> rank_;      // of each vertex in the order of elimination
  std::vector<int> block_;     // of each triangle's edges in the Hessian
  BlockLdlt hessian_;
  std::vector<Modes> modes_;  // of each triangle in the Hessian
  double shift_ = 0;          // of its diagonal
  Eigen::VectorXd gradient_;
};

/// The caller's start by the disc's vertices, with those added in the middle of their loops.
PlanePoints start_of(const LayoutMesh& disc, const PlanePoints& start, double scale) {
  PlanePoints uv = PlanePoints::Zero(disc.count, 2);
  const Index known = static_cast<Index>(disc.vertices.size());
  for (Index v = 0; v < known; ++v) uv.row(v) = start.row(disc.vertices[v]) / scale;
  for (std::size_t l = 0; l < disc.filled.size(); ++l) {
    for (int v : disc.filled[l]) uv.row(known + static_cast<Index>(l)) += uv.row(v);
    uv.row(known + static_cast<Index>(l)) /= static_cast<double>(disc.filled[l].size());
  }
  return uv;
}

/// As a whole towards other places: steps turn it by what they are long, squared.
void turn_to(const PlanePoints& places, PlanePoints& uv) {
  const Eigen::RowVector2d middle = uv.colwise().mean();
  const PlanePoints about = uv.rowwise() - middle, to = places.rowwise() - Eigen::RowVector2d(places.colwise().mean());
  Vec2 way(about.cwiseProduct(to).sum(), about.col(0).dot(to.col(1)) - about.col(1).dot(to.col(0)));
  if (!(way.norm() > 0)) return;
  way.normalize();
  uv.col(0) = (way[0] * about.col(0) - way[1] * about.col(1)).array() + middle[0];
  uv.col(1) = (way[1] * about.col(0) + way[0] * about.col(1)).array() + middle[1];
}

double plane_area(const LayoutMesh& disc, const PlanePoints& uv, bool& flipped) {
  double sum = 0;
  for (std::size_t t = 0; t < disc.real; ++t) {
    const auto& [a, b, c] = disc.triangles[t];
    const Vec2 p = uv.row(b) - uv.row(a), q = uv.row(c) - uv.row(a);
    const double twice = p[0] * q[1] - p[1] * q[0];
    flipped |= !(twice > 0);
    sum += twice / 2;
  }
  return sum;
}

}  // namespace

std::optional<Parametrization> parametrize(const PointsRef& points, const std::vector<std::array<Index, 3>>& triangles,
                                           const PlaneLayoutOptions& options, const PlanePoints* start) {
  const std::optional<LayoutMesh> disc = make_layout_mesh(points, triangles);
  if (!disc) return std::nullopt;
  if (start && start->rows() != points.rows()) throw InvalidArgument("start: a row of the plane for each point");
  Problem problem(points, *disc);
  std::optional<PlanePoints> uv;
  if (start) {
    uv = start_of(*disc, *start, problem.scale());
    if (!std::isfinite(problem.energy(*uv))) uv.reset();
  }
  if (!uv) uv = problem.tutte();
  if (!uv) return std::nullopt;
  Parametrization layout;
  double energy = problem.energy(*uv);
  layout.energies.push_back(energy);
  const bool is_hard = energy > hard;
  const PlanePoints begun = *uv;
  const double tolerance = is_hard ? tolerance::close * options.tolerance : options.tolerance;
  const int affordable = std::max(options.iterations, options.vertex_steps / disc->count);
  const int iterations = is_hard ? std::min(hard_iterations * options.iterations, affordable) : options.iterations;
  bool is_near = false;
  for (int k = 0; k < iterations; ++k) {
    const double before = energy;
    const bool gained = problem.step(*uv, energy, is_near);
    if (gained) layout.energies.push_back(energy);
    if (!gained || before - energy < tolerance * before) break;
    is_near = is_hard && before - energy < near_its_end * before;
  }
  if (is_hard) turn_to(begun, *uv);
  bool flipped = false;
  const double area = plane_area(*disc, *uv, flipped);
  *uv *= problem.area() > 0 ? std::sqrt(problem.area() / area) : problem.scale();
  plane_area(*disc, *uv, flipped);
  if (flipped) return std::nullopt;
  layout.uv = PlanePoints::Constant(points.rows(), 2, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t v = 0; v < disc->vertices.size(); ++v) layout.uv.row(disc->vertices[v]) = uv->row(static_cast<Index>(v));
  layout.holes_filled = static_cast<Index>(disc->filled.size());
  return layout;
}

}  // namespace tripatch
