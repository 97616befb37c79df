#include "tripatch/estimate/local_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tripatch/math/angle.h"
#include "tripatch/math/parallel.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

constexpr std::size_t many_faces = count::block;  ///< it takes 30 us to look at them, several times what it costs to share that
/// Radians: edges that bend less are never sharp; a quarter of a circle in eleven steps bends by this.
constexpr double sharp_bend = 8 * std::numbers::pi / 180;
/// A sharp edge bends this many times as much as any edge near it that runs its way: a chamfer's edge does, the edges of a coarse
/// sphere or cylinder bend alike.
constexpr double over_others = factor::clear;
/// Cosine of the angle to it up to which an edge runs its way, 45 degrees. Of 78 rims half and
/// twice of it change one, by less than 0.1%.
constexpr double its_way = share::most;

/// Origin and scale, from the rim.
void measure_rim(const Mesh& mesh, const std::vector<Index>& rim, LocalMesh& w) {
  const std::size_t n = rim.size();
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (Index v : rim) {
    const Vec3 p = mesh.vertices.row(v);
    if (!p.allFinite()) throw CodedRefusal(Code::vertex_not_finite, {v});
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
    w.origin += p / static_cast<double>(n);
  }
  w.scale = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const Index a = rim[k], b = rim[(k + 1) % n];
    const double length = (mesh.vertices.row(a) - mesh.vertices.row(b)).norm();
    if (!(length > tolerance::rounding * (high - low).norm())) throw CodedRefusal(Code::edge_without_length, {a, b});
    w.scale += length / static_cast<double>(n);
  }
}

/// The faces within the rings and one more, for those at the vertices of the last.
void take_out(const Mesh& mesh, const Connectivity& around, const std::vector<Index>& rim, LocalMesh& w) {
  const Rings rings = rings_around(around, rim, max_rings + 1);
  for (int ring = 0; ring <= max_rings; ++ring)
    for (Index v : rings.vertices[ring])
      if (!mesh.vertices.row(v).allFinite()) throw CodedRefusal(Code::vertex_not_finite, {v});
  w.part = submesh(mesh.faces, mesh.vertices.rows(), rings.all_faces(), rim);
  w.position.reserve(w.part.vertex.size());
  for (Index v : w.part.vertex.items()) w.position.push_back((Vec3(mesh.vertices.row(v)) - w.origin) / w.scale);
}

Vec3 area_of(const LocalMesh& w, std::span<const int> face) {
  Vec3 sum = Vec3::Zero();
  const Vec3 p = w.position[face[0]];
  double extent = 0;
  for (std::size_t c = 1; c < face.size(); ++c) {
    const Vec3 d = w.position[face[c]] - p;
    extent = std::max(extent, d.squaredNorm());
    if (c + 1 < face.size()) sum += d.cross(w.position[face[c + 1]] - p);
  }
  return sum.norm() > tolerance::rounding * extent ? sum : Vec3::Zero();
}

/// The face that holds b -> a.
int face_beside(const LocalMesh& w, int a, int b) {
  for (int f : w.part.faces_at(a)) {
    const std::span<const int> face = w.part[f];
    for (std::size_t c = 0; c < face.size(); ++c)
      if (face[c] == b && face[(c + 1) % face.size()] == a) return f;
  }
  throw CodedRefusal(Code::no_face_at_edge, {w.vertex(a), w.vertex(b)});
}

