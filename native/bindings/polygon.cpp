// Patches of n sides over a polygon.
#include "arrays.h"
#include "bindings.h"
#include "options.h"
#include "tripatch/annulus/annulus_fill.h"
#include "tripatch/fill/polygon_fill.h"
#include "tripatch/loops/loops_patch.h"
#include "tripatch/polygon/joined.h"
#include "tripatch/polygon/round.h"
#include "tripatch/spline/plane_patch.h"

using namespace tripatch;

namespace {

/// Places and triangles, made without Python.
template <class F>
py::tuple triangles_from(const F& make) {
  decltype(make()) made;
  {
    py::gil_scoped_release release;
    made = make();
  }
  std::vector<std::array<Index, 3>> triangles;
  for (Index f = 0; f < made.faces.size(); ++f) triangles.push_back({made.faces[f][0], made.faces[f][1], made.faces[f][2]});
  return py::make_tuple(array_from(made.uv), triangles);
}

/// Of sides alone.
void check_asked(const FillOptions& asked) {
  check_taken(asked);
  if (asked.fairing == Fairing::isometric) refuse_isometric();
}

PolygonPatchOptions asked_of_polygon(const FillOptions& asked) {
  check_asked(asked);
  return polygon_options(asked);
}

template <class Made>
Report told(const FillOptions& asked, const Made& made, double size, const char* method = polygon_method) {
  Report report;
  report_patch(made, report);
  report.method = method;
  for (Message& said : told_of_not_taken(asked, method)) report.warnings.push_back(std::move(said));
  return told_of_patch(std::move(report), size);
}

/// What is reported of a patch between loops, which has no options.
Report told_of_loops(const FillOptions& asked, const LoopsPatch& made) {
  Report report;
  Method without = {.name = "islands"};
  for (const Option& option : options()) without.lacks.emplace_back(option.name);
  std::vector<std::string> given = not_taken(without, asked);
  std::erase(given, "fairing");  // of patches it is none unless asked for
  if (asked.fairing) given.emplace_back("fairing");
  if (!given.empty()) report.warnings.push_back({Code::options_not_taken, {{"method", "islands"}, {"options", given}}});
  report.method = polygon_method;
  report.folds = made.folds;
  report.continuity.assign(made.seams.size(), SeamContinuity::g1);
  report.seam_angle_max_by_side.clear();
  report.seam_angle_rms_by_side.clear();
  double squares = 0;
  for (const SeamOfSide& seam : made.seams) {
    report.seam_angle_max_by_side.push_back(seam.angle_max);
    report.seam_angle_rms_by_side.push_back(seam.angle_rms);
    report.seam_angle_max = std::max(report.seam_angle_max, seam.angle_max);
    report.boundary_gap = std::max(report.boundary_gap, seam.gap);
    squares += seam.angle_rms * seam.angle_rms / static_cast<double>(made.seams.size());
  }
  report.seam_angle_rms = std::sqrt(squares);
  return told_of_patch(std::move(report), made.size);
}

void bind_loops(py::module_& m) {
  shared_class<LoopsSurface, Surface>(m, "LoopsPatch", "A patch in a concave outline, or with loops inside.")
      .def_property_readonly(
          "domain",
          [](const LoopsSurface& surface) {
            PlanePoints corners(static_cast<Index>(surface.sides()), 2);
            for (Index i = 0; i < corners.rows(); ++i) corners.row(i) = surface.on_side(static_cast<std::size_t>(i), 0);
            return array_from(corners);
          },
          "(n, 2) the corners of all loops, the outer one first.")
      .def("_on_side", [](const LoopsSurface& surface, std::size_t i, const std::vector<double>& t) {
        PlanePoints places(static_cast<Index>(t.size()), 2);
        for (std::size_t k = 0; k < t.size(); ++k) places.row(static_cast<Index>(k)) = surface.on_side(i, t[k]);
        return array_from(places);
      });
  m.def("_loops_patch", [](const std::vector<std::vector<Side>>& loops, const py::dict& given, const py::object& progress) {
    const FillOptions asked = fill_options(given);
    check_asked(asked);
    LoopsPatch made;
    interruptibly([&] { made = loops_patch(loops); }, progress);
    return py::make_tuple(std::const_pointer_cast<LoopsSurface>(made.patch), told_of_loops(asked, made));
  });
  m.def("_loops_triangles", [](const std::shared_ptr<LoopsSurface>& patch, const std::vector<std::vector<double>>& parameters,
                               const std::optional<int>& resolution) {
    LoopsTriangles made;
    interruptibly([&] { made = triangulate_loops(*patch, parameters, resolution); });
    return py::make_tuple(array_from(made.uv), made.triangles);
  });
}

}  // namespace

