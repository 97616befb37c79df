#include "tripatch/creases/joined_parts.h"

#include <algorithm>
#include <map>
#include <memory>
#include <utility>

#include "tripatch/creases/hinged_surface.h"
#include "tripatch/math/tolerances.h"

namespace tripatch {
namespace {

/// Where the domains of the parts go: each next to one that shares a crease with it, no nearer than their curves allow.
std::vector<PlaneMotion> hinged_motions(const Division& division, const std::vector<PlaneFill>& fills) {
  const std::vector<VertexLoop>& loops = division.loops;
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
    for (const VertexLoop& curve : division.curves)
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
      const Index loop = static_cast<Index>(division_.loops[part].size());
      for (std::array<Index, 3> t : fill.triangles) {
        for (Index& v : t) v = v < loop ? row_.at(division_.loops[part][v]) : start_[part] + v - loop;
        out.triangles.push_back(t);
      }
      out.surroundings_error = std::max(out.surroundings_error, fill.surroundings_error);
      out.rings = std::max(out.rings, fill.rings);
      if (!out.plainer) out.plainer = fill.plainer;
      out.doubles_edges |= fill.doubles_edges;
    }
    for (const VertexLoop& curve : division_.curves)
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
      const VertexLoop& loop = division_.loops[part];
      for (Index k = 0; k < fills_[part].vertices.rows(); ++k) {
        double sum = 0, weights = 0;
        for (Index v : loop) {
          const double w = 1 / std::max((division_.point(v) - Vec3(fills_[part].vertices.row(k))).squaredNorm(), tolerance::tiny);
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
    for (const VertexLoop& curve : division_.curves)
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
        const Index row = row_.at(division_.loops[part][k]);
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

PlaneFill joined_parts(const VertexLoop& rim, const Division& division, const std::vector<PlaneFill>& fills) {
  return JoinedParts(rim, division, fills).fill();
}

}  // namespace tripatch
