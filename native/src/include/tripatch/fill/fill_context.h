// A mesh in which holes are filled, and the rim that is meant in it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tripatch/boundary/vertex_planes.h"
#include "tripatch/hole/hole.h"
#include "tripatch/mesh/connectivity.h"
#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"

namespace tripatch {

struct FillProblem;

/// A mesh and who is next to whom in it, for one fill or for several.
class FillContext {
  std::optional<Connectivity> own_, all_;  // before what refers to them

public:
  /// For one rim, or for all of the mesh where none is given. connected: of the whole mesh, if the caller has it.
  FillContext(const Mesh& mesh, const std::optional<std::vector<Index>>& rim, const FillOptions& options,
              const Connectivity* connected = nullptr);
  /// With the faces that are replaced.
  const Connectivity& whole() const { return all_ ? *all_ : left; }
  /// Where fills pass through each other or the mesh, or through its limit surface if that is what they continue.
  std::vector<std::optional<Vec3>> passages_of(std::span<const Fill* const> fills, const FillOptions& options) const;
  /// Whether the neighborhood of one rim is all that is known.
  bool is_part() const { return is_part_; }

  const Mesh& mesh;
  const Connectivity& left;  ///< without the faces that are replaced
  VertexPlanes planes;       ///< that fills have at vertices of their rims, whatever the faces around tell
  bool keeps_clear = false;  ///< whether fills that pass through the mesh are the last to be chosen
  /// Of the only rim: what was found for it stays for the next fill of the same.
  mutable std::shared_ptr<FillProblem> problem;

private:
  bool is_part_;
};

/// Vertices of a rim; empty: it is round; none: they are to be found.
using Corners = std::optional<std::vector<Index>>;

/// The border through the first of the corners.
std::vector<Index> loop_through(const FillContext& context, const std::vector<Index>& corners);
/// The only hole of the mesh, of any rim; a Refusal that lists them where there are several.
std::vector<Index> only_hole(const FillContext& context);
/// The hole with three corners.
Hole hole_of(const FillContext& context, const std::optional<std::vector<Index>>& rim, const Corners& corners);
/// For a method that takes three sides only; a Refusal where another number of corners is given.
std::optional<std::array<Index, 3>> three(const Corners& corners);

std::vector<Index> at_places(const std::vector<Index>& loop, const std::vector<Index>& places);
/// The other way round: where in a loop some of its vertices are, in its order.
std::vector<Index> places_in(const std::vector<Index>& loop, const std::vector<Index>& vertices);

/// A rim from its first corner on, with the places of the corners.
struct CorneredRim {
  std::vector<Index> rim, places;
};
CorneredRim cornered(const FillContext& context, const std::vector<Index>& rim, const std::vector<Index>& corners);

/// Numbers of corners that a patch over a polygon or a lens takes: not three.
bool makes_polygon(const std::vector<Index>& corners);

/// Per-side options have one value or as many as there are sides.
void check_counts(const FillOptions& options, std::size_t sides);

}  // namespace tripatch
