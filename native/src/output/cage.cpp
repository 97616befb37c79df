#include "tripatch/output/cage.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "tripatch/boundary/limit_sides.h"

namespace tripatch {
namespace {

constexpr double anchor = 1e-5;  ///< weight that keeps a vertex near its start where nothing else holds it

/// The mesh with the fills in place of the holes.
struct Closed {
  Points vertices;
  Faces faces;
  std::vector<Index> kept;          ///< given face of each of the first faces
  std::vector<Index> first_face;    ///< of each fill, and the end
  std::vector<Index> first_vertex;  ///< of each fill's inside, and the end
  Mesh mesh() const { return {vertices, faces}; }
};

Closed close(const Mesh& mesh, const std::vector<CageHole>& holes, const std::vector<Index>& replaced) {
  Closed closed;
  const std::set<Index> gone(replaced.begin(), replaced.end());
  for (Index f = 0; f < mesh.faces.size(); ++f)
    if (!gone.contains(f)) {
      closed.faces.add(mesh.faces[f]);
      closed.kept.push_back(f);
    }
  Index n = mesh.vertices.rows();
  for (const CageHole& h : holes) {
    const Index rim = static_cast<Index>(h.hole.rim.size());
    closed.first_face.push_back(closed.faces.size());
    closed.first_vertex.push_back(n);
    for (Index f = 0; f < h.layout.size(); ++f) {
      std::vector<Index> face;
      for (Index v : h.layout[f]) face.push_back(v < rim ? h.hole.rim[v] : n + v - rim);
      closed.faces.add(face);
    }
    n += h.barycentric.rows() - rim;
  }
  closed.first_face.push_back(closed.faces.size());
  closed.first_vertex.push_back(n);
  closed.vertices.resize(n, 3);
  closed.vertices.topRows(mesh.vertices.rows()) = mesh.vertices;
  return closed;
}

/// A place on a face with what its limit should be.
struct Sample {
  Index face;
  int quarter;
  double u, v;
};

/// Places spread over a face: cell centres of a grid (of each quarter of an n-gon).
std::vector<Sample> spread(Index face, std::size_t size, int count, bool loop) {
  std::vector<Sample> samples;
  if (loop) {  // the corners' thirds of the small triangles
    for (int i = 0; i < count; ++i)
      for (int j = 0; i + j < count; ++j) samples.push_back({face, 0, (i + 1.0 / 3) / count, (j + 1.0 / 3) / count});
    return samples;
  }
  const int per = size == 4 ? count : (count + 1) / 2;
  for (int q = 0; q < (size == 4 ? 1 : static_cast<int>(size)); ++q)
    for (int i = 0; i < per; ++i)
      for (int j = 0; j < per; ++j) samples.push_back({face, q, (i + 0.5) / per, (j + 0.5) / per});
  return samples;
}

/// Barycentric coordinates there, bilinear between those of the face's corners.
Vec3 barycentric_at(const Sample& s, std::span<const Index> face, const Points& rows, bool loop) {
  const auto row = [&](std::size_t k) { return Vec3(rows.row(face[k % face.size()])); };
  if (loop) return (1 - s.u - s.v) * row(0) + s.u * row(1) + s.v * row(2);
  std::array<Vec3, 4> q;
  if (face.size() == 4) {
    q = {row(0), row(1), row(2), row(3)};
  } else {
    Vec3 centre = Vec3::Zero();
    for (std::size_t k = 0; k < face.size(); ++k) centre += row(k) / static_cast<double>(face.size());
    const std::size_t k = static_cast<std::size_t>(s.quarter);
    q = {row(k), 0.5 * (row(k) + row(k + 1)), centre, 0.5 * (row(k) + row(k + face.size() - 1))};
  }
  const Vec3 b = (1 - s.u) * (1 - s.v) * q[0] + s.u * (1 - s.v) * q[1] + s.u * s.v * q[2] + (1 - s.u) * s.v * q[3];
  return b.cwiseMax(0) / b.cwiseMax(0).sum();
}

Vec3 apply(const LimitStencil& s, const std::vector<double>& weights, const Points& vertices) {
  Vec3 p = Vec3::Zero();
  for (std::size_t k = 0; k < s.vertices.size(); ++k) p += weights[k] * vertices.row(s.vertices[k]).transpose();
  return p;
}

/// Linear least squares in the free vertices of a cage.
class System {
public:
  System(const Points& vertices, const std::vector<Index>& free)
      : vertices_(vertices), free_(free), column_(vertices.rows(), -1) {
    for (std::size_t k = 0; k < free_.size(); ++k) column_[free_[k]] = static_cast<int>(3 * k);
  }

