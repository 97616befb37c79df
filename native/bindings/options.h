// Options of a fill from Python: a dict of values that python/tripatch has checked by their types.
#pragma once

#include "bindings.h"
#include "tripatch/options.h"

/// Throws InvalidArgument where a number is out of its range. What the dict lacks keeps its default.
tripatch::FillOptions fill_options(const py::dict& given);
tripatch::MethodOptions method_options(const py::dict& given);
tripatch::HoleChoice hole_choice(const py::dict& given);
