// The Python module: arrays in, arrays out, the GIL released around every computation. Names and shapes are checked in
// python/tripatch; here only what C++ needs.
#include <pybind11/functional.h>
#include <pybind11/stl.h>

#include "arrays.h"
#include "tripatch/boundary/limit.h"
#include "tripatch/boundary/limit_surface.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/boundary/ribbon.h"
#include "tripatch/cage/limit_mesh.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fairing/fairing.h"
#include "tripatch/fill.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/output/triangulate.h"

namespace py = pybind11;
using namespace tripatch;

void bind_bezier(py::module_& m);
void bind_blends(py::module_& m);

namespace {

py::object refusal_object(const std::string& reason, const std::vector<Index>& where) {
  return py::module_::import("tripatch.errors").attr("Refusal")(reason, where);
}

/// A Python callable of t (k,) -> (k, 3) as a field of the side.
PiecewisePolynomial sampled(const py::function& f, const char* name) {
  return PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        Array parameters(static_cast<Index>(t.size()));
        std::copy(t.begin(), t.end(), parameters.mutable_data());
        const Array values = Array::ensure(f(parameters));
        if (!values) throw py::type_error(std::string(name) + "(t) must return an array of numbers");
        if (values.ndim() != 2 || values.shape(0) != static_cast<Index>(t.size()) || values.shape(1) != 3)
          throw InvalidArgument(std::string(name) + "(t) must return an array of shape (k, 3) for t of shape (k,)");
        std::copy_n(values.data(), values.size(), out.begin());
        for (std::size_t k = 0; k < out.size(); ++k)
          if (!std::isfinite(out[k]))
            throw InvalidArgument(std::string(name) + "(t) is not finite at t = " + std::to_string(t[k / 3]));
      },
      3);
}

Side side_from_functions(const py::function& c, const py::function& dc, const py::function& r, const std::vector<double>& rim,
                         const std::optional<py::function>& q) {
  Side side{sampled(c, "c"), sampled(r, "r"), q ? sampled(*q, "q") : PiecewisePolynomial(), rim};
  // The side's own derivative is that of c, exactly; dc only has to agree.
  const PiecewisePolynomial given = sampled(dc, "dc");
  double scale = 0, off = 0;
  for (int k = 0; k <= 16; ++k) {
    const Vec3 mine = side.c.derivative_at(k / 16.0), theirs = given(k / 16.0);
    scale = std::max({scale, mine.norm(), theirs.norm()});
    off = std::max(off, (mine - theirs).norm());
  }
  if (off > 1e-5 * scale) throw InvalidArgument("dc is not the derivative of c");
  return side;
}

py::tuple evaluate_side(const Side& side, const Array& t) {
  const Index n = t.size();
  Array c({n, Index{3}}), dc({n, Index{3}}), r({n, Index{3}}), normal({n, Index{3}});
  for (Index k = 0; k < n; ++k) {
    std::array<double, 6> series;
    side.c.taylor(t.data()[k], 1, series.data());
    std::copy_n(series.data(), 3, c.mutable_data(k));
    std::copy_n(series.data() + 3, 3, dc.mutable_data(k));
    side.r.taylor(t.data()[k], 0, r.mutable_data(k));
    const Vec3 v = side.normal(t.data()[k]);
    std::copy_n(v.data(), 3, normal.mutable_data(k));
  }
  return py::make_tuple(c, dc, r, normal);
}

MethodOptions method_options_from(const py::dict& d) {
  MethodOptions o;
  o.shape = d["shape"].cast<std::array<double, 3>>();
  o.optimal_shape = d["optimal_shape"].cast<bool>();
  o.as_printed = d["as_printed"].cast<bool>();
  o.symmetric = d["symmetric"].cast<bool>();
  o.alpha = d["alpha"].cast<std::optional<double>>();
  return o;
}

