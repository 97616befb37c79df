// A triangulation of a plane domain that isotropic remeshing works on: splits, flips and collapses of edges, sizes, and what is
// asked of the triangles around a vertex. Every step keeps every triangle positively oriented in the domain, so the result is a
// triangulation of it, hence watertight and manifold, whatever the surface does in space.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <vector>

#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/types.h"

namespace tripatch {

/// 1 for an equilateral triangle, 0 for one without area.
double shape(const Vec3& a, const Vec3& b, const Vec3& c);

/// As many triangles as this per squared edge of the rim at most, where no resolution is given.
constexpr double triangles_per_squared_edge = 5;

/// Remesh at about this resolution and cut the triangles far from the rim in rows, once a resolution of twice this is asked for. At 100 the
/// remesher takes 0.1 to 0.3 s, and its triangles follow the sizes as well as finer ones.
constexpr int coarse_resolution = count::hundred;
/// Of such triangles, those of a lower shape (a least angle of some 28 degrees) are left to the remesher: a lattice has their angles.
constexpr double lattice_shape = 0.7;

constexpr double area_of_triangle = 0.43;  ///< of squared edge length: that of an equilateral one

class DomainMesh {
public:
  virtual ~DomainMesh() = default;

protected:
  static constexpr double growth = 0.4;            // of the size per distance, where the rim is finer than the inside
  static constexpr double max_triangles = 50'000;  // wanted where the rim's density says the count; grading adds to it
  static constexpr double max_over =
      factor::huge;  // times as many triangles as the sizes say: no more are made (5 where a rim is uneven)
  static constexpr double too_long = 4.0 / 3, too_short = share::most;  // times the size: where edges are split and collapsed

  /// Edges looked at for each triangle until flips have come to no end, which there may be none of where the surface folds over itself; and
  /// from then on.
  static constexpr std::size_t many_looks = 40, few_looks = count::several;
  static constexpr double good_enough = share::three_tenths;  // shape of a triangle that a move in between may bring about
  static constexpr double collapsed_shape = 0.4;              // that a collapse may bring about; or no worse than what was there
  static constexpr double rounding =
      tolerance::solved;  // of an area, per length: ten times that of coordinates from 0 to 1 read far from the origin

  enum : int { at_rim = -1, at_lattice = -2 };
  struct Triangle {
    std::array<int, 3> v;  // v[0] < 0: removed
    std::array<int, 3> n;  // n[k]: the triangle across the edge opposite v[k], or at_rim, or at_lattice
  };
  struct Corner {
    int triangle, k;
  };
  struct Edge {
    int triangle, k;
    double excess;  // coarse: what edges are sorted by
  };
  /// Of an edge that may be split: coarse, 1 or less where it is not too long.
  static double sorted_by(double excess) { return excess > 1 ? coarse(excess) : 1; }

  explicit DomainMesh(int rim) : rim_(rim) {}

  /// Two edges of a triangle, from one corner.
  struct TwoEdges {
    TwoEdges(const Vec3& u, const Vec3& v) : first(u), second(v), normal(u.cross(v)) {}
    Vec3 first, second, normal;
  };
  /// Whether two triangles lie folded over each other by more than a right angle; not where one has no area but rounding.
  bool face_away(const TwoEdges& one, const TwoEdges& other) const;

  /// Up to where numbers that are made of directions of such edges are a tie.
  double tie_between(const TwoEdges& one, const TwoEdges& other) const;

  /// Length wanted for edges at b, from what the rim has.
  virtual double wanted(const Vec3& b) const = 0;
  /// Is anything missing on the rim between two of its vertices that the border joins?
  virtual bool rim_is_complete(int, int) const { return true; }
  /// Positively oriented beyond doubt?
  virtual bool valid(int a, int b, int c) const { return positive(b_[a], b_[b], b_[c]); }
  /// Should edge a-b between triangles (c, a, b) and (d, b, a) become c-d?
  virtual bool wants_flip(int a, int b, int c, int d) const = 0;
  /// Neither moved nor taken away.
  virtual bool is_fixed(int v) const { return on_rim(v) || on_lattice_[v]; }
  /// May an edge join them?
  virtual bool may_join(int, int) const { return true; }

  /// On the surface.
  virtual Points positions(const std::vector<Vec3>& b) const = 0;

  /// Of `count` triangles that the wanted sizes ask for, before any is made: not more than the rim or the resolution do, which says the
  /// sizes inside.
  void bound_triangles(double count, double edges, std::optional<int> resolution);