void bind_polygon(py::module_& m) {
  bind_loops(m);
  shared_class<OverPolygon, Surface>(m, "PolygonPatch", "A patch over a convex polygon.")
      .def_property_readonly(
          "domain",
          [](const OverPolygon& surface) {
            PlanePoints corners(surface.domain().sides(), 2);
            for (int i = 0; i < surface.domain().sides(); ++i) corners.row(i) = surface.domain().corner(i);
            return array_from(corners);
          },
          "(n, 2) the corners of the polygon; side i runs from corner i to corner i + 1. Two: of a lens between two parabolas.")
      .def("_on_side", [](const OverPolygon& surface, int i, const std::vector<double>& t) {
        PlanePoints places(static_cast<Index>(t.size()), 2);
        for (std::size_t k = 0; k < t.size(); ++k) places.row(static_cast<Index>(k)) = surface.domain().on_side(i, t[k]);
        return array_from(places);
      });
  shared_class<RoundSurface, Surface>(m, "RoundPatch", "A patch over the unit disc.")
      .def_property_readonly(
          "domain",
          [](const RoundSurface&) {
            PlanePoints places(64, 2);
            for (int k = 0; k < 64; ++k) places.row(k) = on_circle(k / 64.0);
            return array_from(places);
          },
          "(64, 2) places on the unit circle, the first where the side begins.");
  shared_class<PlanePatch, Surface>(m, "PlanePatch", "A surface over a plane, for any rim.")
      .def_property_readonly(
          "domain", [](const PlanePatch& surface) { return array_from(surface.rim()); },
          "(r, 2) the places of the rim's vertices, of islands those after them.");
  shared_class<OverAnnulus, Surface>(m, "RingPatch", "A patch between two closed sides.")
      .def("_on_side",
           [](const OverAnnulus& surface, int i, const std::vector<double>& t) { return array_from(surface.on_side(i, t)); });
  m.def("_joined_side", [](const std::vector<Side>& pieces, const std::vector<std::vector<double>>& parameters) {
    JoinedSide made = joined(pieces, parameters);
    return py::make_tuple(std::move(made.side), std::move(made.parameters));
  });
  m.def("_evenly_run", &evenly_run, py::call_guard<py::gil_scoped_release>());
  m.def("_round_patch", [](const Side& side, const py::dict& given, const py::object& progress) {
    const FillOptions asked = fill_options(given);
    const PolygonPatchOptions options = asked_of_polygon(asked);
    RoundPatch made;
    interruptibly([&] { made = round_patch(side, options); }, progress);
    return py::make_tuple(std::const_pointer_cast<RoundSurface>(made.patch), told(asked, made, 0));
  });
  m.def("_ring_patch", [](const std::array<Side, 2>& sides, const py::dict& given, const py::object& progress) {
    const FillOptions asked = fill_options(given);
    check_asked(asked);
    check_count(asked.continuity, 2, "continuity");
    const std::vector<SideContinuity> continuity = asked.continuity.values();
    std::shared_ptr<OverAnnulus> made;
    interruptibly(
        [&] {
          made =
              std::make_shared<OverAnnulus>(annulus_patch(sides[0], sides[1], {{continuity.front(), continuity.back()}, {1, 1}}));
        },
        progress);
    return py::make_tuple(made, told(asked, made->made(), 0, annulus_method));
  });
  m.def("_ring_triangles", [](const std::shared_ptr<OverAnnulus>& patch, const std::array<std::vector<double>, 2>& parameters,
                              const std::optional<int>& resolution) {
    return triangles_from([&] { return triangulate_annulus(*patch, parameters[0], parameters[1], resolution); });
  });
  m.def("_polygon_triangles", [](const std::shared_ptr<OverPolygon>& patch, const std::vector<std::vector<double>>& parameters,
                                 const std::optional<int>& resolution) {
    return triangles_from([&] { return triangulate_polygon(*patch, parameters, resolution); });
  });
  m.def("_disc_triangles", [](const std::shared_ptr<RoundSurface>& patch, const std::array<std::vector<double>, 1>& parameters,
                              const std::optional<int>& resolution) {
    return triangles_from([&] { return triangulate_disc(*patch, parameters[0], resolution); });
  });
  m.def("_polygon_patch", [](const std::vector<Side>& sides, const py::dict& given, const py::object& progress) {
    const FillOptions asked = fill_options(given);
    PolygonPatchOptions options = asked_of_polygon(asked);
    options.past_hooks = true;  // there is no spline to fall back to
    PolygonPatch made;
    interruptibly([&] { made = polygon_patch(sides, options); }, progress);
    return py::make_tuple(std::const_pointer_cast<Surface>(made.patch),
                          told(asked, made, polygon_size(*made.patch, made.domain)));
  });
}
