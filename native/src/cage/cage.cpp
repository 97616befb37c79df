#include "tripatch/cage/cage.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "tripatch/boundary/limit_sides.h"
#include "tripatch/cage/cage_fair.h"
#include "tripatch/cage/cage_system.h"
#include "tripatch/cage/limit_mesh.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

constexpr double anchor = 1e-10;  ///< relative, squared: keeps a vertex where it is where nothing else holds it
constexpr int samples = 4;        ///< a row of each face, for positions
constexpr int folds_level = 3;    ///< of the limit surface whose folds are counted: 8 x 8 quads a face, what `Fill.limit` gives

/// The mesh with the fills in place of the holes.
struct Closed {
  Points vertices;
  Faces faces;
  std::vector<Index> kept;          ///< given face of each of the first faces
  std::vector<Index> first_face;    ///< of each fill, and the end
  std::vector<Index> first_vertex;  ///< of each fill's inside, and the end; they start in the plane of the corners
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
  for (std::size_t k = 0; k < holes.size(); ++k) {
    const Hole& hole = holes[k].hole;
    Eigen::Matrix3d corners;
    for (int c = 0; c < 3; ++c) corners.row(c) = mesh.vertices.row(hole.rim[hole.corners[c]]);
    const Index inside = closed.first_vertex[k + 1] - closed.first_vertex[k];
    closed.vertices.middleRows(closed.first_vertex[k], inside) = holes[k].barycentric.bottomRows(inside) * corners;
  }
  return closed;
}

/// Places spread over a face: cell centres of a grid (of each quarter of an n-gon).
std::vector<FacePlace> spread(std::size_t size, bool loop) {
  std::vector<FacePlace> places;
  if (loop) {  // the corners' thirds of the small triangles
    for (int i = 0; i < samples; ++i)
      for (int j = 0; i + j < samples; ++j) places.push_back({0, (i + 1.0 / 3) / samples, (j + 1.0 / 3) / samples});
    return places;
  }
  const int per = size == 4 ? samples : (samples + 1) / 2;
  for (int q = 0; q < (size == 4 ? 1 : static_cast<int>(size)); ++q)
    for (int i = 0; i < per; ++i)
      for (int j = 0; j < per; ++j) places.push_back({q, (i + 0.5) / per, (j + 0.5) / per});
  return places;
}

/// Barycentric coordinates there, bilinear between those of the face's corners.
Vec3 barycentric_at(const FacePlace& s, std::span<const Index> face, const Points& rows, bool loop) {
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

double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI; }

struct EdgePlace {
  Index face = -1;
  int edge = 0;
};
using EdgePlaces = std::map<std::pair<Index, Index>, EdgePlace>;
EdgePlaces directed_edges(const Closed& closed, const std::vector<CageHole>& holes) {
  std::vector<char> on(closed.vertices.rows(), 0);
  for (const CageHole& h : holes)
    for (Index v : h.hole.rim) on[v] = 1;
  EdgePlaces result;
  for (Index f = 0; f < closed.faces.size(); ++f) {
    const auto face = closed.faces[f];
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Index a = face[k], b = face[(k + 1) % face.size()];
      if (on[a] && on[b]) result[{a, b}] = {f, static_cast<int>(k)};
    }
  }
  return result;
}

/// Samples of a face: sums of the cage's vertices, their targets by row.
struct SampledFace {
  Index face;
  Sums limit;
  Points target, normal;  ///< outside: of the old limit surface
  double trust = 1;
};

/// What is known of one hole while its cage is fitted.
struct Work {
  std::vector<SampledFace> inside, outside;  ///< of the fill, and the first two rings around
  Points coordinates;                        ///< barycentric, of the samples inside: where on the patch they shall be
  std::size_t first_ring = 0;                ///< faces of `outside` that touch the rim
  FairHole shape;                            ///< of the faces inside and of the first ring
  bool region = false;                       ///< replaces faces

  /// Of the samples inside.
  Points positions(const Points& free) const {
    Points all(coordinates.rows(), 3);
    Index row = 0;
    for (const SampledFace& face : inside) {
      all.middleRows(row, face.limit.rest.rows()) = face.limit.at(free);
      row += face.limit.rest.rows();
    }
    return all;
  }
};

/// The samples' targets go to the points of the patch that are nearest to where the samples are: along it nothing holds them.
void slide(const Points& free, const Surface& patch, Work& work) { nearest(patch, work.positions(free), work.coordinates); }

/// Distances across a plane and along it, by weights.
Eigen::Matrix3d metric(const Vec3& normal, double across, double along) {
  const Eigen::Matrix3d n = normal * normal.transpose();
  return across * across * n + along * along * (Eigen::Matrix3d::Identity() - n);
}

