// numpy arrays to and from the core's types.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "tripatch/math/jet.h"
#include "tripatch/output/fill_result.h"
#include "tripatch/types.h"

namespace py = pybind11;

using Array = py::array_t<double, py::array::c_style | py::array::forcecast>;
using IndexArray = py::array_t<tripatch::Index, py::array::c_style | py::array::forcecast>;
using ShortIndexArray = py::array_t<std::int32_t, py::array::c_style | py::array::forcecast>;

/// The arrays themselves, which must outlive it. corners: of 32 or 64 bits, one after another in memory.
inline tripatch::FacesRef faces_from(const IndexArray& offsets, const py::array& corners) {
  const auto size = static_cast<std::size_t>(corners.size());
  tripatch::FacesRef faces{{offsets.data(), static_cast<std::size_t>(offsets.size())}, {}};
  if (py::isinstance<IndexArray>(corners))
    faces.corners = std::span(static_cast<const tripatch::Index*>(corners.data()), size);
  else if (py::isinstance<ShortIndexArray>(corners))
    faces.corners = std::span(static_cast<const std::int32_t*>(corners.data()), size);
  else
    throw py::type_error("corners must be one row of int32 or int64");
  return faces;
}

inline Eigen::Map<const tripatch::Points> rows_of(const Array& a) { return {a.data(), a.shape(0), 3}; }
inline tripatch::Points points_from(const Array& a) { return rows_of(a); }

inline Array array_from(const tripatch::Points& p) {
  Array a({p.rows(), tripatch::Index{3}});
  std::copy_n(p.data(), p.size(), a.mutable_data());
  return a;
}

/// Points that belong to an object of Python, without a copy: the array keeps the object.
inline Array array_in(const py::object& owner, const tripatch::Points& p) {
  return Array({p.rows(), tripatch::Index{3}}, p.data(), owner);
}

/// None where there is none.
/// (x, y, z), or None.
inline py::object place(const std::optional<tripatch::Vec3>& p) {
  return p ? py::object(py::make_tuple(p->x(), p->y(), p->z())) : py::none();
}

inline py::object array_from(const tripatch::PlanePoints& p) {
  if (p.rows() == 0) return py::none();
  return Array({p.rows(), tripatch::Index{2}}, p.data());
}
inline py::object array_from(const Eigen::VectorXd& v) {
  if (v.size() == 0) return py::none();
  return Array(v.size(), v.data());
}

inline IndexArray array_from(const std::vector<tripatch::Index>& v) {
  return IndexArray(static_cast<tripatch::Index>(v.size()), v.data());
}

/// Places for which there is memory at a time: Taylor coefficients that stay in the cache.
constexpr tripatch::Index places_at_once = 1 << 14;

/// P, or the tuple (P, D1 (k,2,3), D2 (k,3,3), D3 (k,4,3)) up to `derivatives`, at parameters of any surface.
template <class AnySurface>
py::object evaluate(const AnySurface& surface, const Array& at, int derivatives) {
  using tripatch::Index;
  const Index n = at.shape(0), columns = at.shape(1), size = tripatch::jet_size(derivatives);
  py::tuple parts(derivatives + 1);
  std::vector<double*> out;  // by order
  for (int d = 0; d <= derivatives; ++d) {
    Array a(d == 0 ? std::vector<Index>{n, 3} : std::vector<Index>{n, d + 1, 3});
    out.push_back(a.mutable_data());
    parts[d] = std::move(a);
  }
  const double* const places = at.data();
  {
    py::gil_scoped_release release;
    if (derivatives == 0) {
      surface.evaluate(places, n, 0, out[0]);
    } else {
      constexpr std::array<double, 5> factorial = {1, 1, 2, 6, 24};
      const auto jets = std::make_unique_for_overwrite<double[]>(std::min(n, places_at_once) * size * 3);
      for (Index first = 0; first < n; first += places_at_once) {
        const Index count = std::min(places_at_once, n - first);
        surface.evaluate(places + columns * first, count, derivatives, jets.get());
        for (int d = 0; d <= derivatives; ++d)
          for (Index k = 0; k < count; ++k)
            for (int j = 0; j <= d; ++j)
              for (int x = 0; x < 3; ++x)
                *out[d]++ = factorial[d - j] * factorial[j] * jets[(k * size + tripatch::jet_index(d - j, j)) * 3 + x];
      }
    }
  }
  return derivatives == 0 ? py::object(parts[0]) : py::object(parts);
}
