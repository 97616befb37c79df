#include "tripatch/cage/limit_mesh.h"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "tripatch/math/interruption.h"
#include "tripatch/report/folded_triangles.h"

namespace tripatch {
namespace {

/// Points of the limit surface that are evaluated once: those of corners and edges belong to several faces.
class SharedPoints {
public:
  /// Of a corner of the cage, a place on an edge, the middle of an n-gon, a place on the spoke of an n-gon, inside a face.
  enum Kind : Index { corner, edge, middle, spoke, inside };
  using Key = std::array<Index, 5>;  ///< kind, and what tells it from others of the kind

  SharedPoints(const LimitSurface& limit, const Mesh& cage) : limit_(limit), cage_(cage) {}

  static Key on_edge(Index a, Index b, int place, int whole) {
    if (place == 0) return {corner, a};
    if (place == whole) return {corner, b};
    return a < b ? Key{edge, a, b, place} : Key{edge, b, a, whole - place};
  }

  /// Number of a point; those that are new are evaluated by `finish`.
  Index at(const Key& key, const FacePlace& place) {
    const auto [known, fresh] = known_.try_emplace(key, static_cast<Index>(points_.size() + waiting_.size()));
    if (fresh) waiting_.push_back(place);
    return known->second;
  }

  /// All that have been asked for since the last time lie on this face.
  void finish(Index face) {
    if (waiting_.empty()) return;
    check_interruption();
    const LimitStencils stencils = limit_.stencils(face, waiting_);
    const Points p = stencils.p * Points(cage_.vertices(stencils.vertices, Eigen::all));
    for (Index k = 0; k < p.rows(); ++k) points_.push_back(p.row(k));
    waiting_.clear();
  }

  Points all() const {
    Points result(static_cast<Index>(points_.size()), 3);
    for (std::size_t k = 0; k < points_.size(); ++k) result.row(static_cast<Index>(k)) = points_[k];
    return result;
  }

private:
  const LimitSurface& limit_;
  const Mesh& cage_;
  std::map<Key, Index> known_;
  std::vector<FacePlace> waiting_;
  std::vector<Vec3> points_;
};

void sample_triangle(SharedPoints& points, const IndicesRef& face, Index f, int steps, Faces& faces) {
  const auto vertex = [&](int i, int j) {
    const SharedPoints::Key key = j == 0           ? SharedPoints::on_edge(face[0], face[1], i, steps)
                                  : i == 0         ? SharedPoints::on_edge(face[0], face[2], j, steps)
                                  : i + j == steps ? SharedPoints::on_edge(face[1], face[2], j, steps)
                                                   : SharedPoints::Key{SharedPoints::inside, f, 0, i, j};
    return points.at(key, {0, static_cast<double>(i) / steps, static_cast<double>(j) / steps});
  };
  for (int i = 0; i < steps; ++i)
    for (int j = 0; i + j < steps; ++j) {
      faces.add(std::array<Index, 3>{vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      if (i + j + 1 < steps) faces.add(std::array<Index, 3>{vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  points.finish(f);
}

/// A quad is one block; an n-gon has a block at each corner, half as wide.
void sample_polygon(SharedPoints& points, const IndicesRef& face, Index f, int steps, Faces& faces) {
  const Index size = static_cast<Index>(face.size());
  const bool quad = size == 4;
  const int blocks = quad ? 1 : static_cast<int>(size), width = quad ? steps : std::max(1, steps / 2);
  const auto edge = [&](Index k, int place, int whole) {
    return SharedPoints::on_edge(face[k % size], face[(k + 1) % size], place, whole);
  };
  const auto quad_key = [&](int i, int j) -> SharedPoints::Key {
    if (j == 0) return edge(0, i, width);
    if (i == width) return edge(1, j, width);
    if (j == width) return edge(2, width - i, width);
    if (i == 0) return edge(3, width - j, width);
    return {SharedPoints::inside, f, 0, i, j};
  };
  const auto quarter_key = [&](int q, int i, int j) -> SharedPoints::Key {
    if (j == 0) return edge(q, i, 2 * width);
    if (i == 0) return edge(q + size - 1, 2 * width - j, 2 * width);
    if (i == width && j == width) return {SharedPoints::middle, f};
    if (i == width) return {SharedPoints::spoke, f, q, j};
    if (j == width) return {SharedPoints::spoke, f, (q + size - 1) % size, i};
    return {SharedPoints::inside, f, q, i, j};
  };
  for (int q = 0; q < blocks; ++q) {
    const auto vertex = [&](int i, int j) {
      return points.at(quad ? quad_key(i, j) : quarter_key(q, i, j),
                       {q, static_cast<double>(i) / width, static_cast<double>(j) / width});
    };
    for (int i = 0; i < width; ++i)
      for (int j = 0; j < width; ++j)
        faces.add(std::array<Index, 4>{vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
  }
  points.finish(f);
}

}  // namespace

LimitMesh sample_limit(const LimitSurface& limit, const Mesh& cage, bool loop, Index first, Index last, int level) {
  LimitMesh mesh;
  SharedPoints points(limit, cage);
  for (Index f = first; f < last; ++f)
    (loop ? sample_triangle : sample_polygon)(points, cage.faces[f], f, 1 << level, mesh.faces);
  mesh.vertices = points.all();
  begin_at_shorter_diagonals(mesh.vertices, Points(0, 3), mesh.faces);
  return mesh;
}

LimitMesh sample_limit(const Mesh& cage, const Subdivision& given, Index first, int level) {
  Subdivision settings = given;
  if (!settings.quality) settings.quality = stencil_quality;
  std::vector<Index> around;
  for (Index f = first; f < cage.faces.size(); ++f) around.insert(around.end(), cage.faces[f].begin(), cage.faces[f].end());
  return sample_limit(LimitSurface(cage, settings, around), cage, settings.loop, first, cage.faces.size(), level);
}

}  // namespace tripatch