/// True for a vertex that was put on an edge between a and b and left there: straight between them, in faces that would be those of
/// the edge without it (it has no other neighbors, or those of triangles that were cut in two). It lies on a chord of the surface.
bool put_on_edge(const LocalMesh& w, int v) {
  const std::size_t faces = w.part.faces_at(v).size();
  if (faces != 1 && faces != 2 && faces != 4) return false;
  std::array<std::array<int, 2>, 4> room;  // v's neighbors in each face, as they follow each other around it
  const std::span<std::array<int, 2>> beside(room.data(), faces);
  bool triangles = true;
  for (std::size_t j = 0; j < faces; ++j) {
    const std::span<const int> face = w.part[w.part.faces_at(v)[j]];
    const std::size_t size = face.size(), k = std::find(face.begin(), face.end(), v) - face.begin();
    beside[j] = {face[(k + 1) % size], face[(k + size - 1) % size]};
    triangles = triangles && size == 3;
  }
  const auto between = [&](int a, int b) {
    const Vec3 p = w.position[a] - w.position[v], q = w.position[b] - w.position[v];
    return p.dot(q) < 0 && p.cross(q).norm() <= tolerance::close * p.norm() * q.norm();
  };
  const auto [first, second] = beside[0];
  if (faces == 1 || (faces == 2 && beside[1][0] == second && beside[1][1] == first)) return between(first, second);
  if (!triangles) return false;
  const auto starts = [&](int a) { return std::find_if(beside.begin(), beside.end(), [&](const auto& o) { return o[0] == a; }); };
  const auto ends = [&](int a) { return std::any_of(beside.begin(), beside.end(), [&](const auto& o) { return o[1] == a; }); };
  std::vector<int> around = {first};  // from the open end, where there is one
  for (const auto& o : beside)
    if (!ends(o[0])) around = {o[0]};
  for (std::size_t k = 0; k < faces; ++k) {
    const auto next = starts(around.back());
    if (next == beside.end()) return false;
    around.push_back((*next)[1]);
  }
  if (faces == 2) return between(around[0], around[2]);
  return around[4] == around[0] && (between(around[0], around[2]) || between(around[1], around[3]));
}

/// The faces within the rings in the order in which the rings are walked, and which vertices they reach.
struct Reached {
  std::vector<int> order;
  std::vector<char> face, vertex;
};

Reached reach(const LocalMesh& w) {
  Reached reached{{}, std::vector<char>(w.part.face.size(), 0), std::vector<char>(w.position.size(), 0)};
  std::vector<int> front = w.rim, next;
  for (int v : front) reached.vertex[v] = 1;
  for (int ring = 0; ring < max_rings; ++ring, front = std::move(next)) {
    next.clear();
    for (int v : front)
      for (int f : w.part.faces_at(v)) {
        if (reached.face[f]) continue;
        reached.face[f] = 1;
        reached.order.push_back(f);
        for (int c : w.part[f])
          if (!reached.vertex[c]) {
            reached.vertex[c] = 1;
            next.push_back(c);
          }
      }
  }
  return reached;
}

/// The corner after c in face f.
int after(const LocalMesh& w, int f, int c) { return c + 1 < w.part.offsets[f + 1] ? c + 1 : w.part.offsets[f]; }

bool has(const Submesh& part, int f, int v) {
  const int* const c = &part.corners[part.offsets[f]];
  const int size = part.offsets[f + 1] - part.offsets[f];
  if (size == 3) return c[0] == v || c[1] == v || c[2] == v;
  return std::find(c, c + size, v) != c + size;
}

/// The faces beyond the edges of those reached, by corner.
void find_across(LocalMesh& w, const Reached& reached) {
  const Submesh& part = w.part;
  w.across.assign(part.corners.size(), -1);
  for (int f : reached.order)
    for (int c = part.offsets[f]; c < part.offsets[f + 1]; ++c) {
      const int a = part.corners[c], b = part.corners[after(w, f, c)];
      for (int g : part.faces_at(a))
        if (g != f && reached.face[g] && has(part, g, b)) {
          w.across[c] = g;
          break;
        }
    }
}

/// How far the faces at the edge at corner c of face f are turned against each other, radians; 0 where there is one.
double bend_at(const LocalMesh& w, const std::vector<int>& across, int f, int c) {
  return across[c] >= 0 ? angle_between(w.area[f], w.area[across[c]]) : 0;
}

/// Whether that is so little that the edge is never sharp, without an arc tangent: nearly always.
bool is_flat(const LocalMesh& w, const std::vector<int>& across, int f, int c) {
  static const double cosine = std::cos(share::nearly_all * sharp_bend);
  const int g = across[c];
  return g < 0 || w.area[f].dot(w.area[g]) > cosine * w.twice_area[f] * w.twice_area[g];
}

