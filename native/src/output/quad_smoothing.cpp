#include "tripatch/output/quad_smoothing.h"

#include <Eigen/Geometry>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

#include "tripatch/math/jet.h"

namespace tripatch {
namespace {

/// Distortions count with this power: high enough for the worst corner to lead, low enough for Newton's steps to converge.
constexpr int distortion_power = 3;
/// In the end the least angle leads: (1 / sin)^2 counts with this power (of two), and beside it how even the spacing is.
constexpr int sharp_power = 8;
constexpr double spacing = 0.25;  ///< weight of the evenness, a choice
/// Of the shortest edge at a vertex: no step is longer, beyond it the surface's second order says little.
constexpr double longest_step = 0.4;
/// Of the larger eigenvalue of a Hessian: where the smaller one is less it becomes that share.
constexpr double least_convex = 1e-3, made_convex = 0.1;
constexpr int halvings = 6;         ///< of a Newton step that makes things worse, before it is left out
constexpr int sweeps_a_metric = 5;  ///< between two evaluations of the surface, whose second order is good for small moves
/// Of a mean corner's area: below it a corner counts as turned over and is pulled back by a smooth bound of that size.
constexpr double least_area = 1e-3;

double square(double x) { return x * x; }

using Edge = std::array<Index, 2>;
Edge edge_of(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

/// Widths of rows of quads: of each edge that of the row that it lies across.
class RowWidths {
public:
  /// round: of rows that go round and have no ends; none: the mean length of their edges.
  RowWidths(const Faces& faces, Index rim_count, const Points& positions, std::optional<double> round = {}) {
    for (Index f = 0; f < faces.size(); ++f)
      for (std::size_t k = 0, m = faces[f].size(); k < m; ++k) number(edge_of(faces[f][k], faces[f][(k + 1) % m]));
    std::vector<Index> root(number_.size());
    std::iota(root.begin(), root.end(), Index{0});
    const auto find = [&](Index e) {
      while (root[e] != e) e = root[e] = root[root[e]];
      return e;
    };
    for (Index f = 0; f < faces.size(); ++f) {
      const auto q = faces[f];
      if (q.size() != 4) continue;
      for (int k : {0, 1}) root[find(number(edge_of(q[k], q[k + 1])))] = find(number(edge_of(q[k + 2], q[(k + 3) % 4])));
    }
    std::vector<double> sum(root.size(), 0), all(root.size(), 0);
    std::vector<Index> ends(root.size(), 0), edges(root.size(), 0);
    for (const auto& [edge, e] : number_) {
      const double length = (positions.row(edge[0]) - positions.row(edge[1])).norm();
      const bool rim = edge[1] < rim_count && (edge[1] - edge[0] == 1 || edge[1] - edge[0] == rim_count - 1);
      const Index row = find(e);
      all[row] += length;
      ++edges[row];
      if (!rim) continue;
      sum[row] += std::log(length);
      ++ends[row];
    }
    width_.resize(root.size());
    for (std::size_t e = 0; e < root.size(); ++e) {
      const Index row = find(static_cast<Index>(e));
      width_[e] = ends[row] > 0 ? std::exp(sum[row] / static_cast<double>(ends[row]))
                                : round.value_or(all[row] / static_cast<double>(edges[row]));
    }
  }

  double at(Index a, Index b) const { return width_[number_.at(edge_of(a, b))]; }
  const std::map<Edge, Index>& edges() const { return number_; }
  double width(Index e) const { return width_[e]; }

private:
  Index number(const Edge& edge) { return number_.try_emplace(edge, static_cast<Index>(number_.size())).first->second; }
  std::map<Edge, Index> number_;
  std::vector<double> width_;
};

Points in_plane(const PlanePoints& uv) {
  Points rows = Points::Zero(uv.rows(), 3);
  rows.leftCols(2) = uv;
  return rows;
}

template <class T>
using Vector = std::array<T, 3>;
template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double root_of(double x) { return std::sqrt(x); }
Jet<2> root_of(const Jet<2>& x) { return sqrt(x); }

/// Moves vertices one after the other.
class Smoother {
public:
  Smoother(PlaneLayout& layout, const Surface* surface, const Points* border, const std::vector<Index>& held)
      : layout_(layout), surface_(surface), border_(border), at_(layout.uv.rows()), held_(layout.uv.rows(), false) {
    for (Index v : held) held_[v] = true;
    read_surface();
    const RowWidths widths(layout.faces, layout.rim, positions());
    for (Index f = 0; f < layout.faces.size(); ++f) {
      const auto face = layout.faces[f];
      const std::size_t m = face.size();
      for (std::size_t k = 0; k < m; ++k) {
        const Index v = face[k], next = face[(k + 1) % m], last = face[(k + m - 1) % m];
        const Corner corner = {{v, next, last}, 1 / widths.at(v, next), 1 / widths.at(v, last), m == 3};
        for (Index w : corner.v)
          if (w >= layout.rim) at_[w].push_back(static_cast<Index>(corners_.size()));
        corners_.push_back(corner);
      }
    }
  }

  void run(int sweeps, int sharpening) {
    for (int sweep = 0; sweep < sweeps + sharpening; ++sweep) {
      if (surface_ && sweep > 0 && sweep % sweeps_a_metric == 0) read_surface();
      bound_ = 0;
      for (const Corner& corner : corners_)
        if (area(corner) < least_area) bound_ = least_area;
      sharp_ = sweep >= sweeps && bound_ == 0;
      for (Index v = layout_.rim; v < layout_.uv.rows(); ++v)
        if (!held_[v]) move(v);
    }
  }

private:
  struct Corner {
    std::array<Index, 3> v;  ///< itself, the next and the last of its face
    double next, last;       ///< one over the widths of these edges
    bool triangle;
  };
  using Taylor = Eigen::Matrix<double, 6, 3, Eigen::RowMajor>;

  void read_surface() {
    const Index n = layout_.uv.rows();
    taylor_.assign(n, Taylor::Zero());
    normal_.assign(n, Vec3::UnitZ());
    base_ = layout_.uv;
    const Points rows = in_plane(layout_.uv);
    if (surface_) {
      surface_->evaluate(rows.data(), n, 2, taylor_[0].data());
      for (Index v = 0; v < n; ++v) normal_[v] = Vec3(taylor_[v].row(1)).cross(Vec3(taylor_[v].row(2))).stableNormalized();
      for (Index v = 0; border_ && v < layout_.rim; ++v) taylor_[v].row(0) = border_->row(v);
    } else {
      for (Index v = 0; v < n; ++v) {
        taylor_[v].row(0) = rows.row(v);
        taylor_[v].row(1) = Vec3::UnitX();
        taylor_[v].row(2) = Vec3::UnitY();
      }
    }
    x_.resize(n);
    for (Index v = 0; v < n; ++v) x_[v] = taylor_[v].row(0);
  }

  Points positions() const {
    Points all(static_cast<Index>(x_.size()), 3);
    for (std::size_t v = 0; v < x_.size(); ++v) all.row(static_cast<Index>(v)) = x_[v];
    return all;
  }

  Vec3 position(Index v, const Eigen::Vector2d& d) const {
    Eigen::Matrix<double, 1, 6> powers;
    powers << 1, d[0], d[1], d[0] * d[0], d[0] * d[1], d[1] * d[1];
    return (powers * taylor_[v]).transpose();
  }

  double area(const Corner& c) const {
    return c.next * c.last * normal_[c.v[0]].dot((x_[c.v[1]] - x_[c.v[0]]).cross(x_[c.v[2]] - x_[c.v[0]]));
  }

  /// 1 for a right angle between edges as long as their rows are wide (a triangle: equal ones), infinite where it is flat; a power.
  template <class T>
  T distortion(const Corner& corner, const Vector<T>& p, const Vector<T>& q, const Vector<T>& r) const {
    Vector<T> a, b;
    for (int k = 0; k < 3; ++k) {
      a[k] = corner.next * (q[k] - p[k]);
      b[k] = corner.last * (r[k] - p[k]);
    }
    const Vec3& n = normal_[corner.v[0]];
    T area = n[0] * (a[1] * b[2] - a[2] * b[1]) + n[1] * (a[2] * b[0] - a[0] * b[2]) + n[2] * (a[0] * b[1] - a[1] * b[0]);
    const T aa = dot(a, a), bb = dot(b, b);
    if (sharp_) {
      if (corner.triangle) area = (2 / std::sqrt(3.0)) * area;  // of two equal edges: 1 for 60 degrees
      T sine = aa * bb / (area * area), power = sine;
      for (int k = 1; k < sharp_power; k *= 2) power *= power;
      const T shape = aa / bb;
      return power + spacing * (shape + 1.0 / shape);
    }
    T size = aa + bb;
    if (corner.triangle) size = (2 / std::sqrt(3.0)) * (size - dot(a, b));
    if (bound_ > 0) area = 0.5 * (area + root_of(area * area + 4 * bound_ * bound_));
    const T ratio = 0.5 * (size / area);
    T power = ratio;
    for (int k = 1; k < distortion_power; ++k) power *= ratio;
    return power;
  }

  double cost_at(Index v, const Vec3& x) const {
    double sum = 0;
    const auto vector = [&](Index w) -> Vector<double> {
      const Vec3& p = w == v ? x : x_[w];
      return {p[0], p[1], p[2]};
    };
    for (Index c : at_[v]) {
      const Corner& corner = corners_[c];
      const double value = distortion<double>(corner, vector(corner.v[0]), vector(corner.v[1]), vector(corner.v[2]));
      if (!(value > 0)) return INFINITY;
      sum += value;
    }
    return sum;
  }

  void move(Index v) {
    const Eigen::Vector2d d = (layout_.uv.row(v) - base_.row(v)).transpose();
    const Taylor& t = taylor_[v];
    Vector<Jet<2>> moving;
    for (int k = 0; k < 3; ++k) {
      moving[k] =
          Jet<2>::linear(x_[v][k], t(1, k) + 2 * d[0] * t(3, k) + d[1] * t(4, k), t(2, k) + d[0] * t(4, k) + 2 * d[1] * t(5, k));
      for (int j = 3; j < 6; ++j) moving[k].c[j] = t(j, k);
    }
    const auto vector = [&](Index w) -> Vector<Jet<2>> {
      return w == v ? moving : Vector<Jet<2>>{Jet<2>(x_[w][0]), Jet<2>(x_[w][1]), Jet<2>(x_[w][2])};
    };
    Jet<2> sum(0.0);
    for (Index c : at_[v]) {
      const Corner& corner = corners_[c];
      sum += distortion<Jet<2>>(corner, vector(corner.v[0]), vector(corner.v[1]), vector(corner.v[2]));
    }
    const Eigen::Vector2d gradient(sum.c[1], sum.c[2]);
    Eigen::Matrix2d hessian;
    hessian << 2 * sum.c[3], sum.c[4], sum.c[4], 2 * sum.c[5];
    // made positive: a saddle's step would lead uphill
    const double mean = 0.5 * hessian.trace(), spread = std::hypot(0.5 * (hessian(0, 0) - hessian(1, 1)), hessian(0, 1));
    if (!(mean - spread > least_convex * (std::abs(mean) + spread)))
      hessian.diagonal().array() += spread - mean + made_convex * (std::abs(mean) + spread);
    Eigen::Vector2d step = -hessian.inverse() * gradient;
    if (!step.allFinite()) return;
    double shortest = INFINITY;
    for (Index c : at_[v])
      for (Index w : corners_[c].v)
        if (w != v) shortest = std::min(shortest, (x_[w] - x_[v]).norm());
    const double length = (t.row(1) * step[0] + t.row(2) * step[1]).norm();
    if (length > longest_step * shortest) step *= longest_step * shortest / length;
    for (int half = 0; half < halvings; ++half, step *= 0.5) {
      const Vec3 there = position(v, d + step);
      if (!(cost_at(v, there) < sum.value())) continue;
      layout_.uv.row(v) += step.transpose();
      x_[v] = there;
      return;
    }
  }

  PlaneLayout& layout_;
  const Surface* surface_;
  const Points* border_;
  std::vector<std::vector<Index>> at_;
  std::vector<bool> held_;
  std::vector<Corner> corners_;
  std::vector<Taylor> taylor_;
  std::vector<Vec3> normal_, x_;
  PlanePoints base_;
  double bound_ = 0;
  bool sharp_ = false;
};

}  // namespace

QuadQuality quad_quality(const PointsRef& points, const Faces& faces) {
  QuadQuality quality;
  double sum = 0;
  Index count = 0;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    const std::size_t m = face.size();
    const auto at = [&](std::size_t k) { return Vec3(points.row(face[k % m])); };
    const Vec3 normal = m == 3 ? (at(1) - at(0)).cross(at(2) - at(0)).stableNormalized()
                               : (at(2) - at(0)).cross(at(3) - at(1)).stableNormalized();
    for (std::size_t k = 0; m == 4 && k < m; ++k) {
      const double sine = normal.dot((at(k + 1) - at(k)).stableNormalized().cross((at(k + m - 1) - at(k)).stableNormalized()));
      quality.least = std::min(quality.least, sine);
      sum += sine;
      ++count;
    }
  }
  if (count > 0) quality.mean = sum / static_cast<double>(count);
  return quality;
}

void spread_inside(const Faces& faces, Index rim, Points& rows) {
  const Index unknowns = rows.rows() - rim;
  if (unknowns == 0) return;
  double mean = 0;
  for (Index k = 0; k < rim; ++k) mean += (rows.row(k) - rows.row((k + 1) % rim)).norm() / static_cast<double>(rim);
  const RowWidths widths(faces, rim, rows, mean);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(unknowns, 3);
  for (const auto& [edge, e] : widths.edges()) {
    const double weight = square(mean / widths.width(e));
    for (const auto& [a, b] : {std::pair(edge[0], edge[1]), std::pair(edge[1], edge[0])}) {
      if (a < rim) continue;
      entries.emplace_back(a - rim, a - rim, weight);
      if (b < rim) {
        right.row(a - rim) += weight * rows.row(b);
      } else {
        entries.emplace_back(a - rim, b - rim, -weight);
      }
    }
  }
  Eigen::SparseMatrix<double> laplacian(unknowns, unknowns);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(laplacian);
  rows.bottomRows(unknowns) = solver.solve(right);
}

void embed(PlaneLayout& layout) {
  Points rows = in_plane(layout.uv);
  spread_inside(layout.faces, layout.rim, rows);
  layout.uv = rows.leftCols(2);
}

void smooth_quads(PlaneLayout& layout, int sweeps, int sharpening, const Surface* surface, const Points* border,
                  const std::vector<Index>& held) {
  if (layout.uv.rows() > layout.rim) Smoother(layout, surface, border, held).run(sweeps, sharpening);
}

}  // namespace tripatch
