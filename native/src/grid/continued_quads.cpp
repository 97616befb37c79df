#include "tripatch/grid/continued_quads.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseQR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <optional>
#include <ranges>

#include "tripatch/grid/mixed_differences.h"
#include "tripatch/math/interruption.h"
#include "tripatch/math/linear.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/quads/wanted_quads.h"

namespace tripatch {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Solver = Eigen::SparseQR<Sparse, Eigen::NaturalOrdering<int>>;

/// The quads and as many rings of faces around them as differences reach, with numbers of their own: the rim, inside, around.
struct Neighborhood {
  Faces faces;
  std::vector<Index> beyond;  ///< vertices of the mesh

  Neighborhood(const Connectivity& around, const QuadsInside& quads) : faces(quads.faces) {
    const Index own = static_cast<Index>(quads.rim.size()) + quads.inside;
    std::map<Index, Index> number;
    std::vector<Index> ring = quads.rim;
    for (std::size_t k = 0; k < ring.size(); ++k) number[ring[k]] = static_cast<Index>(k);
    std::map<Index, bool> taken;  // faces
    for (int rings = 0; rings < max_difference_order; ++rings) {
      std::vector<Index> next;
      for (const Index v : ring) {
        if (!around.knows(v)) continue;
        for (const Connectivity::Corner c : around.at(v)) {
          if (!taken.emplace(around.face(c), true).second) continue;
          std::vector<Index> face;
          for (const Index w : around.faces()[around.face(c)]) {
            const auto [at, is_new] = number.emplace(w, own + static_cast<Index>(beyond.size()));
            if (is_new) beyond.push_back(w), next.push_back(w);
            face.push_back(at->second);
          }
          faces.add(face);
        }
      }
      ring = std::move(next);
    }
  }
};

/// Runs of the rim's vertices at which it continues, and how many quads lie across from there to where the rows end.
struct RimSide {
  std::vector<Index> places;
  double across = 0;
};

class SidesOfRim {
public:
  explicit SidesOfRim(const QuadsInside& quads)
      : r_(static_cast<Index>(quads.rim.size())), quads_(quads.faces, r_ + quads.inside) {}

  std::vector<RimSide> sides() const {
    Index corner = 0;
    while (corner < r_ && runs_on(corner)) ++corner;
    std::vector<RimSide> found;
    RimSide now;
    for (Index k = 1; k <= r_; ++k) {
      const Index place = (corner + k) % r_;
      if (runs_on(place)) now.places.push_back(place);
      if ((runs_on(place) && k < r_) || now.places.empty()) continue;
      now.across = across(now.places);
      found.push_back(std::move(now));
      now = {};
    }
    return found;
  }

private:
  bool runs_on(Index place) const { return quads_.at(place).size() == 2; }

  double across(const std::vector<Index>& places) const {
    double sum = quads_across((places.front() + r_ - 1) % r_);
    for (const Index place : places) sum += quads_across(place);
    return sum / static_cast<double>(places.size() + 1);
  }
  /// From the edge after a place.
  Index quads_across(Index place) const {
    Index from = place, to = (place + 1) % r_, count = 0;
    while (const std::optional<Connectivity::Corner> corner = quads_.edge(from, to)) {
      const IndicesRef face = quads_.faces()[quads_.face(*corner)];
      const Index at = quads_.place(*corner);
      from = face[(at + 3) % 4];
      to = face[(at + 2) % 4];
      if (++count > quads_.faces().size()) break;
    }
    return count;
  }

