#include "tripatch/mesh/canonical_part.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "tripatch/math/canonical_start.h"
#include "tripatch/math/thresholds.h"
#include "tripatch/math/tolerant_compare.h"
#include "tripatch/mesh/submesh.h"

namespace tripatch {
namespace {

using RimLoop = std::vector<Index>;

/// Rings whose vertices are looked at where the rim alone does not tell its beginnings apart, before all that is known is.
constexpr int near_rings = count::pair;
/// Vertices next to beginnings that are looked at so, at most: 0.3 s. Where there are more only those of so many rings as that allows are.
constexpr Index max_compared = Index{count::hundreds} * count::million;

/// Gives out numbers from the loops on, the faces around each vertex in the order in which they follow each other.
class Walk {
public:
  explicit Walk(const Mesh& mesh) : vertices(mesh.vertices.rows()), faces(mesh.faces.size()), around_(mesh) {}

  void from(const std::vector<RimLoop>& loops) {
    for (const RimLoop& loop : loops)
      for (Index v : loop) vertices.add(v);
    for (const RimLoop& loop : loops)
      for (std::size_t k = 0; k < loop.size(); ++k) {  // from the rim on
        const Index v = loop[k];
        const auto beyond = around_.edge(loop[(k + 1) % loop.size()], v);
        if (beyond) turn_about(v, corner_at(v, around_.face(*beyond)));
      }
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      const Index v = vertices.items()[k];
      if (entered_.size() > k && entered_[k]) turn_about(v, *entered_[k]);
      for (Connectivity::Corner c : around_.at(v)) take(c);  // what no edge joins to those
    }
  }

  Numbering vertices, faces;
  std::vector<Connectivity::Corner> first;  // of each face, from which it is met

private:
  Connectivity::Corner corner_at(Index v, Index face) const {
    for (Connectivity::Corner c : around_.at(v))
      if (around_.face(c) == face) return c;
    return around_.at(v)[0];
  }

  void take(Connectivity::Corner c) {
    const Index f = around_.face(c);
    if (!faces.add(f)) return;
    const IndicesRef face = around_.faces()[f];
    const std::size_t n = face.size(), at = static_cast<std::size_t>(around_.place(c));
    first.push_back(c);
    for (std::size_t k = 0; k < n; ++k) {
      const Index w = face[at + k < n ? at + k : at + k - n];
      if (!vertices.add(w)) continue;
      entered_.resize(vertices.size());
      entered_.back() = corner_at(w, f);
    }
  }

  /// Takes the faces at v from a corner on, one after the other across their edges; those before it then.
  void turn_about(Index v, Connectivity::Corner start) {
    take(start);
    std::size_t left = around_.at(v).size();
    Connectivity::Corner c = start;
    for (; left > 0; --left) {
      const auto next = around_.edge(v, around_.previous(c));
      if (!next) break;
      if (*next == start) return;
      take(c = *next);
    }
    for (c = start; left > 0; --left) {
      const auto before = around_.edge(around_.next(c), v);
      if (!before) break;
      c = corner_at(v, around_.face(*before));
      if (c == start) break;
      take(c);
    }
  }

