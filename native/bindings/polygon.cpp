// Patches of n sides over a polygon.
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "options.h"
#include "tripatch/choices.h"
#include "tripatch/polygon/patch.h"

using namespace tripatch;

void bind_polygon(py::module_& m) {
  py::class_<PolygonPatch>(m, "PolygonPatch")
      .def_property_readonly("patch", [](const PolygonPatch& p) { return std::const_pointer_cast<Surface>(p.patch); })
      .def_property_readonly("domain",
                             [](const PolygonPatch& p) {
                               PlanePoints corners(p.domain.sides(), 2);
                               for (int i = 0; i < p.domain.sides(); ++i) corners.row(i) = p.domain.corner(i);
                               return array_from(corners);
                             })
      .def_readonly("seam_angle_max", &PolygonPatch::seam_angle_max)
      .def_readonly("seam_angle_rms", &PolygonPatch::seam_angle_rms)
      .def_readonly("corner_mismatch", &PolygonPatch::corner_mismatch_deg)
      .def_readonly("continuity", &PolygonPatch::continuity)
      .def_readonly("fairing", &PolygonPatch::fairing)
      .def_readonly("energy_before", &PolygonPatch::energy_before)
      .def_readonly("energy_after", &PolygonPatch::energy_after)
      .def_readonly("folds", &PolygonPatch::folds)
      .def_readonly("warnings", &PolygonPatch::warnings);
  m.def("_polygon_patch", [](const std::vector<Side>& sides, const std::string& fairing) {
    PolygonPatchOptions options;
    if (fairing.empty()) {
      options.fairing.reset();
    } else {
      options.fairing = named<Fairing>(fairing, "fairing");
    }
    py::gil_scoped_release release;
    return polygon_patch(sides, options);
  });
}
