// Subdivision surfaces: a modifier's settings, limit points, and the surface around places of a cage.
#include "arrays.h"
#include "bindings.h"
#include "tripatch/boundary/limit_surface.h"
#include "tripatch/cage/limit_mesh.h"
#include "tripatch/cage/limit_points.h"

using namespace tripatch;

void bind_limit(py::module_& m) {
  m.def("_sample_limit", [](const Array& vertices, const IndexArray& offsets, const py::array& corners,
                            const Subdivision& settings, Index first_face, int level) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    LimitMesh limit;
    interruptibly([&] { limit = sample_limit({points, faces}, settings, first_face, level); });
    return py::make_tuple(array_from(limit.vertices), array_from(limit.faces.corners));
  });
  py::class_<Subdivision> subdivision(m, "Subdivision");
  define_constructor<>(subdivision, [] { return Subdivision(); });
  define_constructor<const Subdivision&>(subdivision, [](const Subdivision& other) { return Subdivision(other); });
  subdivision.def_readwrite("loop", &Subdivision::loop)
      .def_readwrite("preserve_corners", &Subdivision::preserve_corners)
      .def_readwrite("quality", &Subdivision::quality)
      .def_readwrite("use_limit_surface", &Subdivision::use_limit_surface)
      .def_readwrite("level", &Subdivision::level)
      .def_readwrite("crease_edges", &Subdivision::crease_edges)
      .def_readwrite("edge_creases", &Subdivision::edge_creases)
      .def_readwrite("crease_vertices", &Subdivision::crease_vertices)
      .def_readwrite("vertex_creases", &Subdivision::vertex_creases)
      .def_readwrite("loose_vertices", &Subdivision::loose_vertices);
  py::class_<LimitSurface> limit_surface(m, "LimitSurface");
  define_constructor<const Array&, const IndexArray&, const py::array&, const Subdivision&, const std::vector<Index>&>(
      limit_surface, [](const Array& vertices, const IndexArray& offsets, const py::array& corners, const Subdivision& settings,
                        const std::vector<Index>& around) {
        const FacesRef faces = faces_from(offsets, corners);
        const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
        return LimitSurface({points, faces}, settings, around);
      });
  limit_surface.def("grid", [](const LimitSurface& surface, int steps) { return array_from(surface.grid(steps)); })
      .def("evaluate_edge", [](const LimitSurface& surface, Index face, int edge, const std::vector<double>& t) {
        std::vector<LimitJet> jets(t.size());
        surface.evaluate_edge(face, edge, t, jets);
        Array out({static_cast<Index>(t.size()), Index{6}, Index{3}});
        double* to = out.mutable_data();
        for (const LimitJet& j : jets)
          for (const Vec3* v : {&j.p, &j.pu, &j.pv, &j.puu, &j.puv, &j.pvv}) to = std::copy_n(v->data(), 3, to);
        return out;
      });
  m.def("limit_points", [](const Array& vertices, const IndexArray& offsets, const py::array& corners) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    const Points limit = limit_points({points, faces});
    py::gil_scoped_acquire acquire;
    return array_from(limit);
  });
}
