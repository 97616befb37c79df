#include "tripatch/output/cage.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "tripatch/boundary/limit_sides.h"

namespace tripatch {
namespace {

constexpr double anchor = 1e-5;  ///< weight that keeps a vertex near its start where nothing else holds it

/// The mesh with the fill in place of the hole.
struct Closed {
  Points vertices;
  Faces faces;
  Index first_face = 0;  ///< of the fill
  Mesh mesh() const { return {vertices, faces}; }
};

Closed close(const Mesh& mesh, const Hole& hole, const std::vector<Index>& replaced, const Points& inside, const Faces& layout) {
  Closed closed;
  const Index n = mesh.vertices.rows(), rim = static_cast<Index>(hole.rim.size());
  closed.vertices.resize(n + inside.rows(), 3);
  closed.vertices << Points(mesh.vertices), inside;
  const std::set<Index> gone(replaced.begin(), replaced.end());
  for (Index f = 0; f < mesh.faces.size(); ++f)
    if (!gone.contains(f)) closed.faces.add(mesh.faces[f]);
  closed.first_face = closed.faces.size();
  for (Index f = 0; f < layout.size(); ++f) {
    std::vector<Index> face;
    for (Index v : layout[f]) face.push_back(v < rim ? hole.rim[v] : n + v - rim);
    closed.faces.add(face);
  }
  return closed;
}

/// A place on a face with what its limit should be.
struct Sample {
  Index face;
  int quarter;
  double u, v;
};

/// Places spread over a face: cell centres of a grid (of each quarter of an n-gon).
std::vector<Sample> spread(Index face, std::size_t size, int count) {
  std::vector<Sample> samples;
  const int per = size == 4 ? count : (count + 1) / 2;
  for (int q = 0; q < (size == 4 ? 1 : static_cast<int>(size)); ++q)
    for (int i = 0; i < per; ++i)
      for (int j = 0; j < per; ++j) samples.push_back({face, q, (i + 0.5) / per, (j + 0.5) / per});
  return samples;
}

/// Barycentric coordinates there, bilinear between those of the face's corners.
Vec3 barycentric_at(const Sample& s, std::span<const Index> face, const Points& rows) {
  const auto row = [&](std::size_t k) { return Vec3(rows.row(face[k % face.size()])); };
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

/// Linear least squares in the free vertices of the closed cage.
class System {
public:
  System(const Points& vertices, const std::vector<Index>& free) : vertices_(vertices), free_(free) {
    for (std::size_t k = 0; k < free.size(); ++k) column_[free[k]] = static_cast<Index>(k);
  }

  /// weight * direction . (sum of weights * vertices - target) = 0
  void add(const LimitStencil& s, const std::vector<double>& weights, const Vec3& direction, const Vec3& target, double weight) {
    double right = direction.dot(target);
    bool any = false;
    for (std::size_t k = 0; k < s.vertices.size(); ++k) {
      const auto found = column_.find(s.vertices[k]);
      if (found == column_.end()) {
        right -= weights[k] * direction.dot(vertices_.row(s.vertices[k]));
      } else if (weights[k] != 0) {
        any = true;
        for (int x = 0; x < 3; ++x) entries_.emplace_back(rows_, 3 * found->second + x, weight * weights[k] * direction[x]);
      }
    }
    if (!any) return;
    right_.push_back(weight * right);
    ++rows_;
  }

  void solve(Points& vertices) const {
    const Index n = 3 * static_cast<Index>(free_.size());
    std::vector<Eigen::Triplet<double>> entries = entries_;
    std::vector<double> right = right_;
    for (std::size_t k = 0; k < free_.size(); ++k)
      for (int x = 0; x < 3; ++x) {
        entries.emplace_back(static_cast<Index>(right.size()), 3 * static_cast<Index>(k) + x, anchor);
        right.push_back(anchor * vertices_(free_[k], x));
      }
    Eigen::SparseMatrix<double> a(static_cast<Index>(right.size()), n);
    a.setFromTriplets(entries.begin(), entries.end());
    const Eigen::Map<const Eigen::VectorXd> b(right.data(), static_cast<Index>(right.size()));
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(Eigen::SparseMatrix<double>(a.transpose() * a));
    const Eigen::VectorXd x = solver.solve(a.transpose() * b);
    for (std::size_t k = 0; k < free_.size(); ++k) vertices.row(free_[k]) = x.segment<3>(3 * static_cast<Index>(k));
  }

private:
  const Points& vertices_;
  const std::vector<Index>& free_;
  std::map<Index, Index> column_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<double> right_;
  Index rows_ = 0;
};

/// Faces of the surroundings by ring: those that touch the rim, and those that touch them.
std::array<std::vector<Index>, 2> rings(const Closed& closed, const Hole& hole) {
  std::vector<char> near(closed.vertices.rows(), 0);
  for (Index v : hole.rim) near[v] = 1;
  std::array<std::vector<Index>, 2> result;
  std::set<Index> taken;
  for (auto& ring : result) {
    for (Index f = 0; f < closed.first_face; ++f) {
      const auto face = closed.faces[f];
      if (!taken.contains(f) && std::any_of(face.begin(), face.end(), [&](Index v) { return near[v]; })) ring.push_back(f);
    }
    for (Index f : ring) {
      taken.insert(f);
      for (Index v : closed.faces[f]) near[v] = 1;
    }
  }
  return result;
}

/// Distance of a point from the patch, from its barycentric coordinates on (Gauss-Newton, kept in the triangle).
double distance_to(const Surface& patch, const Vec3& p, Vec3 b) {
  double best = 1e300;
  std::array<double, 9> jet;
  for (int step = 0; step < 4; ++step) {
    patch.evaluate(b.data(), 1, 1, jet.data());
    const Eigen::Map<const Vec3> at(jet.data()), d0(jet.data() + 3), d1(jet.data() + 6);
    best = std::min(best, (p - at).norm());
    Eigen::Matrix<double, 3, 2> d;
    d << d0, d1;
    const Eigen::Vector2d move = d.colPivHouseholderQr().solve(p - at);
    if (!move.allFinite()) break;
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
std::map<std::pair<Index, Index>, EdgePlace> directed_edges(const Faces& faces, const std::vector<Index>& rim) {
  const std::set<Index> on(rim.begin(), rim.end());
  std::map<std::pair<Index, Index>, EdgePlace> result;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    for (std::size_t k = 0; k < face.size(); ++k)
      if (on.contains(face[k]) && on.contains(face[(k + 1) % face.size()]))
        result[{face[k], face[(k + 1) % face.size()]}] = {f, static_cast<int>(k)};
  }
  return result;
}

}  // namespace

CageFit fit_cage(const Mesh& mesh, const Hole& hole, const Subdivision& given, const std::vector<Index>& replaced,
                 const Points& barycentric, const Faces& layout, const std::function<SurfacePtr(const Sides&)>& build,
                 const CageOptions& options, const CageFit& coarser) {
  CageFit fit;
  Subdivision settings = given;
  if (!settings.quality) settings.quality = 5;  // stencils need patches
  settings.use_limit_surface = true;
  const Index rim = static_cast<Index>(hole.rim.size()), n = mesh.vertices.rows(), inside = barycentric.rows() - rim;

  fit.sides = coarser.patch ? coarser.sides : limit_sides(mesh, hole, settings, replaced).sides;
  fit.patch = coarser.patch ? coarser.patch : build(fit.sides);
  Closed closed = close(mesh, hole, replaced, fit.patch->positions(barycentric.bottomRows(inside)), layout);

  Subdivision fitted = settings;
  if (options.rim == CageRim::exact)
    for (Index k = 0; k < rim; ++k) {
      fit.creases.push_back({hole.rim[k], hole.rim[(k + 1) % rim]});
      fitted.crease_edges.push_back(fit.creases.back());
      fitted.edge_creases.push_back(1.0);
    }

  const auto [first_ring, second_ring] = rings(closed, hole);
  std::vector<Index> around = hole.rim;
  for (Index f : first_ring) around.insert(around.end(), closed.faces[f].begin(), closed.faces[f].end());
  for (Index v = n; v < closed.vertices.rows(); ++v) around.push_back(v);
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());

  // What the surroundings were: the cage as it was given, with the faces being replaced, where there were any, else open.
  std::vector<Index> kept;  // closed face -> given face
  {
    const std::set<Index> gone(replaced.begin(), replaced.end());
    for (Index f = 0; f < mesh.faces.size(); ++f)
      if (!gone.contains(f)) kept.push_back(f);
  }
  std::vector<Index> around_given;
  for (Index v : around)
    if (v < n) around_given.push_back(v);
  const LimitSurface was(mesh, settings, around_given);
  std::vector<Sample> outside;
  std::vector<Vec3> outside_was;
  LimitStencil stencil;
  for (const std::vector<Index>* ring : {&first_ring, &second_ring})
    for (Index f : *ring)
      for (const Sample& s : spread(f, closed.faces[f].size(), options.samples)) {
        was.stencil(kept[f], s.quarter, s.u, s.v, stencil);
        outside.push_back(s);
        outside_was.push_back(apply(stencil, stencil.p, mesh.vertices));
      }

  std::vector<Sample> places;
  std::vector<Vec3> coordinates;
  for (Index f = 0; f < layout.size(); ++f)
    for (const Sample& s : spread(closed.first_face + f, layout[f].size(), options.samples)) {
      places.push_back(s);
      coordinates.push_back(barycentric_at(s, layout[f], barycentric));
    }
  Points b(static_cast<Index>(coordinates.size()), 3);
  for (std::size_t k = 0; k < coordinates.size(); ++k) b.row(static_cast<Index>(k)) = coordinates[k];

  std::vector<Index> free;
  for (Index v = n; v < closed.vertices.rows(); ++v) free.push_back(v);
  if (options.rim == CageRim::move) free.insert(free.end(), hole.rim.begin(), hole.rim.end());

  double size_of_hole = 0;
  for (Index v : hole.rim) size_of_hole = std::max(size_of_hole, (mesh.vertices.row(v) - mesh.vertices.row(hole.rim[0])).norm());
  const auto edges = directed_edges(closed.faces, hole.rim);
  const bool rebuild = replaced.empty() && options.rim != CageRim::exact && !coarser.patch;
  std::vector<Index> fill_faces;
  for (Index f = closed.first_face; f < closed.faces.size(); ++f) fill_faces.push_back(f);
  for (int round = 0; round < (rebuild ? options.rounds : 1); ++round) {
    if (rebuild) {  // a closed rim has another limit than an open one: the patch goes where the fitted cage's rim is
      fit.sides = limit_sides(closed.mesh(), hole, fitted, fill_faces).sides;
      fit.patch = build(fit.sides);
    }
    const LimitSurface limit(closed.mesh(), fitted, around);
    System system(closed.vertices, free);
    const Points target = fit.patch->positions(b), normal = fit.patch->normals(b);
    for (std::size_t k = 0; k < places.size(); ++k) {
      limit.stencil(places[k].face, places[k].quarter, places[k].u, places[k].v, stencil);
      const Vec3 p = target.row(static_cast<Index>(k)), m = normal.row(static_cast<Index>(k));
      const Vec3 t = m.unitOrthogonal();
      system.add(stencil, stencil.p, m, p, 1);
      system.add(stencil, stencil.p, t, p, options.tangential);
      system.add(stencil, stencil.p, m.cross(t), p, options.tangential);
    }
    for (std::size_t k = 0; k < outside.size(); ++k) {
      limit.stencil(outside[k].face, outside[k].quarter, outside[k].u, outside[k].v, stencil);
      for (int x = 0; x < 3; ++x)
        system.add(stencil, stencil.p, Vec3::Unit(x), outside_was[k], replaced.empty() ? options.surroundings : options.whole);
    }
    if (options.rim == CageRim::exact)
      for (int i = 0; i < 3; ++i) {
        const std::vector<Index> side = hole.side(i);
        for (std::size_t e = 0; e + 1 < side.size(); ++e) {
          const EdgePlace place = edges.at({side[e], side[e + 1]});
          const std::size_t size = closed.faces[place.face].size();
          for (double s : {0.0, 0.15, 0.35, 0.5, 0.65, 0.85, 1.0}) {
            // a smooth rim leaves the quad in its corner no tangent plane there, and little freedom beside it
            const double along_side = static_cast<double>(e) + s,
                         from_corner = std::min(along_side, static_cast<double>(side.size() - 1) - along_side);
            if (from_corner == 0) continue;
            const double trust = std::min(1.0, from_corner);
            const Vec3 m = fit.sides[i].normal((static_cast<double>(e) + s) / static_cast<double>(side.size() - 1));
            if (size == 4) {
              const std::array<Eigen::Vector2d, 4> corner = {Eigen::Vector2d(0, 0), {1, 0}, {1, 1}, {0, 1}};
              const Eigen::Vector2d along = corner[(place.edge + 1) % 4] - corner[place.edge],
                                    at = corner[place.edge] + s * along;
              limit.stencil(place.face, 0, at[0], at[1], stencil);
              std::vector<double> across(stencil.p.size());
              for (std::size_t k = 0; k < across.size(); ++k) across[k] = -along[1] * stencil.pu[k] + along[0] * stencil.pv[k];
              const double width = apply(stencil, across, closed.vertices).norm();  // of the quad: the row is an angle
              if (width > 0) system.add(stencil, across, m, Vec3::Zero(), trust * options.seam * size_of_hole / width);
            }
          }
        }
      }
    system.solve(closed.vertices);
  }
  fit.vertices = closed.vertices.bottomRows(inside);
  if (options.rim == CageRim::move) {
    fit.moved = hole.rim;
    fit.moved_to.resize(rim, 3);
    for (Index k = 0; k < rim; ++k) fit.moved_to.row(k) = closed.vertices.row(hole.rim[k]);
  }

  // the report
  const LimitSurface limit(closed.mesh(), fitted, around);
  double sum = 0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    limit.stencil(places[k].face, places[k].quarter, places[k].u, places[k].v, stencil);
    const double d = distance_to(*fit.patch, apply(stencil, stencil.p, closed.vertices), coordinates[k]);
    fit.deviation_max = std::max(fit.deviation_max, d);
    sum += d * d;
  }
  fit.deviation_rms = std::sqrt(sum / static_cast<double>(places.size()));
  sum = 0;
  for (std::size_t k = 0; k < outside.size(); ++k) {
    limit.stencil(outside[k].face, outside[k].quarter, outside[k].u, outside[k].v, stencil);
    const double d = (apply(stencil, stencil.p, closed.vertices) - outside_was[k]).norm();
    if (d > fit.surroundings_max) {
      fit.surroundings_max = d;
      fit.surroundings_where = closed.faces[outside[k].face][0];
    }
    sum += d * d;
  }
  if (!outside.empty()) fit.surroundings_rms = std::sqrt(sum / static_cast<double>(outside.size()));
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
    was.evaluate_edge(kept[first.face], first.edge, std::array{1.0}, {&before, 1});
    fit.corners_moved = std::max(fit.corners_moved, (out[0].p - before.p).norm());
  }
  return fit;
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
  for (Index f = first_face; f < cage.faces.size(); ++f) {
    const auto face = cage.faces[f];
    const Index size = static_cast<Index>(face.size());
    // a quad is one block; an n-gon has a block at each corner, half as wide
    const int blocks = size == 4 ? 1 : static_cast<int>(size), width = size == 4 ? steps : std::max(1, steps / 2);
    for (int q = 0; q < blocks; ++q) {
      const auto on_edge = [&](Index k, int place, int whole) -> std::array<Index, 4> {  // of the face's edge k, in whole parts
        const Index a = face[k % size], b = face[(k + 1) % size];
        if (place == 0) return {-1, a, 0, 0};
        if (place == whole) return {-1, b, 0, 0};
        return a < b ? std::array<Index, 4>{-2, a, b, place} : std::array<Index, 4>{-2, b, a, whole - place};
      };
      const auto key = [&](int i, int j) -> std::array<Index, 4> {
        if (size == 4) {
          if (j == 0) return on_edge(0, i, width);
          if (i == width) return on_edge(1, j, width);
          if (j == width) return on_edge(2, width - i, width);
          if (i == 0) return on_edge(3, width - j, width);
          return {f, 0, i, j};
        }
        if (j == 0) return on_edge(q, i, 2 * width);
        if (i == 0) return on_edge(q + size - 1, 2 * width - j, 2 * width);
        if (i == width && j == width) return {f, -1, 0, 0};
        if (i == width) return {f, -2, q, j};
        if (j == width) return {f, -2, (q + size - 1) % size, i};
        return {f, q, i, j};
      };
      const auto vertex = [&](int i, int j) {
        const auto [place, fresh] = known.try_emplace(key(i, j), static_cast<Index>(points.size()));
        if (fresh) {
          limit.stencil(f, q, static_cast<double>(i) / width, static_cast<double>(j) / width, stencil);
          points.push_back(apply(stencil, stencil.p, cage.vertices));
        }
        return place->second;
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
