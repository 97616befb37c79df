// Rims with edges of no length, as a boolean leaves them whose cutter lies upon an axis of the mesh: filled as if the vertices there were
// one, and the new faces joined to all of them.
#pragma once

#include <array>
#include <map>
#include <span>
#include <unordered_map>
#include <vector>

#include "tripatch/fill/fill_context.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

/// Whether vertices that follow each other on a rim lie at one place.
bool has_edges_of_no_length(const PointsRef& vertices, std::span<const Index> rim);

/// A mesh in which the vertices of a rim that follow each other, and lie at one place, are one. It has the vertices of the mesh that is
/// given, which outlives it; faces of which less than a triangle stays are left out.
class MergedRims {
public:
  /// rims: each passes a vertex once. Their edges of no length are merged, but for vertices that several pass.
  MergedRims(const Mesh& mesh, std::span<const std::vector<Index>> rims, const FillOptions& options);

  /// Whether there was anything to merge.
  bool any() const { return !at_.empty(); }
  Mesh mesh() const { return {mesh_.vertices, faces_}; }
  /// Those that were given, by the vertices and faces of this mesh.
  const FillOptions& options() const { return options_; }
  std::vector<Index> merged(const std::vector<Index>& loop) const;
  /// Throws InvalidArgument where two are at one place.
  Corners merged(const Corners& corners) const;
  /// Joins a fill of this mesh to the one that was given: a triangle without area is added for every edge of no length. False where such
  /// a triangle would double an edge of the mesh: the fill is of no use then.
  bool bring_back(Fill& fill) const;

private:
  /// By two vertices that are neighbors in the merged rim: those between them, from the first to the second.
  using Between = std::map<std::array<Index, 2>, std::vector<Index>>;

  void merge(const std::vector<Index>& rim, const std::unordered_map<Index, int>& passed);
  void merge_faces();
  Index place(Index v) const;
  Between between_in(Fill& fill) const;
  void add_joined(std::span<const Index> face, const Between& between, Faces& faces,
                  std::vector<std::array<Index, 3>>& flat) const;

  Mesh mesh_;
  std::vector<Index> replaced_;  ///< faces of it
  FillOptions options_;
  Faces faces_;
  std::unordered_map<Index, Index> at_;  ///< of a vertex that is merged: the one that stands for its place
  Between between_;
};

}  // namespace tripatch
