// The report of a fill and the table of constructions.
#include "tripatch/report/report.h"

#include <cmath>

#include "arrays.h"
#include "bindings.h"
#include "tripatch/constructions/methods.h"
#include "tripatch/options.h"
#include "tripatch/triangulation/plane_triangles.h"

using namespace tripatch;

tripatch::Report told_of_patch(tripatch::Report report, double size) {
  tripatch::tell_folds(report);  // the worst first: a status line has room for two sentences
  tripatch::tell_gap(size, report);
  tripatch::tell_corners(report);
  return report;
}

namespace {

/// Corners of the triangles of all faces, one after another, and the face of each triangle.
std::array<std::vector<Index>, 2> triangles_of(const Eigen::Map<const Points>& vertices, const FacesRef& faces) {
  std::vector<Index> corners, of_face;
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    if (face.size() < 3) continue;
    for (Index v : face)
      if (v < 0 || v >= vertices.rows())
        throw CodedArgument(Code::no_such_vertex,
                            {{"option", "faces[" + std::to_string(f) + "]"}, {"vertex", v}, {"count", vertices.rows()}});
    Points at(static_cast<Index>(face.size()), 3);
    for (std::size_t k = 0; k < face.size(); ++k) at.row(static_cast<Index>(k)) = vertices.row(face[k]);
    for (const std::array<Index, 3>& triangle : triangulate_face(at)) {
      for (Index k : triangle) corners.push_back(face[k]);
      of_face.push_back(f);
    }
  }
  return {std::move(corners), std::move(of_face)};
}

py::object known(double value) { return std::isnan(value) ? py::object(py::none()) : py::float_(value); }
py::object told(const Reason& reason) { return reason ? message_object(*reason) : py::str(); }

/// As tripatch.candidates.Candidate, in the order of its fields.
py::list candidates_of(const Report& report) {
  const py::object type = py::module_::import("tripatch.candidates").attr("Candidate");
  py::list out;
  for (const FillCandidate& each : report.candidates) {
    static constexpr std::array names = {"used", "made", "skipped", "refused"};
    const char* const status = names[static_cast<std::size_t>(each.status)];
    const Quality& q = each.quality;
    if (each.status == CandidateStatus::used || each.status == CandidateStatus::made)
      out.append(type(each.method, status, known(q.expected_error), q.folds, q.crosses, q.exceeds_hole_bounds, known(q.seam_deg),
                      told(each.why)));
    else
      out.append(type(each.method, status, py::none(), py::none(), py::none(), py::none(), py::none(), told(each.why)));
  }
  return out;
}

py::tuple triangles_with_faces(const Array& vertices, const IndexArray& offsets, const py::array& corners) {
  const FacesRef faces = faces_from(offsets, corners);
  const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
  std::array<std::vector<Index>, 2> made;
  interruptibly([&] { made = triangles_of(points, faces); });
  return py::make_tuple(array_from(made[0]), array_from(made[1]));
}

}  // namespace

