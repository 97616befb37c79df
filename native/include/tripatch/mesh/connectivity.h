// Who is next to whom in a mesh: built once, in time linear in the mesh, and passed on to all that walk over it. What is asked of it
// afterwards takes time by the faces concerned, not by the mesh.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

class Connectivity {
public:
  /// A corner of a face: its place in the corners of all faces.
  using Corner = std::uint32_t;

  /// Of a mesh without the `replaced` faces. `faces` must outlive it. vertices: how many the mesh has; none: as many as the faces name.
  /// Throws InvalidArgument for a vertex or a face that does not exist, for offsets out of order, and where there are 2^32 corners or
  /// more.
  explicit Connectivity(const FacesRef& faces, std::optional<Index> vertices = {}, std::span<const Index> replaced = {});
  explicit Connectivity(const Mesh& mesh, std::span<const Index> replaced = {})
      : Connectivity(mesh.faces, mesh.vertices.rows(), replaced) {}

  /// Of the mesh as far as `rings` rings of faces around `vertices`, and at least there: half the work where one hole is asked for.
  static Connectivity around(const Mesh& mesh, std::span<const Index> vertices, int rings, std::span<const Index> replaced = {});
  /// Whether the faces at a vertex are known; always, but for `around`.
  bool knows(Index v) const { return known_.empty() || known_[v]; }

  const FacesRef& faces() const { return faces_; }
  Index vertices() const { return vertices_; }

  /// The corners at a vertex, in the order of their faces.
  std::span<const Corner> at(Index v) const { return {corners_.get() + start_[v], corners_.get() + start_[v + 1]}; }
  Index face(Corner c) const { return size_ == 3 ? c / 3 : size_ > 0 ? c / size_ : face_[c]; }  // by a constant: a product
  /// Of a corner in its face.
  Index place(Corner c) const { return c - of_face(c).first; }
  /// The vertices after and before a corner in its face.
  Index next(Corner c) const {
    const auto [first, end] = of_face(c);
    return faces_.corners[c + 1 < end ? c + 1 : first];
  }
  Index previous(Corner c) const {
    const auto [first, end] = of_face(c);
    return faces_.corners[(c > first ? c : end) - 1];
  }

  /// That of two vertices with fewer faces: to look at for an edge.
  Index sparser(Index a, Index b) const;
  /// The first corner at `from` whose face continues to `to`: the face that holds the edge in this direction.
  std::optional<Corner> edge(Index from, Index to) const;
  /// The faces at an edge, whatever their direction.
  std::vector<Index> faces_at_edge(Index a, Index b) const;
  /// The neighbors of a vertex in the order in which its faces follow each other: against the clock seen from their outer side, from
  /// the first corner on, or from the border on. Empty where its faces are no single fan.
  std::vector<Index> one_ring(Index v) const;

private:
  Connectivity(const FacesRef& faces, Index vertices, std::span<const Index> replaced, std::vector<char> known);

  /// The corners of a face from one of them: the first, and one past the last.
  struct CornersOfFace {
    Corner first, end;
  };
  CornersOfFace of_face(Corner c) const {
    if (size_ == 3) return {c - c % 3, c - c % 3 + 3};
    if (size_ > 0) return {c - c % size_, c - c % size_ + size_};
    const Index f = face_[c];
    return {static_cast<Corner>(faces_.offsets[f]), static_cast<Corner>(faces_.offsets[f + 1])};
  }

  FacesRef faces_;
  Index vertices_ = 0;
  std::vector<Corner> start_;  // of each vertex in corners_
  std::unique_ptr<Corner[]> corners_;
  Corner size_ = 0;           // of every face; 0: they differ,
  std::vector<Corner> face_;  // and this is the face of each corner
  std::vector<char> known_;   // by vertex; empty: all
};

/// Every edge of a mesh once.
struct Edges {
  std::vector<std::array<Index, 2>> vertices;     ///< lower index first, in the order in which the faces name the edges
  std::vector<Connectivity::Corner> from_corner;  ///< the edge that leaves each corner of the faces
};
Edges edges_of(const Connectivity& mesh);

/// Connected components, by edges: for each face the number of its component, in the order of their first faces.
std::vector<Index> components_of(const Connectivity& mesh);

}  // namespace tripatch