  virtual int add_vertex(const Vec3& b, const Vec3& x);
  /// Once all vertices of the rim are there: how far rounding may move them, in a hole of that size or theirs.
  void set_lowest(double size = 0);
  bool on_rim(int v) const { return v < rim_; }
  bool alive(int t) const { return triangles_[t].v[0] >= 0; }
  std::size_t alive_triangles() const;
  double length(int a, int b) const { return (x_[a] - x_[b]).norm(); }
  double shape_of(int a, int b, int c) const { return shape(x_[a], x_[b], x_[c]); }
  static bool positive(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double ux = b[1] - a[1], uy = b[2] - a[2], vx = c[1] - a[1], vy = c[2] - a[2];
    const double longest = std::max(std::max(std::abs(ux), std::abs(uy)), std::max(std::abs(vx), std::abs(vy)));
    return ux * vy - vx * uy > rounding * longest;
  }

  /// Sizes of inner vertices: what is wanted; more near longer rim edges; not more than what shorter neighbors allow; and, next to
  /// a rim edge, what lets its triangle be tall enough.
  void limit_sizes();
  double size_of_edge(int a, int b) const { return 0.5 * (size_[a] + size_[b]); }

  void link(int t, int old_neighbor, int new_neighbor);
  int slot(int t, int neighbor) const {
    const auto& n = triangles_[t].n;
    return n[0] == neighbor ? 0 : n[1] == neighbor ? 1 : 2;
  }
  int corner_of(int t, int v) const {
    const auto& c = triangles_[t].v;
    return c[0] == v ? 0 : c[1] == v ? 1 : 2;
  }
  /// Puts vertex m on the edge opposite v[k] of triangle t, on both sides of it.
  void split_edge(int t, int k, int m);
  /// Can the inner edge opposite v[k] of t be halved at m, nothing turned over?
  bool can_split(int t, int k, const Vec3& m) const;
  void look_at_all();
  /// Flips edges while that is wanted.
  void flip_all();
  /// The corners of triangles at an inner vertex, in order.
  const std::vector<Corner>& around(int v);
  /// Takes inner vertices away where edges are too short, by pulling them onto a neighbor.
  void collapse_short();

  struct Way {
    Vec2 step;      // in the domain
    Vec3 in_space;  // the same, by the local Jacobian
  };
  /// Where inner vertex v should go: to the size-weighted center of the triangles around, in its tangent plane. None where that is
  /// not known.
  std::optional<Way> way_of(int v);

  /// Of a mesh whose triangles are as large as `rows_` rows of the wanted sizes: takes those out whose sizes the rim does not change. They
  /// become lattices. What is left is a band along the rim, to be remeshed again; its inner border has the vertices of the lattices, which stay.
  /// False if there is but one row: then nothing is left to do.
  bool take_lattices_out();
  /// The last step: the triangles of the lattices have no neighbors.
  void add_lattices();

  bool star_is_valid(int v, const Vec3& b);
  /// The worst shape around v when it stands at x; negative where a triangle faces away from the others.
  double star_quality(int v, const Vec3& x);

  int rim_;               // vertices 0 .. rim_ - 1 are the rim
  double lowest_ = 0;     // height of a triangle in space up to which it may be rounding
  double decline_ = 0.8;  // of the size per distance, where the rim is coarser
  double coarser_ = 1;    // the inside than the wanted sizes
  int rows_ = 1;          // of a lattice
  double most_ = 0;       // triangles beyond which no inner edge is split
  std::size_t looks_ = many_looks;
  std::vector<Vec3> b_;  // in the domain: the last two coordinates count
  std::vector<Vec3> x_;  // in space
  std::vector<double> size_;
  std::vector<int> triangle_of_;  // one triangle of each vertex, -1: removed
  std::vector<Triangle> triangles_;
  std::vector<std::array<int, 2>> dirty_;  // edges (triangle, opposite corner) to be looked at
  std::vector<char> on_lattice_;           // whether a vertex is a corner of one or on an edge of one

private:
  void raise_beside_rim(double fall);
  bool collapse(int v, int w);
  void cut_edges_of_lattices();
  /// The vertex so many rows from one corner of a lattice to another.
  int on_lattice_edge(int from, int to, int row) const;

  std::vector<Corner> ring_;
  int ring_of_ = -1;  // the vertex that it is around, until triangles change
  /// Of a vertex in the triangles around it: a neighbor, in space and in the domain, and how much it counts.
  struct Spoke {
    Vec3 x;
    Vec2 along;
    double near;
  };
  std::vector<Spoke> spokes_;
  struct StarTriangle {
    Vec3 normal;  // as long as `area`, which is twice the triangle's
    double area, shape;
  };
  std::vector<StarTriangle> star_;
  std::vector<std::array<int, 3>> lattices_;         // corners
  std::map<std::array<int, 2>, int> first_on_edge_;  // of the vertices on an edge of a lattice, from its lower vertex on
  // of the vertex that is being collapsed: neighbors in order, ring_[i] spanning link_of_v_[i] and [i + 1], and what lies beyond
  std::vector<int> link_of_v_, link_triangles_;
};

}  // namespace tripatch
