// The codes of messages.def, and sentences made of them for one interface or another.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// What a message is about. Every code has a row of messages.def, in the same order: that file holds the sentences, apart from here so that
/// nothing but messages.cpp depends on them.
enum class Code : std::uint16_t {
  // Holes, their rims and corners
  no_border,
  only_outer_borders,
  border_not_closed,
  several_holes,
  several_three_cornered_holes,
  no_hole_fillable,
  rim_too_short,
  rim_passes_twice,
  rim_too_large,
  no_face_at_edge,
  faces_on_both_sides,
  loose_face,
  non_manifold_edge,
  faces_flipped,
  face_flipped,
  vertex_not_finite,
  edge_without_length,
  vertices_at_one_place,
  borders_share_vertex,
  corner_not_on_rim,
  corner_not_on_border,
  no_clear_corners,
  too_many_corners,
  not_three_corners,
  faces_without_area,
  faces_at_vertex_without_area,
  side_too_short,
  round_rim_too_short,
  edges_on_borders,
  rim_on_borders,
  slit_without_width,
  edges_without_length,
  // Numbers
  numbers_overflow,
  coordinates_out_of_range,
  coordinates_too_large,
  center_too_far,
  // Methods and what they take
  method_takes_three,
  three_corners_needed,
  method_takes_three_not_round,
  method_needs_three,
  method_needs_three_rim_shows_none,
  patch_needs_sides,
  limit_needs_three_corners,
  no_surface_laid_out,
  no_rows_of_quads,
  method_folds,
  method_folds_more_than_rim,
  method_crosses,
  continuity_above_method,
  curvature_unknown,
  option_of_other_methods,
  options_not_taken,
  options_need_smooth_sides,
  option_needs_three_sides,
  option_not_of_method,
  method_lacks_options,
  method_makes_no_cages,
  corner_counts_not_in_order,
  // Points inside
  points_in_one_place,
  points_over_one_place,
  point_on_rim,
  points_not_met,
  points_without_vertices,
  // Sides that are given
  sides_without_length,
  sides_apart,
  pieces_apart,
  pieces_meet_at_angle,
  single_side_open,
  single_side_has_corner,
  side_without_planes,
  printed_slopes_parallel,
  edge_is_point,
  straight_corner,
  side_kink,
  corner_planes_differ,
  // Bezier patches
  coons_without_solution,
  coons_singular,
  permanence_singular,
  ill_conditioned,
  side_is_no_bezier_curve,
  side_has_many_vertices,
  no_bezier_curve_through_rim,
  // Triangles that are smoothed, and networks of curves
  face_is_no_triangle,
  face_without_area,
  position_not_finite,
  normal_not_finite,
  normal_zero,
  normals_cancel,
  normal_along_edge,
  normals_disagree,
  no_curve_given,
  curve_off_vertices,
  curve_planes_differ,
  // Subdivision cages and limit surfaces
  cage_without_faces,
  face_without_limit,
  loop_needs_triangles,
  loop_cage_needs_three_corners,
  face_has_many_corners,
  many_faces_at_vertex,
  face_passes_twice,
  not_subdivided,
  corner_lacks_planes,
  cage_meets_no_points,
  cage_needs_corners,
  cage_crosses,
  cage_folds,
  cornerless_cage_crosses,
  cornerless_cage_folds,
  cage_doubles_edge,
  limit_not_used,
  limit_rim_kink,
  limit_planes_fold,
  border_touches_rim,
  high_valence_pole,
  cage_off_patch,
  cage_faces_cross,
  cage_corner_turns_back,
  split_edge_would_cross,
  split_edge_would_fold,
  // Rows of quads
  tolerance_out_of_reach,
  rows_would_cross,
  fewer_rows,
  one_triangle,
  // What became of a fill
  crosses_itself,
  patch_folds,
  faces_folded_beyond,
  lies_on_mesh,
  boundary_folds,
  misses_boundary,
  fairest_folds,
  fairest_folds_least_bending,
  surroundings_vary,
  two_rings_followed,
  one_ring_followed,
  rim_alone_followed,
  least_bending,
  triangles_off_surface,
  plain_triangles,
  tiny_edges_plain_triangles,
  sharp_sides,
  side_sharp,
  all_sides_sharp,
  flat_all_around,
  extra_face,
  cage_runs_off,
  cornerless_cage_not_shaped,
  // Ways to fill a hole that give way to others
  sides_zigzag,
  surroundings_too_rough,
  two_sides_tell_less,
  lower_cap_fails,
  patch_would_fold,
  not_on_quadric,
  // Why a way to fill a hole is used
  requested,
  has_smooth_sides,
  has_sides,
  has_three_edges,
  is_small,
  is_round,
  is_of_revolution,
  lower_cap_stays,
  cap_requested,
  has_islands,
  joins_boundaries,
  fits_better_than_ring,
  no_ring_joins,
  round_not_smooth,
  corners_given,
  no_smooth_sides,
  wall_missing,
  wall_continues,
  walls_meet,
  crease_continues,
  rows_continue,
  no_patch_fits,
  patch_crosses,
  patch_folds_over,
  patch_leaves_hole,
  surroundings_tell_more,
  polygon_meets_points,
  tangent_fill_crosses,
  reads_mesh,
  quads_continue,
  fair_cage_leaves,
  large_cage_on_surface,
  cage_of_guessed_corners,
  // Why a way to fill a hole is not used
  not_made,
  candidate_crosses,
  candidate_folds,
  candidate_leaves_hole,
  less_accurate,
  not_more_accurate,
  accurate_enough,
  rows_take_no_options,
  not_among_quads,
  not_of_revolution,
  cap_follows_curvature,
  no_wall_missing,
  patch_requested,
  spline_of_revolution,
  meets_sharp_sides,
  has_planes_already,
  sides_requested,
  planes_not_better,
  no_smooth_spline,
  is_known_well,
  lies_on_quadric,
  other_does_not_fold,
  other_does_not_cross,
  // Ways to fill a hole that share a method
  lower_cap,
  flat_wall,
  planes_of_patch,
  on_quadric,
  folded_patch,
  flat_fill,
  // Why a cage is not used
  does_as_much_harm,
  other_tried_first,
  cages_fitted_together,
  options_ask_otherwise,
  rows_do_not_continue,
  surface_tells_more,
  fair_cage_stays,
  leaves_surface,
  no_vertices_inside,
  no_surface_continues,
  // Cages that are tried
  cage_in_rows,
  cage_on_surface,
  fairest_cage,
  fitted_cage,
  cage_with_rows,
  // Rings between two boundaries
  ring_takes_two,
  boundaries_not_joined,
  boundaries_face_opposite_ways,
  ring_boundary_open,
  // Arguments
  out_of_range,
  not_finite,
  zero_vector,
  not_numbers,
  wrong_shape,
  not_one_of,
  values_by_side,
  no_such_option,
  no_such_vertex,
  no_such_face,
  offsets_not_in_order,
  no_such_edge,
  given_twice,
  corners_at_one_place,
  single_corner,
  options_exclusive,
  option_needs,
  option_needs_mesh,
  option_of_one_hole,
  value_needs_three_sides,
  triangle_cage_has_no_rows,
  method_of_function,
  method_of_three_sides,
  surfaces_apart,
  outside_domain,
  wrong_net,
  knots_decrease,
  knots_repeat,
  not_a_piece,
  not_the_derivative,
  no_energy,
  loops_miscounted,
  rim_not_from_corner,
  // Isometric fills
  value_needs_mesh,
  surroundings_do_not_unroll,
  isometric_would_fold,
  // Patches with loops inside
  loops_not_over_plane,
};

