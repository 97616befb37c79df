#include "tripatch/creases/creased_fill.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <set>

#include "tripatch/creases/crease_curve.h"
#include "tripatch/creases/hinged_surface.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/mesh/triangles.h"
#include "tripatch/report/crossings.h"
#include "tripatch/report/folded_triangles.h"
#include "tripatch/spline/disc.h"

namespace tripatch {
namespace {

using VertexLoop = std::vector<Index>;
using EdgeKey = std::array<Index, 2>;

/// Vertices of a crease that its curve is fitted to, on either side: farther ones tell nothing of the hole. Of 68 holes across
/// creases (features.cpp) none has more than 17; with twelve their fills are as near in the mean.
constexpr Index max_of_chain = 24;
/// New edges along a crease for each edge of the rim, if no resolution is given. The crease is at most half as long as the rim.
/// With edges as short as those at its ends a rim of 65 edges got 60,000 triangles.
constexpr Index crease_edges_a_rim_edge = 1;

/// Of an edge: a crease that passes a vertex of the rim more closely leaves parts that touch themselves there. On which side of it the vertex
/// lies is chance where single precision decides, within 1e-6; ten roofs with a rim that comes down to the crease are filled alike at any
/// distance from 1e-9 on.
constexpr double grazing = 1e-4;
/// Of the rim's length: an edge at a crease's end counts as that long, so that the number of new points stays a number.
constexpr double min_size = 1e-6;
/// Sizes at a crease's two ends that differ by this share are one: the number of edges between them has its limit there.
constexpr double one_size = 1e-6;
/// A point nearer to a crease than this share of its edges is meant to lie on it.
constexpr double on_crease = 0.05;

EdgeKey edge_key(Index a, Index b) { return {std::min(a, b), std::max(a, b)}; }

/// A line through points, linear between them, and their deviations.
class Polyline {
public:
  explicit Polyline(const WallCrease& crease) : crease_(crease), along_(crease.points.rows()) {
    along_[0] = 0;
    for (Index k = 1; k < along_.size(); ++k)
      along_[k] = along_[k - 1] + (crease.points.row(k) - crease.points.row(k - 1)).norm();
  }
  double length() const { return along_[along_.size() - 1]; }
  Points at(const Eigen::VectorXd& shares) const { return mixed(shares, crease_.points); }
  Eigen::VectorXd deviation(const Eigen::VectorXd& shares) const { return mixed(shares, crease_.deviation); }

private:
  template <class Rows>
  Rows mixed(const Eigen::VectorXd& shares, const Rows& rows) const {
    Rows out(shares.size(), rows.cols());
    for (Index k = 0; k < shares.size(); ++k) {
      const double place = shares[k] * length();
      Index j = 1;
      while (j + 1 < along_.size() && along_[j] < place) ++j;
      const double t = (place - along_[j - 1]) / std::max(along_[j] - along_[j - 1], 1e-300);
      out.row(k) = (1 - t) * rows.row(j - 1) + t * rows.row(j);
    }
    return out;
  }

  const WallCrease& crease_;
  Eigen::VectorXd along_;
};

/// The creases in the hole and the loops around the parts between them. New points are numbered after the mesh's vertices.
class Division {
public:
  Division(const Mesh& mesh, const VertexLoop& rim, const Features& features, const PlaneFillOptions& options)
      : mesh_(mesh), rim_(rim), first_(mesh.vertices.rows()), loops_({rim}) {
    const Index r = static_cast<Index>(rim.size());
    for (Index k = 0; k < r; ++k) around_ += edge(k);
    if (options.resolution) even_ = around_ / (3 * *options.resolution);
    if (features.walls) join(*features.walls);
    for (const Crease& crease : features.walls ? std::vector<Crease>() : features.creases) {
      if (crease.ends.size() == 2)
        cross(crease);
      else
        meet(crease);
    }
  }

