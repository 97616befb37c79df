#include "tripatch/options.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>
#include <type_traits>

#include "tripatch/math/thresholds.h"
#include "tripatch/messages.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/output/shaped.h"

namespace tripatch {
namespace {

/// What an option is follows from its type.
void tell(Option& option, std::type_identity<bool>) { option.kind = Option::Kind::flag; }
void tell(Option& option, std::type_identity<int>) { option.kind = Option::Kind::whole; }
void tell(Option&, std::type_identity<double>) {}
void tell(Option& option, std::type_identity<Pair>) { option.count = 2; }
void tell(Option& option, std::type_identity<CountRange>) {
  option.kind = Option::Kind::whole;
  option.count = 2;
}
void tell(Option& option, std::type_identity<std::string>) { option.kind = Option::Kind::choice; }
void tell(Option& option, std::type_identity<Vec3>) {
  option.kind = Option::Kind::position;
  option.count = 3;
}
void tell(Option& option, std::type_identity<Subdivision>) {
  option.kind = Option::Kind::subdivision;
  option.optional = true;
}
void tell(Option& option, std::type_identity<std::vector<Index>>) {
  option.kind = Option::Kind::indices;
  option.count = 0;
}
void tell(Option& option, std::type_identity<std::vector<std::vector<Index>>>) {
  option.kind = Option::Kind::loops;
  option.count = 0;
}
void tell(Option& option, std::type_identity<std::vector<Through>>) {
  option.kind = Option::Kind::points;
  option.count = 0;
}
template <class T>
  requires std::is_enum_v<T>
void tell(Option& option, std::type_identity<T>) {
  option.kind = Option::Kind::choice;
  option.choices.assign(choices<T>.begin(), choices<T>.end());
}
template <class T>
void tell(Option& option, std::type_identity<BySide<T>>) {
  tell(option, std::type_identity<T>());
  option.by_side = true;
}
template <class T>
void tell(Option& option, std::type_identity<std::optional<T>>) {
  tell(option, std::type_identity<T>());
  option.optional = true;
}

template <class T>
Option row(const char* name, AboutOption about) {
  Option option = {};
  static_cast<AboutOption&>(option) = std::move(about);
  option.name = name;
  tell(option, std::type_identity<T>());
  for (const Method& method : methods())
    for (const std::string& read : method.options)
      if (read == name) option.applies.push_back({"method", method.name});
  return option;
}

Option of_holes(Option option) {
  option.of_holes = true;
  return option;
}

std::string text(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

void check_number(const std::string& name, const Range& range, double value) {
  if (!std::isfinite(value) && !std::isfinite(range.most)) throw CodedArgument(Code::not_finite, {{"name", name}});
  if (range.open ? range.least < value && value < range.most : range.least <= value && value <= range.most) return;
  const bool ends = std::isfinite(range.most);
  std::vector<Parameter> said = {{"name", name}, {"value", text(value)}};
  said.emplace_back(range.open ? (ends ? "after" : "above") : ends ? "from" : "least", text(range.least));
  if (ends) said.emplace_back(range.open ? "before" : "to", text(range.most));
  throw CodedArgument(Code::out_of_range, std::move(said));
}

/// Extra rows of quads that may be asked for: a bound against slips of the hand, far beyond what any fill has room for.
constexpr int max_rows = count::hundred;
/// Edges along a side, as in options.def.
constexpr int max_edges = 10'000;

void check_resolution(int value, bool triangles) {
  check_number("resolution", triangles ? Range{1, max_edges} : Range{0, max_rows}, value);
}

void check_value(const Option& option, double value) { check_number(option.name, option.range, value); }
void check_value(const Option& option, int value) { check_number(option.name, option.range, value); }
template <class T, std::size_t N>
  requires std::is_arithmetic_v<T>
void check_value(const Option& option, const std::array<T, N>& values) {
  for (std::size_t i = 0; i < N; ++i)
    check_number(option.name + std::string("[") + std::to_string(i) + "]", option.range, values[i]);
}
void check_value(const Option& option, const BySide<double>& values) {
  for (std::size_t i = 0; i < values.values().size(); ++i)
    check_number(option.name + std::string("[") + std::to_string(i) + "]", option.range, values[i]);
}
void check_value(const Option& option, const Vec3& values) { check_value(option, std::array{values[0], values[1], values[2]}); }
void check_value(const Option& option, const std::vector<Through>& values) {
  for (const Through& each : values) {
    check_value(option, each.point);
    if (each.normal) check_value(option, *each.normal);
    if (each.normal && !(each.normal->norm() > 0)) throw CodedArgument(Code::zero_vector, {{"name", option.name}});
  }
}
void check_value(const Option&, const auto&) {}  // whatever the type holds is right
template <class T>
void check_value(const Option& option, const std::optional<T>& value) {
  if (value) check_value(option, *value);
}

const Option& option_named(const char* name) {
  for (const Option& option : options())
    if (std::string_view(option.name) == name) return option;
  throw InvalidArgument(std::string("There is no option ") + name);
}

/// Of each option the names of the methods that name it as one of their own; none: most methods read it.
std::vector<std::vector<std::string>> names_of_methods() {
  std::vector<std::vector<std::string>> names;
  for (const Option& option : options()) {
    std::vector<std::string>& own = names.emplace_back();
    for (const Condition& condition : option.applies)
      if (condition.option == "method") own.push_back(condition.value);
  }
  return names;
}

/// option: of options().
const std::vector<std::string>& named_by(const Option& option) {
  static const std::vector<std::vector<std::string>> names = names_of_methods();
  return names[&option - options().data()];
}

bool is_plain(const auto& value, const auto& plain) { return value == plain; }
bool is_plain(const BySide<double>& value, const BySide<double>& plain) { return value.are_all(plain[0]); }
bool is_plain(const std::optional<BySide<double>>& value, const std::optional<BySide<double>>& plain) {
  return value && plain && is_plain(*value, *plain);
}
bool is_position(SideContinuity c) { return c == SideContinuity::free || c == SideContinuity::g0; }
bool is_plain(const BySide<SideContinuity>& value, const BySide<SideContinuity>&) {
  return std::ranges::all_of(value, [](SideContinuity c) { return c == SideContinuity::automatic || c == SideContinuity::g1; }) ||
         std::ranges::all_of(value, is_position);
}
bool is_plain(const std::vector<Through>& value, const std::vector<Through>&) { return value.empty(); }
bool is_plain(const Subdivision&, const Subdivision&) { return true; }  // for another surroundings or output, not another method
bool is_plain(const std::optional<int>& value, const std::optional<int>&) { return value.value_or(0) == 0; }  // no extra rows

/// Whether an option means something for what the hole is filled with.
bool is_of_output(const Option& option, Output output) {
  const auto names_output = [](const Condition& condition) { return condition.option == "output"; };
  return std::ranges::none_of(option.applies, names_output) ||
         std::ranges::any_of(option.applies, [&](const Condition& c) { return names_output(c) && c.value == name_of(output); });
}

}  // namespace

bool takes(const Method& method, const Option& option) {
  const auto is_in = [&](const std::vector<std::string>& names) { return std::ranges::find(names, option.name) != names.end(); };
  return named_by(option).empty() ? !is_in(method.lacks) : is_in(method.options);
}

std::vector<std::string> not_taken(const Method& method, const FillOptions& given, bool patch) {
  static const FillOptions plain;
  std::vector<std::string> names;
  const auto look = [&](const char* name, bool is_given) {
    if (!is_given || (given.fairing == Fairing::isometric && name == std::string_view("fairing"))) return;  // moves any vertices
    const Option& option = option_named(name);
    if ((option.patch || !patch) && is_of_output(option, given.output) && !takes(method, option)) names.emplace_back(name);
  };
  // the surface that continues all surroundings meets all of them in one way, rows only continue
  const std::string_view name = method.name;
  if (name == spline_method && !is_plain(given.continuity, plain.continuity)) names.emplace_back("continuity");
  if (name == rows_method && meets_position_only(given)) names.emplace_back("continuity");
#define OPTION(type, name, value, ...) look(#name, !is_plain(given.name, plain.name));
#define METHOD_OPTION(type, name, value, ...) look(#name, !is_plain(given.own.name, plain.own.name));
#include "tripatch/options.def"
  return names;
}

namespace {

/// Of methods: an option that no more than so many read is said to be theirs. A choice.
constexpr std::size_t few = count::pair;

/// The methods that an option is said to be of; of an option of many methods, or all, none.
std::vector<std::string> owners(const std::string& name) {
  std::vector<std::string> methods = named_by(option_named(name.c_str()));
  if (methods.size() > few) methods.clear();
  return methods;
}

/// Of names that a method, which is named, does not read: those that several constructions of patches read and this one, another, does not.
/// They are reported; who names the method by its paper may have the same options for all.
bool is_told(const Method& method, const std::string& name) {
  const bool between_sides = method.from_boundary || method.name == std::string(polygon_method);
  return between_sides && named_by(option_named(name.c_str())).size() > 1;
}

}  // namespace

void refuse_count(const char* name, std::size_t given, std::size_t sides) {
  throw CodedArgument(Code::values_by_side, {{"name", name}, {"given", given}, {"sides", sides}});
}

void refuse_name(const char* option, std::string_view name, std::vector<std::string> names) {
  throw CodedArgument(Code::not_one_of,
                      {{"name", option}, {"values", std::move(names)}, {"value", "'" + std::string(name) + "'"}});
}

void check_taken(const FillOptions& given) {
  if (given.method == automatic_method) return;
  const Method& method = find_method(given.method);
  std::vector<std::string> names;
  for (std::string& name : not_taken(method, given))
    if (!is_told(method, name)) names.push_back(std::move(name));
  for (const std::string& name : names)
    if (const std::vector<std::string> methods = owners(name); !methods.empty())
      throw CodedArgument(Code::option_not_of_method, {{"option", name}, {"methods", methods}, {"method", given.method}});
  if (!names.empty()) throw CodedArgument(Code::method_lacks_options, {{"method", given.method}, {"options", names}});
}

Messages told_of_not_taken(const FillOptions& given, const std::string& used) {
  const bool automatic = given.method == automatic_method;
  const Method& method = find_method(automatic ? used : given.method);
  Messages told;
  std::vector<std::string> others;
  for (const std::string& name : not_taken(method, given)) {
    if (const std::vector<std::string> methods = owners(name); methods.empty())
      others.push_back(name);
    else
      told.push_back({Code::option_of_other_methods, {{"option", name}, {"methods", methods}}});
  }
  if (!others.empty() && automatic) told.push_back({Code::options_need_smooth_sides, {{"options", others}, {"method", used}}});
  if (!others.empty() && !automatic) told.push_back({Code::options_not_taken, {{"method", given.method}, {"options", others}}});
  if (automatic && used == polygon_method && given.cross_boundary != CrossBoundary::consistent)
    told.push_back({Code::option_needs_three_sides, {{"option", "cross_boundary"}}});
  return told;
}

namespace {

/// Of the options that no patch alone has: those that a fill takes or leaves.
bool is_choice_of_fill(const Option& option) {
  constexpr std::array<std::string_view, 7> names = {"corners", "pole_offset", "tolerance", "resolution",
                                                     "odd",     "cage_rim",    "features"};
  return std::ranges::find(names, option.name) != names.end();
}

}  // namespace

bool meets_position_only(const FillOptions& options) { return std::ranges::all_of(options.continuity, is_position); }

std::map<std::string, std::string> not_applied(const FillOptions& given, const Fill& fill) {
  const Method& method = find_method(fill.report.method);
  const bool sided = !fill.sides.empty() || given.output == Output::cage, laid_out_in_three = fill.barycentric.rows() > 0;
  const bool tangent = !std::ranges::all_of(fill.report.continuity, in_position);
  const auto code = [&](const Option& option) -> std::string_view {
    const std::string_view name = option.name;
    if (!is_of_output(option, given.output)) return "output";
    const bool moves = name == "bulge" || name == "tension" || name == "center" || name == "center_offset";
    if (fill.vertices.rows() == 0 && (moves || name == "fairing")) return "vertices";
    if (name == "fairing" && given.fairing == Fairing::isometric) return given.output == Output::cage ? "output" : "";
    if (name == "continuity" && given.method == automatic_method && !sided) return "";  // met in position only, by another
    if (name == "corners") return sided && fill.report.corners.size() > 1 ? "" : "sides";
    if (!takes(method, option)) {
      if (name == "bulge" || name == "cross_boundary") return sided ? "position" : "sides";
      return named_by(option).empty() ? "sides" : "method";
    }
    if (name == "pole_offset" && !laid_out_in_three) return "three_sides";
    if (name == "pole_offset" && (fill.report.poles.empty() || fill.faces[0].size() != 4)) return "poles";
    if (name == "cross_boundary" && std::string_view(method.name) == polygon_method) return "three_sides";
    if (sided && !tangent && (name == "bulge" || name == "cross_boundary")) return "position";
    if (sided && name == "tension" && !given.fairing) return "fairing";
    const std::size_t values = given.bulge.values().size();
    if (name == "bulge" && !sided && values > 1 && values != fill.report.corners.size()) return "sides";
    return moves && !sided && !(can_be_shaped(fill) && given.through.empty()) ? "vertices" : "";
  };
  std::map<std::string, std::string> found;
  for (const Option& option : options()) {
    if (!option.patch && !is_choice_of_fill(option)) continue;
    if (const std::string_view why = code(option); !why.empty()) found.emplace(option.name, why);
  }
  return found;
}

std::span<const Option> options() {
  static const std::vector<Option> all = {
#define OPTION(type, name, value, ...) row<type>(#name, {__VA_ARGS__}),
#define METHOD_OPTION(type, name, value, ...) row<type>(#name, {__VA_ARGS__}),
#define HOLES_OPTION(type, name, value, ...) of_holes(row<type>(#name, {__VA_ARGS__})),
#define OPTION_AT(path, name, ...) \
  row<std::remove_reference_t<decltype((std::declval<FillOptions&>().path))>>(#name, {__VA_ARGS__}),
#include "tripatch/options.def"
  };
  return all;
}

void refuse_isometric() {
  throw CodedArgument(Code::value_needs_mesh, {{"option", "fairing"}, {"value", name_of(Fairing::isometric)}});
}

void check(const FillOptions& given) {
  if (given.resolution) check_resolution(*given.resolution, given.output == Output::triangles);
#define OPTION(type, name, value, ...) check_value(option_named(#name), given.name);
#define OPTION_AT(path, name, ...) check_value(option_named(#name), given.path);
#include "tripatch/options.def"
  check(given.own);
  if (given.center && given.center_offset != 0)
    throw CodedArgument(Code::options_exclusive, {{"first", "center"}, {"second", "center_offset"}});
}

void check(const MethodOptions& given) {
  if (given.shape && !given.shape->fit(3)) refuse_count("shape", given.shape->values().size(), 3);
#define METHOD_OPTION(type, name, value, ...) check_value(option_named(#name), given.name);
#include "tripatch/options.def"
}

void check(const HoleChoice& given) {
#define HOLES_OPTION(type, name, value, ...) check_value(option_named(#name), given.name);
#include "tripatch/options.def"
}

}  // namespace tripatch