/// (k, 3) the second derivative across, or None where it is not known.
py::object second_derivative(const Side& side, const Array& t) {
  if (side.q.empty()) return py::none();
  Array q({static_cast<Index>(t.size()), Index{3}});
  for (Index k = 0; k < t.size(); ++k) side.q.taylor(t.data()[k], 0, q.mutable_data(k));
  return q;
}

FillOptions options_from(const py::dict& d) {
  FillOptions o;
  const auto has = [&](const char* key) { return d.contains(key) && !d[key].is_none(); };
  if (has("rim")) o.rim = d["rim"].cast<std::vector<Index>>();
  if (has("corners")) o.corners = d["corners"].cast<std::array<Index, 3>>();
  if (has("resolution")) o.resolution = d["resolution"].cast<int>();
  o.replaced = d["replaced"].cast<std::vector<Index>>();
  o.method = d["method"].cast<std::string>();
  o.continuity = d["continuity"].cast<std::array<std::string, 3>>();
  o.cross_boundary = d["cross_boundary"].cast<CrossBoundary>();
  o.fairing = d["fairing"].cast<std::string>();
  o.output = d["output"].cast<std::string>();
  if (has("tolerance")) o.tolerance = d["tolerance"].cast<double>();
  o.cage_rim = d["cage_rim"].cast<CageRim>();
  o.odd = d["odd"].cast<std::string>();
  o.pole_offset = d["pole_offset"].cast<std::array<double, 2>>();
  o.bulge = d["bulge"].cast<std::array<double, 3>>();
  o.tension = d["tension"].cast<double>();
  if (has("center")) o.center = Vec3::Map(d["center"].cast<std::array<double, 3>>().data());
  o.center_offset = d["center_offset"].cast<double>();
  o.own = method_options_from(d["own"]);
  o.limit = d["limit"].cast<bool>();
  if (has("subdivision")) o.subdivision = d["subdivision"].cast<Subdivision>();
  return o;
}

}  // namespace