  const std::vector<VertexLoop>& loops() const { return loops_; }
  const std::vector<VertexLoop>& curves() const { return curves_; }  // with their ends
  Index added() const { return static_cast<Index>(points_.size()); }
  Vec3 point(Index v) const { return v < first_ ? Vec3(mesh_.vertices.row(v)) : points_[static_cast<std::size_t>(v - first_)]; }
  double deviation(Index v) const { return v < first_ ? 0 : deviation_[static_cast<std::size_t>(v - first_)]; }
  Index first() const { return first_; }
  double even() const { return even_; }

private:
  double edge(Index k) const {
    const Index r = static_cast<Index>(rim_.size());
    return (mesh_.vertices.row(rim_[k % r]) - mesh_.vertices.row(rim_[(k + 1) % r])).norm();
  }
  /// How long edges are at a place of the rim.
  double size(Index place) const {
    const Index r = static_cast<Index>(rim_.size());
    return even_ > 0 ? even_ : std::max((edge(place) + edge(place + r - 1)) / 2, min_size * around_);
  }

  Points chain(const CreaseEnd& end, bool towards) const {
    const Index n = std::min(static_cast<Index>(end.chain.size()), max_of_chain);
    Points p(n, 3);
    for (Index k = 0; k < n; ++k) p.row(towards ? n - 1 - k : k) = mesh_.vertices.row(end.chain[k]);
    return p;
  }

  /// New points of a curve between two rows, spaced from the size at one end to that at the other. At least `least` edges.
  template <class Curve>
  VertexLoop points_along(Index from, Index to, const Curve& curve, double before, double after, Index least) {
    // edges of linearly growing length: their number is the integral of 1 / size
    const double ratio = after / before;
    const double edges = curve.length() / before * (std::abs(ratio - 1) < one_size ? 1 : std::log(ratio) / (ratio - 1));
    const Index asked = static_cast<Index>(std::llround(std::min((1 - tie) * edges, 1e9)));
    const Index count =
        std::max(least, even_ > 0 ? asked : std::min(asked, crease_edges_a_rim_edge * static_cast<Index>(rim_.size())));
    VertexLoop line = {from};
    if (count > 1) {
      Eigen::VectorXd shares(count - 1);
      for (Index k = 1; k < count; ++k) {
        const double t = static_cast<double>(k) / static_cast<double>(count);
        shares[k - 1] = std::abs(ratio - 1) < one_size ? t : (std::pow(ratio, t) - 1) / (ratio - 1);
      }
      const Points p = curve.at(shares);
      const Eigen::VectorXd s = curve.deviation(shares);
      for (Index k = 0; k + 1 < count; ++k) line.push_back(add(p.row(k), s[k]));
    }
    line.push_back(to);
    curves_.push_back(line);
    return line;
  }

  Index add(const Vec3& p, double deviation) {
    points_.push_back(p);
    deviation_.push_back(deviation);
    return first_ + static_cast<Index>(points_.size()) - 1;
  }

  void cross(const Crease& crease) {
    const CreaseEnd &a = crease.ends[0], &b = crease.ends[1];
    const Index from = a.chain[0], to = b.chain[0];
    for (std::size_t k = 0; k < loops_.size(); ++k) {
      const VertexLoop loop = loops_[k];
      const auto i = std::find(loop.begin(), loop.end(), from), j = std::find(loop.begin(), loop.end(), to);
      if (i == loop.end() || j == loop.end()) continue;
      const CreaseCurve curve(chain(a, true), chain(b, false), (size(a.place) + size(b.place)) / 2);
      const VertexLoop line =
          points_along(from, to, curve, size(a.place), size(b.place), even_ > 0 && !clearly_less(even_ * 3, around_) ? 1 : 2);
      VertexLoop turned = loop;  // from the crease's start on
      std::rotate(turned.begin(), turned.begin() + (i - loop.begin()), turned.end());
      const auto end = std::find(turned.begin(), turned.end(), to);
      VertexLoop first(turned.begin(), end), second(end, turned.end());
      first.insert(first.end(), line.rbegin(), line.rend() - 1);
      second.insert(second.end(), line.begin(), line.end() - 1);
      loops_[k] = first;
      loops_.push_back(second);
      return;
    }
  }