struct Message;

/// A value that the sentence of a message names.
struct Parameter {
  /// A count or a number of something, a measure, text, vertices of the mesh, names of options or methods, another message.
  using Value =
      std::variant<Index, double, std::string, std::vector<Index>, std::vector<std::string>, std::shared_ptr<const Message>>;
  std::string name;
  Value value;

  Parameter(std::string called, std::integral auto number) : name(std::move(called)), value(static_cast<Index>(number)) {}
  Parameter(std::string called, double measure) : name(std::move(called)), value(measure) {}
  Parameter(std::string called, const char* text) : name(std::move(called)), value(std::string(text)) {}
  Parameter(std::string called, const Message& message);
  Parameter(std::string called, Value any) : name(std::move(called)), value(std::move(any)) {}
};

/// What a user reads: a code and what its sentence names. Sentences are made of it where they are shown.
struct Message {
  Code code;
  std::vector<Parameter> parameters = {};
  std::vector<Index> where = {};  ///< vertices of the mesh

  /// In the words of the library.
  std::string text() const;
};
using Messages = std::vector<Message>;
/// Why something is so; none: nothing is said of it.
using Reason = std::optional<Message>;

inline Parameter::Parameter(std::string called, const Message& message)
    : name(std::move(called)), value(std::make_shared<const Message>(message)) {}

