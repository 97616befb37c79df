// Each file of this folder binds one concept; module.cpp calls them in an order in which every type is known before it is used.
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "tripatch/types.h"

namespace py = pybind11;

void bind_options(py::module_& m);
void bind_patches(py::module_& m);
void bind_bezier(py::module_& m);
void bind_smooth_triangles(py::module_& m);
void bind_attributes(py::module_& m);
void bind_blends(py::module_& m);
void bind_limit(py::module_& m);
void bind_methods(py::module_& m);
void bind_report(py::module_& m);
void bind_holes(py::module_& m);
void bind_fill(py::module_& m);
void bind_making(py::module_& m);

/// A tripatch.Refusal.
py::object refusal_object(const std::string& reason, const std::vector<tripatch::Index>& where);
