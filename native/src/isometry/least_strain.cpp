#include "tripatch/isometry/least_strain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tripatch/math/damping.h"
#include "tripatch/math/plane.h"
#include "tripatch/math/sparse_ldlt.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/parametrization/parametrization.h"
#include "tripatch/spline/minimize_bending.h"

namespace tripatch {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Entries = std::vector<Eigen::Triplet<double>>;

/// Of the chords of an arc, over (curvature length)^2: how much shorter they are than the arc.
constexpr double shortness_of_chords = 1.0 / 24;
/// The variance of their distance from it, over (curvature length^2)^2.
constexpr double variance_of_chords = 1.0 / 720;
/// The bending energy of a plate over its stretching energy, by its thickness squared.
constexpr double bending_of_plate = 1.0 / 12;

/// Levenberg-Marquardt: the most that is added to the diagonal, of it.
constexpr double most_damping = 1e6;
/// It ends when a step that is hardly damped takes no more than nobody sees off the energy.
constexpr double hardly_damped = 1e-5;
constexpr int max_steps = count::many_places;

struct WeightedEdge {
  Index from, to;
  double area;  ///< a third of its triangles
};

std::vector<WeightedEdge> weighted_edges(const Points& points, const Triangles& triangles) {
  std::vector<WeightedEdge> all, edges;
  for (const std::array<Index, 3>& t : triangles)
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
      all.push_back({a, b, triangle_normal(points, t).norm() / 6});
    }
  const auto ends = [](const WeightedEdge& e) { return std::pair(e.from, e.to); };
  std::ranges::stable_sort(all, {}, ends);
  for (const WeightedEdge& each : all)
    if (edges.empty() || ends(edges.back()) != ends(each))
      edges.push_back(each);
    else
      edges.back().area += each.area;
  return edges;
}

/// Triangles in space and in the plane.
struct Unrolled {
  Points points;
  PlanePoints flat;

  /// Of an edge: half the difference of its squared lengths over their mean.
  double strain(const WeightedEdge& e) const {
    const double here = (points.row(e.to) - points.row(e.from)).squaredNorm();
    const double there = (flat.row(e.to) - flat.row(e.from)).squaredNorm();
    return (here - there) / std::max(here + there, tolerance::tiny);
  }
};

double root_mean_square_strain(const std::vector<WeightedEdge>& edges, const Unrolled& at) {
  double sum = 0, area = 0;
  for (const WeightedEdge& e : edges) {
    const double strain = at.strain(e);
    sum += e.area * strain * strain;
    area += e.area;
  }
  return area > 0 ? std::sqrt(sum / area) : 0;
}

/// The strain of edges with the bending energy of what moves, as a function of its coordinates in space, then of all in the plane.
class StrainEnergy {
public:
  /// bending: of those that move; none: nothing moves in space.
  StrainEnergy(std::vector<WeightedEdge> edges, const Points& start, const Sparse& bending)
      : edges_(std::move(edges)), start_(start.topRows(bending.rows())), bending_(bending) {}

  void minimize(Unrolled& at) const {
    double damping = tolerance::slight, least = value(at);
    SparseLdlt solver;
    for (int step = 0; step < max_steps && least > 0; ++step) {
      const auto [hessian, gradient] = derivatives(at);
      if (step == 0) solver.analyzePattern(hessian);
      const Eigen::VectorXd diagonal = hessian.diagonal();
      const double mean = diagonal.mean(), before = least;
      for (; !(least < before); damping *= damping_by) {
        if (damping > most_damping) return;
        Sparse damped = hessian;
        damped.diagonal() += damping * (diagonal.array() + mean).matrix();
        solver.factorize(damped);
        const Unrolled next = moved(at, -solver.solve(gradient));
        const double found = value(next);
        if (!(found < before)) continue;
        least = found;
        at = next;
        break;
      }
      if (before - least <= tolerance::close * before && damping <= hardly_damped) return;
      damping = std::max(damping / damping_by, tolerance::solved);
    }
  }

private:
  Index free() const { return bending_.rows(); }
  Index plane_at(Index row) const { return 3 * free() + 2 * row; }
  Points moves(const Unrolled& at) const { return at.points.topRows(free()) - start_; }

  double value(const Unrolled& at) const {
    const Points moves = this->moves(at);
    double sum = moves.cwiseProduct(bending_ * moves).sum();
    for (const WeightedEdge& e : edges_) {
      const double strain = at.strain(e);
      sum += e.area * strain * strain;
    }
    return sum;
  }

  Unrolled moved(Unrolled at, const Eigen::VectorXd& by) const {
    at.points.topRows(free()) += Eigen::Map<const Points>(by.data(), free(), 3);
    at.flat += Eigen::Map<const PlanePoints>(by.data() + 3 * free(), at.flat.rows(), 2);
    return at;
  }