void bind_report(py::module_& m) {
  m.def("_triangles_of", triangles_with_faces);
  py::class_<Report> report(m, "Report", "Numbers of a fill: angles in degrees, time in seconds.");
  define_constructor<>(report, [] { return Report(); });
  report
      .def_readonly("seam_angle_max", &Report::seam_angle_max, "Largest angle of the fill to the surroundings used, in degrees.")
      .def_readonly("seam_angle_rms", &Report::seam_angle_rms, "Root mean square of that angle, in degrees.")
      .def_readonly("seam_angle_max_by_side", &Report::seam_angle_max_by_side, "Largest angle on each side, in degrees.")
      .def_readonly("seam_angle_rms_by_side", &Report::seam_angle_rms_by_side, "Root mean square on each side, in degrees.")
      .def_property_readonly(
          "continuity",
          [](const Report& report) {
            std::vector<std::string> names;
            for (SeamContinuity each : report.continuity) names.emplace_back(name_of(each));
            return names;
          },
          "On each side: Free, G0, G1 or G2, what was asked or what auto took; none: the patch misses its boundary.")
      .def_readonly("boundary_gap", &Report::boundary_gap,
                    "Largest distance of the patch from the boundary that it is to meet, in units of the mesh.")
      .def_readonly("corner_planes_angle", &Report::corner_planes_angle,
                    "At each corner the angle between the tangent planes of its two sides, in degrees.")
      .def_readonly(
          "corner_normals_spread", &Report::corner_normals_spread,
          "At each corner the largest angle between normals of the patch around it, in degrees: 0 where it has a tangent "
          "plane.")
      .def_readonly("surroundings_error", &Report::surroundings_error,
                    "How well the mesh determines its own tangent planes, in degrees; 0 where they are known exactly.")
      .def_readonly("fairing", &Report::fairing, "Name of the energy that was made small; empty: none.")
      .def_readonly("energy_before", &Report::energy_before,
                    "That energy before fairing; where none serves, of the one that was asked for.")
      .def_readonly("energy_after", &Report::energy_after, "That energy of the fill.")
      .def_readonly("shape_path", &Report::shape_path,
                    R"(With shape="optimal": a list of (lambda by side, energy), the last of which was taken.)")
      .def_readonly("method", &Report::method, "Name of the method used.")
      .def_property_readonly(
          "method_reason", [](const Report& report) { return told(report.method_reason); },
          "Why that method was used: a sentence (`Message`) with a `code`; empty: of a patch that was made alone.")
      .def_property_readonly(
          "candidates", candidates_of,
          "The ways to fill the hole, each a `Candidate`: the one that is used, then, with method auto and of cages, the others.")
      .def_readonly("deviation_max", &Report::deviation_max,
                    "Largest standard deviation of a new vertex, in units of the mesh; None: the method does not know it.")
      .def_readonly(
          "triangles_folded", &Report::triangles_folded,
          "Edges of new faces (of a cage: of its limit surface) that are folded by more than 120 degrees, between two of them "
          "or over the mesh's own faces beyond the rim.")
      .def_readonly("rim_folded", &Report::rim_folded,
                    "The same of the rim's own triangulation, and of faces beyond the rim that are folded over those around "
                    "them: such a rim leaves no other way.")
      .def_property_readonly("is_flawed", py::overload_cast<const Report&>(&is_flawed),
                             "Whether it folds more than its rim, crosses itself or misses its boundary.")
      .def_readonly("crosses_itself", &Report::crosses_itself,
                    "Whether new faces go through each other, which every way to fill the rim that was tried does; not looked "
                    "for in cages.")
      .def_readonly("folds", &Report::folds, "Places of a 64 x 64 grid where the patch folds over itself.")
      .def_readonly("corners", &Report::corners, "Vertex indices of the corners.")
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
      .def_readonly("rows", &Report::rows, "Quads and cages: extra rows of quads round the poles that were taken.")
      .def_readonly("cage_in_rows", &Report::cage_in_rows, "Cages: whether the rows of quads around the hole continue across it.")
      .def_readonly("poles", &Report::poles, "Quads and cages: [vertex, valence] of each inner vertex with an irregular valence.")
      .def_property_readonly(
          "warnings", [](const Report& report) { return message_objects(report.warnings); },
          "What a person should know of the fill: sentences (`Message`) with a `code`.")
      .def_readonly(
          "not_applied", &Report::not_applied,
          "Options without effect, each with a code: output, method, sides, three_sides, poles, position, fairing, vertices.")
      .def_readonly("seconds", &Report::seconds, "Time that the fill took.");
}

void bind_methods(py::module_& m) {
  py::class_<Method>(m, "Method", "A construction of the registry.")
      .def_readonly("name", &Method::name)
      .def_readonly("description", &Method::description)
      .def_readonly("citation", &Method::citation)
      .def_readonly("fills_holes", &Method::fills_holes)
      .def_property_readonly(
          "joins_sides",
          [](const Method& method) { return method.from_boundary != nullptr || method.name == std::string(polygon_method); },
          "Whether `patch` makes it between given sides.")
      .def_property_readonly("continuity", [](const Method& method) { return name_of(method.continuity); })
      .def_property_readonly(
          "sides",
          [](const Method& method) {
            return py::make_tuple(method.sides[0], method.sides[1] > 0 ? py::object(py::int_(method.sides[1])) : py::none());
          },
          "The smallest and the largest number of sides; (0, None): any rim.")
      .def_property_readonly("options", [](const Method& method) { return py::tuple(py::cast(method.options)); })
      .def(
          "takes",
          [](const Method& method, const std::string& name) {
            for (const Option& option : options())
              if (name == option.name) return takes(method, option);
            throw CodedArgument(Code::no_such_option, {{"function", "fill()"}, {"name", name}});
          },
          "Whether it reads an option of `fill`, by its name; of continuity whether it does more than tangent planes.")
      .def("__repr__", [](const Method& method) { return std::string("<tripatch method ") + method.name + ">"; });
  m.def("_methods", [] {
    py::dict all;
    for (const Method& method : methods()) all[method.name] = py::cast(&method, py::return_value_policy::reference);
    return all;
  });
}
