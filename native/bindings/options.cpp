#include "options.h"

#include <type_traits>

using namespace tripatch;

namespace {

/// Values from Python: a choice is its name.
template <class T>
void read(const py::handle& value, const char*, T& to) {
  to = value.cast<T>();
}
template <class T>
  requires std::is_enum_v<T>
void read(const py::handle& value, const char* name, T& to) {
  to = named<T>(value.cast<std::string>(), name);
}
void read(const py::handle& value, const char*, Vec3& to) { to = Vec3::Map(value.cast<std::array<double, 3>>().data()); }
/// Points, each with its normal or none.
void read(const py::handle& value, const char*, std::vector<Through>& to) {
  using Three = std::array<double, 3>;
  for (const auto& [point, normal] : value.cast<std::vector<std::pair<Three, std::optional<Three>>>>()) {
    to.push_back({Vec3::Map(point.data()), {}});
    if (normal) to.back().normal = Vec3::Map(normal->data());
  }
}
template <class T>
void read(const py::handle& value, const char* name, BySide<T>& to) {
  std::vector<T> values;
  for (const py::handle one : value.cast<std::vector<py::object>>()) read(one, name, values.emplace_back());
  if (values.empty()) throw InvalidArgument(std::string(name) + " must hold a value");
  to = BySide<T>(std::move(values));
}
template <class T>
void read(const py::handle& value, const char* name, std::optional<T>& to) {
  to.reset();
  if (!value.is_none()) read(value, name, to.emplace());
}

template <class T>
void read_from(const py::dict& given, const char* name, T& to) {
  if (given.contains(name)) read(given[name], name, to);
}

/// Defaults to Python.
template <class T>
py::object shown(const T& value) {
  if constexpr (std::is_enum_v<T>)
    return py::str(name_of(value));
  else
    return py::cast(value);
}
py::object shown(const Vec3& value) { return py::cast(std::array{value[0], value[1], value[2]}); }
py::object shown(const Pair& value) { return py::make_tuple(value[0], value[1]); }
py::object shown(const std::vector<Index>& value) { return py::tuple(py::cast(value)); }
py::object shown(const std::vector<std::vector<Index>>& value) { return py::tuple(py::cast(value)); }
py::object shown(const std::vector<Through>&) { return py::tuple(); }
py::object shown(const Subdivision&) { return py::none(); }
template <class T>
py::object shown(const BySide<T>& value) {
  return shown(value[0]);
}
template <class T>
py::object shown(const std::optional<T>& value) {
  return value ? shown(*value) : py::none();
}

const char* kind_name(const Option& option) {
  using Kind = Option::Kind;
  switch (option.kind) {
    case Kind::flag: return "flag";
    case Kind::whole: return "whole";
    case Kind::number: return "number";
    case Kind::choice: return "choice";
    case Kind::indices: return "indices";
    case Kind::loops: return "loops";
    case Kind::position: return "position";
    case Kind::points: return "points";
    case Kind::subdivision: return "subdivision";
  }
  return "";
}

/// The functions that take it.
py::tuple functions(const Option& option) {
  py::list names;
  if (!option.of_holes) names.append("fill");
  if (!option.one_hole) names.append("fill_all");
  if (option.patch) names.append("patch");
  if (option.blend) names.append("blend");
  if (option.of_holes) names.append("choose_holes");
  return names;
}

py::dict defaults() {
  const FillOptions plain;
  const HoleChoice every;
  py::dict all;
#define OPTION(type, name, value, ...) all[#name] = shown(plain.name);
#define METHOD_OPTION(type, name, value, ...) all[#name] = shown(plain.own.name);
#define HOLES_OPTION(type, name, value, ...) all[#name] = shown(every.name);
#define OPTION_AT(path, name, ...) all[#name] = shown(plain.path);
#include "tripatch/options.def"
  return all;
}

}  // namespace

