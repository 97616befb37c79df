// A baseline: CGAL's triangulate, refine and fair.
//   cgal_fill IN CONTINUITY REPETITIONS [OUT]
// IN: a line "vertices faces", then a line for each vertex and each triangle, then the two vertices of one border edge of the hole.
// OUT: a line "vertices faces", then all vertices, the given ones first, and the new triangles.
// Prints a line: the triangles of the fill, then the CPU seconds of each repetition, arrays in to arrays out. Without arguments: the
// version of CGAL.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace processing = CGAL::Polygon_mesh_processing;

int main(int argc, char** argv) {
  if (argc == 1) std::puts(CGAL_VERSION_STR);
  if (argc < 4) return 2;
  std::ifstream in(argv[1]);
  std::size_t vertex_count = 0, face_count = 0;
  in >> vertex_count >> face_count;
  std::vector<std::array<double, 3>> points(vertex_count);
  std::vector<std::array<std::size_t, 3>> triangles(face_count);
  for (auto& p : points) in >> p[0] >> p[1] >> p[2];
  for (auto& t : triangles) in >> t[0] >> t[1] >> t[2];
  std::size_t a = 0, b = 0;
  in >> a >> b;
  if (!in) return 2;

  Mesh mesh;
  std::vector<Mesh::Face_index> new_faces;
  std::vector<double> seconds;
  for (int k = std::atoi(argv[3]); k > 0; --k) {
    mesh = Mesh();
    new_faces.clear();
    std::vector<Mesh::Vertex_index> vertices;
    for (const auto& p : points) vertices.push_back(mesh.add_vertex({p[0], p[1], p[2]}));
    for (const auto& t : triangles) mesh.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
    // the data structure is CGAL's own input: what it takes to make it is not charged
    const std::clock_t start = std::clock();
    std::vector<Mesh::Vertex_index> new_vertices;
    processing::triangulate_refine_and_fair_hole(mesh, mesh.halfedge(vertices[a], vertices[b]), std::back_inserter(new_faces),
                                                 std::back_inserter(new_vertices),
                                                 CGAL::parameters::fairing_continuity(std::atoi(argv[2])));
    seconds.push_back(double(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::printf("%zu", new_faces.size());
  for (double s : seconds) std::printf(" %.6f", s);
  std::printf("\n");
  if (argc < 5) return 0;
  std::ofstream out(argv[4]);
  out.precision(17);
  out << mesh.number_of_vertices() << ' ' << new_faces.size() << '\n';
  for (const auto v : mesh.vertices()) out << mesh.point(v) << '\n';
  for (const auto f : new_faces) {
    for (const auto v : vertices_around_face(mesh.halfedge(f), mesh)) out << v.idx() << ' ';
    out << '\n';
  }
}