  void meet(const Crease& crease) {
    if (loops_.size() != 1) return;
    const std::size_t n = crease.ends.size();
    const Index node = add(crease.node, 0);
    Points at_node(1, 3);
    at_node << crease.node.transpose();
    std::vector<VertexLoop> spokes;
    double mean = 0, spread = 0;
    for (const CreaseEnd& end : crease.ends) mean += size(end.place) / static_cast<double>(n);
    for (const CreaseEnd& end : crease.ends) {
      const CreaseCurve curve(chain(end, true), at_node, mean);
      spokes.push_back(points_along(end.chain[0], node, curve, size(end.place), mean, 1));
      const Vec3 to = crease.node - Vec3(mesh_.vertices.row(end.chain[0]));
      spread = std::max(spread, (to - to.dot(end.into) * end.into).norm());
    }
    deviation_[static_cast<std::size_t>(node - first_)] = spread;
    const VertexLoop whole = loops_[0];
    loops_.clear();
    for (std::size_t k = 0; k < n; ++k) {
      const VertexLoop &here = spokes[k], &next = spokes[(k + 1) % n];
      VertexLoop turned = whole;
      std::rotate(turned.begin(), std::find(turned.begin(), turned.end(), here[0]), turned.end());
      VertexLoop part(turned.begin(), std::find(turned.begin(), turned.end(), next[0]));
      part.insert(part.end(), next.begin(), next.end());
      part.insert(part.end(), here.rbegin() + 1, here.rend() - 1);
      loops_.push_back(std::move(part));
    }
  }

  /// Walls that meet along creases.
  void join(const Walls& walls) {
    const Index r = static_cast<Index>(rim_.size());
    double sum = 0, count = 0;  // of sizes of edges at the rim
    for (const auto& [ends, crease] : walls.creases)
      for (const Index corner : ends)
        if (corner < r) sum += size(corner), ++count;
    const double mean = count > 0 ? sum / count : around_ / static_cast<double>(r);
    VertexLoop nodes;
    for (std::size_t k = 0; k < walls.nodes.size(); ++k) nodes.push_back(add(walls.nodes[k], walls.deviation[k]));
    const auto vertex = [&](Index corner) { return corner < r ? rim_[corner] : nodes[corner - r]; };
    std::map<EdgeKey, VertexLoop> creases;
    for (const auto& [ends, crease] : walls.creases) {
      const auto [from, to] = ends;
      const Index least = from < r && to < r && !(even_ > 0 && !clearly_less(even_ * 3, around_)) ? 2 : 1;
      creases[ends] =
          points_along(vertex(from), vertex(to), Polyline(crease), from < r ? size(from) : mean, to < r ? size(to) : mean, least);
    }
    loops_.clear();
    for (const std::vector<Index>& part : walls.parts) {
      loops_.emplace_back();
      for (std::size_t k = 0; k < part.size(); ++k) {
        const Index from = part[k], to = part[(k + 1) % part.size()];
        const auto crease = creases.find(edge_key(from, to));
        VertexLoop way = crease == creases.end() ? VertexLoop{vertex(from), vertex(to)} : crease->second;
        if (from > to && crease != creases.end()) std::reverse(way.begin(), way.end());
        loops_.back().insert(loops_.back().end(), way.begin(), way.end() - 1);
      }
    }
  }

