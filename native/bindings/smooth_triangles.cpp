// What vertex normals determine: sides, patches of three, whole meshes of triangles made smooth.
#include "tripatch/smooth_triangles.h"

#include "arrays.h"
#include "bindings.h"
#include "tripatch/boundary/normal_sides.h"
#include "tripatch/constructions/smits_patch.h"

using namespace tripatch;

namespace {

std::array<Vec3, 3> rows(const Array& a) { return {Vec3::Map(a.data(0, 0)), Vec3::Map(a.data(1, 0)), Vec3::Map(a.data(2, 0))}; }

}  // namespace

void bind_smooth_triangles(py::module_& m) {
  py::enum_<NormalCurve>(m, "NormalCurve").value("hermite", NormalCurve::hermite).value("smits", NormalCurve::smits);
  m.def("_sides_from_normals", [](const Array& points, const Array& normals, NormalCurve curve) {
    return sides_from_normals(rows(points), rows(normals), curve);
  });

  m.def("_smits_patch", [](const Array& points, const Array& normals) {
    return std::const_pointer_cast<Surface>(smits_patch(rows(points), rows(normals)));
  });

  py::class_<SmoothMesh>(m, "SmoothMesh", "A smoothed triangle mesh.")
      .def_property_readonly("vertices", [](const SmoothMesh& s) { return array_from(s.vertices); })
      .def_property_readonly("normals", [](const SmoothMesh& s) { return array_from(s.normals); })
      .def_property_readonly("faces",
                             [](const SmoothMesh& s) {
                               IndexArray a({static_cast<Index>(s.faces.size()), Index{3}});
                               for (std::size_t f = 0; f < s.faces.size(); ++f)
                                 std::copy_n(s.faces[f].data(), 3, a.mutable_data(f));
                               return a;
                             })
      .def_property_readonly("edges",
                             [](const SmoothMesh& s) {
                               IndexArray a({static_cast<Index>(s.edges.size()), Index{2}});
                               for (std::size_t e = 0; e < s.edges.size(); ++e)
                                 std::copy_n(s.edges[e].data(), 2, a.mutable_data(e));
                               return a;
                             })
      .def_property_readonly(
          "patches",
          [](const SmoothMesh& s) {
            py::list patches;
            for (const SurfacePtr& patch : s.patches) patches.append(py::cast(std::const_pointer_cast<Surface>(patch)));
            return patches;
          },
          "A Patch for every triangle, corners in its order; of `tripatch.network` only.");
  m.def("_network", [](const Array& vertices, const IndexArray& offsets, const py::array& corners,
                       const std::vector<std::array<Index, 2>>& edges, const std::vector<Side>& sides, int resolution) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    SmoothMesh made;
    interruptibly([&] { made = network({points, faces}, edges, sides, resolution); });
    return made;
  });
  m.def("_smooth_triangles", [](const Array& vertices, const IndexArray& offsets, const py::array& corners,
                                const std::optional<Array>& normals, int resolution, NormalCurve curve, bool keep) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    std::optional<Points> given;
    if (normals) given = points_from(*normals);
    SmoothMesh smooth;
    interruptibly([&] { smooth = smooth_triangles({points, faces}, given, resolution, curve, keep); });
    return smooth;
  });
}