void add_patch(const CageSystem& system, const Points& free, const Surface& patch, const Work& work, const CageOptions& options,
               CageSystem::Term& term) {
  const auto [target, normal] = patch.positions_and_normals(work.coordinates);
  Index row = 0;
  for (const SampledFace& face : work.inside) {
    const Points now = face.limit.at(free);
    for (Index k = 0; k < now.rows(); ++k, ++row)
      system.add(term, face.limit, k, metric(normal.row(row), 1, options.tangential), now.row(k) - target.row(row));
  }
}

void add_surroundings(const CageSystem& system, const Points& free, const Work& work, const CageOptions& options,
                      CageSystem::Term& term) {
  const double across = work.region ? options.whole : options.surroundings,
               along = work.region ? options.whole : options.surroundings_tangential;
  for (const SampledFace& face : work.outside) {
    if (face.limit.slots.empty()) continue;
    const Points now = face.limit.at(free);
    for (Index k = 0; k < now.rows(); ++k)
      system.add(term, face.limit, k, metric(face.normal.row(k), face.trust * across, face.trust * along),
                 now.row(k) - face.target.row(k));
  }
}

/// What holds the old limit surface while the cage is made fair: its mean square movement over that which is tolerated.
void hold_surroundings(const CageSystem& system, const Points& free, const Work& work, double tolerated, CageSystem::Term& term) {
  double count = 0;
  for (const SampledFace& face : work.outside)
    if (face.trust == 1) count += static_cast<double>(face.target.rows());
  for (const SampledFace& face : work.outside) {
    if (face.trust < 1 || face.limit.slots.empty()) continue;
    const Points now = face.limit.at(free);
    for (Index k = 0; k < now.rows(); ++k)
      system.add(term, face.limit, k, Eigen::Matrix3d::Identity() / (count * tolerated * tolerated),
                 now.row(k) - face.target.row(k));
  }
}

/// The rows of an exact rim: at a few places of each of its edges the derivative across.
struct Seam {
  struct Row {
    Sums across;
    Vec3 normal, inwards;
    double trust;
  };
  std::vector<Row> rows;
  double size = 0;  ///< of the hole
};

Seam seam_of(const Hole& hole, const Sides& sides, const EdgePlaces& edges, const Closed& closed, const LimitSurface& limit,
             bool loop, const CageSystem& system) {
  Seam seam;
  for (Index v : hole.rim) seam.size = std::max(seam.size, (closed.vertices.row(v) - closed.vertices.row(hole.rim[0])).norm());
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
        const FacePlace where = {0, at[0], at[1]};
        const LimitStencils stencil = limit.stencils(place.face, {&where, 1});
        seam.rows.push_back({system.sums(stencil.vertices, into[0] * stencil.pu + into[1] * stencil.pv), m, inwards, trust});
      }
    }
  }
  return seam;
}

/// Along an exact rim the quads' derivative across shall lie in the tangent plane of the surroundings.
void add_seam(const CageSystem& system, const Points& free, const Seam& seam, const CageOptions& options,
              CageSystem::Term& term) {
  for (const Seam::Row& row : seam.rows) {
    const Vec3 now = row.across.at(free).row(0);
    const double width = now.norm();  // of the quad: the row is an angle
    if (width == 0) continue;
    const double weight = row.trust * options.seam * seam.size / width, held = options.seam_width * weight;
    system.add(term, row.across, 0, weight * weight * row.normal * row.normal.transpose(), now);
    // else the quads may turn their first row over: that lies in the plane as well
    system.add(term, row.across, 0, held * held * row.inwards * row.inwards.transpose(), Vec3::Zero());
  }
}

