#include "tripatch/creases/crease_division.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "tripatch/creases/crease_curve.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/edge_key.h"

namespace tripatch {
namespace {

/// Vertices of a crease that its curve is fitted to, on either side: farther ones tell nothing of the hole. Of 68 holes across
/// creases (features.cpp) none has more than 17; with twelve their fills are as near in the mean.
constexpr Index max_of_chain = count::dozens;

/// A smooth curve through points, and their deviations, linear between them.
class AlongCrease {
public:
  explicit AlongCrease(const WallCrease& crease)
      : crease_(crease), curve_(smooth_through(crease.points)), along_(crease.points.rows()) {
    along_[0] = 0;
    for (Index k = 1; k < along_.size(); ++k)
      along_[k] = along_[k - 1] + (crease.points.row(k) - crease.points.row(k - 1)).norm();
  }
  double length() const { return along_[along_.size() - 1]; }
  Points at(const Eigen::VectorXd& shares) const {
    Points out(shares.size(), 3);
    const double pieces = static_cast<double>(along_.size() - 1);
    for (Index k = 0; k < shares.size(); ++k) {
      const auto [piece, t] = place(shares[k]);
      out.row(k) = curve_((static_cast<double>(piece) + t) / pieces);
    }
    return out;
  }
  Eigen::VectorXd deviation(const Eigen::VectorXd& shares) const {
    Eigen::VectorXd out(shares.size());
    for (Index k = 0; k < shares.size(); ++k) {
      const auto [piece, t] = place(shares[k]);
      out[k] = std::lerp(crease_.deviation[piece], crease_.deviation[piece + 1], t);
    }
    return out;
  }

private:
  /// Between which points a share of the length ends, and the share of the way from the first of them.
  std::pair<Index, double> place(double share) const {
    const double at = share * length();
    Index j = 0;
    while (j + 2 < along_.size() && along_[j + 1] < at) ++j;
    return {j, (at - along_[j]) / std::max(along_[j + 1] - along_[j], tolerance::tiny)};
  }

  const WallCrease& crease_;
  PiecewisePolynomial curve_;
  Eigen::VectorXd along_;
};

class Divider {
public:
  Divider(const Mesh& mesh, const VertexLoop& rim, const Features& features, const PlaneFillOptions& options)
      : mesh_(mesh), rim_(rim), out_{mesh, {rim}} {
    const Index r = static_cast<Index>(rim.size());
    for (Index k = 0; k < r; ++k) around_ += edge(k);
    if (options.resolution) out_.even = around_ / (3 * *options.resolution);
    if (features.walls) join(*features.walls);
    for (const Crease& crease : features.walls ? std::vector<Crease>() : features.creases) {
      if (crease.ends.size() == 2)
        cross(crease);
      else
        meet(crease);
    }
  }

  Division found() { return std::move(out_); }

private:
  double edge(Index k) const {
    const Index r = static_cast<Index>(rim_.size());
    return (mesh_.vertices.row(rim_[k % r]) - mesh_.vertices.row(rim_[(k + 1) % r])).norm();
  }
  /// How long edges are at a place of the rim.
  double size(Index place) const {
    const Index r = static_cast<Index>(rim_.size());
    return out_.even > 0 ? out_.even : std::max((edge(place) + edge(place + r - 1)) / 2, tolerance::same * around_);
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
    const double edges = curve.length() / before * (std::abs(ratio - 1) < tolerance::same ? 1 : std::log(ratio) / (ratio - 1));
    const Index asked = static_cast<Index>(std::llround(std::min((1 - tie) * edges, 1 / tolerance::solved)));
    // If no resolution is given, no more than the rim has: with edges as short as those at its ends a rim of 65 edges got 60,000 triangles.
    const Index count = std::max(least, out_.even > 0 ? asked : std::min(asked, static_cast<Index>(rim_.size())));
    VertexLoop line = {from};
    if (count > 1) {
      Eigen::VectorXd shares(count - 1);
      for (Index k = 1; k < count; ++k) {
        const double t = static_cast<double>(k) / static_cast<double>(count);
        shares[k - 1] = std::abs(ratio - 1) < tolerance::same ? t : (std::pow(ratio, t) - 1) / (ratio - 1);
      }
      const Points p = curve.at(shares);
      const Eigen::VectorXd s = curve.deviation(shares);
      for (Index k = 0; k + 1 < count; ++k) line.push_back(add(p.row(k), s[k]));
    }
    line.push_back(to);
    out_.curves.push_back(line);
    return line;
  }

