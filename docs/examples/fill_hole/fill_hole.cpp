// A paraboloid of triangles with a three-sided hole, filled and printed as OBJ.
#include <tripatch/fill.h>

#include <cstdio>
#include <vector>

int main() {
  const int n = 20;  // a triangular lattice of n edges a side; place(i, j) is a vertex of it
  const auto place = [n](int i, int j) { return tripatch::Index{j} * (n + 1) - j * (j - 1) / 2 + i; };
  const auto in_hole = [](int i, int j) { return i >= 5 && j >= 5 && i + j <= 15; };
  tripatch::Points vertices((n + 1) * (n + 2) / 2, 3);
  tripatch::Faces faces;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i + j <= n; ++i) {
      const double x = (i + 0.5 * j) / n - 0.5, y = 0.866 * j / n - 0.289;
      vertices.row(place(i, j)) << x, y, -x * x - y * y;
      if (i + j < n && !(in_hole(i, j) && in_hole(i + 1, j) && in_hole(i, j + 1)))
        faces.add(std::vector{place(i, j), place(i + 1, j), place(i, j + 1)});
      if (i + j < n - 1 && !(in_hole(i + 1, j) && in_hole(i + 1, j + 1) && in_hole(i, j + 1)))
        faces.add(std::vector{place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)});
    }
  try {
    const tripatch::Fill fill = tripatch::fill({vertices, faces});  // the only hole; the mesh itself is left as it is
    std::fprintf(stderr, "%d new faces; seam within %.2g deg\n", int(fill.faces.size()), fill.report.seam_angle_max);
    for (const tripatch::Points& points : {vertices, fill.vertices})
      for (const auto& p : points.rowwise()) std::printf("v %.9g %.9g %.9g\n", p[0], p[1], p[2]);
    for (const tripatch::Faces& some : {faces, fill.faces})
      for (tripatch::Index f = 0; f < some.size(); ++f)
        std::printf("f %d %d %d\n", int(some[f][0]) + 1, int(some[f][1]) + 1, int(some[f][2]) + 1);
  } catch (const tripatch::Refusal& refusal) {
    std::fprintf(stderr, "%s\n", refusal.what());
    return 1;
  }
}
