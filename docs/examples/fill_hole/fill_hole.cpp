// Reads a mesh, fills its only hole and writes the whole mesh: fill_hole IN.obj OUT.obj
#include <tripatch/fill.h>

#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

/// Positions and faces of an OBJ file.
void read(const char* path, tripatch::Points& vertices, tripatch::Faces& faces) {
  std::ifstream file(path);
  std::vector<double> coordinates;
  for (std::string line, word; std::getline(file, line);) {
    std::istringstream words(line);
    words >> word;
    if (word == "v") {
      double x = 0, y = 0, z = 0;
      words >> x >> y >> z;
      coordinates.insert(coordinates.end(), {x, y, z});
    } else if (word == "f") {
      std::vector<tripatch::Index> face;
      while (words >> word) face.push_back(std::stol(word) - 1);  // what follows a slash is not read
      faces.add(face);
    }
  }
  vertices = Eigen::Map<tripatch::Points>(coordinates.data(), static_cast<tripatch::Index>(coordinates.size() / 3), 3);
}

void write(const char* path, const tripatch::Points& vertices, const tripatch::Faces& faces) {
  std::ofstream file(path);
  file.precision(9);
  for (const auto& p : vertices.rowwise()) file << "v " << p[0] << ' ' << p[1] << ' ' << p[2] << '\n';
  for (tripatch::Index f = 0; f < faces.size(); ++f) {
    file << 'f';
    for (const tripatch::Index v : faces[f]) file << ' ' << v + 1;
    file << '\n';
  }
}

int main(int count, char** arguments) {
  if (count != 3) {
    std::fprintf(stderr, "usage: fill_hole IN.obj OUT.obj\n");
    return 2;
  }
  tripatch::Points vertices;
  tripatch::Faces faces;
  read(arguments[1], vertices, faces);
  try {
    tripatch::FillOptions options;
    options.fairing = tripatch::Fairing::thin_plate;  // every option is documented in tripatch/options.def
    const tripatch::Fill fill = tripatch::fill({vertices, faces}, options);
    std::printf("%d new faces; seam within %.2g deg\n", static_cast<int>(fill.faces.size()), fill.report.seam_angle_max);
    const tripatch::OwnMesh whole = tripatch::with_fill({vertices, faces}, fill);
    write(arguments[2], whole.vertices, whole.faces);
    if (tripatch::is_flawed(fill)) std::fprintf(stderr, "it folds, misses its boundary, or passes through itself or the mesh\n");
  } catch (const tripatch::Refusal& refusal) {
    std::fprintf(stderr, "%s\n", refusal.what());
    for (const tripatch::Index v : refusal.where()) std::fprintf(stderr, "vertex %d\n", static_cast<int>(v));
    return 1;
  }
}