PYBIND11_MODULE(_native, m) {
  m.doc() = "Compiled core of tripatch";
  py::register_exception_translator([](std::exception_ptr p) {
    try {
      if (p) std::rethrow_exception(p);
    } catch (const Refusal& refusal) {
      const py::object error = refusal_object(refusal.what(), refusal.where());
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(error.ptr())), error.ptr());
    }
  });

  py::enum_<CrossBoundary>(m, "CrossBoundary")
      .value("given", CrossBoundary::given)
      .value("consistent", CrossBoundary::consistent)
      .value("as_printed", CrossBoundary::as_printed);

  py::class_<Surface, std::shared_ptr<Surface>>(m, "Patch", "A surface over the triangle.")
      .def("_evaluate", &evaluate<Surface>)
      .def(
          "_energy", [](const Surface& surface, const std::string& name) { return energy(surface, name, size_of(surface)); },
          py::call_guard<py::gil_scoped_release>())
      .def("_normal", [](const Surface& surface, const Array& b) {
        const Points points = points_from(b);
        Points normals;
        {
          py::gil_scoped_release release;
          normals = surface.normals(points);
        }
        return array_from(normals);
      });

  py::class_<Side>(m, "Side", "A side of the hole: position and the derivative of the surroundings across it.")
      .def_static("_from_functions", &side_from_functions)
      .def("_evaluate", &evaluate_side)
      .def("_second_derivative", &second_derivative)
      .def("_part", &piece_of)
      .def("_moved", [](const Side& side, const std::array<double, 3>& start, const std::array<double, 3>& end) {
        return moved_ends(side, {start[0], start[1], start[2]}, {end[0], end[1], end[2]});
      });

  py::enum_<CageRim>(m, "CageRim").value("smooth", CageRim::smooth).value("exact", CageRim::exact).value("move", CageRim::move);
  m.def("_sample_limit", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners,
                            const Subdivision& settings, Index first_face, int level) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    LimitMesh limit;
    {
      py::gil_scoped_release release;
      limit = sample_limit({points, faces}, settings, first_face, level);
    }
    return py::make_tuple(array_from(limit.vertices), array_from(limit.faces.corners));
  });
  py::class_<Subdivision>(m, "Subdivision")
      .def(py::init<>())
      .def(py::init<const Subdivision&>())
      .def_readwrite("loop", &Subdivision::loop)
      .def_readwrite("preserve_corners", &Subdivision::preserve_corners)
      .def_readwrite("quality", &Subdivision::quality)
      .def_readwrite("use_limit_surface", &Subdivision::use_limit_surface)
      .def_readwrite("level", &Subdivision::level)
      .def_readwrite("crease_edges", &Subdivision::crease_edges)
      .def_readwrite("edge_creases", &Subdivision::edge_creases)
      .def_readwrite("crease_vertices", &Subdivision::crease_vertices)
      .def_readwrite("vertex_creases", &Subdivision::vertex_creases)
      .def_readwrite("loose_vertices", &Subdivision::loose_vertices);
  py::class_<LimitSurface>(m, "LimitSurface")
      .def(py::init([](const Array& vertices, const IndexArray& offsets, const IndexArray& corners, const Subdivision& settings,
                       const std::vector<Index>& around) {
        const FacesRef faces = faces_from(offsets, corners);
        const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
        return LimitSurface({points, faces}, settings, around);
      }))
      .def("grid", [](const LimitSurface& surface, int steps) { return array_from(surface.grid(steps)); })
      .def("evaluate_edge", [](const LimitSurface& surface, Index face, int edge, const std::vector<double>& t) {
        std::vector<LimitJet> jets(t.size());
        surface.evaluate_edge(face, edge, t, jets);
        Array out({static_cast<Index>(t.size()), Index{6}, Index{3}});
        double* to = out.mutable_data();
        for (const LimitJet& j : jets)
          for (const Vec3* v : {&j.p, &j.pu, &j.pv, &j.puu, &j.puv, &j.pvv}) to = std::copy_n(v->data(), 3, to);
        return out;
      });

  bind_bezier(m);
  bind_blends(m);

  py::class_<Method>(m, "Method", "A construction of the registry.")
      .def_readonly("name", &Method::name)
      .def_readonly("description", &Method::description)
      .def_readonly("citation", &Method::citation)
      .def_readonly("fills_holes", &Method::fills_holes)
      .def_readonly("continuity", &Method::continuity)
      .def_property_readonly("options", [](const Method& method) { return py::tuple(py::cast(method.options)); })
      .def("__repr__", [](const Method& method) { return std::string("<tripatch method ") + method.name + ">"; });
  m.def("_methods", [] {
    py::dict all;
    for (const Method& method : methods()) all[method.name] = py::cast(&method, py::return_value_policy::reference);
    return all;
  });

  py::class_<Report>(m, "Report", "Numbers of a fill: angles in degrees, time in seconds.")
      .def_readonly("seam_angle_max", &Report::seam_angle_max,
                    "Largest angle between the fill and the surroundings used, in degrees.")
      .def_readonly("seam_angle_rms", &Report::seam_angle_rms, "Root mean square of that angle, in degrees.")
      .def_readonly("seam_angle_max_by_side", &Report::seam_angle_max_by_side,
                    "Largest angle on each of the three sides, in degrees.")
      .def_readonly("seam_angle_rms_by_side", &Report::seam_angle_rms_by_side,
                    "Root mean square on each of the three sides, in degrees.")
      .def_readonly("continuity", &Report::continuity,
                    "On each of the three sides: Free, G0, G1 or G2, what was asked or what auto took.")
      .def_readonly("surroundings_error", &Report::surroundings_error,
                    "How well the mesh determines its own tangent planes, in degrees; 0 where they are known exactly.")
      .def_readonly("fairing", &Report::fairing, "Name of the energy that was made small; empty: none.")
      .def_readonly("energy_before", &Report::energy_before, "That energy before fairing.")
      .def_readonly("energy_after", &Report::energy_after, "That energy of the fill.")
      .def_readonly("shape_path", &Report::shape_path,
                    R"(With shape="optimal": a list of (lambda by side, energy), the last of which was taken.)")
      .def_readonly("method", &Report::method, "Name of the method used.")
      .def_readonly("method_reason", &Report::method_reason, "Why that method was used.")
      .def_readonly("deviation_max", &Report::deviation_max,
                    "Largest standard deviation of a new vertex, in units of the mesh; None: the method does not know it.")
      .def_readonly("triangles_folded", &Report::triangles_folded,
                    "Edges between new faces (of a cage: of its limit surface) whose triangles face more than 120 degrees apart.")
      .def_readonly("folds", &Report::folds, "Places of a 64 x 64 grid where the patch folds over itself.")
      .def_readonly("corners", &Report::corners, "Vertex indices of the three corners.")
      .def_readonly("cage_deviation_max", &Report::cage_deviation_max,
                    "Cages: largest distance of the limit surface from the patch, in units of the mesh.")
      .def_readonly("cage_deviation_rms", &Report::cage_deviation_rms, "Cages: root mean square of that distance.")
      .def_readonly("surroundings_moved_max", &Report::surroundings_moved_max,
                    "Cages: how far the limit surface around the hole moved at most, in units of the mesh.")
      .def_readonly("surroundings_moved_rms", &Report::surroundings_moved_rms, "Cages: root mean square of that distance.")
      .def_readonly("surroundings_moved_where", &Report::surroundings_moved_where,
                    "Cages: a vertex of the face that moved most; -1: none.")
      .def_readonly("corners_moved_max", &Report::corners_moved_max,
                    "Cages: how far the limit points of the three corners moved at most.")
      .def_readonly("seam_angle_median", &Report::seam_angle_median, "Cages: median angle along the seam, in degrees.")
      .def_readonly("seam_angle_max_inside", &Report::seam_angle_max_inside,
                    "Cages: largest angle without the rim edges that touch a corner, in degrees.")
      .def_readonly("poles", &Report::poles, "Quads and cages: [vertex, valence] of each inner vertex with an irregular valence.")
      .def_readonly("warnings", &Report::warnings, "Sentences on what a person should know of the fill.")
      .def_readonly("seconds", &Report::seconds, "Time that the fill took.");

  py::class_<Fill>(m, "Fill")
      .def_property_readonly("vertices", [](const Fill& f) { return array_from(f.vertices); })
      .def_property_readonly("normals", [](const Fill& f) { return array_from(f.normals); })
      .def_property_readonly("barycentric", [](const Fill& f) { return array_from(f.barycentric); })
      .def_property_readonly("rim_normals", [](const Fill& f) { return array_from(f.rim_normals); })
      .def_property_readonly("rim_barycentric", [](const Fill& f) { return array_from(f.rim_barycentric); })
      .def_property_readonly("uv", [](const Fill& f) { return array_from(f.uv); })
      .def_property_readonly("rim_uv", [](const Fill& f) { return array_from(f.rim_uv); })
      .def_property_readonly("deviation", [](const Fill& f) { return array_from(f.deviation); })
      .def_property_readonly("moved", [](const Fill& f) { return array_from(f.moved); })
      .def_property_readonly("moved_to", [](const Fill& f) { return array_from(f.moved_to); })
      .def_readonly("creases", &Fill::creases)
      .def_readonly("split_edges", &Fill::split_edges)
      .def_readonly("split_t", &Fill::split_t)
      .def_property_readonly("border", [](const Fill& f) { return array_from(f.border); })
      .def_property_readonly("rim", [](const Fill& f) { return array_from(f.rim); })
      .def_property_readonly("face_offsets", [](const Fill& f) { return array_from(f.faces.offsets); })
      .def_property_readonly("face_corners", [](const Fill& f) { return array_from(f.faces.corners); })
      .def_property_readonly("patch", [](const Fill& f) { return std::const_pointer_cast<Surface>(f.patch); })
      .def_readonly("sides", &Fill::sides)
      .def_readonly("report", &Fill::report);

  m.def("limit_points", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    const Points limit = limit_points({points, faces});
    py::gil_scoped_acquire acquire;
    return array_from(limit);
  });

  m.def("_find_holes", [](const IndexArray& offsets, const IndexArray& corners) {
    const FacesRef faces = faces_from(offsets, corners);
    std::vector<std::vector<Index>> loops;
    {
      py::gil_scoped_release release;
      loops = find_holes(faces);
    }
    py::list out;
    for (const std::vector<Index>& loop : loops) out.append(array_from(loop));
    return out;
  });
  m.def("_find_corners", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners,
                            const std::vector<Index>& rim, const std::vector<Index>& replaced) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    const Hole hole = make_hole({points, faces}, rim, std::nullopt, replaced);
    return std::array<Index, 3>{hole.rim[hole.corners[0]], hole.rim[hole.corners[1]], hole.rim[hole.corners[2]]};
  });
  m.def("_is_outer_border",
        [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners, const std::vector<Index>& rim) {
          const FacesRef faces = faces_from(offsets, corners);
          const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
          py::gil_scoped_release release;
          return is_outer_border({points, faces}, rim);
        });
  m.def("_mesh_sides", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners,
                          const std::vector<Index>& rim, const std::array<Index, 3>& at) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    MeshSides made;
    {
      py::gil_scoped_release release;
      made = mesh_sides({points, faces}, make_hole({points, faces}, rim, at));
      for (int i = 0; i < 3; ++i) made.sides[i].rim = made.parameters[i];
    }
    return py::make_tuple(made.sides, made.parameters, made.surroundings_error);
  });
  m.def("_fill", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners, const py::dict& options) {
    const FillOptions o = options_from(options);
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    return fill({points, faces}, o);
  });
  m.def("_fill_all", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners,
                        const std::vector<std::vector<Index>>& rims, const py::dict& options,
                        const std::vector<std::optional<std::array<Index, 3>>>& rim_corners, const py::object& progress) {
    const FillOptions o = options_from(options);
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    std::vector<std::variant<Fill, Refused>> results;
    {
      py::gil_scoped_release release;
      results = fill_all({points, faces}, rims, o, rim_corners, [&](std::size_t done) {
        const py::gil_scoped_acquire acquire;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        if (!progress.is_none()) progress(done, rims.size());
      });
    }
    py::list out;
    for (auto& result : results) {
      if (auto* filled = std::get_if<Fill>(&result)) {
        out.append(std::move(*filled));
      } else {
        const Refused& refused = std::get<Refused>(result);
        out.append(refusal_object(refused.reason, refused.where));
      }
    }
    return out;
  });
  m.def("_patch", [](const Sides& sides, const py::dict& given) {
    const FillOptions options = options_from(given);
    const py::gil_scoped_release release;
    MadePatch made = patch_from_sides(sides, options);
    return std::make_pair(std::const_pointer_cast<Surface>(made.patch), std::move(made.report.warnings));
  });
  m.def("_triangles", [](const std::shared_ptr<Surface>& patch, const std::array<std::vector<double>, 3>& parameters,
                         const std::optional<int>& resolution) {
    TriangleMesh mesh;
    {
      py::gil_scoped_release release;
      mesh = triangulate(parameters, resolution, [&](const PointsRef& b) { return patch->positions(b); });
    }
    return py::make_tuple(array_from(mesh.barycentric), mesh.triangles);
  });
  m.def("_blend", [](const std::array<std::shared_ptr<Surface>, 3>& surfaces, const std::string& method, const py::dict& own) {
    const MethodOptions options = method_options_from(own);
    py::gil_scoped_release release;
    const Method& chosen = find_method(method);
    if (!chosen.from_surfaces) throw InvalidArgument(method + " is made from three sides; use tripatch.patch");
    return std::const_pointer_cast<Surface>(chosen.from_surfaces({surfaces[0], surfaces[1], surfaces[2]}, options));
  });
}