FillOptions fill_options(const py::dict& given) {
  FillOptions options;
#define OPTION(type, name, value, ...) read_from(given, #name, options.name);
#define OPTION_AT(path, name, ...) read_from(given, #name, options.path);
#include "tripatch/options.def"
  options.own = method_options(given);
  check(options);
  return options;
}

MethodOptions method_options(const py::dict& given) {
  MethodOptions options;
#define METHOD_OPTION(type, name, value, ...) read_from(given, #name, options.name);
#include "tripatch/options.def"
  check(options);
  return options;
}

HoleChoice hole_choice(const py::dict& given) {
  HoleChoice choice;
#define HOLES_OPTION(type, name, value, ...) read_from(given, #name, choice.name);
#include "tripatch/options.def"
  check(choice);
  return choice;
}

void bind_options(py::module_& m) {
  py::class_<Choice>(m, "Choice", "One value of a choice.")
      .def_readonly("name", &Choice::name, "As in Python and on the command line.")
      .def_readonly("label", &Choice::label, "In a panel; empty: the name in capitalized words.")
      .def_readonly("description", &Choice::description, "What it means.")
      .def_readonly("misprint", &Choice::misprint, "As a paper prints it, mistakes included: for scripts, not for a panel.");
  py::class_<Range>(m, "Range", "From the least to the most value.")
      .def_readonly("least", &Range::least, "-inf: no end.")
      .def_readonly("most", &Range::most, "inf: no end.")
      .def_readonly("open", &Range::open, "Neither of the two is in it.");
  py::class_<Option>(m, "Option", "An option of a fill, a row of the table.")
      .def_readonly("name", &Option::name, "Its keyword.")
      .def_property_readonly("kind", &kind_name, "flag, whole, number, choice, indices, loops, position, points or subdivision.")
      .def_readonly("optional", &Option::optional, "May be None.")
      .def_readonly("by_side", &Option::by_side, "One value, or one a side.")
      .def_readonly("count", &Option::count, "Numbers or indices that belong together; 0: any number of them.")
      .def_readonly("choices", &Option::choices, "Of a choice; those of `method` are METHODS.")
      .def_readonly("description", &Option::sentence, "A sentence without its full stop.")
      .def_readonly("seen", &Option::seen, "What one will see when it is changed: a tooltip; empty: the description.")
      .def_readonly("range", &Option::range, "Of a number.")
      .def_readonly("soft", &Option::soft, "The range of a slider.")
      .def_readonly("unit", &Option::unit, "Empty: none.")
      .def_readonly("label", &Option::label, "In a panel; empty: the name in capitalized words.")
      .def_property_readonly(
          "none", [](const Option& option) { return option.none.name ? py::cast(option.none) : py::none(); },
          "What no value is called, where that is a choice among others.")
      .def_property_readonly(
          "applies",
          [](const Option& option) {
            py::list pairs;
            for (const Condition& condition : option.applies) pairs.append(py::make_tuple(condition.option, condition.value));
            return py::tuple(pairs);
          },
          "(option, value): where one of these holds it is read; empty: always. A value '' is any but None.")
      .def_property_readonly("functions", &functions, "Names of the functions that take it.")
      .def_readonly("selection", &Option::selection, "Goes with today's selection.")
      .def_readonly("panel", &Option::panel, "A panel has it; else a selection or a modifier says it, or it is for programs.")
      .def_property_readonly(
          "default", [](const Option& option) { return py::object(defaults()[option.name]); }, "Where it is not given.")
      .def("__repr__", [](const Option& option) { return "<tripatch option " + std::string(option.name) + ">"; });
  m.def("_not_taken",
        [](const std::string& method, const py::dict& given) { return not_taken(find_method(method), fill_options(given)); });
  m.def("_options", [] {
    py::dict all;
    for (const Option& option : options()) all[option.name] = py::cast(&option, py::return_value_policy::reference);
    return all;
  });
}
