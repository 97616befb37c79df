#include "tripatch/fill.h"
#include "tripatch/fill_checks.h"
#include "tripatch/hole/joined_mesh.h"
#include "tripatch/math/parallel.h"

namespace tripatch {

std::vector<std::variant<Fill, Refused>> fill_all(const Mesh& mesh, const Holes& holes, const FillOptions& options,
                                                  const std::vector<std::optional<std::vector<Index>>>& corners,
                                                  const Progress& progress, const Connectivity* connected) {
  check_several(holes.rims, options, corners);
  const Mesh joined = holes.joined ? Mesh{mesh.vertices, holes.joined->faces()} : mesh;
  std::vector<std::variant<Fill, Refused>> results(holes.rims.size());
  std::vector<std::size_t> plain, around;
  std::vector<std::vector<Index>> rims;
  std::vector<std::optional<std::vector<Index>>> own_corners;
  for (std::size_t k = 0; k < holes.rims.size(); ++k) {
    if (k < holes.refused.size() && holes.refused[k]) {
      results[k] = Refused{*holes.refused[k]};
    } else if (k < holes.islands.size() && !holes.islands[k].empty()) {
      around.push_back(k);
    } else {
      plain.push_back(k);
      rims.push_back(holes.rims[k]);
      if (k < corners.size()) own_corners.push_back(corners[k]);
    }
  }
  std::vector<std::variant<Fill, Refused>> made = fill_all(joined, rims, options, own_corners, progress, connected);
  for (std::size_t k = 0; k < plain.size(); ++k) results[plain[k]] = std::move(made[k]);
  const auto fill_one = [&](std::size_t k) {
    FillOptions one = options;
    one.rim = holes.rims[around[k]];
    one.islands = holes.islands[around[k]];
    try {
      results[around[k]] = fill(joined, one);
    } catch (const CodedRefusal& refusal) {
      results[around[k]] = refused(refusal);
    }
  };
  if (!around.empty())
    parallel_for_each(around.size(), fill_one, [&](std::size_t done) {
      if (progress) progress(plain.size() + done);
    });
  if (holes.joined)
    for (std::variant<Fill, Refused>& result : results)
      if (Fill* fill = std::get_if<Fill>(&result)) holes.joined->bring_back(*fill);
  return results;
}

}  // namespace tripatch