  /// weight * direction . (sum of weights * vertices - target) = 0
  void add(const LimitStencil& s, const std::vector<double>& weights, const Vec3& direction, const Vec3& target, double weight) {
    double right = direction.dot(target);
    bool any = false;
    for (std::size_t k = 0; k < s.vertices.size(); ++k) {
      const int column = column_[s.vertices[k]];
      if (column < 0) {
        right -= weights[k] * direction.dot(vertices_.row(s.vertices[k]));
      } else if (weights[k] != 0) {
        any = true;
        for (int x = 0; x < 3; ++x) entries_.emplace_back(column + x, rows_, weight * weights[k] * direction[x]);
      }
    }
    if (!any) return;
    right_.push_back(weight * right);
    ++rows_;
  }

  void solve(Points& vertices) const {
    const Index n = 3 * static_cast<Index>(free_.size());
    Eigen::SparseMatrix<double> transposed(n, rows_);  // built by its columns, which come in order
    transposed.setFromTriplets(entries_.begin(), entries_.end());
    Eigen::SparseMatrix<double> normal = transposed * transposed.transpose();
    Eigen::VectorXd right = transposed * Eigen::Map<const Eigen::VectorXd>(right_.data(), rows_);
    for (Index k = 0; k < n; ++k) {
      normal.coeffRef(k, k) += anchor * anchor;
      right[k] += anchor * anchor * vertices_(free_[k / 3], k % 3);
    }
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(normal);
    const Eigen::VectorXd x = solver.solve(right);
    for (std::size_t k = 0; k < free_.size(); ++k) vertices.row(free_[k]) = x.segment<3>(3 * static_cast<Index>(k));
  }

private:
  const Points& vertices_;
  const std::vector<Index>& free_;
  std::vector<int> column_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<double> right_;
  int rows_ = 0;
};

/// Faces of the surroundings by ring: those that touch the rim, and those that touch them.
std::array<std::vector<Index>, 2> rings(const Closed& closed, const Hole& hole) {
  std::vector<char> near(closed.vertices.rows(), 0), taken(closed.faces.size(), 0);
  for (Index v : hole.rim) near[v] = 1;
  std::array<std::vector<Index>, 2> result;
  for (auto& ring : result) {
    for (Index f = 0; f < static_cast<Index>(closed.kept.size()); ++f) {
      const auto face = closed.faces[f];
      if (!taken[f] && std::any_of(face.begin(), face.end(), [&](Index v) { return near[v]; })) ring.push_back(f);
    }
    for (Index f : ring) {
      taken[f] = 1;
      for (Index v : closed.faces[f]) near[v] = 1;
    }
  }
  return result;
}

/// Barycentric coordinates of the point of the patch nearest to p, from b on (Gauss-Newton, kept in the triangle), and the distance.
std::pair<Vec3, double> nearest(const Surface& patch, const Vec3& p, Vec3 b) {
  std::pair<Vec3, double> best = {b, 1e300};
  std::array<double, 9> jet;
  for (int step = 0; step < 4; ++step) {
    patch.evaluate(b.data(), 1, 1, jet.data());
    const Eigen::Map<const Vec3> at(jet.data()), d0(jet.data() + 3), d1(jet.data() + 6);
    const double distance = (p - at).norm();
    if (distance < best.second) best = {b, distance};
    Eigen::Matrix2d normal;
    normal << d0.dot(d0), d0.dot(d1), d0.dot(d1), d1.dot(d1);
    const Eigen::Vector2d move = normal.inverse() * Eigen::Vector2d(d0.dot(p - at), d1.dot(p - at));
    if (!move.allFinite() || move.norm() < 1e-6) break;
    b += Vec3(move[0], move[1], -move[0] - move[1]);
    b = b.cwiseMax(0);
    b /= b.sum();
  }
  return best;
}

double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI; }

struct EdgePlace {
  Index face = -1;
  int edge = 0;
};
using EdgePlaces = std::map<std::pair<Index, Index>, EdgePlace>;
EdgePlaces directed_edges(const Faces& faces, const std::vector<CageHole>& holes) {
  std::set<Index> on;
  for (const CageHole& h : holes) on.insert(h.hole.rim.begin(), h.hole.rim.end());
  EdgePlaces result;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    for (std::size_t k = 0; k < face.size(); ++k)
      if (on.contains(face[k]) && on.contains(face[(k + 1) % face.size()]))
        result[{face[k], face[(k + 1) % face.size()]}] = {f, static_cast<int>(k)};
  }
  return result;
}