/// The largest bend of the edges that run the way of the edge at corner c of face f, and do not touch it, within two faces of it; -1:
/// there are none.
double bend_near(const LocalMesh& w, const std::vector<int>& across, int f, int c) {
  const Submesh& part = w.part;
  const int a = part.corners[c], b = part.corners[after(w, f, c)];
  std::vector<int> around = {f, across[c]};
  for (std::size_t k = 0, round = 0, end = 2; round < 2; ++round, end = around.size())
    for (; k < end; ++k)
      for (int d = part.offsets[around[k]]; d < part.offsets[around[k] + 1]; ++d)
        if (across[d] >= 0 && std::find(around.begin(), around.end(), across[d]) == around.end()) around.push_back(across[d]);
  double others = -1;
  const Vec3 way = w.position[b] - w.position[a];
  for (int g : around)
    for (int d = part.offsets[g]; d < part.offsets[g + 1]; ++d) {
      const int p = part.corners[d], q = part.corners[after(w, g, d)];
      if (p == a || p == b || q == a || q == b || across[d] < 0) continue;
      const Vec3 direction = w.position[q] - w.position[p];
      if (std::abs(direction.dot(way)) > its_way * direction.norm() * way.norm())
        others = std::max(others, bend_at(w, across, g, d));
    }
  return others;
}

/// Neighbors of the faces within the rings, and which vertices were put on an edge.
Reached find_neighbors(LocalMesh& w) {
  const Reached reached = reach(w);
  find_across(w, reached);
  w.on_chord.assign(w.position.size(), 0);
  for (std::size_t v = 0; v < w.position.size(); ++v) w.on_chord[v] = reached.vertex[v] && put_on_edge(w, static_cast<int>(v));
  for (int v : w.rim) w.on_chord[v] = 0;
  return reached;
}

/// Areas of the faces, and from them normals at the vertices.
void measure_areas(LocalMesh& w) {
  w.area.reserve(w.part.face.size());
  w.twice_area.reserve(w.part.face.size());
  for (int f = 0; f < static_cast<int>(w.part.face.size()); ++f) w.area.push_back(area_of(w, w.part[f]));
  for (const Vec3& area : w.area) w.twice_area.push_back(area.norm());
  w.normal_at.assign(w.position.size(), Vec3::Zero());
  for (int f = 0; f < static_cast<int>(w.area.size()); ++f)
    for (int v : w.part[f]) w.normal_at[v] += w.area[f];
  for (Vec3& n : w.normal_at)
    if (const double length = n.norm(); length > 0) n /= length;
}

/// Takes away the neighbors beyond sharp edges.
void part_at_sharp_edges(LocalMesh& w, const Reached& reached) {
  const std::vector<int> across = w.across;
  for (int f : reached.order)
    for (int c = w.part.offsets[f]; c < w.part.offsets[f + 1]; ++c) {
      if (is_flat(w, across, f, c)) continue;
      const double bend = bend_at(w, across, f, c);
      if (bend <= sharp_bend) continue;
      const double others = bend_near(w, across, f, c);
      if (others >= 0 && bend > sharp_bend + over_others * others) w.across[c] = -1;
    }
}

}  // namespace

LocalMesh local_mesh(const Mesh& mesh, const Connectivity& around, const Hole& hole) {
  LocalMesh w;
  measure_rim(mesh, hole.rim, w);
  take_out(mesh, around, hole.rim, w);
  const int n = static_cast<int>(hole.rim.size());
  w.rim.resize(n);
  std::iota(w.rim.begin(), w.rim.end(), 0);
  Reached reached;
  const auto measure_all = [&] {
    measure_areas(w);
    for (int k = 0; k < n; ++k) w.beside.push_back(face_beside(w, k, (k + 1) % n));
  };
  both_at_once([&] { reached = find_neighbors(w); }, measure_all, w.part.face.size() >= many_faces);
  part_at_sharp_edges(w, reached);
  return w;
}

}  // namespace tripatch