/// A refusal and its code: every one that the library throws is of this class.
class CodedRefusal : public Refusal {
public:
  explicit CodedRefusal(Code code) : CodedRefusal(Message{code}) {}
  CodedRefusal(Code code, std::initializer_list<Index> where) : CodedRefusal(Message{code, {}, where}) {}
  CodedRefusal(Code code, std::vector<Index> where) : CodedRefusal(Message{code, {}, std::move(where)}) {}
  CodedRefusal(Code code, std::vector<Parameter> parameters, std::vector<Index> where = {})
      : CodedRefusal(Message{code, std::move(parameters), std::move(where)}) {}
  /// also: what else is to be said.
  explicit CodedRefusal(Message message, Messages also = {});

  const Message& message() const { return message_; }
  Code code() const { return message_.code; }
  const Messages& also() const { return also_; }

private:
  Message message_;
  Messages also_;
};

/// A mistake of the caller that a user of an interface can make, and its code; what only programs can make wrong is an InvalidArgument.
class CodedArgument : public InvalidArgument {
public:
  CodedArgument(Code code, std::vector<Parameter> parameters);
  const Message& message() const { return message_; }

private:
  Message message_;
};

/// A row of the table.
struct AboutMessage {
  const char* code;
  const char* kind;      ///< "refusal", "warning", "reason" or "note"
  const char* sentence;  ///< a pattern, see format
  const char* panel;     ///< the same for a window, with its own names for what to do; empty: as `sentence`
  const char* meaning;   ///< what it means and what to do, for the documentation
};
std::span<const AboutMessage> messages();
const AboutMessage& about(Code code);

/// How an interface words what a message names.
struct Wording {
  enum class Vertices { numbered, selected, unnamed };
  Vertices vertices = Vertices::numbered;    ///< selected: they are, nobody sees their numbers; unnamed: neither
  bool panel = false;                        ///< the sentences for a window, sides and corners counted from 1
  std::map<std::string, std::string> names;  ///< what it calls options and methods; others keep theirs
};

/// A sentence made of a pattern, in which {name} stands for a parameter and {where} for the vertices of the message:
///   {name}                a number (of a measure two digits), text, or a list
///   {name:degrees}        an angle
///   {name:side}           the number of a side or corner
///   {name:names}          options or methods as the interface calls them
///   {name:problem}        a message without what to do: its first sentence
///   {name:vertices}       "vertex 4", "vertices 4 and 5". {name:Vertices} begins a sentence
///   {name:# edge|# edges} one or several, # being the number
/// What stands in [brackets] is left out if a parameter in it is not there.
std::string format(std::string_view pattern, const Message& message, const Wording& wording = {});
/// The sentence of the table.
std::string text(const Message& message, const Wording& wording = {});

/// The same of vertices that are called otherwise: `named` says how; less than 0: not at all.
Message with_vertices(Message message, const std::function<Index(Index)>& named);

}  // namespace tripatch
