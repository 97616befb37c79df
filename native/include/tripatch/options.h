// The options of a fill as C++ reads them, and the table that says of each what it is: see options.def.
#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tripatch/boundary/limit_surface.h"
#include "tripatch/choices.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/hole/choose_holes.h"
#include "tripatch/patch/through.h"

namespace tripatch {

using Pair = std::array<double, 2>;

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

/// Throws InvalidArgument where a number is not finite or out of its range.
void check(const FillOptions& options);
void check(const MethodOptions& options);
void check(const HoleChoice& choice);

}  // namespace tripatch