  Index add(const Vec3& p, double deviation) {
    out_.points.push_back(p);
    out_.deviations.push_back(deviation);
    return out_.first() + out_.added() - 1;
  }

  void cross(const Crease& crease) {
    const CreaseEnd &a = crease.ends[0], &b = crease.ends[1];
    const Index from = a.chain[0], to = b.chain[0];
    for (std::size_t k = 0; k < out_.loops.size(); ++k) {
      const VertexLoop loop = out_.loops[k];
      const auto i = std::find(loop.begin(), loop.end(), from), j = std::find(loop.begin(), loop.end(), to);
      if (i == loop.end() || j == loop.end()) continue;
      const CreaseCurve curve(chain(a, true), chain(b, false), (size(a.place) + size(b.place)) / 2);
      const VertexLoop line = points_along(from, to, curve, size(a.place), size(b.place),
                                           out_.even > 0 && !clearly_less(out_.even * 3, around_) ? 1 : 2);
      VertexLoop turned = loop;  // from the crease's start on
      std::rotate(turned.begin(), turned.begin() + (i - loop.begin()), turned.end());
      const auto end = std::find(turned.begin(), turned.end(), to);
      VertexLoop first(turned.begin(), end), second(end, turned.end());
      first.insert(first.end(), line.rbegin(), line.rend() - 1);
      second.insert(second.end(), line.begin(), line.end() - 1);
      out_.loops[k] = first;
      out_.loops.push_back(second);
      return;
    }
  }

  void meet(const Crease& crease) {
    if (out_.loops.size() != 1) return;
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
    out_.deviations[static_cast<std::size_t>(node - out_.first())] = spread;
    const VertexLoop whole = out_.loops[0];
    out_.loops.clear();
    for (std::size_t k = 0; k < n; ++k) {
      const VertexLoop &here = spokes[k], &next = spokes[(k + 1) % n];
      VertexLoop turned = whole;
      std::rotate(turned.begin(), std::find(turned.begin(), turned.end(), here[0]), turned.end());
      VertexLoop part(turned.begin(), std::find(turned.begin(), turned.end(), next[0]));
      part.insert(part.end(), next.begin(), next.end());
      part.insert(part.end(), here.rbegin() + 1, here.rend() - 1);
      out_.loops.push_back(std::move(part));
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
      const Index least = from < r && to < r && !(out_.even > 0 && !clearly_less(out_.even * 3, around_)) ? 2 : 1;
      creases[ends] = points_along(vertex(from), vertex(to), AlongCrease(crease), from < r ? size(from) : mean,
                                   to < r ? size(to) : mean, least);
    }
    out_.loops.clear();
    for (const std::vector<Index>& part : walls.parts) {
      out_.loops.emplace_back();
      for (std::size_t k = 0; k < part.size(); ++k) {
        const Index from = part[k], to = part[(k + 1) % part.size()];
        const auto crease = creases.find(edge_key(from, to));
        VertexLoop way = crease == creases.end() ? VertexLoop{vertex(from), vertex(to)} : crease->second;
        if (from > to && crease != creases.end()) std::reverse(way.begin(), way.end());
        out_.loops.back().insert(out_.loops.back().end(), way.begin(), way.end() - 1);
      }
    }
  }

  const Mesh& mesh_;
  const VertexLoop& rim_;
  double around_ = 0;
  Division out_;
};

}  // namespace

Division divided(const Mesh& mesh, const VertexLoop& rim, const Features& features, const PlaneFillOptions& options) {
  return Divider(mesh, rim, features, options).found();
}

}  // namespace tripatch