  const Mesh& mesh_;
  const VertexLoop& rim_;
  Index first_;
  double around_ = 0, even_ = 0;
  std::vector<VertexLoop> loops_, curves_;
  std::vector<Vec3> points_;
  std::vector<double> deviation_;
};

/// For each part the faces on its side of the creases: from its piece of the rim on across edges that are not sharp.
std::vector<std::vector<Index>> faces_of_parts(const Mesh& mesh, const Connectivity& around, const Features& features,
                                               const std::vector<VertexLoop>& loops) {
  if (features.walls) return features.walls->faces;
  std::set<EdgeKey> barred(features.barred.begin(), features.barred.end());
  for (const Crease& crease : features.creases)
    for (const CreaseEnd& end : crease.ends)
      for (std::size_t k = 0; k + 1 < end.chain.size(); ++k) barred.insert(edge_key(end.chain[k], end.chain[k + 1]));
  const auto near = [&](Index f) {
    const auto face = mesh.faces[f];
    return std::all_of(face.begin(), face.end(),
                       [&](Index v) { return std::binary_search(features.vertices.begin(), features.vertices.end(), v); });
  };
  std::vector<std::vector<Index>> faces(loops.size());
  std::deque<std::pair<Index, std::size_t>> open;
  Numbering taken;
  const auto claim = [&](Index a, Index b, std::size_t part) {  // the face that holds the edge so
    if (barred.count(edge_key(a, b))) return;
    const auto corner = around.edge(a, b);
    if (!corner || !near(around.face(*corner)) || !taken.add(around.face(*corner))) return;
    open.emplace_back(around.face(*corner), part);
  };
  for (std::size_t part = 0; part < loops.size(); ++part)
    for (std::size_t k = 0; k < loops[part].size(); ++k) {
      const Index a = loops[part][k], b = loops[part][(k + 1) % loops[part].size()];
      if (a < mesh.vertices.rows() && b < mesh.vertices.rows()) claim(b, a, part);
    }
  while (!open.empty()) {
    const auto [f, part] = open.front();
    open.pop_front();
    faces[part].push_back(f);
    const auto face = mesh.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) claim(face[(k + 1) % face.size()], face[k], part);
  }
  return faces;
}

/// One part as a hole of a mesh of its own: its loop's vertices come first, then those of the faces around.
struct CreasedPart {
  Points vertices;
  Faces faces;
  VertexLoop loop;  // 0, 1, 2, ...
  PlaneFillOptions options;
};

CreasedPart creased_part(const Mesh& mesh, const Connectivity& around, const Division& division, std::size_t number,
                         const std::vector<Index>& faces, const PlaneFillOptions& options) {
  const VertexLoop& loop = division.loops()[number];
  const Index r = static_cast<Index>(loop.size());
  Numbering row;
  for (Index v : loop) row.add(v);
  for (Index f : faces)
    for (Index v : mesh.faces[f]) row.add(v);
  CreasedPart part;
  part.vertices.resize(static_cast<Index>(row.size()), 3);
  for (Index k = 0; k < part.vertices.rows(); ++k)
    part.vertices.row(k) = division.point(row.items()[static_cast<std::size_t>(k)]);
  for (Index f : faces) {
    VertexLoop face;
    for (Index v : mesh.faces[f]) face.push_back(row.find(v));
    part.faces.add(face);
  }
  double length = 0;
  for (Index k = 0; k < r; ++k) {
    part.loop.push_back(k);
    length += (part.vertices.row(k) - part.vertices.row((k + 1) % r)).norm();
    if (loop[k] >= division.first()) continue;
    for (Connectivity::Corner c : around.at(loop[k]))
      for (Index other : {around.next(c), around.previous(c)})
        if (const Index at = row.find(other); at >= 0 && at < r && at != k) part.options.joined.push_back(edge_key(k, at));
  }
  // What is inside one part between the points of a crease must not be inside another.
  for (const VertexLoop& curve : division.curves())
    for (std::size_t i = 0; i < curve.size(); ++i)
      for (std::size_t j = i + 2; j < curve.size(); ++j) {
        const Index a = row.find(curve[i]), b = row.find(curve[j]);
        if (a >= 0 && a < r && b >= 0 && b < r) part.options.joined.push_back(edge_key(a, b));
      }
  std::sort(part.options.joined.begin(), part.options.joined.end());
  part.options.joined.erase(std::unique(part.options.joined.begin(), part.options.joined.end()), part.options.joined.end());
  if (options.resolution)
    part.options.resolution =
        std::max(1, static_cast<int>(std::lround((1 - tie) * length / (3 * std::max(division.even(), 1e-300)))));
  else if (r == 3 || (faces.empty() && r > long_rim))  // else a triangle has no surface, a long rim by itself none
    part.options.resolution = static_cast<int>(r / 3);
  return part;
}

/// Where the domains of the parts go: each next to one that shares a crease with it, no nearer than their curves allow.
std::vector<PlaneMotion> hinged_motions(const Division& division, const std::vector<PlaneFill>& fills) {
  const std::vector<VertexLoop>& loops = division.loops();
  std::vector<PlaneMotion> motions(fills.size());
  std::vector<char> placed(fills.size(), 0);
  placed[0] = 1;
  const auto place_of = [&](std::size_t part, Index v) -> Eigen::Vector2d {
    const auto at = std::find(loops[part].begin(), loops[part].end(), v);
    return fills[part].rim_uv.row(at - loops[part].begin()).transpose();
  };
  const auto has = [&](std::size_t part, const VertexLoop& curve) {
    return std::all_of(curve.begin(), curve.end(),
                       [&](Index v) { return std::find(loops[part].begin(), loops[part].end(), v) != loops[part].end(); });
  };
  for (bool more = true; more;) {
    more = false;
    for (const VertexLoop& curve : division.curves())
      for (std::size_t i = 0; i < fills.size(); ++i)
        for (std::size_t j = 0; j < fills.size(); ++j) {
          if (!placed[i] || placed[j] || !has(i, curve) || !has(j, curve)) continue;
          const auto there = [&](Index v) -> Eigen::Vector2d { return motions[i].turn * place_of(i, v) + motions[i].shift; };
          const Eigen::Vector2d a = there(curve.front()), b = there(curve.back());
          const Eigen::Vector2d p = place_of(j, curve.front()), q = place_of(j, curve.back());
          const Eigen::Vector2d along = (b - a).normalized(), own = (q - p).normalized();
          const double c = own.dot(along), s = own[0] * along[1] - own[1] * along[0];
          PlaneMotion& motion = motions[j];
          motion.turn << c, -s, s, c;
          motion.shift = (a + b) / 2 - motion.turn * (p + q) / 2;
          // off part i, whose middle says on which side it lies
          Eigen::Vector2d normal(-along[1], along[0]);
          const Eigen::Vector2d middle = motions[i].of(fills[i].rim_uv).colwise().mean().transpose();
          if (normal.dot(middle - a) > 0) normal = -normal;
          double apart = 0;
          for (Index v : curve) apart = std::max(apart, normal.dot(there(v) - motion.turn * place_of(j, v) - motion.shift));
          motion.shift += apart * normal;
          placed[j] = 1;
          more = true;
        }
  }
  return motions;
}

/// In a row, where hinged_motions domains overlap.
std::vector<PlaneMotion> motions_in_a_row(const std::vector<PlaneFill>& fills) {
  std::vector<PlaneMotion> motions(fills.size());
  double right = 0;
  for (std::size_t k = 0; k < fills.size(); ++k) {
    const double low = fills[k].rim_uv.col(0).minCoeff(), high = fills[k].rim_uv.col(0).maxCoeff();
    motions[k].shift[0] = right - low;
    right += 1.5 * (high - low);
  }
  return motions;
}

/// The parts as one fill of the rim.
class JoinedParts {
public:
  JoinedParts(const VertexLoop& rim, const Division& division, const std::vector<PlaneFill>& fills)
      : rim_(rim), division_(division), fills_(fills) {
    const Index r = static_cast<Index>(rim.size());
    for (Index k = 0; k < r; ++k) row_[rim[k]] = k;
    for (Index k = 0; k < division.added(); ++k) row_[division.first() + k] = r + k;
    Index next = r + division.added();
    for (const PlaneFill& fill : fills) {
      start_.push_back(next);
      next += fill.vertices.rows();
    }
    count_ = next;
  }

