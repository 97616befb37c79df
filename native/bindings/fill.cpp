// Filling: the whole path from a mesh to new faces.
#include "tripatch/fill.h"

#include "arrays.h"
#include "bindings.h"
#include "connected_mesh.h"
#include "options.h"

using namespace tripatch;

void bind_fill(py::module_& m) {
  py::class_<Fill>(m, "Fill")
      .def_property_readonly("vertices", [](const py::object& fill) { return array_in(fill, fill.cast<const Fill&>().vertices); })
      .def_property_readonly("normals", [](const py::object& fill) { return array_in(fill, fill.cast<const Fill&>().normals); })
      .def_property_readonly("barycentric",
                             [](const py::object& fill) { return array_in(fill, fill.cast<const Fill&>().barycentric); })
      .def_property_readonly("rim_normals", [](const Fill& f) { return array_from(f.rim_normals); })
      .def_property_readonly("rim_barycentric", [](const Fill& f) { return array_from(f.rim_barycentric); })
      .def_property_readonly("uv",
                             [](const Fill& f) -> py::object {  // a small hole has a plane domain, and may have no vertex inside
                               if (f.rim_uv.rows() == 0) return py::none();
                               return Array({f.uv.rows(), Index{2}}, f.uv.data());
                             })
      .def_property_readonly("rim_uv", [](const Fill& f) { return array_from(f.rim_uv); })
      .def_property_readonly("deviation", [](const Fill& f) { return array_from(f.deviation); })
      .def_property_readonly("moved", [](const Fill& f) { return array_from(f.moved); })
      .def_property_readonly("moved_to", [](const Fill& f) { return array_from(f.moved_to); })
      .def_readonly("creases", &Fill::creases)
      .def_readonly("crease_values", &Fill::crease_values)
      .def_readonly("feature_edges", &Fill::feature_edges)
      .def_readonly("split_edges", &Fill::split_edges)
      .def_readonly("split_t", &Fill::split_t)
      .def_property_readonly("border", [](const Fill& f) { return array_from(f.border); })
      .def_property_readonly("rim", [](const Fill& f) { return array_from(f.rim); })
      .def_property_readonly("face_offsets", [](const Fill& f) { return array_from(f.faces.offsets); })
      .def_property_readonly("face_corners", [](const Fill& f) { return array_from(f.faces.corners); })
      .def_property_readonly("patch", [](const Fill& f) { return std::const_pointer_cast<Surface>(f.patch); })
      .def_readonly("sides", &Fill::sides)
      .def_readonly("report", &Fill::report)
      .def_property_readonly("passes_through", [](const Fill& fill) { return place(fill.passes_through); });

  m.def("_fill", [](const Array& vertices, const IndexArray& offsets, const py::array& corners, const py::dict& options,
                    const py::object& progress) {
    const FillOptions o = fill_options(options);
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    Fill filled;
    interruptibly([&] { filled = fill({points, faces}, o); }, progress);
    return filled;
  });
  m.def("_fill_all", [](const Array& vertices, const IndexArray& offsets, const py::array& corners,
                        std::vector<std::vector<Index>> rims, std::vector<std::vector<std::vector<Index>>> islands,
                        const py::dict& options, const std::vector<std::optional<std::vector<Index>>>& rim_corners,
                        const py::object& progress, const ConnectedMesh* connected) {
    const FillOptions o = fill_options(options);
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    Holes holes;
    holes.rims = std::move(rims);
    holes.islands = std::move(islands);
    std::vector<std::variant<Fill, Refused>> results;
    {
      py::gil_scoped_release release;
      results = fill_all(
          {points, faces}, holes, o, rim_corners,
          [&](std::size_t done) {
            const py::gil_scoped_acquire acquire;
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            if (!progress.is_none()) progress(done, holes.rims.size());
          },
          connected ? &connected->around() : nullptr);
    }
    py::list out;
    for (auto& result : results) {
      if (auto* filled = std::get_if<Fill>(&result)) {
        out.append(std::move(*filled));
      } else {
        const Refused& refused = std::get<Refused>(result);
        out.append(refusal_object(refused.message, refused.also));
      }
    }
    return out;
  });
}