/// What is known of one hole while its cage is fitted.
struct Work {
  std::vector<Sample> inside;
  std::vector<LimitStencil> inside_stencils;
  Points coordinates;         ///< barycentric, of `inside`: where on the patch they shall be
  std::vector<Index> around;  ///< faces of the first two rings
  std::vector<Sample> outside;
  std::vector<LimitStencil> outside_stencils;  ///< of the closed cage
  std::vector<Vec3> outside_was, outside_normal;
  std::vector<double> trust;  ///< of `outside`
  bool region = false;        ///< replaces faces
};

/// The samples' targets go to the points of the patch that are nearest to where the samples are: along it nothing holds them.
void slide(const Points& vertices, const Surface& patch, Work& work) {
  for (std::size_t k = 0; k < work.inside.size(); ++k) {
    const Index row = static_cast<Index>(k);
    const Vec3 b = work.coordinates.row(row);
    const LimitStencil& stencil = work.inside_stencils[k];
    work.coordinates.row(row) = nearest(patch, apply(stencil, stencil.p, vertices), b).first;
  }
}

void add_patch(const Surface& patch, const Work& work, const CageOptions& options, System& system) {
  const auto [target, normal] = patch.positions_and_normals(work.coordinates);
  for (std::size_t k = 0; k < work.inside.size(); ++k) {
    const LimitStencil& stencil = work.inside_stencils[k];
    const Vec3 p = target.row(static_cast<Index>(k)), m = normal.row(static_cast<Index>(k)), t = m.unitOrthogonal();
    system.add(stencil, stencil.p, m, p, 1);
    system.add(stencil, stencil.p, t, p, options.tangential);
    system.add(stencil, stencil.p, m.cross(t), p, options.tangential);
  }
}

void add_surroundings(const Work& work, const CageOptions& options, System& system) {
  const double across = work.region ? options.whole : options.surroundings,
               along = work.region ? options.whole : options.surroundings_tangential;
  for (std::size_t k = 0; k < work.outside.size(); ++k) {
    const LimitStencil& stencil = work.outside_stencils[k];
    const Vec3 m = work.outside_normal[k], t = m.unitOrthogonal();
    system.add(stencil, stencil.p, m, work.outside_was[k], work.trust[k] * across);
    system.add(stencil, stencil.p, t, work.outside_was[k], work.trust[k] * along);
    system.add(stencil, stencil.p, m.cross(t), work.outside_was[k], work.trust[k] * along);
  }
}