  Index r_;
  Connectivity quads_;
};

/// The vertices inside by rings of faces around the first of them, what hangs together one after the other.
std::vector<Index> by_rings(const Connectivity& neighborhood, const QuadsInside& quads, const std::vector<Index>& from) {
  const Index r = static_cast<Index>(quads.rim.size()), own = r + quads.inside;
  std::vector<char> is_reached(static_cast<std::size_t>(own), 0);
  std::vector<Index> reached;
  const auto reach = [&](Index v) {
    if (v >= r && v < own && !std::exchange(is_reached[static_cast<std::size_t>(v)], 1)) reached.push_back(v);
  };
  for (std::size_t next = 0; const Index first : from)
    for (reach(first); next < reached.size(); ++next)
      for (const Connectivity::Corner c : neighborhood.at(reached[next]))
        for (const Index v : neighborhood.faces()[neighborhood.face(c)]) reach(v);
  return reached;
}

/// Columns for the vertices inside, those of a difference near each other, as by Cuthill and McKee: from one far away from the others.
std::vector<Index> banded_columns(const Connectivity& neighborhood, const QuadsInside& quads) {
  std::vector<Index> order(static_cast<std::size_t>(quads.inside));
  const Index r = static_cast<Index>(quads.rim.size());
  std::iota(order.begin(), order.end(), r);
  for (int times = 0; times < 2; ++times) {
    std::ranges::reverse(order);
    order = by_rings(neighborhood, quads, order);
  }
  std::vector<Index> column(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) column[static_cast<std::size_t>(order[k] - r)] = static_cast<Index>(k);
  return column;
}

/// Differences of an order, which are to be as little as possible.
class MixedDifferences {
public:
  MixedDifferences(const Connectivity& neighborhood, const QuadsInside& quads, const std::vector<Index>& column,
                   const Points& rim, const Points& beyond, int order) {
    const Index r = rim.rows(), own = r + quads.inside;
    const std::vector<Difference> all = in_bands(mixed_differences(neighborhood, order), r, column);
    const Index rows = static_cast<Index>(all.size());
    std::vector<Eigen::Triplet<double>> of_inside;
    Eigen::MatrixXd of_rim = Eigen::MatrixXd::Zero(rows, r);
    Eigen::MatrixXd known = Eigen::MatrixXd::Zero(rows, 3);
    for (Index row = 0; row < rows; ++row)
      for (const auto& [v, weight] : all[static_cast<std::size_t>(row)]) {
        if (v < r)
          of_rim(row, v) += weight;
        else if (v < own)
          of_inside.emplace_back(static_cast<int>(row), static_cast<int>(column[static_cast<std::size_t>(v - r)]), weight);
        else
          known.row(row) += weight * beyond.row(v - own);
      }
    known += of_rim * rim;
    determined_ = rows >= quads.inside;
    if (!determined_) return;
    Eigen::MatrixXd right(rows, 3 + r);
    right << known, of_rim;
    if (quads.inside > 0) {
      Sparse matrix(rows, quads.inside);
      matrix.setFromTriplets(of_inside.begin(), of_inside.end());
      matrix.makeCompressed();
      Solver solver;
      solver.setPivotThreshold(tolerance::solved * std::sqrt(matrix.squaredNorm() / static_cast<double>(quads.inside)));
      solver.compute(matrix);
      determined_ = solver.rank() == quads.inside;
      if (!determined_) return;
      inside_ = -Eigen::MatrixXd(solver.solve(known))(column, Eigen::all);
      right = Eigen::MatrixXd(solver.matrixQ().transpose() * right);
    }
    left_ = right.bottomRows(rows - quads.inside).leftCols(3);
    of_rim_ = right.bottomRows(rows - quads.inside).rightCols(r);
  }

  bool determined() const { return determined_; }
  const Eigen::MatrixXd& inside() const { return inside_; }

  /// Root mean square distance by which some of the rim are missed where they are unknown too; infinite where they are not determined.
  double missed(const std::vector<Index>& places) const {
    const Index count = static_cast<Index>(places.size());
    if (left_.rows() < count) return INFINITY;
    const auto [moved, rank] = minimum_norm_least_squares(of_rim_(Eigen::all, places), left_, tolerance::solved);
    return rank < count ? INFINITY : std::sqrt(moved.squaredNorm() / static_cast<double>(count));
  }

private:
  /// Those that concern the rim or the inside, by the first of their columns: between bands that continue, nothing else fills the factors,
  /// which takes a tenth of the time.
  static std::vector<Difference> in_bands(const std::vector<Difference>& all, Index r, const std::vector<Index>& column) {
    const Index inside = static_cast<Index>(column.size());
    std::vector<std::vector<Difference>> by_column(column.size() + 1);
    for (const Difference& difference : all) {
      bool concerns = false;
      Index first = inside;
      for (const auto& [v, weight] : difference) {
        concerns = concerns || v < r + inside;
        if (v >= r && v < r + inside) first = std::min(first, column[static_cast<std::size_t>(v - r)]);
      }
      if (concerns) by_column[static_cast<std::size_t>(first)].push_back(difference);
    }
    std::vector<Difference> sorted;
    for (const std::vector<Difference>& each : by_column) sorted.insert(sorted.end(), each.begin(), each.end());
    return sorted;
  }

