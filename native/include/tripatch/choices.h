// The choices that options of a fill offer, each with its name (in Python, on the command line) and what it means.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tripatch/types.h"

namespace tripatch {

/// A value for each side of the hole: one for all of them, or as many as there are.
template <class T>
class BySide {
public:
  BySide() : values_(1) {}
  BySide(const T& all) : values_{all} {}
  BySide(std::initializer_list<T> values) : values_(values) {}
  explicit BySide(std::vector<T> values) : values_(std::move(values)) {}

  /// Of side i; they fit the number of sides.
  const T& operator[](std::size_t i) const { return values_[values_.size() == 1 ? 0 : i]; }
  const std::vector<T>& values() const { return values_; }
  auto begin() const { return values_.begin(); }
  auto end() const { return values_.end(); }
  bool fit(std::size_t sides) const { return values_.size() == 1 || values_.size() == sides; }
  bool are_all(const T& value) const {
    return std::all_of(begin(), end(), [&](const T& own) { return own == value; });
  }
  bool operator==(const BySide&) const = default;

private:
  std::vector<T> values_;
};
template <class T>
BySide<T> each_side(const T& value) {
  return {value};
}

/// Throws what check_count throws.
[[noreturn]] void refuse_count(const char* name, std::size_t given, std::size_t sides);
/// Throws InvalidArgument where the values are neither one nor one a side.
template <class T>
void check_count(const BySide<T>& values, std::size_t sides, const char* name) {
  if (!values.fit(sides)) refuse_count(name, values.values().size(), sides);
}
/// The same as an array of three.
template <class T>
std::array<T, 3> of_three(const BySide<T>& values, const char* name) {
  check_count(values, 3, name);
  return {values[0], values[1], values[2]};
}

/// One value of a choice.
struct Choice {
  const char* name;
  const char* label;  ///< in a panel; empty: the name in capitalized words
  const char* description;
  bool misprint = false;  ///< as a paper prints it, mistakes included: for scripts, not for a panel
};

/// Of an enumeration, in its order.
template <class Enum>
inline constexpr std::array<Choice, 0> choices = {};

enum class SurroundingsFrom { mesh, limit };
template <>
inline constexpr std::array<Choice, 2> choices<SurroundingsFrom> = {{
    {"mesh", "", "Estimated from the faces around the hole"},
    {"limit", "", "The surface of a Subdivision modifier; the fill becomes a separate mesh"},
}};

enum class SideContinuity { automatic, free, g0, g1, g2 };
template <>
inline constexpr std::array<Choice, 5> choices<SideContinuity> = {{
    {"auto", "",
     "The highest that the method supports, and curvature if it is clear; Free if the mesh meets the hole at an angle"},
    {"Free", "", "Position only; fairing chooses the slope"},
    {"G0", "Position", "Position only, with the slopes of the corners (G0)"},
    {"G1", "Tangent", "Equal tangent planes (G1)"},
    {"G2", "Curvature", "Equal tangent planes and curvature (G2)"},
}};

enum class Fairing { automatic, thin_plate, third_derivative, minimum_variation, quadric_variation, isometric };
template <>
inline constexpr std::array<Choice, 6> choices<Fairing> = {{
    {"auto", "", "Least variation of curvature, or the nearest quadric if one fits"},
    {"thin_plate", "", "Least bending"},
    {"third_derivative", "", "Least change of bending"},
    {"minimum_variation", "", "Least variation of curvature; exact for spheres and cylinders"},
    {"quadric_variation", "", "Nearest to a quadric: ellipsoid, saddle, cone"},
    {"isometric", "", "Least stretch, for cloth, paper and sheet metal: the fill unrolls flat with its surroundings"},
}};

enum class Output { triangles, quads, cage };
template <>
inline constexpr std::array<Choice, 3> choices<Output> = {{
    {"triangles", "", "Triangles with vertices on the surface"},
    {"quads", "", "Quads with vertices on the surface"},
    {"cage", "Subdivision Cage", "A few quads that a Subdivision modifier turns into the surface"},
}};

/// Round a rim with an odd number of edges.
enum class Odd { split, triangle };
template <>
inline constexpr std::array<Choice, 2> choices<Odd> = {{
    {"split", "", "Split the longest boundary edge"},
    {"triangle", "", "Leave one triangle"},
}};

/// What happens along the rim of a cage.
enum class CageRim { smooth, exact, move };
template <>
inline constexpr std::array<Choice, 3> choices<CageRim> = {{
    {"smooth", "", "Smooth everywhere; the surroundings move as little as possible"},
    {"exact", "", "The boundary is creased, so the surface around an open hole does not move"},
    {"move", "", "As Smooth, and boundary vertices may move too"},
}};

/// Slopes across the sides after Liu, Ma and Cheng (2008).
enum class CrossBoundary {
  given,       ///< alpha = 1, beta = 0: the surroundings' derivative as it is, G1 but of no fitting length
  consistent,  ///< equations (9) to (13) with full normal equations at the corners, alpha and beta linear
  as_printed,  ///< equations (7) and (10) to (14) as the paper prints them: beta from orthogonality; Theorems 1 and 2 fail
};
template <>
inline constexpr std::array<Choice, 3> choices<CrossBoundary> = {{
    {"given", "", "As in the surrounding surface"},
    {"consistent", "", "Matched to the tangents at the corners"},
    {"as_printed", "", "By the equations as printed, which contradict the paper's theorems", true},
}};

/// Of the formulas of Szilvasi-Nagy and Szabo (2006).
enum class Reading { corrected, as_printed };
template <>
inline constexpr std::array<Choice, 2> choices<Reading> = {{
    {"corrected", "", "Corrected, so that the fill meets its surroundings"},
    {"as_printed", "", "As printed, with the misprints", true},
}};

template <class Enum>
const char* name_of(Enum value) {
  return choices<Enum>[static_cast<std::size_t>(value)].name;
}

/// Throws what named and find_method throw.
[[noreturn]] void refuse_name(const char* option, std::string_view name, std::vector<std::string> names);
/// The value of a name; InvalidArgument that lists the names. option: of which it is a value.
template <class Enum>
Enum named(std::string_view name, const char* option) {
  std::vector<std::string> names;
  for (std::size_t k = 0; k < choices<Enum>.size(); ++k) {
    if (name == choices<Enum>[k].name) return static_cast<Enum>(k);
    names.emplace_back(choices<Enum>[k].name);
  }
  refuse_name(option, name, std::move(names));
}

}  // namespace tripatch