  PlaneFill fill() const {
    const Index r = static_cast<Index>(rim_.size());
    PlaneFill out;
    out.vertices.resize(count_ - r, 3);
    for (Index k = 0; k < division_.added(); ++k) out.vertices.row(k) = division_.point(division_.first() + k);
    for (std::size_t part = 0; part < fills_.size(); ++part) {
      const PlaneFill& fill = fills_[part];
      out.vertices.middleRows(start_[part] - r, fill.vertices.rows()) = fill.vertices;
      const Index loop = static_cast<Index>(division_.loops()[part].size());
      for (std::array<Index, 3> t : fill.triangles) {
        for (Index& v : t) v = v < loop ? row_.at(division_.loops()[part][v]) : start_[part] + v - loop;
        out.triangles.push_back(t);
      }
      out.surroundings_error = std::max(out.surroundings_error, fill.surroundings_error);
      out.rings = std::max(out.rings, fill.rings);
      if (!out.plainer) out.plainer = fill.plainer;
      out.doubles_edges |= fill.doubles_edges;
    }
    for (const VertexLoop& curve : division_.curves())
      for (std::size_t k = 0; k + 1 < curve.size(); ++k) out.creases.push_back({row_.at(curve[k]), row_.at(curve[k + 1])});
    deviations(out);
    surface(out);
    return out;
  }

private:
  /// The samples of a part's field on a crease are not known to be there: their deviation counts the less, the nearer the rim is.
  void deviations(PlaneFill& out) const {
    const Index r = static_cast<Index>(rim_.size()), added = division_.added();
    out.deviation = Eigen::VectorXd::Zero(count_ - r);
    for (Index k = 0; k < added; ++k) out.deviation[k] = division_.deviation(division_.first() + k);
    for (std::size_t part = 0; part < fills_.size(); ++part) {
      const VertexLoop& loop = division_.loops()[part];
      for (Index k = 0; k < fills_[part].vertices.rows(); ++k) {
        double sum = 0, weights = 0;
        for (Index v : loop) {
          const double w = 1 / std::max((division_.point(v) - Vec3(fills_[part].vertices.row(k))).squaredNorm(), 1e-300);
          weights += w;
          sum += w * division_.deviation(v);
        }
        out.deviation[start_[part] - r + k] = Vec2(fills_[part].deviation[k], sum / weights).stableNorm();
      }
    }
  }

