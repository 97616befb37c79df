// CGAL's fill of one hole, for the pictures of beside_cgal.py: beside_cgal IN.off A B CONTINUITY OUT.off, where A B is an edge of the
// rim as new faces traverse it. Compiled by beside_cgal.py where CGAL is installed (Debian: libcgal-dev); no part of TriPatch needs it.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/IO/polygon_mesh_io.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <cstdlib>
#include <iterator>
#include <vector>

using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;

int main(int count, char** words) {
  if (count != 6) return 2;
  Mesh mesh;
  if (!CGAL::IO::read_polygon_mesh(words[1], mesh)) return 1;
  const Mesh::Vertex_index a(std::atoi(words[2])), b(std::atoi(words[3]));
  std::vector<Mesh::Face_index> faces;
  std::vector<Mesh::Vertex_index> vertices;
  CGAL::Polygon_mesh_processing::triangulate_refine_and_fair_hole(mesh, mesh.halfedge(a, b), std::back_inserter(faces),
                                                                  std::back_inserter(vertices),
                                                                  CGAL::parameters::fairing_continuity(std::atoi(words[4])));
  return CGAL::IO::write_polygon_mesh(words[5], mesh, CGAL::parameters::stream_precision(17)) ? 0 : 1;
}
