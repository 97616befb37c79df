// Borders of a mesh, their corners, and the sides that its faces give them.
#include "arrays.h"
#include "bindings.h"
#include "options.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/estimate/local_mesh.h"
#include "tripatch/hole/choose_holes.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/hole.h"
#include "tripatch/hole/outer_borders.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/unjoined.h"

using namespace tripatch;

namespace {

py::list listed(const std::vector<std::vector<Index>>& loops) {
  py::list out;
  for (const std::vector<Index>& loop : loops) out.append(array_from(loop));
  return out;
}

}  // namespace

void bind_holes(py::module_& m) {
  m.attr("surrounding_rings") = most_rings + 1;
  m.def("_find_holes", [](const IndexArray& offsets, const IndexArray& corners) {
    const FacesRef faces = faces_from(offsets, corners);
    std::vector<std::vector<Index>> loops;
    {
      py::gil_scoped_release release;
      loops = find_holes(faces);
    }
    return listed(loops);
  });
  m.def("_choose_holes",
        [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners, const py::dict& options) {
          const HoleChoice choice = hole_choice(options);
          const FacesRef faces = faces_from(offsets, corners);
          const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
          std::vector<std::vector<Index>> loops;
          {
            py::gil_scoped_release release;
            loops = choose_holes({points, faces}, choice);
          }
          return listed(loops);
        });
  m.def("_outer_borders", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    std::vector<std::vector<Index>> loops;
    {
      py::gil_scoped_release release;
      for (Border& border : borders_of({points, faces}))
        if (border.outer) loops.push_back(std::move(border.loop));
    }
    return listed(loops);
  });
  m.attr("not_joined") = not_joined;
  m.def("_told_of_unjoined", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners,
                                const std::vector<std::vector<Index>>& rims) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    return told_of_unjoined({points, faces}, rims);
  });
  m.def("_find_corners", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners,
                            const std::vector<Index>& rim, const std::vector<Index>& replaced, bool any_number) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    std::vector<Index> found;
    if (any_number) {
      const Connectivity around = Connectivity::around({points, faces}, rim, most_rings, replaced);
      const std::vector<Index> loop = check_topology(around, rim);
      for (Index place : corners_of_fill({points, faces}, around, loop)) found.push_back(loop[place]);
    } else {
      const Hole hole = make_hole({points, faces}, rim, std::nullopt, replaced);
      for (Index place : hole.corners) found.push_back(hole.rim[place]);
    }
    return found;
  });
  m.def("_is_outer_border", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners,
                               const std::vector<Index>& rim, bool of_sheet) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    return is_outer_border({points, faces}, rim, of_sheet);
  });
  m.def("_mesh_sides", [](const Array& vertices, const IndexArray& offsets, const IndexArray& corners,
                          const std::vector<Index>& rim, const std::array<Index, 3>& at) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    MeshSides made;
    {
      py::gil_scoped_release release;
      made = mesh_sides({points, faces}, make_hole({points, faces}, rim, at));
      for (int i = 0; i < 3; ++i) made.sides[i].rim = made.parameters[i];
    }
    return py::make_tuple(made.sides, made.parameters, made.surroundings_error);
  });
}
