// Faces in a file that may be larger than the memory.
#include "tripatch/mesh/face_rows.h"

#include <optional>

#include "arrays.h"
#include "bindings.h"

using namespace tripatch;

namespace {

std::span<const std::byte> bytes_in(const py::buffer_info& info) {
  return {static_cast<const std::byte*>(info.ptr), static_cast<std::size_t>(info.size * info.itemsize)};
}

/// The rows, and the bytes that they are in.
struct FaceFile {
  py::buffer_info info;
  FaceRows rows;
};

using Lists = std::vector<std::tuple<std::size_t, std::string, std::size_t>>;

FaceFile face_file(const py::buffer& data, std::size_t first, Index count, const Lists& lists, std::size_t after,
                   std::size_t corners, const std::string& kind, bool swapped, Index vertices) {
  RowLayout layout{{}, after, corners, kind.at(0), swapped};
  for (const auto& [before, of_count, size] : lists) layout.lists.push_back({before, of_count.at(0), size});
  py::buffer_info info = data.request();
  const std::span<const std::byte> bytes = bytes_in(info);
  std::optional<FaceRows> rows;
  {
    const py::gil_scoped_release release;
    rows.emplace(bytes, first, count, std::move(layout), vertices);
  }
  return {std::move(info), std::move(*rows)};
}

py::array_t<std::size_t> starts_array(const std::vector<std::size_t>& from) {
  return py::array_t<std::size_t>(static_cast<Index>(from.size()), from.data());
}

template <class Array>
std::span<const typename Array::value_type> values_in(const Array& array) {
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// Of (buffer, first byte, bytes of a row, bytes before x, y and z, their kinds, whether they are swapped).
using PlacesIn = std::tuple<py::buffer, std::size_t, std::size_t, std::array<std::size_t, 3>, std::string, bool>;

PointRows points_in(const PlacesIn& places, const py::buffer_info& info) {
  const auto& [data, first, stride, at, kinds, swapped] = places;
  return {bytes_in(info).subspan(first), stride, at, {kinds.at(0), kinds.at(1), kinds.at(2)}, swapped};
}

template <class Found>
Found of_boxes(const FaceFile& file, Found (FaceRows::*find)(const PointRows&, const Eigen::Ref<const Eigen::MatrixXd>&) const,
               const PlacesIn& places, const Array& boxes) {
  const py::buffer_info info = std::get<0>(places).request();
  const PointRows points = points_in(places, info);
  const Eigen::MatrixXd all =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::RowMajor>>(boxes.data(), boxes.shape(0), 6);
  const py::gil_scoped_release release;
  return (file.rows.*find)(points, all);
}

}  // namespace

void bind_face_rows(py::module_& m) {
  m.def("_box_of_rows", [](const PlacesIn& places, Index rows) {
    const py::buffer_info info = std::get<0>(places).request();
    const PointRows points = points_in(places, info);
    std::array<Vec3, 2> box;
    {
      const py::gil_scoped_release release;
      box = points.box(rows);
    }
    return py::make_tuple(place(box[0]), place(box[1]));
  });
  py::class_<FaceFile> face_rows(m, "FaceRows");
  define_constructor<const py::buffer&, std::size_t, Index, const Lists&, std::size_t, std::size_t, const std::string&, bool,
                     Index>(face_rows, face_file);
  face_rows.def_property_readonly("end", [](const FaceFile& file) { return file.rows.end(); })
      .def_property_readonly("faces", [](const FaceFile& file) { return file.rows.faces(); })
      .def_property_readonly("portions", [](const FaceFile& file) { return file.rows.portions(); })
      .def("at_borders", [](const FaceFile& file) { return array_from(file.rows.at_borders()); })
      .def("around",
           [](FaceFile& file, const IndexArray& vertices, int rings, const py::array_t<std::size_t, py::array::forcecast>& more) {
             const std::span<const Index> from = values_in(vertices);
             const std::span<const std::size_t> also = values_in(more);
             FacePart part;
             {
               const py::gil_scoped_release release;
               part = file.rows.around(from, rings, also);
             }
             const py::array_t<bool> known(static_cast<Index>(part.known.size()),
                                           reinterpret_cast<const bool*>(part.known.data()));
             return py::make_tuple(array_from(part.vertices), known, py::bytes(part.rows), starts_array(part.starts));
           })
      .def("connected",
           [](const FaceFile& file, const IndexArray& asked, const IndexArray& without) {
             const std::span<const Index> some = values_in(asked), others = values_in(without);
             std::vector<Index> found;
             {
               const py::gil_scoped_release release;
               found = file.rows.connected(some, others);
             }
             return array_from(found);
           })
      .def("count_meeting", [](const FaceFile& file, const PlacesIn& places,
                               const Array& boxes) { return of_boxes(file, &FaceRows::count_meeting, places, boxes); })
      .def("meeting", [](const FaceFile& file, const PlacesIn& places,
                         const Array& boxes) { return of_boxes(file, &FaceRows::meeting, places, boxes); })
      .def("widened", [](const FaceFile& file, std::size_t portion, std::size_t by) {
        std::string rows;
        {
          const py::gil_scoped_release release;
          rows = file.rows.widened(portion, by);
        }
        return py::bytes(rows);
      });
}