  bool determined_ = false;
  Eigen::MatrixXd inside_;         ///< (inside, 3)
  Eigen::MatrixXd left_, of_rim_;  ///< what the inside cannot make good: of the positions as they are, and by those of the rim
};

/// By differences of one order.
struct Continued {
  Eigen::MatrixXd inside;
  double missed = 0;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size();
  return 0.5 * (values[(count - 1) / 2] + values[count / 2]);
}

}  // namespace

bool is_among_quads(const Connectivity& around, const std::vector<Index>& rim) {
  const auto is_quad = [&](Connectivity::Corner c) { return around.faces()[around.face(c)].size() == 4; };
  return std::ranges::all_of(rim, [&](Index v) { return around.knows(v) && std::ranges::all_of(around.at(v), is_quad); });
}

bool go_on(const PointsRef& vertices, const Connectivity& around, const QuadsInside& quads) {
  if (!is_among_quads(around, quads.rim)) return false;
  const Index r = static_cast<Index>(quads.rim.size());
  std::vector<Index> count(static_cast<std::size_t>(r + quads.inside), 0);
  for (Index f = 0; f < quads.faces.size(); ++f) {
    if (quads.faces[f].size() != 4) return false;
    for (const Index v : quads.faces[f]) ++count[static_cast<std::size_t>(v)];
  }
  Index poles = std::count_if(count.begin() + r, count.end(), [](Index quads_there) { return quads_there != 4; });
  for (std::size_t k = 0; k < quads.rim.size(); ++k)
    poles += std::abs(count[k] - std::lround(coarse(quads_left(vertices, around, quads.rim, k))));
  return poles <= max_poles;
}

ContinuedRows continued_quads(const PointsRef& vertices, const Connectivity& around, const QuadsInside& quads) {
  const Neighborhood all(around, quads);
  const Index own = static_cast<Index>(quads.rim.size()) + quads.inside;
  const Connectivity neighborhood(all.faces, own + static_cast<Index>(all.beyond.size()));
  const Vec3 origin = vertices(quads.rim, Eigen::all).colwise().mean();
  const Points rim = vertices(quads.rim, Eigen::all).rowwise() - origin.transpose(),
               beyond = vertices(all.beyond, Eigen::all).rowwise() - origin.transpose();
  const std::vector<RimSide> sides = SidesOfRim(quads).sides();
  const std::vector<Index> column = banded_columns(neighborhood, quads);
  std::array<std::optional<Continued>, max_difference_order> made;
  for (int order = 1; order <= max_difference_order && !sides.empty(); ++order) {
    check_interruption();
    const MixedDifferences differences(neighborhood, quads, column, rim, beyond, order);
    if (!differences.determined()) continue;
    std::vector<double> by_side;
    for (const RimSide& side : sides) by_side.push_back(differences.missed(side.places) * middle_over_first(side.across));
    const double missed = median(by_side);
    if (std::isfinite(missed)) made[order - 1] = {differences.inside(), missed};
  }
  ContinuedRows best;
  for (int order = 1; order <= max_difference_order; ++order) {
    const std::optional<Continued>& own = made[order - 1];
    if (own && (best.order == 0 || clearly_less(own->missed, best.missed))) best.order = order, best.missed = own->missed;
  }
  if (best.order == 0) return best;
  const Eigen::MatrixXd& inside = made[best.order - 1]->inside;
  best.inside = Points(inside.rows(), 3);
  if (inside.rows() == 0) return best;
  best.inside = inside.rowwise() + origin.transpose();
  const bool higher = best.order < max_difference_order && made[best.order];
  const std::optional<Continued>& other = higher ? made[best.order] : made[std::max(best.order - 2, 0)];
  if (!other || (best.order == 1 && !higher)) return {};
  best.missed = std::max(best.missed, (inside - other->inside).norm() / std::sqrt(static_cast<double>(inside.rows())));
  return best;
}

}  // namespace tripatch
