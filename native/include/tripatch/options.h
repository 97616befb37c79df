// The options of a fill as C++ reads them, and the table that says of each what it is: see options.def.
#pragma once

#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/choices.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/hole/choose_holes.h"
#include "tripatch/messages.h"
#include "tripatch/patch/through.h"

namespace tripatch {

struct Fill;

using Pair = std::array<double, 2>;

/// How an open end is closed.
enum class Cap { automatic, flat, dome };
template <>
inline constexpr std::array<Choice, 3> choices<Cap> = {{
    {"auto", "Automatic", "Flat on a straight tube; otherwise as the surface continues"},
    {"flat", "", "A flat lid with sharp edges"},
    {"dome", "", "A round end, tangent to the surrounding surface"},
}};

/// Documented in options.def.
struct FillOptions {
#define OPTION(type, name, value, ...) type name = value;
#include "tripatch/options.def"
  MethodOptions own;  ///< what the method reads besides
};

struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool open = false;  ///< neither of the two is in it
};
constexpr Range between(double least, double most) { return {least, most, true}; }
constexpr Range above(double least) { return {.least = least, .open = true}; }

/// That another option has a value.
struct Condition {
  std::string option, value;
};
inline constexpr const char* any_value = "";  ///< all but none

/// What a row of the table says.
struct AboutOption {
  const char* sentence;   ///< without its full stop
  const char* seen = "";  ///< what one will see when it is changed: the tooltip of a panel; empty: the sentence
  Range range = {};
  Range soft = {};                      ///< between these a slider goes
  const char* unit = "";                ///< empty: none
  const char* label = "";               ///< in a panel; empty: the name in capitalized words
  Choice none = {};                     ///< what no value is called, where that is a choice among others
  std::vector<Condition> applies = {};  ///< where it is read, if one of them holds; empty: always
  bool patch = false;                   ///< concerns the patch alone: `patch`, made from sides, takes it too,
  bool blend = false;                   ///< and `blend`, of three surfaces
  bool one_hole = false;                ///< of one hole, not of several
  bool selection = false;               ///< goes with today's selection: a panel does not keep it for the next
  bool panel = true;                    ///< a panel has it; else a selection or a modifier says it, or it is for programs
};

struct Option : AboutOption {
  enum class Kind { flag, whole, number, choice, indices, loops, position, points, subdivision };
  const char* name = "";
  Kind kind = Kind::number;
  bool optional = false;        ///< may be none
  bool by_side = false;         ///< a value a side, or one for all
  bool of_holes = false;        ///< chooses holes, says nothing of a fill
  int count = 1;                ///< numbers or indices that belong together; 0: any number of them
  std::vector<Choice> choices;  ///< those of `method` are methods()
};

/// All rows, in their order.
std::span<const Option> options();

/// Whether a method reads an option of a fill.
bool takes(const Method& method, const Option& option);
/// Names of the options that are not at their defaults, go with the output, and are none that a method reads, in their order. A continuity that is left open, or
/// G1, every method has: more than that is reported by what makes the patch. patch: of those that concern the patch alone.
std::vector<std::string> not_taken(const Method& method, const FillOptions& given, bool patch = false);
/// Throws InvalidArgument where a method that is named does not read what is given; but what several other patches between sides read,
/// and a named one does not, is reported.
void check_taken(const FillOptions& given);
/// Options that mean nothing for a fill, each with a code that says why: what it is given changes nothing. Of options that choose a hole
/// or its surroundings nothing is said, but of corners.
///   "output"      of other kinds of faces
///   "method"      of other methods
///   "sides"       the fill has no sides: it continues from the whole surrounding surface, or as rows
///   "three_sides" the fill has other than three sides
///   "position"    the sides are met in position only
///   "fairing"     there is no fairing
///   "vertices"    the fill has no vertices that could move
std::map<std::string, std::string> not_applied(const FillOptions& given, const Fill& fill);
/// What is said of options that were given and that the method which was used does not read.
Messages told_of_not_taken(const FillOptions& given, const std::string& used);

/// Whether all sides are to be met in position only.
bool meets_position_only(const FillOptions& options);

/// Throws InvalidArgument that says what the fairing of that name needs.
[[noreturn]] void refuse_isometric();

/// Throws InvalidArgument where a number is not finite or out of its range.
void check(const FillOptions& options);
void check(const MethodOptions& options);
void check(const HoleChoice& choice);

}  // namespace tripatch
