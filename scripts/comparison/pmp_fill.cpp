// A baseline: PMP's fill_hole, then fair with k = 3 of what is new (k = 2: fill_hole alone, which ends with it).
//   pmp_fill IN K REPETITIONS OUT
// IN, OUT and what is printed: as in cgal_fill.cpp. PMP is compiled with it, from its own sources; PMP_VERSION says which they are.
#include <pmp/algorithms/fairing.h>
#include <pmp/algorithms/hole_filling.h>
#include <pmp/surface_mesh.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <vector>

int main(int argc, char** argv) {
  if (argc == 1) std::puts(PMP_VERSION);
  if (argc < 5) return 2;
  std::ifstream in(argv[1]);
  std::size_t vertex_count = 0, face_count = 0;
  in >> vertex_count >> face_count;
  std::vector<pmp::Point> points(vertex_count);
  std::vector<std::array<pmp::IndexType, 3>> triangles(face_count);
  for (auto& p : points) in >> p[0] >> p[1] >> p[2];
  for (auto& t : triangles) in >> t[0] >> t[1] >> t[2];
  pmp::IndexType a = 0, b = 0;
  in >> a >> b;
  if (!in) return 2;

  pmp::SurfaceMesh mesh;
  std::vector<double> seconds;
  for (int k = std::atoi(argv[3]); k > 0; --k) {
    mesh = pmp::SurfaceMesh();
    for (const auto& p : points) mesh.add_vertex(p);
    for (const auto& t : triangles) mesh.add_triangle(pmp::Vertex(t[0]), pmp::Vertex(t[1]), pmp::Vertex(t[2]));
    auto rim = mesh.find_halfedge(pmp::Vertex(a), pmp::Vertex(b));
    if (!mesh.is_boundary(rim)) rim = mesh.opposite_halfedge(rim);
    const std::clock_t start = std::clock();
    pmp::fill_hole(mesh, rim);
    if (const int order = std::atoi(argv[2]); order > 2) {
      auto selected = mesh.vertex_property<bool>("v:selected");
      for (const auto v : mesh.vertices()) selected[v] = v.idx() >= vertex_count;
      pmp::fair(mesh, order);
    }
    seconds.push_back(double(std::clock() - start) / CLOCKS_PER_SEC);
  }
  std::printf("%zu", mesh.n_faces() - face_count);
  for (double s : seconds) std::printf(" %.6f", s);
  std::printf("\n");
  std::ofstream out(argv[4]);
  out.precision(17);
  out << mesh.n_vertices() << ' ' << mesh.n_faces() - face_count << '\n';
  for (const auto v : mesh.vertices()) out << mesh.position(v) << '\n';
  for (const auto f : mesh.faces()) {
    if (f.idx() < face_count) continue;
    for (const auto v : mesh.vertices(f)) out << v.idx() << ' ';
    out << '\n';
  }
}
