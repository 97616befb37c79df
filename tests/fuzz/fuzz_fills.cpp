// Fills of any rim in any mesh with any options: each is refused in words, or whole.
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <type_traits>

#include "bytes.h"
#include "tripatch/fill.h"
#include "tripatch/hole/hole.h"

using namespace tripatch;
using fuzz::Bytes;
using fuzz::require;

namespace {

/// How many fills there were, said at the end: an input may ask for many, or come to none.
struct Count {
  long filled = 0, refused = 0;

  ~Count() { std::fprintf(stderr, "%ld fills, %ld refusals\n", filled, refused); }
} count;

/// Values of options from bytes: an option that is not there keeps its default.
struct Taker {
  Bytes& bytes;
  Index vertices, faces;

  void take(bool& to) { to = bytes.flag(); }
  void take(int& to) { to = bytes.seldom(10) ? bytes.whole(-3, 200) : bytes.whole(0, 12); }
  void take(double& to) { to = bytes.flag() ? std::abs(bytes.number()) : bytes.number(); }
  void take(Pair& to) { to = {bytes.number(), bytes.number()}; }
  void take(Vec3& to) { to = bytes.point(); }
  void take(std::string& to) {
    const std::size_t k = bytes.byte() % (methods().size() + 1);
    to = k < methods().size() ? methods()[k].name : automatic_method;
  }
  void take(std::vector<Index>& to) { to = bytes.indices(14, vertices); }
  void take(std::vector<std::vector<Index>>& to) {
    to.resize(bytes.byte() % 3);
    for (auto& each : to) take(each);
  }
  void take(std::vector<Through>& to) {
    to.resize(bytes.byte() % 4);
    for (Through& each : to) {
      take(each.point);
      take(each.normal);
    }
  }
  template <class T>
    requires std::is_enum_v<T>
  void take(T& to) {
    to = static_cast<T>(bytes.byte() % choices<T>.size());
  }
  template <class T>
  void take(BySide<T>& to) {
    std::vector<T> values(bytes.flag() ? 1 : bytes.seldom(4) ? bytes.whole(1, 7) : 3);
    for (T& value : values) take(value);
    to = BySide<T>(std::move(values));
  }
  template <class T>
  void take(std::optional<T>& to) {
    to.reset();
    if (!bytes.seldom(4)) take(to.emplace());
  }
  void take(Subdivision& to) {
    to.loop = bytes.seldom(3);
    to.preserve_corners = bytes.flag();
    if (bytes.flag()) to.quality = bytes.whole(0, 11);
    to.use_limit_surface = !bytes.seldom(3);
    for (int k = bytes.byte() % 3; k > 0; --k) {
      to.crease_edges.push_back({bytes.byte(), bytes.byte() % std::max<Index>(1, vertices)});
      to.edge_creases.push_back(bytes.number());
    }
    for (Index v : bytes.indices(3, vertices)) {
      to.crease_vertices.push_back(v);
      to.vertex_creases.push_back(bytes.number());
    }
    to.loose_vertices = bytes.indices(2, vertices);
  }
  template <class T>
  void sometimes(T& to) {
    if (bytes.seldom(10)) take(to);
  }
};

FillOptions take_options(Bytes& bytes, const Mesh& mesh) {
  Taker taker = {bytes, mesh.vertices.rows(), mesh.faces.size()};
  FillOptions o;
#define OPTION(type, name, value, ...) taker.sometimes(o.name);
#define METHOD_OPTION(type, name, value, ...) taker.sometimes(o.own.name);
#define OPTION_AT(path, name, ...) taker.sometimes(o.path);
#include "tripatch/options.def"
  o.subdivision.level = std::min(o.subdivision.level, 3);  // finer ones only take longer
  if (o.resolution) o.resolution = std::min(*o.resolution, 24);
  if (o.tolerance && *o.tolerance < 1e-4) o.tolerance = 1e-4;
  if (bytes.seldom(3)) o.output = bytes.flag() ? Output::quads : Output::cage;
  return o;
}

using Edge = std::pair<Index, Index>;

std::map<Edge, int> edges_by_direction(const FacesRef& faces, const std::set<Index>& without = {}) {
  std::map<Edge, int> count;
  for (Index f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < faces[f].size() && !without.contains(f); ++k)
      ++count[{faces[f][k], faces[f][(k + 1) % faces[f].size()]}];
  return count;
}

int at(const std::map<Edge, int>& edges, Index a, Index b) {
  const auto found = edges.find({a, b});
  return found == edges.end() ? 0 : found->second;
}

void check_faces(const Mesh& mesh, const FillOptions& options, const Fill& fill) {
  const Index n = mesh.vertices.rows(), all = n + fill.vertices.rows();
  for (Index v : fill.faces.corners) require(v >= 0 && v < all, "a face of the fill names a vertex that is not there");
  const std::map<Edge, int> added = edges_by_direction(fill.faces);
  const std::map<Edge, int> before =
      edges_by_direction(mesh.faces, std::set<Index>(options.replaced.begin(), options.replaced.end()));
  for (const auto& [edge, count] : added) {
    const auto [a, b] = edge;
    require(count == 1, "an edge of the fill has two faces in one direction");
    require(a != b, "a face of the fill passes a vertex twice in a row");
    const int there = at(before, a, b) + at(before, b, a), total = there + 1 + at(added, b, a);
    require(total <= 2, "an edge of the fill has more than two faces");
    require(at(before, a, b) == 0, "a face of the fill is turned against its neighbor");
  }
  if (!fill.border.empty() || !fill.split_edges.empty() || !options.islands.empty()) return;
  std::set<Edge> rim;
  for (std::size_t k = 0; k < fill.rim.size(); ++k) rim.emplace(fill.rim[k], fill.rim[(k + 1) % fill.rim.size()]);
  for (const Edge& edge : rim) require(added.contains(edge), "a rim edge has no face of the fill");
  for (const auto& [edge, count] : added)
    require(rim.contains(edge) || added.contains({edge.second, edge.first}), "the fill is open away from the rim");
}

void check_fill(const Mesh& mesh, const FillOptions& options, const Fill& fill) {
  ++count.filled;
  require(fill.vertices.allFinite(), "a new vertex is not finite");
  require(fill.normals.allFinite(), "a normal is not finite");
  require(fill.rim_normals.allFinite(), "a normal at the rim is not finite");
  require(fill.moved_to.allFinite(), "a vertex moves to where is no place");
  require(fill.faces.size() > 0, "a fill without faces");
  require(fill.normals.rows() == fill.vertices.rows() || fill.normals.rows() == 0, "normals of other vertices");
  for (Index k = 0; k < fill.normals.rows(); ++k) require(fill.normals.row(k).norm() < 1 + 1e-6, "a normal is longer than one");
  require(std::isfinite(fill.report.seam_angle_max), "the seam's angle is not finite");
  check_faces(mesh, options, fill);
}

void check_refusal(const Mesh& mesh, const Refused& refused) {
  ++count.refused;
  require(refused.text().size() > 10, "a refusal without a sentence");
  for (Index v : refused.message.where) require(v >= 0 && v < mesh.vertices.rows(), "a refusal names a vertex that is not there");
}

/// What is refused as a mistake of the caller names what was given: no step on the way may take what another made for a mistake.
void check_mistake(const std::string& told) {
  const auto names = [&](const std::string& word) { return told.find(word) != std::string::npos; };
  bool known =
      names("vertex") || names("vertices") || names("corner") || names("Corner") || names("No method") || names("quality");
  for (const Option& option : tripatch::options()) known = known || names(option.name);
  require(known, ("a mistake that names nothing that was given: " + told).c_str());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Bytes bytes(data, size);
  const fuzz::OwnMesh own = fuzz::take_mesh(bytes);
  const Mesh mesh = own;
  FillOptions options = take_options(bytes, mesh);
  const bool several = bytes.seldom(4) && !options.rim;
  try {
    std::vector<std::vector<Index>> rims = find_holes(mesh.faces);
    if (!options.rim && !rims.empty()) options.rim = rims[bytes.byte() % rims.size()];
    if (several) {
      options.rim.reset(), options.corners.reset();
      for (const auto& result : fill_all(mesh, rims, options))
        if (const Fill* fill = std::get_if<Fill>(&result))
          check_fill(mesh, options, *fill);
        else
          check_refusal(mesh, std::get<Refused>(result));
    } else {
      check_fill(mesh, options, fill(mesh, options));
    }
  } catch (const CodedRefusal& refusal) {
    check_refusal(mesh, refused(refusal));
  } catch (const InvalidArgument& mistake) {
    check_mistake(mistake.what());
  }
  return 0;
}