/// The numbers of the report.
void measure(const LimitSurface& was, const Closed& closed, const LimitSurface& limit, const EdgePlaces& edges, const Hole& hole,
             const Points& free, const Work& work, CageFit& fit) {
  Points coordinates = work.coordinates;
  const Eigen::VectorXd deviation = nearest(*fit.patch, work.positions(free), coordinates);
  fit.deviation_max = deviation.maxCoeff();
  fit.deviation_rms = std::sqrt(deviation.squaredNorm() / static_cast<double>(deviation.size()));
  double sum = 0;
  Index row = 0;
  for (const SampledFace& face : work.outside) {
    const Eigen::VectorXd d = (face.limit.at(free) - face.target).rowwise().norm();
    if (d.maxCoeff() > fit.surroundings_max) {
      fit.surroundings_max = d.maxCoeff();
      fit.surroundings_where = closed.faces[face.face][0];
    }
    sum += d.squaredNorm();
    row += d.size();
  }
  if (row > 0) fit.surroundings_rms = std::sqrt(sum / static_cast<double>(row));
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
  const bool exact = options.rim == CageRim::exact;
  Subdivision settings = given;
  if (!settings.quality) settings.quality = stencil_quality;
  settings.use_limit_surface = true;
  const Index n = mesh.vertices.rows();
  const std::size_t count = holes.size();
  std::vector<CageFit> fits(count);
  std::vector<Work> works(count);
  Closed closed = close(mesh, holes, replaced);

  Subdivision fitted = settings;
  std::vector<Index> around;
  std::vector<std::array<std::vector<Index>, 2>> ring(count);
  for (std::size_t h = 0; h < count; ++h) {
    const std::vector<Index>& rim = holes[h].hole.rim;
    around.insert(around.end(), rim.begin(), rim.end());
    ring[h] = rings(closed, holes[h].hole);
    for (Index f : ring[h][0]) around.insert(around.end(), closed.faces[f].begin(), closed.faces[f].end());
    if (!exact) continue;
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
  const bool part = exact && !replaced.empty();
  Faces left;
  for (std::size_t k = 0; part && k < closed.kept.size(); ++k) left.add(mesh.faces[closed.kept[k]]);
  const std::optional<LimitSurface> open =
      part ? std::optional<LimitSurface>(std::in_place, Mesh{mesh.vertices, left}, settings, around) : std::nullopt;
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
  CageSystem system(closed.vertices, free);
  Points x(static_cast<Index>(free.size()), 3);
  for (std::size_t k = 0; k < free.size(); ++k) x.row(static_cast<Index>(k)) = closed.vertices.row(free[k]);

  const std::set<Index> gone(replaced.begin(), replaced.end());
  std::vector<std::vector<LimitStencils>> inside(count);
  std::vector<const Sums*> together;
  for (std::size_t h = 0; h < count; ++h) {
    const CageHole& hole = holes[h];
    Work& work = works[h];
    for (Index f : gone) {
      const auto face = mesh.faces[f];
      for (std::size_t k = 0; k < face.size(); ++k)
        work.region = work.region || (face[k] == hole.hole.rim[0] && face[(k + 1) % face.size()] == hole.hole.rim[1]);
    }
    std::vector<Vec3> coordinates;
    for (Index f = 0; f < hole.layout.size(); ++f) {
      const std::vector<FacePlace> places = spread(hole.layout[f].size(), settings.loop);
      inside[h].push_back(limit.stencils(closed.first_face[h] + f, places));
      work.inside.push_back({closed.first_face[h] + f, system.sums(inside[h].back().vertices, inside[h].back().p), {}, {}});
      for (const FacePlace& s : places) coordinates.push_back(barycentric_at(s, hole.layout[f], hole.barycentric, settings.loop));
    }
    work.coordinates.resize(static_cast<Index>(coordinates.size()), 3);
    for (std::size_t k = 0; k < coordinates.size(); ++k) work.coordinates.row(static_cast<Index>(k)) = coordinates[k];
    std::set<Index> corners;
    for (Index c : hole.hole.corners) corners.insert(hole.hole.rim[c]);
    work.first_ring = ring[h][0].size();
    for (const std::vector<Index>& faces : ring[h])
      for (Index f : faces) {
        const auto face = closed.faces[f];
        const bool corner = std::any_of(face.begin(), face.end(), [&](Index v) { return corners.contains(v); });
        const std::vector<FacePlace> places = spread(face.size(), settings.loop);
        const LimitStencils before = was.stencils(closed.kept[f], places), now = limit.stencils(f, places);
        const Points vertices = mesh.vertices(before.vertices, Eigen::all);
        const Points pu = before.pu * vertices, pv = before.pv * vertices;
        Points normal(pu.rows(), 3);
        for (Index k = 0; k < pu.rows(); ++k) normal.row(k) = Vec3(pu.row(k)).cross(Vec3(pv.row(k))).stableNormalized();
        work.outside.push_back(
            {f, system.sums(now.vertices, now.p), before.p * vertices, normal, corner && !work.region ? options.corner : 1});
      }
    for (const auto* faces : {&work.inside, &work.outside})
      for (const SampledFace& face : *faces) together.push_back(&face.limit);
  }
  if (!exact) system.prepare(together);

  for (std::size_t h = 0; h < count; ++h) {
    Work& work = works[h];
    for (Index v : holes[h].hole.rim)
      work.shape.size = std::max(work.shape.size, (mesh.vertices.row(v) - mesh.vertices.row(holes[h].hole.rim[0])).norm());
    const std::size_t corners = settings.loop ? 3 : 4;
    for (const SampledFace& face : work.inside)
      if (closed.faces[face.face].size() == corners) work.shape.inside.push_back(face_shape(face.limit, settings.loop));
    for (std::size_t k = 0; k < work.first_ring; ++k) {
      const SampledFace& face = work.outside[k];
      if (closed.faces[face.face].size() == corners) work.shape.around.push_back(face_shape(face.limit, settings.loop));
    }
  }
  if (!exact && coarser.empty()) {
    std::vector<FairHole> fair;
    CageSystem::Term held = system.zero();
    for (const Work& work : works) {
      fair.push_back(work.shape);
      hold_surroundings(system, x, work, (work.region ? options.fair_whole : options.fair_open) * work.shape.size, held);
    }
    std::vector<int> waiting;  // the rim's own vertices, for the fit
    for (std::size_t k = 0; k < free.size(); ++k)
      if (free[k] < n) waiting.push_back(static_cast<int>(k));
    x = fair_cage(system, x, fair, held, waiting);
    for (std::size_t h = 0; h < count; ++h) {
      fits[h].fair_before = fair[h].before;
      fits[h].fair_after = fair[h].after;
    }
  }
  const auto take = [&] {
    for (std::size_t k = 0; k < free.size(); ++k) closed.vertices.row(free[k]) = x.row(static_cast<Index>(k));
    limit.move(closed.vertices);
  };
  take();

  const auto edges = directed_edges(closed, holes);
  std::vector<Seam> seams(count);
  for (std::size_t h = 0; h < count; ++h) {
    CageFit& fit = fits[h];
    const CageHole& hole = holes[h];
    if (!coarser.empty()) {
      fit.sides = coarser[h].sides;
      fit.patch = coarser[h].patch;
      fit.fair_before = coarser[h].fair_before;
      fit.fair_after = coarser[h].fair_after;
    } else {
      std::vector<Index> fill;
      for (Index f = closed.first_face[h]; f < closed.first_face[h + 1]; ++f) fill.push_back(f);
      fit.sides = part                       ? sides_on(*open, {mesh.vertices, left}, hole.hole, {}, sides_tolerance)
                  : exact || works[h].region ? sides_on(was, mesh, hole.hole, replaced, sides_tolerance)
                                             : sides_on(limit, closed.mesh(), hole.hole, fill, sides_tolerance);
      SurfacePoints points;
      if (!exact) {
        const Index rows = works[h].coordinates.rows();
        points.barycentric = works[h].coordinates;
        points.points.resize(rows, 3);
        points.normals.resize(rows, 3);
        Index row = 0;
        for (const LimitStencils& face : inside[h]) {
          const Points vertices = closed.vertices(face.vertices, Eigen::all);
          const Points p = face.p * vertices, pu = face.pu * vertices, pv = face.pv * vertices;
          for (Index k = 0; k < p.rows(); ++k, ++row) {
            points.points.row(row) = p.row(k);
            points.normals.row(row) = Vec3(pu.row(k)).cross(Vec3(pv.row(k))).stableNormalized();
          }
        }
      }
      fit.patch = hole.build(fit.sides, points);
    }
    if (exact || !coarser.empty()) {
      const Index inside_vertices = closed.first_vertex[h + 1] - closed.first_vertex[h];
      const Points on_patch = fit.patch->positions(hole.barycentric.bottomRows(inside_vertices));
      for (std::size_t k = 0; k < free.size(); ++k)
        if (free[k] >= closed.first_vertex[h] && free[k] < closed.first_vertex[h + 1])
          x.row(static_cast<Index>(k)) = on_patch.row(free[k] - closed.first_vertex[h]);
    }
    if (exact) seams[h] = seam_of(hole.hole, fit.sides, edges, closed, limit, settings.loop, system);
  }

  if (exact) {
    for (const Seam& seam : seams)
      for (const Seam::Row& row : seam.rows) together.push_back(&row.across);
    system.prepare(together);
  }

  for (int round = 0; round < options.rounds; ++round) {
    CageSystem::Term term = system.zero();
    for (std::size_t h = 0; h < count; ++h) {
      if (round > 0 || !exact) slide(x, *fits[h].patch, works[h]);
      add_patch(system, x, *fits[h].patch, works[h], options, term);
      add_surroundings(system, x, works[h], options, term);
      if (exact) add_seam(system, x, seams[h], options, term);
      add_third_derivatives(system, works[h].shape, x, options.lines * options.lines, term);
    }
    const Eigen::VectorXd y = system.step(term, Eigen::VectorXd::Zero(x.size()), anchor);
    x += Eigen::Map<const Points>(y.data(), x.rows(), 3);
  }
  take();

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
    measure(was, closed, limit, edges, hole, x, works[h], fit);
    const LimitMesh surface =
        sample_limit(limit, closed.mesh(), settings.loop, closed.first_face[h], closed.first_face[h + 1], folds_level);
    fit.triangles_folded = count_folded_edges(surface.vertices, Points(0, 3), surface.faces);
  }
  return fits;
}

}  // namespace tripatch
