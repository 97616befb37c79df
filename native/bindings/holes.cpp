// Borders of a mesh, their corners, and the sides that its faces give them.
#include "arrays.h"
#include "bindings.h"
#include "connected_mesh.h"
#include "options.h"
#include "tripatch/boundary/mesh_sides.h"
#include "tripatch/creases/features.h"
#include "tripatch/estimate/local_mesh.h"
#include "tripatch/hole/choose_holes.h"
#include "tripatch/hole/clear_corners.h"
#include "tripatch/hole/corners.h"
#include "tripatch/hole/hole.h"
#include "tripatch/hole/islands.h"
#include "tripatch/hole/joined_mesh.h"
#include "tripatch/hole/near_duplicates.h"
#include "tripatch/hole/rim_checks.h"
#include "tripatch/hole/rim_shape.h"
#include "tripatch/hole/sharp_sides.h"
#include "tripatch/math/tolerances.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/report/passages.h"
#include "tripatch/spline/disc.h"

using namespace tripatch;

namespace {

py::list listed(const std::vector<std::vector<Index>>& loops) {
  py::list out;
  for (const std::vector<Index>& loop : loops) out.append(array_from(loop));
  return out;
}

py::object joined_borders(ConnectedMesh& connected, std::optional<double> distance) {
  JoinedBorders joined;
  {
    py::gil_scoped_release release;
    const double within = distance.value_or(tolerance::same * size_of(connected.mesh()));
    joined = join_borders(connected.mesh(), connected.loops(), within, distance.has_value());
  }
  if (joined.stands.empty()) return py::none();
  py::list splits;
  for (const EdgeSplit& each : joined.splits) splits.append(py::make_tuple(each.face, each.corner, each.vertex, each.t));
  return py::make_tuple(array_from(joined.faces.offsets), array_from(joined.faces.corners), array_from(joined.own),
                        array_from(joined.stands), splits);
}

bool has_sharp_sides(const ConnectedMesh& connected, const std::vector<Index>& rim) {
  try {
    const std::vector<Index> corners = detect_corners(connected.mesh(), connected.around(), rim);
    return corners.size() > 1 && any_sharp(sharp_sides(connected.mesh(), connected.around(), rim, corners));
  } catch (const Refusal&) {  // faces without area tell nothing
    return false;
  }
}

/// Whether what fills a hole looks at vertices only whose faces are all known. loops: its rim and islands.
bool looks_within(const ConnectedMesh& connected, const std::vector<std::vector<Index>>& loops, const py::array_t<bool>& known) {
  constexpr int beyond = 4;  // rings: neighbors of neighbors are looked at too
  const auto are_known = [known = known.unchecked<1>()](const Rings& rings) {
    return std::ranges::all_of(rings.vertices, [&](const std::vector<Index>& ring) {
      return &ring == &rings.vertices.back() || std::ranges::all_of(ring, [&](Index v) { return known(v); });
    });
  };
  const py::gil_scoped_release release;
  const Mesh& mesh = connected.mesh();
  double across = 0;
  std::vector<Index> all;
  for (const std::vector<Index>& loop : loops) {
    across = std::max(across, diameter(mesh, loop));
    all.insert(all.end(), loop.begin(), loop.end());
  }
  const Index edges = std::ssize(all);
  const int far = static_cast<int>(std::max<Index>(edges, max_crease_rings));
  const bool sharp = loops.size() == 1 && has_sharp_sides(connected, loops[0]);
  if (!are_known(rings_around(connected.around(), all, sharp ? far + beyond : max_rings + 2))) return false;
  const Disc disc = disc_around(mesh, connected.around(), loops, crease_reach * across, far, max_triangles_around(edges));
  return are_known(rings_around(connected.around(), disc.vertices, beyond));
}

void bind_borders(py::module_& m) {
  py::class_<ConnectedMesh> connected_mesh(m, "ConnectedMesh");
  define_constructor<Array, IndexArray, py::array>(connected_mesh, [](Array vertices, IndexArray offsets, py::array corners) {
    return ConnectedMesh(std::move(vertices), std::move(offsets), std::move(corners));
  });
  connected_mesh.def("borders", [](ConnectedMesh& connected) { return listed(connected.loops()); })
      .def("unclosed", [](ConnectedMesh& connected) { return listed(connected.unclosed()); })
      .def("outer_borders",
           [](ConnectedMesh& connected) {
             std::vector<std::vector<Index>> outer;
             for (const Border& border : connected.borders())
               if (border.outer) outer.push_back(border.loop);
             return listed(outer);
           })
      .def("chosen",
           [](ConnectedMesh& connected, const py::dict& options) {
             const HoleChoice choice = hole_choice(options);
             std::vector<std::vector<Index>> loops;
             {
               py::gil_scoped_release release;
               loops = chosen_among(connected.borders(), connected.mesh(), connected.around(), choice);
             }
             return listed(loops);
           })
      .def("join_borders", &joined_borders)
      .def("looks_within", &looks_within)
      .def("holes",
           [](ConnectedMesh& connected, const py::dict& options, bool islands) {
             const HoleChoice choice = hole_choice(options);
             Holes holes;
             {
               py::gil_scoped_release release;
               holes =
                   holes_among(connected.borders(), connected.unclosed(), connected.mesh(), connected.around(), choice, islands);
             }
             py::dict refused;
             for (std::size_t k = 0; k < holes.rims.size(); ++k)
               if (holes.refused[k]) refused[py::int_(k)] = refusal_object(*holes.refused[k], {});
             return py::make_tuple(holes.rims, holes.islands, refused, holes.outer, holes.borders);
           })
      .def("refusals",
           [](const ConnectedMesh& connected, const std::vector<std::vector<Index>>& rims) {
             py::list found;
             for (const std::vector<Index>& rim : rims) {
               try {
                 check_finite(connected.mesh(), connected.around(), check_topology(connected.around(), rim));
                 found.append(py::none());
               } catch (const CodedRefusal& refusal) {
                 found.append(refusal_object(refusal.message(), refusal.also()));
               }
             }
             return found;
           })
      .def("islands", [](const ConnectedMesh& connected, const std::vector<std::vector<Index>>& loops, bool parts) {
        py::gil_scoped_release release;
        return islands_of(connected.mesh(), connected.around(), loops, parts);
      });
}

void bind_joined(py::module_& m) {
  py::class_<JoinedMesh> joined_mesh(m, "JoinedMesh");
  define_constructor<std::vector<Index>, std::vector<Index>, std::vector<Index>, std::vector<Index>>(
      joined_mesh,
      [](std::vector<Index> offsets, std::vector<Index> corners, const std::vector<Index>& own, std::vector<Index> stands) {
        Faces faces;
        faces.offsets = std::move(offsets);
        faces.corners = std::move(corners);
        return JoinedMesh(std::move(faces), own, std::move(stands));
      });
  joined_mesh
      .def("in_mesh", [](const JoinedMesh& joined, const std::vector<Index>& loop) { return array_from(joined.in_mesh(loop)); })
      .def("bring_back", &JoinedMesh::bring_back);
}

void bind_passages(py::module_& m) {
  m.def("_passages_of_faces", [](const Array& vertices, const IndexArray& offsets, const py::array& corners,
                                 const std::vector<Index>& fill_of_face, const std::optional<Subdivision>& subdivision) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    std::vector<std::optional<Vec3>> found;
    interruptibly([&] { found = passages({points, faces}, fill_of_face, subdivision); });
    py::list out;
    for (const std::optional<Vec3>& each : found) out.append(place(each));
    return out;
  });
}

}  // namespace