/// Along an exact rim the quads' derivative across shall lie in the tangent plane of the surroundings.
void add_seam(const Hole& hole, const Sides& sides, const EdgePlaces& edges, const Closed& closed, const LimitSurface& limit,
              bool loop, const CageOptions& options, System& system) {
  double size_of_hole = 0;
  for (Index v : hole.rim)
    size_of_hole = std::max(size_of_hole, (closed.vertices.row(v) - closed.vertices.row(hole.rim[0])).norm());
  LimitStencil stencil;
  for (int i = 0; i < 3; ++i) {
    const std::vector<Index> side = hole.side(i);
    for (std::size_t e = 0; e + 1 < side.size(); ++e) {
      const EdgePlace place = edges.at({side[e], side[e + 1]});
      const std::size_t size = closed.faces[place.face].size();
      if (!loop && size != 4) continue;
      for (double s : {0.0, 0.15, 0.35, 0.5, 0.65, 0.85, 1.0}) {
        // a smooth rim leaves the quad in its corner no tangent plane there, and little freedom beside it
        const double along_side = static_cast<double>(e) + s,
                     from_corner = std::min(along_side, static_cast<double>(side.size() - 1) - along_side);
        if (from_corner == 0) continue;
        const double trust = std::pow(std::min(1.0, from_corner), 3), t = along_side / static_cast<double>(side.size() - 1);
        const Vec3 m = sides[i].normal(t), inwards = m.cross(sides[i].c.derivative_at(t)).normalized();
        const std::array<Eigen::Vector2d, 4> square = {Eigen::Vector2d(0, 0), {1, 0}, {1, 1}, {0, 1}};
        const std::array<Eigen::Vector2d, 3> triangle = {Eigen::Vector2d(0, 0), {1, 0}, {0, 1}};
        const auto corner = [&](std::size_t k) { return loop ? triangle[k % 3] : square[k % 4]; };
        const std::size_t edge = static_cast<std::size_t>(place.edge);
        const Eigen::Vector2d along = corner(edge + 1) - corner(edge), at = corner(edge) + s * along,
                              into = corner(edge + size - 1) - corner(edge);
        limit.stencil(place.face, 0, at[0], at[1], stencil);
        std::vector<double> across(stencil.p.size());
        for (std::size_t k = 0; k < across.size(); ++k) across[k] = into[0] * stencil.pu[k] + into[1] * stencil.pv[k];
        const Vec3 now = apply(stencil, across, closed.vertices);
        const double width = now.norm();  // of the quad: the row is an angle
        if (width == 0) continue;
        const double weight = trust * options.seam * size_of_hole / width;
        system.add(stencil, across, m, Vec3::Zero(), weight);
        // else the quads may turn their first row over: that lies in the plane as well
        system.add(stencil, across, inwards, now, options.seam_width * weight);
      }
    }
  }
}

/// The numbers of the report.
void measure(const LimitSurface& was, const Closed& closed, const LimitSurface& limit, const EdgePlaces& edges, const Hole& hole,
             const Work& work, CageFit& fit) {
  LimitStencil stencil;
  double sum = 0;
  for (std::size_t k = 0; k < work.inside.size(); ++k) {
    const LimitStencil& stencil = work.inside_stencils[k];
    const double d =
        nearest(*fit.patch, apply(stencil, stencil.p, closed.vertices), work.coordinates.row(static_cast<Index>(k))).second;
    fit.deviation_max = std::max(fit.deviation_max, d);
    sum += d * d;
  }
  fit.deviation_rms = std::sqrt(sum / static_cast<double>(work.inside.size()));
  sum = 0;
  for (std::size_t k = 0; k < work.outside.size(); ++k) {
    const LimitStencil& stencil = work.outside_stencils[k];
    const double d = (apply(stencil, stencil.p, closed.vertices) - work.outside_was[k]).norm();
    if (d > fit.surroundings_max) {
      fit.surroundings_max = d;
      fit.surroundings_where = closed.faces[work.outside[k].face][0];
    }
    sum += d * d;
  }
  if (!work.outside.empty()) fit.surroundings_rms = std::sqrt(sum / static_cast<double>(work.outside.size()));
  const std::vector<double> t = {0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1.0};
  std::vector<double> reversed(t.rbegin(), t.rend());
  std::vector<LimitJet> in(t.size()), out(t.size());
  for (int i = 0; i < 3; ++i) {
    const std::vector<Index> side = hole.side(i);
    for (std::size_t e = 0; e + 1 < side.size(); ++e) {
      const EdgePlace mine = edges.at({side[e], side[e + 1]}), theirs = edges.at({side[e + 1], side[e]});
      limit.evaluate_edge(mine.face, mine.edge, t, in);
      limit.evaluate_edge(theirs.face, theirs.edge, reversed, out);
      for (std::size_t k = 0; k < t.size(); ++k) {
        const Vec3 a = in[k].pu.cross(in[k].pv), c = out[k].pu.cross(out[k].pv);
        // not where a quad's two edges run into one line, as in the corner of a smooth rim
        const bool plane =
            a.norm() > 1e-3 * in[k].pu.norm() * in[k].pv.norm() && c.norm() > 1e-3 * out[k].pu.norm() * out[k].pv.norm();
        fit.seam_angles[i].push_back(plane ? degrees_between(a, c) : -1);
      }
    }
    const EdgePlace first = edges.at({side[1], side[0]});
    limit.evaluate_edge(first.face, first.edge, std::array{1.0}, std::span(out).first(1));
    LimitJet before;
    was.evaluate_edge(closed.kept[first.face], first.edge, std::array{1.0}, {&before, 1});
    fit.corners_moved = std::max(fit.corners_moved, (out[0].p - before.p).norm());
  }
}

}  // namespace