  Connectivity around_;
  std::vector<std::optional<Connectivity::Corner>> entered_;  // of each vertex but the loops': where it was met
};

/// Some faces with numbers of their own, in a mirror or not.
struct Copy {
  Copy(const Mesh& mesh, const std::vector<Index>& some, const std::vector<RimLoop>& loops, bool mirrored)
      : numbers(mesh.vertices.rows()) {
    for (const RimLoop& loop : loops)
      for (Index v : loop) numbers.add(v);
    std::vector<Index> face;
    for (Index f : some) {
      face.clear();
      for (Index v : mesh.faces[f]) {
        numbers.add(v);
        face.push_back(numbers.find(v));
      }
      if (mirrored) std::reverse(face.begin(), face.end());
      faces.add(face);
    }
    points = mesh.vertices(numbers.items(), Eigen::all);
    if (mirrored) points.col(0) *= -1;
  }
  Numbering numbers;
  Points points;
  Faces faces;
};

/// Where and in which direction each loop is begun; the first of them says whether it is backwards. Of those that are alike as far as
/// `some` faces reach the one of the lowest vertex, forwards.
std::vector<CanonicalStart> beginnings_of(const Mesh& mesh, const Connectivity& around, const std::vector<RimLoop>& loops,
                                          const std::vector<Index>& some) {
  std::vector<CanonicalStart> out;
  RimLoop all;
  for (const RimLoop& loop : loops) all.insert(all.end(), loop.begin(), loop.end());
  for (const RimLoop& loop : loops) {
    CanonicalStarts choice(mesh.vertices(loop, Eigen::all), out.empty() ? std::nullopt : std::optional(out[0].backwards));
    choice.compare_along();
    const Index most = max_compared / static_cast<Index>(loop.size());
    const auto compare_with_rings = [&](Index rings) {
      RimLoop near;
      for (const RimLoop& ring : rings_around(around, all, static_cast<int>(rings)).vertices)
        near.insert(near.end(), ring.begin(), ring.end());
      choice.compare_with(mesh.vertices(near, Eigen::all));
    };
    if (!choice.decided()) compare_with_rings(near_rings);
    if (!choice.decided()) {
      Numbering seen;
      for (Index f : some)
        for (Index v : mesh.faces[f]) seen.add(v);
      const Index rings = most / static_cast<Index>(all.size());
      if (std::cmp_less_equal(seen.size(), most))
        choice.compare_with(mesh.vertices(seen.items(), Eigen::all));
      else if (rings > near_rings)
        compare_with_rings(rings);
    }
    out.push_back(
        *std::min_element(choice.left().begin(), choice.left().end(), [&](const CanonicalStart& a, const CanonicalStart& b) {
          return std::pair(loop[a.place], a.backwards) < std::pair(loop[b.place], b.backwards);
        }));
  }
  return out;
}

}  // namespace

CanonicalPart canonical_part(const Mesh& mesh, const Connectivity& around, const std::vector<RimLoop>& loops,
                             const std::vector<Index>& some) {
  const std::vector<CanonicalStart> begun = beginnings_of(mesh, around, loops, some);
  CanonicalPart part;
  part.mirrored = begun[0].backwards;
  std::vector<std::size_t> order(loops.size());  // islands by their length
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> length;
  for (const RimLoop& loop : loops) length.push_back(coarse(length_around(Points(mesh.vertices(loop, Eigen::all)))));
  std::stable_sort(order.begin() + 1, order.end(), [&](std::size_t a, std::size_t b) { return length[a] > length[b]; });
  std::vector<Index> before(loops.size(), 0);
  for (std::size_t k = 0; k + 1 < loops.size(); ++k) before[k + 1] = before[k] + static_cast<Index>(loops[k].size());

  const Copy copy(mesh, some, loops, part.mirrored);
  std::vector<RimLoop> walked;  // by the copy's numbers
  for (std::size_t l : order) {
    const Index n = static_cast<Index>(loops[l].size());
    walked.emplace_back();
    for (Index k = 0; k < n; ++k) {
      const Index place = begun[l].at(k, n);
      part.row.push_back(before[l] + place);
      walked.back().push_back(copy.numbers.find(loops[l][place]));
    }
  }
  Walk walk(Mesh{copy.points, copy.faces});
  walk.from(walked);

  part.vertices.resize(static_cast<Index>(walk.vertices.size()), 3);
  for (Index k = 0; k < part.vertices.rows(); ++k) {
    const Index v = walk.vertices.items()[k];
    part.vertices.row(k) = copy.points.row(v);
    part.vertex.push_back(copy.numbers.items()[v]);
  }
  std::vector<Index> own;
  for (std::size_t k = 0; k < walk.faces.size(); ++k) {
    const Index f = walk.faces.items()[k];
    const auto face = copy.faces[f];
    const std::size_t n = face.size(), first = walk.first[k] - static_cast<std::size_t>(copy.faces.offsets[f]);
    own.clear();
    for (std::size_t j = 0; j < n; ++j) own.push_back(walk.vertices.find(face[(first + j) % n]));
    part.faces.add(own);
    part.face.push_back(some[f]);
  }
  for (RimLoop& loop : walked) {
    for (Index& v : loop) v = walk.vertices.find(v);
    part.loops.push_back(std::move(loop));
  }
  return part;
}

}  // namespace tripatch