void bind_holes(py::module_& m) {
  bind_borders(m);
  bind_joined(m);
  bind_passages(m);
  m.attr("surrounding_rings") = max_rings + 1;
  m.def("_find_holes", [](const IndexArray& offsets, const py::array& corners) {
    const FacesRef faces = faces_from(offsets, corners);
    std::vector<std::vector<Index>> loops;
    {
      py::gil_scoped_release release;
      loops = find_holes(faces);
    }
    return listed(loops);
  });
  m.def("_find_corners", [](const Array& vertices, const IndexArray& offsets, const py::array& corners,
                            const std::vector<Index>& rim, const std::vector<Index>& replaced, bool any_number) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    std::vector<Index> found;
    if (any_number) {
      const Connectivity around = Connectivity::around({points, faces}, rim, max_rings, replaced);
      const std::vector<Index> loop = check_topology(around, rim);
      for (Index place : corners_of_fill({points, faces}, around, loop)) found.push_back(loop[place]);
    } else {
      const Hole hole = make_hole({points, faces}, rim, std::nullopt, replaced);
      for (Index place : hole.corners) found.push_back(hole.rim[place]);
    }
    return found;
  });
  m.def("_is_outer_border", [](const Array& vertices, const IndexArray& offsets, const py::array& corners,
                               const std::vector<Index>& rim, bool of_sheet) {
    const FacesRef faces = faces_from(offsets, corners);
    const Eigen::Map<const Points> points(vertices.data(), vertices.shape(0), 3);
    py::gil_scoped_release release;
    return is_outer_border({points, faces}, rim, of_sheet);
  });
  m.def("_mesh_sides", [](const Array& vertices, const IndexArray& offsets, const py::array& corners,
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