std::vector<CageFit> fit_cages(const Mesh& mesh, const std::vector<CageHole>& holes, const Subdivision& given,
                               const std::vector<Index>& replaced, const CageOptions& options,
                               const std::vector<CageFit>& coarser) {
  constexpr double sides_tolerance = 1e-7;
  Subdivision settings = given;
  if (!settings.quality) settings.quality = 5;  // stencils need patches
  settings.use_limit_surface = true;
  const Index n = mesh.vertices.rows();
  const std::size_t count = holes.size();
  std::vector<CageFit> fits(count);
  std::vector<Work> works(count);
  Closed closed = close(mesh, holes, replaced);

  Subdivision fitted = settings;
  std::vector<Index> around;
  for (std::size_t h = 0; h < count; ++h) {
    const std::vector<Index>& rim = holes[h].hole.rim;
    around.insert(around.end(), rim.begin(), rim.end());
    const auto [first, second] = rings(closed, holes[h].hole);
    for (Index f : first) around.insert(around.end(), closed.faces[f].begin(), closed.faces[f].end());
    works[h].around = first;
    works[h].around.insert(works[h].around.end(), second.begin(), second.end());
    if (options.rim != CageRim::exact) continue;
    for (std::size_t k = 0; k < rim.size(); ++k) {
      fits[h].creases.push_back({rim[k], rim[(k + 1) % rim.size()]});
      fitted.crease_edges.push_back(fits[h].creases.back());
      fitted.edge_creases.push_back(1.0);
    }
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());

  // What the surroundings were: the cage as it was given, with the faces being replaced, where there were any, else open.
  const LimitSurface was(mesh, settings, around);
  // What an exact rim leaves them: the creased border of an open hole.
  Faces left;
  for (Index f : closed.kept) left.add(mesh.faces[f]);
  const bool part = options.rim == CageRim::exact && !replaced.empty();
  const std::optional<LimitSurface> open =
      part ? std::optional<LimitSurface>(std::in_place, Mesh{mesh.vertices, left}, settings, around) : std::nullopt;
  for (std::size_t h = 0; h < count; ++h) {
    const CageHole& hole = holes[h];
    Work& work = works[h];
    const std::set<Index> gone(replaced.begin(), replaced.end());
    for (Index f : gone) {
      const auto face = mesh.faces[f];
      for (std::size_t k = 0; k < face.size(); ++k)
        work.region = work.region || (face[k] == hole.hole.rim[0] && face[(k + 1) % face.size()] == hole.hole.rim[1]);
    }
    if (!coarser.empty()) {
      fits[h].sides = coarser[h].sides;
      fits[h].patch = coarser[h].patch;
    } else if (hole.start.rows() == 0) {
      fits[h].sides = part ? sides_on(*open, {mesh.vertices, left}, hole.hole, {}, sides_tolerance)
                           : sides_on(was, mesh, hole.hole, replaced, sides_tolerance);
      fits[h].patch = hole.build(fits[h].sides);
    }
    const Index inside = closed.first_vertex[h + 1] - closed.first_vertex[h];
    closed.vertices.middleRows(closed.first_vertex[h], inside) =
        hole.start.rows() > 0 ? hole.start : fits[h].patch->positions(hole.barycentric.bottomRows(inside));
  }
  std::vector<Index> free;
  for (Index v = n; v < closed.vertices.rows(); ++v) {
    around.push_back(v);
    free.push_back(v);
  }
  if (options.rim == CageRim::move)
    for (const CageHole& hole : holes) free.insert(free.end(), hole.hole.rim.begin(), hole.hole.rim.end());
  std::sort(free.begin(), free.end());
  free.erase(std::unique(free.begin(), free.end()), free.end());

  LimitSurface limit(closed.mesh(), fitted, around);
  const auto fill_faces = [&](std::size_t h) {
    std::vector<Index> faces;
    for (Index f = closed.first_face[h]; f < closed.first_face[h + 1]; ++f) faces.push_back(f);
    return faces;
  };
  const auto rebuild = [&](std::size_t h) {
    fits[h].sides = sides_on(limit, closed.mesh(), holes[h].hole, fill_faces(h), sides_tolerance);
    fits[h].patch = holes[h].build(fits[h].sides);
  };
  LimitStencil stencil;
  for (std::size_t h = 0; h < count; ++h) {
    Work& work = works[h];
    if (!fits[h].patch) rebuild(h);
    std::vector<Vec3> coordinates;
    for (Index f = 0; f < holes[h].layout.size(); ++f)
      for (const Sample& s : spread(closed.first_face[h] + f, holes[h].layout[f].size(), options.samples, settings.loop)) {
        work.inside.push_back(s);
        limit.stencil(s.face, s.quarter, s.u, s.v, work.inside_stencils.emplace_back());
        coordinates.push_back(barycentric_at(s, holes[h].layout[f], holes[h].barycentric, settings.loop));
      }
    work.coordinates.resize(static_cast<Index>(coordinates.size()), 3);
    for (std::size_t k = 0; k < coordinates.size(); ++k) work.coordinates.row(static_cast<Index>(k)) = coordinates[k];
    std::set<Index> corners;
    for (Index c : holes[h].hole.corners) corners.insert(holes[h].hole.rim[c]);
    for (Index f : work.around) {
      const auto face = closed.faces[f];
      const bool corner = std::any_of(face.begin(), face.end(), [&](Index v) { return corners.contains(v); });
      for (const Sample& s : spread(f, face.size(), options.samples, settings.loop)) {
        was.stencil(closed.kept[f], s.quarter, s.u, s.v, stencil);
        work.outside.push_back(s);
        limit.stencil(s.face, s.quarter, s.u, s.v, work.outside_stencils.emplace_back());
        work.outside_was.push_back(apply(stencil, stencil.p, mesh.vertices));
        work.outside_normal.push_back(
            apply(stencil, stencil.pu, mesh.vertices).cross(apply(stencil, stencil.pv, mesh.vertices)).stableNormalized());
        work.trust.push_back(corner && !work.region ? options.corner : 1);
      }
    }
  }

  const auto edges = directed_edges(closed.faces, holes);
  for (int round = 0; round < options.rounds; ++round) {
    System system(closed.vertices, free);
    for (std::size_t h = 0; h < count; ++h) {
      if (round > 0) slide(closed.vertices, *fits[h].patch, works[h]);
      add_patch(*fits[h].patch, works[h], options, system);
      add_surroundings(works[h], options, system);
      if (options.rim == CageRim::exact)
        add_seam(holes[h].hole, fits[h].sides, edges, closed, limit, settings.loop, options, system);
    }
    system.solve(closed.vertices);
    limit.move(closed.vertices);
  }

  for (std::size_t h = 0; h < count; ++h) {
    CageFit& fit = fits[h];
    const Hole& hole = holes[h].hole;
    fit.vertices = closed.vertices.middleRows(closed.first_vertex[h], closed.first_vertex[h + 1] - closed.first_vertex[h]);
    if (options.rim == CageRim::move) {
      fit.moved = hole.rim;
      fit.moved_to.resize(static_cast<Index>(hole.rim.size()), 3);
      for (std::size_t k = 0; k < hole.rim.size(); ++k)
        fit.moved_to.row(static_cast<Index>(k)) = closed.vertices.row(hole.rim[k]);
    }
    measure(was, closed, limit, edges, hole, works[h], fit);
  }
  return fits;
}

