// The whole path: a hole of a mesh goes in and comes out as faces.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "tripatch/hole/choose_holes.h"
#include "tripatch/messages.h"
#include "tripatch/options.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/report/report.h"

namespace tripatch {

Fill fill(const Mesh& mesh, const FillOptions& options = {});

/// Why a hole is not filled.
struct Refused {
  Message message;
  Messages also = {};  ///< what else is to be said
  std::string text() const { return CodedRefusal(message, also).what(); }
};
inline Refused refused(const CodedRefusal& refusal) { return {refusal.message(), refusal.also()}; }

/// Called by the caller's own thread, several times a second and after the last: how many holes are done. What it throws ends the
/// work.
using Progress = std::function<void(std::size_t done)>;
/// One result for each rim, in order; a refusal of one does not stop the others. Cages whose surroundings overlap are fitted
/// together; fills of holes that share a vertex have one tangent plane there. corners: of each rim (shorter: detected); options.replaced:
/// the faces in all of them; options.center: of one rim only. connected: of the whole mesh, if the caller has it.
std::vector<std::variant<Fill, Refused>> fill_all(const Mesh& mesh, const std::vector<std::vector<Index>>& rims,
                                                  const FillOptions& options = {},
                                                  const std::vector<std::optional<std::vector<Index>>>& corners = {},
                                                  const Progress& progress = {}, const Connectivity* connected = nullptr);

/// The same of all holes that were found, with their islands. Corners of a rim with islands are not looked at. connected: of the joined
/// mesh, where borders lie on each other.
std::vector<std::variant<Fill, Refused>> fill_all(const Mesh& mesh, const Holes& holes, const FillOptions& options = {},
                                                  const std::vector<std::optional<std::vector<Index>>>& corners = {},
                                                  const Progress& progress = {}, const Connectivity* connected = nullptr);

/// A mesh with arrays of its own.
struct OwnMesh {
  Points vertices;
  Faces faces;

  operator Mesh() const { return {vertices, faces}; }  // NOLINT(google-explicit-constructor): as of a vector to a span
};
/// A mesh with fills of it: its own vertices keep their numbers, those of each fill follow in order. Edges that were split have their
/// vertex in the face beyond too, and vertices that were moved are where they went. Refused results are left out.
/// replaced: as options.replaced, faces that are left out.
OwnMesh with_fill(const Mesh& mesh, const Fill& fill, std::span<const Index> replaced = {});
OwnMesh with_fills(const Mesh& mesh, const std::vector<std::variant<Fill, Refused>>& results,
                   std::span<const Index> replaced = {});

}  // namespace tripatch
