// What users read: messages become str objects with a code, and the table of sentences is Python's to read.
#include "tripatch/messages.h"

#include "bindings.h"

using namespace tripatch;

namespace {

py::dict parameters_of(const Message& message) {
  py::dict out;
  for (const Parameter& each : message.parameters) {
    if (const auto* const nested = std::get_if<std::shared_ptr<const Message>>(&each.value))
      out[each.name.c_str()] = message_object(**nested);
    else
      out[each.name.c_str()] = std::visit(
          [](const auto& value) -> py::object {
            if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::shared_ptr<const Message>>)
              return py::none();
            else
              return py::cast(value);
          },
          each.value);
  }
  return out;
}

/// A value that Python gives; what is no number and no list is text.
Parameter::Value value_of(const py::handle& given) {
  if (py::isinstance<py::str>(given)) return given.cast<std::string>();
  if (py::isinstance<py::float_>(given)) return given.cast<double>();
  if (py::isinstance<py::int_>(given)) return given.cast<Index>();
  const py::sequence items = py::reinterpret_borrow<py::sequence>(given);
  if (items.size() > 0 && py::isinstance<py::str>(items[0])) return given.cast<std::vector<std::string>>();
  return given.cast<std::vector<Index>>();
}

}  // namespace

py::object message_object(const Message& message) {
  return py::module_::import("tripatch.messages")
      .attr("Message")(about(message.code).code, parameters_of(message), message.where);
}

py::list message_objects(const Messages& messages) {
  py::list out;
  for (const Message& each : messages) out.append(message_object(each));
  return out;
}

py::object refusal_object(const Message& message, const Messages& also) {
  const py::object refusal = py::module_::import("tripatch.errors").attr("Refusal");
  return refusal.attr("of")(message_object(message), message_objects(also));
}

void bind_messages(py::module_& m) {
  m.def("_messages", [] {
    py::list rows;
    for (const AboutMessage& row : messages())
      rows.append(py::make_tuple(row.code, row.kind, row.sentence, row.panel, row.meaning));
    return rows;
  });
  m.def("_format", [](const std::string& pattern, const py::dict& parameters, const std::vector<Index>& where,
                      const std::string& vertices, bool panel, const std::map<std::string, std::string>& names) {
    Message message = {Code{}, {}, where};
    for (const auto& [name, value] : parameters) message.parameters.emplace_back(name.cast<std::string>(), value_of(value));
    using Vertices = Wording::Vertices;
    const Vertices shown = vertices == "selected"  ? Vertices::selected
                           : vertices == "unnamed" ? Vertices::unnamed
                                                   : Vertices::numbered;
    return format(pattern, message, {shown, panel, names});
  });
}