void sample_limit(const Mesh& cage, const Subdivision& given, Index first_face, int level, Points& vertices, Faces& faces) {
  Subdivision settings = given;
  if (!settings.quality) settings.quality = 5;
  std::vector<Index> around;
  for (Index f = first_face; f < cage.faces.size(); ++f) around.insert(around.end(), cage.faces[f].begin(), cage.faces[f].end());
  const LimitSurface limit(cage, settings, around);
  const int steps = 1 << level;
  std::map<std::array<Index, 4>, Index> known;  // corner, edge or inside point -> vertex
  std::vector<Vec3> points;
  LimitStencil stencil;
  const auto at = [&](const std::array<Index, 4>& key, Index f, int quarter, double u, double v) {
    const auto [place, fresh] = known.try_emplace(key, static_cast<Index>(points.size()));
    if (fresh) {
      limit.stencil(f, quarter, u, v, stencil);
      points.push_back(apply(stencil, stencil.p, cage.vertices));
    }
    return place->second;
  };
  const auto on_edge = [](Index a, Index b, int place, int whole) -> std::array<Index, 4> {
    if (place == 0) return {-1, a, 0, 0};
    if (place == whole) return {-1, b, 0, 0};
    return a < b ? std::array<Index, 4>{-2, a, b, place} : std::array<Index, 4>{-2, b, a, whole - place};
  };
  for (Index f = first_face; settings.loop && f < cage.faces.size(); ++f) {
    const auto face = cage.faces[f];
    const auto vertex = [&](int i, int j) {
      const std::array<Index, 4> key = j == 0           ? on_edge(face[0], face[1], i, steps)
                                       : i == 0         ? on_edge(face[0], face[2], j, steps)
                                       : i + j == steps ? on_edge(face[1], face[2], j, steps)
                                                        : std::array<Index, 4>{f, 0, i, j};
      return at(key, f, 0, static_cast<double>(i) / steps, static_cast<double>(j) / steps);
    };
    for (int i = 0; i < steps; ++i)
      for (int j = 0; i + j < steps; ++j) {
        faces.add(std::array<Index, 3>{vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
        if (i + j + 1 < steps) faces.add(std::array<Index, 3>{vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
      }
  }
  for (Index f = first_face; !settings.loop && f < cage.faces.size(); ++f) {
    const auto face = cage.faces[f];
    const Index size = static_cast<Index>(face.size());
    // a quad is one block; an n-gon has a block at each corner, half as wide
    const int blocks = size == 4 ? 1 : static_cast<int>(size), width = size == 4 ? steps : std::max(1, steps / 2);
    for (int q = 0; q < blocks; ++q) {
      const auto edge = [&](Index k, int place, int whole) {
        return on_edge(face[k % size], face[(k + 1) % size], place, whole);
      };
      const auto key = [&](int i, int j) -> std::array<Index, 4> {
        if (size == 4) {
          if (j == 0) return edge(0, i, width);
          if (i == width) return edge(1, j, width);
          if (j == width) return edge(2, width - i, width);
          if (i == 0) return edge(3, width - j, width);
          return {f, 0, i, j};
        }
        if (j == 0) return edge(q, i, 2 * width);
        if (i == 0) return edge(q + size - 1, 2 * width - j, 2 * width);
        if (i == width && j == width) return {f, -1, 0, 0};
        if (i == width) return {f, -2, q, j};
        if (j == width) return {f, -2, (q + size - 1) % size, i};
        return {f, q, i, j};
      };
      const auto vertex = [&](int i, int j) {
        return at(key(i, j), f, q, static_cast<double>(i) / width, static_cast<double>(j) / width);
      };
      for (int i = 0; i < width; ++i)
        for (int j = 0; j < width; ++j)
          faces.add(std::array<Index, 4>{vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  vertices.resize(static_cast<Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) vertices.row(static_cast<Index>(k)) = points[k];
}

}  // namespace tripatch