  /// Where the domains of hinged parts overlap they are laid in a row, a half of their width apart.
  void surface(PlaneFill& out) const {
    std::shared_ptr<const HingedSurface> hinged = laid(hinged_motions(division_, fills_), out);
    if (!are_found(*hinged, out)) hinged = laid(motions_in_a_row(fills_), out);
    out.surface = std::move(hinged);
  }

  /// Whether a surface has the parts' own vertices in them, and is nearer to each point of a crease than those next to it are.
  bool are_found(const HingedSurface& hinged, const PlaneFill& out) const {
    const Index r = static_cast<Index>(rim_.size());
    for (std::size_t part = 0; part < fills_.size(); ++part)
      for (Index k = 0; k < fills_[part].vertices.rows(); ++k)
        if (hinged.part_of(out.uv.row(start_[part] - r + k)) != part) return false;
    const Points at = hinged.positions(as_rows(out.uv.topRows(division_.added())));
    for (const VertexLoop& curve : division_.curves())
      for (std::size_t k = 1; k + 1 < curve.size(); ++k) {
        const Vec3 point = division_.point(curve[k]), found = at.row(curve[k] - division_.first());
        const double beside =
            std::min((division_.point(curve[k - 1]) - point).norm(), (division_.point(curve[k + 1]) - point).norm());
        if (!((found - point).norm() < beside)) return false;
      }
    return true;
  }

  /// The parts in one plane; out: gets the places there and normals.
  std::shared_ptr<const HingedSurface> laid(const std::vector<PlaneMotion>& motions, PlaneFill& out) const {
    const Index r = static_cast<Index>(rim_.size());
    std::vector<HingedSurface::Part> parts;
    for (std::size_t k = 0; k < fills_.size(); ++k) parts.push_back({fills_[k].surface, fills_[k].rim_uv, motions[k]});
    PlanePoints uv = PlanePoints::Zero(count_, 2);
    Points normals = Points::Zero(count_, 3);
    std::vector<char> known(count_, 0);
    for (std::size_t part = 0; part < fills_.size(); ++part) {
      const PlaneFill& fill = fills_[part];
      const PlanePoints loop = motions[part].of(fill.rim_uv);
      Points at = Points::Zero(loop.rows(), 3);
      at.leftCols(2) = fill.rim_uv;
      const Points at_loop = fill.surface->normals(at);
      for (Index k = 0; k < loop.rows(); ++k) {
        const Index row = row_.at(division_.loops()[part][k]);
        if (!known[row]) uv.row(row) = loop.row(k);
        known[row] = 1;
        normals.row(row) += at_loop.row(k);
      }
      uv.middleRows(start_[part], fill.uv.rows()) = motions[part].of(fill.uv);
      normals.middleRows(start_[part], fill.uv.rows()) = fill.normals;
    }
    for (Index k = 0; k < count_; ++k) normals.row(k) = Vec3(normals.row(k)).stableNormalized();
    out.rim_uv = uv.topRows(r);
    out.uv = uv.bottomRows(count_ - r);
    out.rim_normals = normals.topRows(r);
    out.normals = normals.bottomRows(count_ - r);
    return std::make_shared<HingedSurface>(std::move(parts));
  }

  const VertexLoop& rim_;
  const Division& division_;
  const std::vector<PlaneFill>& fills_;
  std::map<Index, Index> row_;  // of the rim's vertices and the creases' points
  std::vector<Index> start_;    // of each part's own vertices
  Index count_ = 0;
};

}  // namespace

