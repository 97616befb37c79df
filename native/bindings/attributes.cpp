// What new vertices take over from the rim, and normals.
#include <pybind11/stl.h>

#include "arrays.h"
#include "bindings.h"
#include "tripatch/math/angle.h"
#include "tripatch/mesh/vertex_normals.h"
#include "tripatch/output/attribute_weights.h"

using namespace tripatch;

namespace {

AttributeWeights weights_from(const Array& rim, const Array& inside, const std::vector<Index>& loops) {
  const auto values = [](const Array& a) -> Values { return Eigen::Map<const Values>(a.data(), a.shape(0), a.shape(1)); };
  return AttributeWeights(values(rim), values(inside), loops);
}

/// (k, terms) ends, or weights, of all points.
template <class Out, class Pick>
Out rows_of(const AttributeWeights& weights, const Pick& pick) {
  Out out({weights.points(), weights.terms()});
  std::vector<Index> ends(weights.terms());
  std::vector<double> by(weights.terms());
  for (Index k = 0; k < weights.points(); ++k) {
    weights.row(k, ends.data(), by.data());
    std::copy_n(pick(ends, by), weights.terms(), out.mutable_data(k));
  }
  return out;
}

}  // namespace

void bind_attributes(py::module_& m) {
  py::class_<AttributeWeights> weights(m, "AttributeWeights",
                                       "Weights, at points inside, of values that are given at both ends of every rim edge.");
  define_constructor<const Array&, const Array&, const std::vector<Index>&>(weights, weights_from);
  weights
      .def_property_readonly(
          "ends",
          [](const AttributeWeights& w) {
            return rows_of<IndexArray>(w, [](const auto& ends, const auto&) { return ends.data(); });
          },
          "(k, m) the ends that each point takes from: 2 e is the start of rim edge e, 2 e + 1 its end.")
      .def_property_readonly(
          "weights",
          [](const AttributeWeights& w) { return rows_of<Array>(w, [](const auto&, const auto& by) { return by.data(); }); },
          "(k, m) their weights; every row sums to 1.")
      .def_property_readonly(
          "nearest", [](const AttributeWeights& w) { return array_from(w.nearest()); },
          "(k,) the end of the largest weight, for what cannot be blended.")
      .def("_blend", [](const AttributeWeights& w, const Array& values) {
        const Eigen::Map<const Values> at_ends(values.data(), values.shape(0), values.shape(1));
        Values blended;
        {
          py::gil_scoped_release release;
          blended = w.blend(at_ends);
        }
        Array out({blended.rows(), blended.cols()});
        std::copy_n(blended.data(), blended.size(), out.mutable_data());
        return out;
      });
  m.def("_vertex_normals",
        [](const Array& vertices, const IndexArray& offsets, const py::array& corners, const Array& corner_normals) {
          const FacesRef faces = faces_from(offsets, corners);
          const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
          return array_from(vertex_normals({points, faces}, points_from(corner_normals)));
        });
  m.def("_angles", [](const Array& a, const Array& b) {
    Array out(a.shape(0));
    for (Index k = 0; k < a.shape(0); ++k) out.mutable_at(k) = degrees_between(Vec3::Map(a.data(k)), Vec3::Map(b.data(k)));
    return out;
  });
}
