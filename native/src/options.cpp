#include "tripatch/options.h"

#include <cmath>
#include <sstream>
#include <type_traits>

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
  if (!std::isfinite(value) && !std::isfinite(range.most)) throw InvalidArgument(name + " must be finite, not " + text(value));
  if (range.open ? range.least < value && value < range.most : range.least <= value && value <= range.most) return;
  const std::string least = text(range.least), most = text(range.most);
  const std::string allowed =
      std::isfinite(range.most)
          ? (range.open ? "lie between " + least + " and " + most + ", ends excluded" : "be from " + least + " to " + most)
          : (range.open ? "be greater than " + least : "be " + least + " or greater");
  throw InvalidArgument(name + " must " + allowed + ", not " + text(value));
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
    if (each.normal && !(each.normal->norm() > 0)) throw InvalidArgument(option.name + std::string(" has a normal of no length"));
  }
}
void check_value(const Option&, const auto&) {}  // whatever the type holds is right
template <class T>
void check_value(const Option& option, const std::optional<T>& value) {
  if (value) check_value(option, *value);
}

const Option& option_named(const char* name) {
  for (const Option& option : options())
    if (std::string(option.name) == name) return option;
  throw InvalidArgument(std::string("There is no option ") + name);
}

}  // namespace

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

void check(const FillOptions& given) {
#define OPTION(type, name, value, ...) check_value(option_named(#name), given.name);
#define OPTION_AT(path, name, ...) check_value(option_named(#name), given.path);
#include "tripatch/options.def"
  check(given.own);
}

void check(const MethodOptions& given) {
  if (given.shape && !given.shape->fit(3))
    throw InvalidArgument("shape must be one value or three, not " + std::to_string(given.shape->values().size()));
#define METHOD_OPTION(type, name, value, ...) check_value(option_named(#name), given.name);
#include "tripatch/options.def"
}

void check(const HoleChoice& given) {
#define HOLES_OPTION(type, name, value, ...) check_value(option_named(#name), given.name);
#include "tripatch/options.def"
}

}  // namespace tripatch