namespace {

double distance_to_edge(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 way = b - a;
  const double along = std::clamp((p - a).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
  return (p - a - along * way).norm();
}

/// Whether a crease runs along the rim, or over one of its vertices.
bool grazes_rim(const Division& division, const VertexLoop& rim) {
  const std::size_t r = rim.size();
  for (const VertexLoop& curve : division.curves())
    for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
      const Vec3 a = division.point(curve[k]), b = division.point(curve[k + 1]);
      const double near = grazing * (b - a).norm();
      for (std::size_t j = 0; j < r; ++j) {
        const bool ends_there = rim[j] == curve.front() || rim[j] == curve.back();
        if (!ends_there && distance_to_edge(division.point(rim[j]), a, b) < near) return true;
        const bool is_inner = k > 0 && rim[j] != curve[k] && rim[(j + 1) % r] != curve[k];
        if (is_inner && distance_to_edge(a, division.point(rim[j]), division.point(rim[(j + 1) % r])) < near) return true;
      }
    }
  return false;
}

/// Fills of parts again, each through the points that are nearest to it. False where one lies on a crease, which is not known to run
/// there, or a part finds no surface.
bool meet_inside(const std::vector<Through>& through, const Division& division, std::vector<CreasedPart>& parts,
                 std::vector<PlaneFill>& fills) {
  for (const Through& met : through) {
    for (const VertexLoop& curve : division.curves())
      for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
        const Vec3 a = division.point(curve[k]), b = division.point(curve[k + 1]);
        if (distance_to_edge(met.point, a, b) < on_crease * (b - a).norm()) return false;
      }
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t part = 0; part < parts.size(); ++part) {
      const Index r = static_cast<Index>(parts[part].loop.size());
      const auto corner = [&](Index v) -> Vec3 {
        return v < r ? Vec3(parts[part].vertices.row(v)) : Vec3(fills[part].vertices.row(v - r));
      };
      for (const std::array<Index, 3>& t : fills[part].triangles) {
        const double far = ((corner(t[0]) + corner(t[1]) + corner(t[2])) / 3 - met.point).norm();
        if (far < least) least = far, best = part;
      }
    }
    parts[best].options.through.push_back(met);
  }
  for (std::size_t part = 0; part < parts.size(); ++part) {
    if (parts[part].options.through.empty()) continue;
    const Mesh own{parts[part].vertices, parts[part].faces};
    fills[part] = fill_over_plane(own, Connectivity(own), {parts[part].loop}, parts[part].options);
    if (!fills[part].surface || fills[part].doubles_edges) return false;
  }
  return true;
}

}  // namespace

std::optional<PlaneFill> fill_across_creases(const Mesh& mesh, const Connectivity& around, const VertexLoop& rim,
                                             const Features& features, const PlaneFillOptions& options) {
  if (!features.found()) return {};
  const Division division(mesh, rim, features, options);
  if (grazes_rim(division, rim)) return {};
  const std::vector<std::vector<Index>> faces = faces_of_parts(mesh, around, features, division.loops());
  const double size = diameter(mesh, rim);
  std::vector<PlaneFill> fills;
  std::vector<CreasedPart> parts;
  for (std::size_t k = 0; k < division.loops().size(); ++k) {
    CreasedPart part = creased_part(mesh, around, division, k, faces[k], options);
    part.options.size = size;
    const Mesh own{part.vertices, part.faces};
    fills.push_back(fill_over_plane(own, Connectivity(own), {part.loop}, part.options));
    if (!fills.back().surface || fills.back().doubles_edges) return {};
    if (features.walls) fills.back().plainer.reset();  // a wall of which nothing is left is as flat as its rim
    parts.push_back(part);
  }
  if (!meet_inside(options.through, division, parts, fills)) return {};
  PlaneFill fill = JoinedParts(rim, division, fills).fill();
  Points points(static_cast<Index>(rim.size()) + fill.vertices.rows(), 3);
  for (std::size_t k = 0; k < rim.size(); ++k) points.row(static_cast<Index>(k)) = mesh.vertices.row(rim[k]);
  points.bottomRows(fill.vertices.rows()) = fill.vertices;
  fill.folds = count_folded_edges(points, Points(0, 3), faces_of(fill.triangles), faces_beyond_rows(mesh, around, {rim}));
  fill.rim_folds = folds_of_rim(mesh, around, {rim});
  // walls and creases that meet so sharply leave no other way either
  if (std::ranges::all_of(fills, [](const PlaneFill& part) { return part.folds == 0; }))
    fill.rim_folds = std::max(fill.rim_folds, fill.folds);
  if (fill.folds > fill.rim_folds || crosses_itself(points, fill.triangles)) return {};
  return fill;
}

}  // namespace tripatch
