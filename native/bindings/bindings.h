// Each file of this folder binds one concept; module.cpp calls them in an order in which every type is known before it is used.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tripatch/math/interruption.h"
#include "tripatch/messages.h"
#include "tripatch/report/report.h"
#include "tripatch/types.h"

namespace py = pybind11;

void bind_messages(py::module_& m);
void bind_options(py::module_& m);
void bind_patches(py::module_& m);
void bind_bezier(py::module_& m);
void bind_smooth_triangles(py::module_& m);
void bind_attributes(py::module_& m);
void bind_blends(py::module_& m);
void bind_limit(py::module_& m);
void bind_methods(py::module_& m);
void bind_report(py::module_& m);
void bind_holes(py::module_& m);
void bind_face_rows(py::module_& m);
void bind_fill(py::module_& m);
void bind_making(py::module_& m);
void bind_polygon(py::module_& m);

/// Does work without the GIL, and ends it within 100 ms where a signal has come, such as Ctrl-C, or where `progress`, which is called with
/// 0 or 1 and 1 several times a second, throws.
template <class Work>
void interruptibly(const Work& work, const py::object& progress = py::none()) {
  const auto tell = [&](int done) {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none()) progress(done, 1);
  };
  const py::gil_scoped_release release;
  tripatch::work_and_ask(work, [&] { tell(0); });
  tell(1);
}

/// Lets Python construct a bound class with what a function of `Arguments` makes. pybind11's own constructors register the object
/// after all catches, where a failed allocation ends the process; here Python gets a MemoryError.
template <class... Arguments, class Bound, class Make>
void define_constructor(Bound& bound, const Make& make, const char* name = "__init__") {
  bound.def(
      name,
      [make](py::detail::value_and_holder& object, Arguments... arguments) {
        auto* const made = new typename Bound::type(make(std::forward<Arguments>(arguments)...));
        object.value_ptr() = made;
        try {
          object.type->init_instance(object.inst, nullptr);
        } catch (...) {
          object.value_ptr() = nullptr;
          delete made;
          throw;
        }
      },
      py::detail::is_new_style_constructor());
}

/// A bound class whose objects Python and C++ share; functions return them as std::shared_ptr. If there is no memory to register one,
/// pybind11 frees it, though others have it; here Python gets a MemoryError and they keep it.
template <class Type, class... Bases, class... Extra>
auto shared_class(py::module_& m, const char* name, const Extra&... extra) {
  py::class_<Type, Bases..., std::shared_ptr<Type>> bound(m, name, extra...);
  py::detail::type_info* const type = py::detail::get_type_info(typeid(Type));
  static const auto init_instance = type->init_instance;
  type->init_instance = [](py::detail::instance* object, const void* holder) {
    try {
      init_instance(object, holder);
    } catch (...) {
      if (holder) object->get_value_and_holder(py::detail::get_type_info(typeid(Type))).value_ptr() = nullptr;
      throw;
    }
  };
  return bound;
}

/// A tripatch.Refusal.
py::object refusal_object(const tripatch::Message& message, const tripatch::Messages& also);
/// A tripatch.Message.
py::object message_object(const tripatch::Message& message);
/// A list of tripatch.Message.
py::list message_objects(const tripatch::Messages& messages);

/// The report of a patch made alone, and what there is to say of it. size: of the patch.
tripatch::Report told_of_patch(tripatch::Report report, double size);