  /// Those of Gauss and Newton, halved.
  std::pair<Sparse, Eigen::VectorXd> derivatives(const Unrolled& at) const {
    const Index size = plane_at(at.flat.rows());
    Entries entries;
    for (Index column = 0; column < free(); ++column)
      for (Sparse::InnerIterator entry(bending_, column); entry; ++entry)
        for (int c = 0; c < 3 && entry.row() >= column; ++c)
          entries.emplace_back(static_cast<int>(3 * entry.row() + c), static_cast<int>(3 * column + c), entry.value());
    for (int k = 0; k < static_cast<int>(size); ++k) entries.emplace_back(k, k, 0);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    const Points pull = bending_ * moves(at);
    gradient.head(3 * free()) = Eigen::Map<const Eigen::VectorXd>(pull.data(), pull.size());
    std::vector<std::pair<int, double>> row;
    for (const WeightedEdge& e : edges_) {
      const Eigen::RowVector3d here = at.points.row(e.to) - at.points.row(e.from);
      const Eigen::RowVector2d there = at.flat.row(e.to) - at.flat.row(e.from);
      const double scale = 2 / std::max(here.squaredNorm() + there.squaredNorm(), tolerance::tiny);
      row.clear();
      for (const auto& [vertex, sign] : {std::pair(e.from, -scale), std::pair(e.to, scale)}) {
        for (int c = 0; c < 3 && vertex < free(); ++c) row.emplace_back(static_cast<int>(3 * vertex + c), sign * here[c]);
        for (int c = 0; c < 2; ++c) row.emplace_back(static_cast<int>(plane_at(vertex) + c), -sign * there[c]);
      }
      for (const auto& [i, by_i] : row) {
        gradient[i] += e.area * at.strain(e) * by_i;
        for (const auto& [j, by_j] : row)
          if (i >= j) entries.emplace_back(i, j, e.area * by_i * by_j);
      }
    }
    Sparse hessian(size, size);
    hessian.setFromTriplets(entries.begin(), entries.end());
    return {std::move(hessian), std::move(gradient)};
  }

  std::vector<WeightedEdge> edges_;
  Points start_;
  Sparse bending_;
};

/// How a sheet lies.
struct Shape {
  Sparse bending;        ///< of the vertices inside: squared Laplacians of them and of the fill's boundary, over areas
  double curvature = 0;  ///< root mean square of the Laplacian there
};

Shape shape_of(const Sheet& sheet, const Triangles& all) {
  const Laplacian laplacian = cotangent_laplacian(sheet.points, all);
  std::vector<char> counts(static_cast<std::size_t>(sheet.points.rows()), 0);
  for (const std::array<Index, 3>& t : sheet.fill)
    for (Index v : t) counts[static_cast<std::size_t>(v)] = 1;
  Eigen::VectorXd over_areas = Eigen::VectorXd::Zero(sheet.points.rows());
  double area = 0;
  for (Index v = 0; v < sheet.points.rows(); ++v)
    if (counts[static_cast<std::size_t>(v)] && laplacian.areas[v] > 0) {
      over_areas[v] = 1 / laplacian.areas[v];
      area += laplacian.areas[v];
    }
  const Points bent = laplacian.stiffness * sheet.points;
  const Sparse columns = laplacian.stiffness.leftCols(sheet.inside);
  Shape shape;
  shape.bending = columns.transpose() * (over_areas.asDiagonal() * columns);
  if (area > 0) shape.curvature = std::sqrt(over_areas.dot(bent.rowwise().squaredNorm()) / area);
  return shape;
}

}  // namespace

std::optional<LeastStrain> least_strain(const Sheet& sheet) {
  Triangles all = sheet.fill;
  all.insert(all.end(), sheet.around.begin(), sheet.around.end());
  const std::vector<WeightedEdge> edges = weighted_edges(sheet.points, all), own = weighted_edges(sheet.points, sheet.fill),
                                  beyond = weighted_edges(sheet.points, sheet.around);
  double length = 0;
  for (const WeightedEdge& e : edges)
    length += (sheet.points.row(e.to) - sheet.points.row(e.from)).squaredNorm() / static_cast<double>(edges.size());
  const auto [bending, curvature] = shape_of(sheet, all);
  const double turn = curvature * curvature * length;  // of an edge, squared
  const std::optional<Parametrization> laid_out = parametrize(sheet.points, all);
  if (!laid_out || !laid_out->uv.allFinite()) return {};

  Unrolled alone{sheet.points, laid_out->uv};
  const Sparse none(0, 0);
  StrainEnergy(beyond, sheet.points, none).minimize(alone);
  if (!(root_mean_square_strain(beyond, alone) <= shortness_of_chords * turn + tolerance::solved)) return {};

  Unrolled at{sheet.points, laid_out->uv};
  StrainEnergy(edges, sheet.points, none).minimize(at);
  LeastStrain made;
  made.before = root_mean_square_strain(own, at);
  // a plate as thick as the sheet is known: by how much its edges, as chords, are off what they stand for
  const double thickness_squared = variance_of_chords * turn * length;
  StrainEnergy(edges, sheet.points, bending_of_plate * thickness_squared * bending).minimize(at);
  made.after = root_mean_square_strain(own, at);
  made.inside = at.points.topRows(sheet.inside);
  return made;
}

}  // namespace tripatch
