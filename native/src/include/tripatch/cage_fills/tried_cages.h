// Cages in some holes that are tried in several ways until one does no harm.
#pragma once

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "tripatch/cage/cage_fill.h"
#include "tripatch/fill/fill_context.h"

namespace tripatch {

/// Whether a method between three sides is asked for by its name: then the cage is that one's or none.
bool is_named(const FillOptions& options);

/// Which cages have their vertices where the mesh around would continue.
enum class OnMeshWhere { nowhere, likelier, run_off, everywhere, untangled };

/// Ways that were tried where one without harm is wanted: the same again would do the same.
class SeenWays {
public:
  /// Whether it is new.
  bool add(const SidedRim& hole, const FillOptions& options, OnMeshWhere where, const QuadLayout& layout) {
    const auto is_same = [&](const Way& other) {
      return other.hole.rim == hole.rim && other.hole.corners == hole.corners && other.odd == options.odd &&
             other.resolution == options.resolution && other.where == where &&
             other.layout.faces.corners == layout.faces.corners && other.layout.faces.offsets == layout.faces.offsets &&
             other.layout.barycentric == layout.barycentric;
    };
    if (std::ranges::any_of(ways_, is_same)) return false;
    ways_.push_back({hole, options.odd, options.resolution, where, layout});
    return true;
  }

private:
  struct Way {
    SidedRim hole;
    Odd odd;
    std::optional<int> resolution;
    OnMeshWhere where;
    QuadLayout layout;
  };
  std::vector<Way> ways_;
};

/// That a cage crosses itself, then its folds: as of a report.
using Harm = std::pair<bool, Index>;
/// Why a cage is not used, but another one that does no more harm.
Code why_not(const Harm& lost, const Harm& used);

/// Cages in some holes, in one of several ways. Where a cage is alone and hangs on no patch, its patch, which takes longer than the cage, is
/// made when the fill is asked for: most of those that are tried are not taken.
class TriedCages {
public:
  /// seen: where one without harm is wanted.
  TriedCages(const FillContext& context, std::vector<SidedRim> holes, FillOptions options, OnMeshWhere on_mesh, SeenWays* seen);
  TriedCages(const TriedCages&) = delete;
  TriedCages& operator=(const TriedCages&) = delete;

  bool is_placed() const { return placed_; }
  /// Whether, and that in a hole of many vertices, it was placed before it was made fair.
  bool is_one_of_many() const { return of_many_; }
  /// Whether there is another place for its vertices.
  bool has_other_place() const { return has_other_place_; }
  const std::vector<SidedRim>& holes() const { return holes_; }
  const FillOptions& options() const { return options_; }

  /// Of the first hole. Where none is wanted what folds is not asked whether it crosses itself too.
  Harm harm();
  bool is_harmless() { return harm() == Harm(false, 0); }
  bool crosses_itself() { return waits_ ? cages_.harm(0).crossing.has_value() : fills_[0].report.crosses_itself; }
  /// With the folds of a patch that it is fitted to.
  Harm harm_and_folds() {
    const auto [crosses, folded] = harm();
    return {crosses, folded + (waits_ || was_seen_ ? 0 : fills_[0].report.folds)};
  }
  int rows() const { return waits_ || was_seen_ ? 0 : fills_[0].report.rows; }

  /// The cage of the first hole, and the candidates that it lists, as candidates that are not used. used: the harm of the cage that is.
  std::vector<FillCandidate> listed(const Harm& used);
  /// Adds a cage that is not used, and what it lists, to the candidates.
  void list(TriedCages& lost);

  /// To be said of the first fill.
  void warn(Message warning) { warnings_.push_back(std::move(warning)); }

  /// Rim, vertices, faces and what changes around them, of the first hole.
  Fill faces() const {
    Fill fill;
    cages_.deliver(0, fill);
    return fill;
  }
  /// Their reports list the candidates that are not used.
  std::vector<Fill> fills();

private:
  /// Where the mesh around would continue, if they are to be there, else as the fairest ones.
  void put(OnMeshWhere on_mesh);
  void make_patches();
  Quality quality();
  std::vector<FillCandidate> others() const;
  void complete();

  const FillContext& ground_;
  const std::vector<SidedRim> holes_;
  const FillOptions options_;
  const bool no_harm_wanted_, named_;
  CageFill cages_;
  std::vector<Fill> fills_;
  Messages warnings_;
  std::optional<Index> folded_;
  Code way_ = Code::fitted_cage;        ///< how it is placed: the code of its row
  std::map<Code, Code> skipped_;        ///< other ways, and why they are not used
  std::vector<FillCandidate> others_;   ///< cages that were made and are not used
  std::optional<double> placed_error_;  ///< of what its vertices were placed on, scene units
  bool exact_ = false, fair_ = false, follows_ = false;
  bool in_rows_ = false, of_many_ = false, likelier_ = false, placed_ = false, has_other_place_ = false;
  bool waits_ = false;     ///< for its patch
  bool was_seen_ = false;  ///< and does harm
};

using TriedOnes = std::unique_ptr<TriedCages>;
/// Of a hole that is alone other ways are tried where one does harm. seen: where one without harm is wanted.
TriedOnes try_cages(const FillContext& context, const std::vector<SidedRim>& holes, const FillOptions& options, SeenWays* seen,
                    OnMeshWhere on_mesh = OnMeshWhere::run_off);

/// Whether faces next to the hole are many times as long as its rim's edges, or its sides have an edge each, of which one split leaves
/// no even way from side to side.
bool may_fold_by_splitting(const FillContext& context, const SidedRim& hole);

}  // namespace tripatch
