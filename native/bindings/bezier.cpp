// Bezier and NURBS surfaces, sides from them, Coons nets.
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "tripatch/boundary/bezier_rectangle.h"
#include "tripatch/boundary/nurbs_surface.h"
#include "tripatch/constructions/blend.h"
#include "tripatch/constructions/coons_bezier.h"
#include "tripatch/constructions/coons_rectangle.h"
#include "tripatch/patch/bezier_triangle.h"

using namespace tripatch;

namespace {

/// (m + 1, n + 1, 3) with the first index u.
Array net_from(const BezierRectangle& rectangle) {
  Array a({Index{rectangle.degree_u() + 1}, Index{rectangle.degree_v() + 1}, Index{3}});
  std::copy_n(rectangle.net().data(), rectangle.net().size(), a.mutable_data());
  return a;
}

Points flat(const Array& a) { return Eigen::Map<const Points>(a.data(), a.shape(0) * a.shape(1), 3); }

}  // namespace

void bind_bezier(py::module_& m) {
  shared_class<BezierTriangle, Surface>(m, "BezierTriangle", "A polynomial surface over the triangle, by its control net.")
      .def(py::init([](const Array& net) { return std::make_shared<BezierTriangle>(points_from(net)); }))
      .def_property_readonly("degree", &BezierTriangle::degree, "n")
      .def_property_readonly(
          "net", [](const BezierTriangle& b) { return array_from(b.net()); }, "((n + 1) (n + 2) / 2, 3) control points.")
      .def(
          "elevated", [](const BezierTriangle& b) { return std::make_shared<BezierTriangle>(b.elevated()); },
          "The same surface, one degree higher.")
      .def("_derivative",
           [](const BezierTriangle& b, const std::array<double, 3>& d) { return b.derivative(Vec3(d[0], d[1], d[2])); })
      .def("_side", [](const BezierTriangle& b, int i) { return array_from(b.side(i)); });

  shared_class<RectangleSurface>(m, "RectangleSurface", py::dynamic_attr(), "A surface over a rectangle (u, v).")
      .def("_evaluate", &evaluate<RectangleSurface>)
      .def_property_readonly("domain", &RectangleSurface::domain, "u from, u to, v from, v to.");
  shared_class<BezierRectangle, RectangleSurface>(m, "BezierRectangle", "A Bezier rectangle over the unit square.")
      .def(py::init([](const Array& net) {
        return std::make_shared<BezierRectangle>(flat(net), static_cast<int>(net.shape(0)) - 1,
                                                 static_cast<int>(net.shape(1)) - 1);
      }))
      .def_property_readonly(
          "degrees", [](const BezierRectangle& b) { return py::make_tuple(b.degree_u(), b.degree_v()); }, "In u and in v.")
      .def_property_readonly("net", &net_from, "(m + 1, n + 1, 3) control points.");
  shared_class<NurbsSurface, RectangleSurface>(m, "NurbsSurface", "A NURBS surface of any degrees, knots and weights.")
      .def(py::init([](const Array& points, const std::vector<double>& weights, const std::vector<double>& knots_u,
                       const std::vector<double>& knots_v) {
        return std::make_shared<NurbsSurface>(flat(points), points.shape(0), points.shape(1), weights, knots_u, knots_v);
      }))
      .def_property_readonly(
          "degrees", [](const NurbsSurface& s) { return py::make_tuple(s.degree_u(), s.degree_v()); }, "In u and in v.");

  m.def("_rational_triangle", [](const Array& net, const std::vector<double>& weights) {
    return std::const_pointer_cast<Surface>(rational_triangle(points_from(net), weights));
  });
  m.def("_triangle_on", [](const std::shared_ptr<RectangleSurface>& surface, const std::array<std::array<double, 2>, 3>& at,
                           const std::array<std::array<double, 3>, 3>& by) {
    std::array<Vec2, 3> corners;
    std::array<Vec3, 3> moved;
    for (int i = 0; i < 3; ++i) corners[i] = {at[i][0], at[i][1]}, moved[i] = {by[i][0], by[i][1], by[i][2]};
    return std::const_pointer_cast<Surface>(triangle_on(surface, corners, moved));
  });

  auto side = py::reinterpret_borrow<py::class_<Side>>(m.attr("Side"));
  define_constructor<const BezierTriangle&, int, bool>(side, side_of);
  define_constructor<const RectangleSurface&, int, bool>(
      side, [](const RectangleSurface& surface, int edge, bool reversed) { return surface.side(edge, reversed); });

  py::enum_<CoonsKind>(m, "CoonsKind")
      .value("discrete", CoonsKind::discrete)
      .value("extremal", CoonsKind::extremal)
      .value("extremal_symmetric", CoonsKind::extremal_symmetric)
      .value("mask", CoonsKind::mask)
      .value("permanence", CoonsKind::permanence);
  m.def("_coons_bezier", [](const std::array<Array, 3>& curves, CoonsKind kind, const std::optional<double>& alpha) {
    BoundaryCurves boundary;
    for (int i = 0; i < 3; ++i) boundary[i] = points_from(curves[i]);
    Messages warnings;
    BezierTriangle triangle = [&] {
      py::gil_scoped_release release;
      return coons_bezier(boundary, kind, alpha, &warnings);
    }();
    return py::make_tuple(std::move(triangle), message_objects(warnings));
  });
  m.def("_coons_energy", [](const BezierTriangle& triangle, bool symmetric) { return coons_energy(triangle, symmetric); });
  m.def("_coons_energy", [](const BezierRectangle& rectangle, bool) { return coons_energy(rectangle); });
  m.def("_coons_rectangle", [](const BezierRectangle& boundary, const std::optional<double>& alpha) {
    return alpha ? permanence_rectangle(boundary, *alpha) : coons_rectangle(boundary);
  });
}
