// What Szilvasi-Nagy's and Szabo's blends are made of, for drawing.
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "tripatch/constructions/szilvasi_nagy.h"

using namespace tripatch;

void bind_blends(py::module_& m) {
  shared_class<SzilvasiNagy, Surface>(
      m, "SzilvasiNagyPatch", "A blend of three surfaces with shape parameters, and its parts (Szilvasi-Nagy and Szabo 2006).")
      .def_property_readonly("shape", &SzilvasiNagy::shape, "lambda, by side")
      .def_property_readonly(
          "path",
          [](const SzilvasiNagy& patch) {
            py::list steps;
            for (const SzilvasiNagy::Step& step : patch.path()) steps.append(py::make_tuple(step.shape, step.energy));
            return steps;
          },
          "The optimizer's path: (lambda, energy) from the start to the optimum; empty where lambda was given.")
      .def("_mu",
           [](const SzilvasiNagy& patch, const Array& b) {
             Array out({Index{b.shape(0)}, Index{3}});
             for (Index k = 0; k < b.shape(0); ++k) {
               const std::array<double, 3> mu = patch.mu(b.data(k));
               std::copy(mu.begin(), mu.end(), out.mutable_data(k));
             }
             return out;
           })
      .def("_auxiliary_curve",
           [](const SzilvasiNagy& patch, int i, const std::vector<double>& t) { return array_from(patch.auxiliary_curve(i, t)); })
      .def("_correction", [](const SzilvasiNagy& patch, const Array& b) { return array_from(patch.correction(points_from(b))); })
      .def("_slope_correction",
           [](const SzilvasiNagy& patch, const Array& b) { return array_from(patch.slope_correction(points_from(b))); });
}
