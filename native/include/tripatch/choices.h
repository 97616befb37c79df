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

/// Throws InvalidArgument where the values are neither one nor one a side.
template <class T>
void check_count(const BySide<T>& values, std::size_t sides, const char* name) {
  if (!values.fit(sides))
    throw InvalidArgument(std::string(name) + " has " + std::to_string(values.values().size()) + " values, for a hole of " +
                          std::to_string(sides) + " sides; give one, or one a side");
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
    {"limit", "",
     "The surface that a Subdivision modifier draws; the fill becomes a mesh of its own, since a cage's vertices do not lie on "
     "it"},
}};

enum class SideContinuity { automatic, free, g0, g1, g2 };
template <>
inline constexpr std::array<Choice, 5> choices<SideContinuity> = {{
    {"auto", "",
     "The best that the method keeps, but Free where the mesh meets the hole at an angle; where the curvature of the "
     "surroundings is "
     "clear, fairing follows it by least squares"},
    {"Free", "", "Meets the rim; the slope there is the fairing's choice (without fairing as G0)"},
    {"G0", "Position", "Meets the rim (G0), with the slopes that the corners give"},
    {"G1", "Tangent", "Continues the surrounding tangent planes (G1)"},
    {"G2", "Curvature", "Continues the curvature as well (G2)"},
}};

enum class Fairing { automatic, thin_plate, third_derivative, minimum_variation, quadric_variation };
template <>
inline constexpr std::array<Choice, 5> choices<Fairing> = {{
    {"auto", "", "Softly the smaller of the last two: curvature varies least, unless the surface is near a quadric"},
    {"thin_plate", "", "Least bending"},
    {"third_derivative", "", "Least change of bending, over the triangle"},
    {"minimum_variation", "", "Least variation of curvature: spheres, cylinders"},
    {"quadric_variation", "", "Nearest to quadrics: ellipsoids, saddles, cones"},
}};

enum class Output { triangles, quads, cage };
template <>
inline constexpr std::array<Choice, 3> choices<Output> = {{
    {"triangles", "", "Triangles with their vertices on the patch"},
    {"quads", "", "Quads with their vertices on the patch"},
    {"cage", "Subdivision Cage", "A few quads whose limit surface under a Subdivision modifier is the patch"},
}};

/// Round a rim with an odd number of edges.
enum class Odd { split, triangle };
template <>
inline constexpr std::array<Choice, 2> choices<Odd> = {{
    {"split", "", "The longest edge of the rim is split"},
    {"triangle", "", "A triangle is left in the middle"},
}};

/// What happens along the rim of a cage.
enum class CageRim { smooth, exact, move };
template <>
inline constexpr std::array<Choice, 3> choices<CageRim> = {{
    {"smooth", "", "The whole cage is smooth; the surroundings move as little as possible"},
    {"exact", "", "The rim is creased: the surface around an open hole does not move, the fill is made tangent to it"},
    {"move", "", "As Smooth, and the vertices of the rim may move too"},
}};

/// Slopes across the sides after Liu, Ma and Cheng (2008).
enum class CrossBoundary {
  given,       ///< alpha = 1, beta = 0: the surroundings' derivative as it is, G1 but of no fitting length
  consistent,  ///< equations (9) to (13) with full normal equations at the corners, alpha and beta linear
  as_printed,  ///< equations (7) and (10) to (14) as the paper prints them: beta from orthogonality; Theorems 1 and 2 fail
};
template <>
inline constexpr std::array<Choice, 3> choices<CrossBoundary> = {{
    {"given", "", "As the surroundings have them"},
    {"consistent", "", "Such that they agree with the sides' tangents at the corners"},
    {"as_printed", "", "By the paper's own equations, which lose its theorems", true},
}};

/// Of the formulas of Szilvasi-Nagy and Szabo (2006).
enum class Reading { corrected, as_printed };
template <>
inline constexpr std::array<Choice, 2> choices<Reading> = {{
    {"corrected", "", "Such that the fill meets its surroundings"},
    {"as_printed", "", "As their paper has them, mistakes included", true},
}};

template <class Enum>
const char* name_of(Enum value) {
  return choices<Enum>[static_cast<std::size_t>(value)].name;
}

/// The value of a name; InvalidArgument that lists the names. option: of which it is a value.
template <class Enum>
Enum named(std::string_view name, const char* option) {
  std::string all;
  for (std::size_t k = 0; k < choices<Enum>.size(); ++k) {
    if (name == choices<Enum>[k].name) return static_cast<Enum>(k);
    all += std::string(k ? ", " : "") + choices<Enum>[k].name;
  }
  throw InvalidArgument(std::string(option) + " must be one of " + all + ", not '" + std::string(name) + "'");
}

}  // namespace tripatch
