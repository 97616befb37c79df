// Patches and sides, and what is made of them: a patch from sides, a blend of surfaces, triangles on a patch.
#include <pybind11/functional.h>

#include "arrays.h"
#include "bindings.h"
#include "options.h"
#include "tripatch/annulus/annulus_patch.h"
#include "tripatch/boundary/poles.h"
#include "tripatch/fairing/curvature.h"
#include "tripatch/fairing/energy.h"
#include "tripatch/fill.h"
#include "tripatch/loops/loops_patch.h"
#include "tripatch/output/triangulate.h"
#include "tripatch/polygon/fair.h"
#include "tripatch/polygon/round.h"
#include "tripatch/spline/plane_patch.h"

using namespace tripatch;

namespace {

/// Of the larger of both: what a derivative that is given may differ from that of the curve. Differences of doubles are off by 1e-8.
constexpr double same_derivative = 1e-5;
/// Where they are compared, and at how many of these places they may differ: edges of CAD programs change their speed at once where
/// faces next to them end, and a polynomial has no two derivatives there.
constexpr int derivative_places = 64, max_kinks = 8;

/// A Python callable of t (k,) -> (k, 3) as a field of the side.
PiecewisePolynomial sampled(const py::function& f, const char* name) {
  return PiecewisePolynomial::fit(
      [&](std::span<const double> t, std::span<double> out) {
        Array parameters(static_cast<Index>(t.size()));
        std::copy(t.begin(), t.end(), parameters.mutable_data());
        const Array values = Array::ensure(f(parameters));
        const std::string call = std::string(name) + "(t)";
        if (!values) {
          PyErr_SetObject(PyExc_TypeError, message_object({Code::not_numbers, {{"name", call}}}).ptr());
          throw py::error_already_set();
        }
        if (values.ndim() != 2 || values.shape(0) != static_cast<Index>(t.size()) || values.shape(1) != 3)
          throw CodedArgument(Code::wrong_shape, {{"name", call}, {"shape", "(" + std::to_string(t.size()) + ", 3)"}});
        std::copy_n(values.data(), values.size(), out.begin());
        for (std::size_t k = 0; k < out.size(); ++k)
          if (!std::isfinite(out[k]))
            throw CodedArgument(Code::not_finite, {{"name", std::string(name) + "(" + std::to_string(t[k / 3]) + ")"}});
      },
      3);
}

Side side_from_functions(const py::function& c, const py::function& dc, const py::function& r, const std::vector<double>& rim,
                         const std::optional<py::function>& q) {
  Side side{sampled(c, "c"), sampled(r, "r"), q ? sampled(*q, "q") : PiecewisePolynomial(), rim};
  // The side's own derivative is that of c, exactly; dc only has to agree.
  const PiecewisePolynomial given = sampled(dc, "dc");
  double scale = 0;
  std::array<double, derivative_places + 1> off;
  for (int k = 0; k <= derivative_places; ++k) {
    const double t = static_cast<double>(k) / derivative_places;
    const Vec3 mine = side.c.derivative_at(t), theirs = given(t);
    scale = std::max({scale, mine.norm(), theirs.norm()});
    off[k] = (mine - theirs).norm();
  }
  const auto differ = std::count_if(off.begin(), off.end(), [&](double d) { return d > same_derivative * scale; });
  if (differ > max_kinks) throw CodedArgument(Code::not_the_derivative, {{"name", "dc"}, {"function", "c"}});
  return without_poles(std::move(side));
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

py::tuple state_of(const PiecewisePolynomial& field) {
  const std::span<const double> coefficients = field.coefficients();
  return py::make_tuple(field.breaks(), field.degree(), field.dimension(),
                        std::vector<double>(coefficients.begin(), coefficients.end()));
}

PiecewisePolynomial field_from(const py::handle& state) {
  auto [breaks, degree, dimension, coefficients] = state.cast<std::tuple<std::vector<double>, int, int, std::vector<double>>>();
  if (breaks.size() < 2) return {};
  return {std::move(breaks), degree, dimension, std::move(coefficients)};
}

/// (k, 3) the second derivative across, or None where it is not known.
py::object second_derivative(const Side& side, const Array& t) {
  if (side.q.empty()) return py::none();
  Array q({static_cast<Index>(t.size()), Index{3}});
  for (Index k = 0; k < t.size(); ++k) side.q.taylor(t.data()[k], 0, q.mutable_data(k));
  return q;
}

}  // namespace

void bind_patches(py::module_& m) {
  shared_class<Surface>(m, "Patch", py::dynamic_attr(), "A surface over the triangle.")
      .def("_evaluate", &evaluate<Surface>)
      .def(
          "_energy",
          [](const Surface& surface, const std::string& name) {
            const Fairing of = named<Fairing>(name, "energy");
            if (of == Fairing::isometric) refuse_isometric();
            if (const auto* polygon = dynamic_cast<const PolygonSurface*>(&surface))
              return polygon_energy(surface, polygon->domain(), of, polygon_size(surface, polygon->domain()));
            if (dynamic_cast<const RoundSurface*>(&surface)) return round_energy(surface, of);
            if (dynamic_cast<const OverAnnulus*>(&surface) || dynamic_cast<const PlanePatch*>(&surface) ||
                dynamic_cast<const LoopsSurface*>(&surface))
              throw CodedArgument(Code::no_energy, {});
            return energy(surface, of, size_of(surface));
          },
          py::call_guard<py::gil_scoped_release>())
      .def("_normal",
           [](const Surface& surface, const Array& b) {
             Array normals({b.shape(0), Index{3}});
             double* const out = normals.mutable_data();
             interruptibly([&] { surface.positions_and_normals(rows_of(b), nullptr, out); });
             return normals;
           })
      .def("_positions_and_normals", [](const Surface& surface, const Array& b) {
        Array positions({b.shape(0), Index{3}}), normals({b.shape(0), Index{3}});
        double *const to = positions.mutable_data(), *const beside = normals.mutable_data();
        interruptibly([&] { surface.positions_and_normals(rows_of(b), to, beside); });
        return std::make_pair(positions, normals);
      });
  m.def("_first_outside", [](const Array& b, double off) { return first_outside(rows_of(b), off); });

  py::class_<Side> side(m, "Side", "A side of the hole: position and the derivative of the surroundings across it.");
  side.def_static("_from_functions", &side_from_functions)
      .def("_evaluate", &evaluate_side)
      .def("_second_derivative", &second_derivative)
      .def("_part", &piece_of)
      .def("__getstate__",
           [](const Side& side) {
             return py::make_tuple(state_of(side.c), state_of(side.r), state_of(side.q), side.rim, side.curvature_error);
           })
      .def("_moved", [](const Side& side, const std::array<double, 3>& start, const std::array<double, 3>& end) {
        return moved_ends(side, {start[0], start[1], start[2]}, {end[0], end[1], end[2]});
      });
  define_constructor<const py::tuple&>(
      side,
      [](const py::tuple& state) {
        return Side{field_from(state[0]), field_from(state[1]), field_from(state[2]), state[3].cast<std::vector<double>>(),
                    state[4].cast<double>()};
      },
      "__setstate__");
}

void bind_making(py::module_& m) {
  m.def("_patch", [](const Sides& sides, const py::dict& given, const py::object& progress) {
    const FillOptions options = fill_options(given);
    check_taken(options);
    MadePatch made;
    interruptibly(
        [&] {
          made = patch_from_sides(sides, options);
          measure_seam(*made.patch, sides, made.report);
        },
        progress);
    made.report.method = options.method == automatic_method ? patch_method : options.method;
    for (Message& said : told_of_not_taken(options, patch_method)) made.report.warnings.push_back(std::move(said));
    return std::make_pair(std::const_pointer_cast<Surface>(made.patch),
                          told_of_patch(std::move(made.report), size_of(*made.patch)));
  });
  m.def("_triangles", [](const std::shared_ptr<Surface>& patch, const std::array<std::vector<double>, 3>& parameters,
                         const std::optional<int>& resolution) {
    TriangleMesh mesh;
    interruptibly([&] { mesh = triangulate(parameters, resolution, *patch); });
    return py::make_tuple(array_from(mesh.barycentric), mesh.triangles);
  });
  m.def("_blend", [](const std::array<std::shared_ptr<Surface>, 3>& surfaces, const std::string& method, const py::dict& own) {
    const MethodOptions options = method_options(own);
    py::gil_scoped_release release;
    const Method& chosen = find_method(method);
    if (!chosen.from_surfaces)
      throw CodedArgument(Code::method_of_function, {{"method", method}, {"function", "tripatch.patch"}});
    const std::array<SurfacePtr, 3> constituents = {surfaces[0], surfaces[1], surfaces[2]};
    const SurfacePtr patch = chosen.from_surfaces(constituents, options);
    Report report;
    report.method = method;
    report.continuity.assign(3, chosen.continuity);
    measure_seam(*patch, constituents, report);
    return std::make_pair(std::const_pointer_cast<Surface>(patch), told_of_patch(std::move(report), size_of(*patch)));
  });
}
