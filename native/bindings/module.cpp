// The Python module: arrays in, arrays out, the GIL released around every computation. Shapes and types are checked in
// python/tripatch; here only what C++ needs.
#include <optional>

#include "bindings.h"
#include "tripatch/threads.h"

using namespace tripatch;

PYBIND11_MODULE(_native, m) {
  m.doc() = "Compiled core of tripatch";
  py::register_exception_translator([](std::exception_ptr p) {
    try {
      if (p) std::rethrow_exception(p);
    } catch (const CodedRefusal& refusal) {
      const py::object error = refusal_object(refusal.message(), refusal.also());
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
    } catch (const CodedArgument& mistake) {
      const py::object type = py::module_::import("tripatch.errors").attr("WrongValue");
      PyErr_SetObject(type.ptr(), message_object(mistake.message()).ptr());
    }
  });
  bind_messages(m);
  bind_options(m);
  bind_patches(m);
  bind_limit(m);
  bind_bezier(m);
  bind_smooth_triangles(m);
  bind_attributes(m);
  bind_blends(m);
  bind_methods(m);
  bind_report(m);
  bind_holes(m);
  bind_face_rows(m);
  bind_fill(m);
  bind_polygon(m);
  bind_making(m);
  m.def(
      "set_threads",
      [](std::optional<int> n) {
        if (n && *n < 1) throw CodedArgument(Code::out_of_range, {{"name", "n"}, {"least", 1}, {"value", *n}});
        set_threads(n.value_or(0));
      },
      py::arg("n"),
      R"(Set how many threads fills work on, the calling thread included.

n: from 1 on; None: as many as there are cores, or fewer if the environment variable TRIPATCH_THREADS says so (the default). The number
holds for the whole process from the next piece of work on. No result depends on it.
)");
}
