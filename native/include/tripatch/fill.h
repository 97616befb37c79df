// The whole path: a hole goes in, passes through the five rooms, and comes out as faces.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/boundary/ribbon.h"
#include "tripatch/cage/cage_options.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/hole/hole.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/patch_from_sides.h"
#include "tripatch/report/report.h"

namespace tripatch {

struct FillOptions {
  std::optional<std::vector<Index>> rim;        ///< none: the only border loop with three corners
  std::optional<std::array<Index, 3>> corners;  ///< vertex indices; none: detected
  std::vector<Index> replaced;                  ///< faces of a region to be replaced: the rim is around them
  std::string method = "side_vertex";           ///< a name in methods() that fills holes
  bool limit = false;                           ///< the surroundings are the limit surface of the cage, not an estimate
  Subdivision subdivision;                      ///< of the cage
  std::array<std::string, 3> continuity = {"auto", "auto", "auto"};  ///< auto, Free, G0, G1, G2; without fairing Free is G0
  CrossBoundary cross_boundary = CrossBoundary::consistent;
  std::string fairing = "auto";                ///< none, auto, thin_plate, third_derivative, minimum_variation
  std::string output = "triangles";            ///< triangles, quads, cage
  std::optional<int> resolution;               ///< triangles: edges per side inside the fill; none: follow the rim. quads:
                                               ///< extra rows round the pole(s); none: the fewest under `tolerance`
  std::optional<double> tolerance;             ///< quads, resolution none: deviation from the patch, scene units; none: 1e-3
                                               ///< of the hole's diameter
  std::string odd = "split";                   ///< quads round an odd rim: split the longest rim edge, or triangle at the pole
  CageRim cage_rim = CageRim::smooth;          ///< cage: what happens along the rim
  std::array<double, 2> pole_offset = {0, 0};  ///< moves the pole, in fractions of the hole
  std::array<double, 3> bulge = {1, 1, 1};     ///< > 0, scales the slopes inside each side
  double tension = 0;                          ///< >= 0, pulls the fill tight (FairingOptions::tension); needs a fairing
  std::optional<Vec3> center;                  ///< where the middle of the patch is to be, S(1/3, 1/3, 1/3), scene units
  double center_offset = 0;                    ///< scene units: moves the middle along its normal from where it would be
  MethodOptions own;                           ///< what the method reads besides
};

Fill fill(const Mesh& mesh, const FillOptions& options = {});

struct Refused {
  std::string reason;
  std::vector<Index> where;
};
/// Called by the caller's own thread, several times a second and after the last: how many holes are done. What it throws ends the
/// work.
using Progress = std::function<void(std::size_t done)>;
/// One result for each rim, in order; a refusal of one does not stop the others. Cages whose surroundings overlap are fitted
/// together. corners: of each rim (shorter: detected); options.replaced: the faces in all of them; options.center: of one rim only.
std::vector<std::variant<Fill, Refused>> fill_all(const Mesh& mesh, const std::vector<std::vector<Index>>& rims,
                                                  const FillOptions& options = {},
                                                  const std::vector<std::optional<std::array<Index, 3>>>& corners = {},
                                                  const Progress& progress = {});

}  // namespace tripatch
