#include "tripatch/boundary/limit_surface.h"

#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/patchMap.h>
#include <opensubdiv/far/patchTableFactory.h>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/ptexIndices.h>
#include <opensubdiv/far/stencilTableFactory.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <opensubdiv/far/topologyRefinerFactory.h>
#include <opensubdiv/sdc/crease.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>

#include "tripatch/boundary/osd_error_scope.h"
#include "tripatch/mesh/submesh.h"
#include "tripatch/messages.h"

namespace tripatch {
namespace {

namespace far = OpenSubdiv::Far;
namespace bfr = OpenSubdiv::Bfr;
namespace sdc = OpenSubdiv::Sdc;

// NOLINTBEGIN(readability-identifier-naming): the names that OpenSubdiv's templates call
struct Vertex {
  Vec3 position = Vec3::Zero();
  void Clear() { position.setZero(); }
  void AddWithWeight(const Vertex& p, double weight) { position += weight * p.position; }
};
// NOLINTEND(readability-identifier-naming)

double sharpness(double crease) {  // as Blender does
  return crease <= 0 ? 0 : crease >= 1 ? sdc::Crease::SHARPNESS_INFINITE : crease * crease * sdc::Crease::SHARPNESS_INFINITE;
}

std::vector<Index> faces_around(const Connectivity& cage, std::span<const Index> around) {
  if (!around.empty()) return rings_around(cage, around, limit_rings).all_faces();
  std::vector<Index> all(cage.faces().size());
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}

/// The part of a cage that is refined, with its own numbering, and OpenSubdiv's description of it.
class LocalCage {
public:
  Submesh part;
  Numbering local_face;
  std::vector<Vertex> vertices;
  std::vector<int> sizes;
  std::unique_ptr<far::TopologyRefiner> refiner;

  /// Of the faces `some` of a cage, in its order.
  LocalCage(const Mesh& cage, const Subdivision& settings, std::vector<Index> some)
      : part(submesh(cage.faces, cage.vertices.rows(), std::move(some))) {
    check_vertices(settings, cage.vertices.rows());
    if (part.face.empty()) throw CodedRefusal(Code::cage_without_faces);
    for (Index f : part.face) {
      if (settings.loop && cage.faces[f].size() != 3)
        throw CodedRefusal(Code::loop_needs_triangles,
                           {{"near", std::vector<Index>{cage.faces[f][0]}}, {"corners", cage.faces[f].size()}},
                           {cage.faces[f].begin(), cage.faces[f].end()});  // by vertices: the faces of a closed cage are others
      local_face.add(f);
      sizes.push_back(static_cast<int>(cage.faces[f].size()));
    }
    for (Index v : vertex_of()) {
      if (!cage.vertices.row(v).allFinite()) throw CodedRefusal(Code::vertex_not_finite, {v});
      vertices.push_back({cage.vertices.row(v)});
    }
    describe(cage.faces, settings);
  }

  /// The cage's own numbers of the vertices.
  const std::vector<Index>& vertex_of() const { return part.vertex.items(); }

  /// The local number of a face.
  int local(Index face) const {
    const int found = local_face.find(face);
    if (found < 0) throw InvalidArgument("face " + std::to_string(face) + " is not around the hole");
    return found;
  }
  /// The same of one that must have this edge.
  int local(Index face, int edge) const {
    const int found = local(face);
    if (edge < 0 || edge >= sizes[found])
      throw InvalidArgument("face " + std::to_string(face) + " has no edge " + std::to_string(edge));
    return found;
  }

private:
  static void check_vertices(const Subdivision& settings, Index count) {
    const auto check = [&](Index v, const char* option) {
      if (v < 0 || v >= count) throw CodedArgument(Code::no_such_vertex, {{"option", option}, {"vertex", v}, {"count", count}});
    };
    for (const auto& [a, b] : settings.crease_edges) check(a, "edge_creases"), check(b, "edge_creases");
    for (Index v : settings.crease_vertices) check(v, "vertex_creases");
    for (Index v : settings.loose_vertices) check(v, "loose_vertices");
  }

  void describe(const FacesRef& faces, const Subdivision& settings) {
    std::map<std::pair<int, int>, double> edge_sharpness;
    std::map<int, double> vertex_sharpness;
    for (std::size_t k = 0; k < settings.crease_edges.size(); ++k) {
      const int a = part.vertex.find(settings.crease_edges[k][0]), b = part.vertex.find(settings.crease_edges[k][1]);
      const double s = sharpness(settings.edge_creases[k]);
      if (s > 0 && a >= 0 && b >= 0) edge_sharpness[std::minmax(a, b)] = s;
    }
    for (std::size_t k = 0; k < settings.crease_vertices.size(); ++k) {
      const int v = part.vertex.find(settings.crease_vertices[k]);
      if (v >= 0) vertex_sharpness[v] = sharpness(settings.vertex_creases[k]);
    }
    add_blender_extras(settings, edge_sharpness, vertex_sharpness);

    std::vector<int> crease_pairs, corner_vertices;
    std::vector<float> crease_weights, corner_weights;
    for (const auto& [edge, s] : edge_sharpness) {
      crease_pairs.insert(crease_pairs.end(), {edge.first, edge.second});
      crease_weights.push_back(static_cast<float>(s));
    }
    for (const auto& [v, s] : vertex_sharpness) {
      if (s <= 0) continue;
      corner_vertices.push_back(v);
      corner_weights.push_back(static_cast<float>(s));
    }
    far::TopologyDescriptor topology;
    topology.numVertices = static_cast<int>(vertices.size());
    topology.numFaces = static_cast<int>(sizes.size());
    topology.numVertsPerFace = sizes.data();
    topology.vertIndicesPerFace = part.corners.data();
    topology.numCreases = static_cast<int>(crease_weights.size());
    topology.creaseVertexIndexPairs = crease_pairs.data();
    topology.creaseWeights = crease_weights.data();
    topology.numCorners = static_cast<int>(corner_weights.size());
    topology.cornerVertexIndices = corner_vertices.data();
    topology.cornerWeights = corner_weights.data();

    sdc::Options options;
    options.SetVtxBoundaryInterpolation(settings.preserve_corners ? sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER
                                                                  : sdc::Options::VTX_BOUNDARY_EDGE_ONLY);
    using Factory = far::TopologyRefinerFactory<far::TopologyDescriptor>;
    Factory::Options factory(settings.loop ? sdc::SCHEME_LOOP : sdc::SCHEME_CATMARK, options);
    factory.validateFullTopology = true;
    const OsdErrorScope complaint;
    refiner.reset(Factory::Create(topology, factory));
    if (!refiner) throw not_subdivided(Subdivided::cage, faces, part.face, complaint);
  }

  /// Blender's own: a border corner of one face whose two edges are creased is sharpened by the lesser of the two; a vertex on a
  /// loose edge is infinitely sharp.
  void add_blender_extras(const Subdivision& settings, const std::map<std::pair<int, int>, double>& edge_sharpness,
                          std::map<int, double>& vertex_sharpness) {
    for (int v = 0; v < static_cast<int>(vertices.size()); ++v) {
      if (part.faces_at(v).size() != 1) continue;
      const std::span<const int> face = part[part.faces_at(v)[0]];
      const std::size_t size = face.size(), k = std::find(face.begin(), face.end(), v) - face.begin();
      const auto a = edge_sharpness.find(std::minmax(v, face[(k + size - 1) % size])),
                 b = edge_sharpness.find(std::minmax(v, face[(k + 1) % size]));
      if (a != edge_sharpness.end() && b != edge_sharpness.end()) vertex_sharpness[v] += std::min(a->second, b->second);
    }
    for (Index v : settings.loose_vertices) {
      const int local = part.vertex.find(v);
      if (local >= 0) vertex_sharpness[local] = sdc::Crease::SHARPNESS_INFINITE;
    }
  }
};

}  // namespace

struct LimitSurface::Impl {
  LocalCage cage;
  bool loop;
  // adaptive patches (quality given)
  std::unique_ptr<far::PatchTable> table;
  std::unique_ptr<far::PatchMap> map;
  std::unique_ptr<far::PtexIndices> ptex;
  std::vector<Vertex> points;
  std::unique_ptr<const far::StencilTableReal<double>> stencils;  // made when first asked for
  std::vector<int> column;                                        // of each local vertex, while stencils are put together
  // the true limit
  std::unique_ptr<bfr::RefinerSurfaceFactory<>> factory;

  Impl(const Mesh& mesh, const Subdivision& settings, std::vector<Index> faces)
      : cage(mesh, settings, std::move(faces)), loop(settings.loop) {
    if (!settings.quality) {
      bfr::SurfaceFactory::Options options;
      options.SetApproxLevelSmooth(10).SetApproxLevelSharp(10);
      factory = std::make_unique<bfr::RefinerSurfaceFactory<>>(*cage.refiner, options);
      return;
    }
    if (*settings.quality < min_quality || *settings.quality > max_quality)
      throw InvalidArgument("quality must be from " + std::to_string(min_quality) + " to " + std::to_string(max_quality) +
                            ", or none, not " + std::to_string(*settings.quality));
    far::PatchTableFactory::Options options(static_cast<unsigned>(*settings.quality));
    options.SetEndCapType(far::PatchTableFactory::Options::ENDCAP_GREGORY_BASIS);
    options.SetPatchPrecision<double>();
    options.useInfSharpPatch = true;
    cage.refiner->RefineAdaptive(options.GetRefineAdaptiveOptions());
    table.reset(far::PatchTableFactory::Create(*cage.refiner, options));
    map = std::make_unique<far::PatchMap>(*table);
    ptex = std::make_unique<far::PtexIndices>(*cage.refiner);
    refine();
  }

  /// Refined and local points from the cage's vertices.
  void refine() {
    points = cage.vertices;
    const int all = cage.refiner->GetNumVerticesTotal(), local = table->GetNumLocalPoints();
    points.resize(all + local);
    const far::PrimvarRefinerReal<double> primvars(*cage.refiner);
    Vertex* from = points.data();
    for (int level = 1; level <= cage.refiner->GetMaxLevel(); ++level) {
      Vertex* to = from + cage.refiner->GetLevel(level - 1).GetNumVertices();
      primvars.Interpolate(level, from, to);
      from = to;
    }
    if (local > 0) table->GetLocalPointStencilTable<double>()->UpdateValues(points.data(), points.data() + all);
  }

  /// Derivatives with respect to the ptex face's own u, v.
  LimitJet at(int ptex_face, double u, double v) const {
    const far::PatchTable::PatchHandle* handle = map->FindPatch(ptex_face, u, v);
    if (!handle) throw CodedRefusal(Code::face_without_limit);
    std::array<double, 20> w, wu, wv, wuu, wuv, wvv;
    table->EvaluateBasis(*handle, u, v, w.data(), wu.data(), wv.data(), wuu.data(), wuv.data(), wvv.data());
    const far::ConstIndexArray cvs = table->GetPatchVertices(*handle);
    LimitJet j{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
    for (int k = 0; k < cvs.size(); ++k) {
      const Vec3& p = points[cvs[k]].position;
      j.p += w[k] * p;
      j.pu += wu[k] * p;
      j.pv += wv[k] * p;
      j.puu += wuu[k] * p;
      j.puv += wuv[k] * p;
      j.pvv += wvv[k] * p;
    }
    return j;
  }

  /// Every refined and local point as weights of the cage's vertices.
  void make_stencils() {
    using Factory = far::StencilTableFactoryReal<double>;
    Factory::Options options;
    options.generateOffsets = true;
    options.generateIntermediateLevels = true;
    options.generateControlVerts = true;
    std::unique_ptr<const far::StencilTableReal<double>> refined(Factory::Create(*cage.refiner, options));
    const auto* local = table->GetLocalPointStencilTable<double>();
    if (local && local->GetNumStencils() > 0) {
      stencils.reset(Factory::AppendLocalPointStencilTable(*cage.refiner, refined.get(), local));
    } else {
      stencils = std::move(refined);
    }
  }

  LimitStencils stencils_at(int ptex_face, bool quarters, std::span<const FacePlace> places) {
    if (!stencils) make_stencils();
    std::array<double, 20> w, wu, wv;
    struct Part {  // of a place: a point of the patch table and its weights
      int place, point;
      double p, pu, pv;
    };
    std::vector<Part> parts;
    LimitStencils out;
    column.resize(cage.vertices.size(), -1);
    for (std::size_t n = 0; n < places.size(); ++n) {
      const int face = ptex_face + (quarters ? places[n].quarter : 0);
      const far::PatchTable::PatchHandle* handle = map->FindPatch(face, places[n].u, places[n].v);
      if (!handle) throw CodedRefusal(Code::face_without_limit);
      table->EvaluateBasis(*handle, places[n].u, places[n].v, w.data(), wu.data(), wv.data());
      const far::ConstIndexArray cvs = table->GetPatchVertices(*handle);
      for (int k = 0; k < cvs.size(); ++k) {
        parts.push_back({static_cast<int>(n), cvs[k], w[k], wu[k], wv[k]});
        const far::StencilReal<double> s = stencils->GetStencil(cvs[k]);
        for (int i = 0; i < s.GetSize(); ++i) {
          int& place = column[s.GetVertexIndices()[i]];
          if (place >= 0) continue;
          place = static_cast<int>(out.vertices.size());
          out.vertices.push_back(s.GetVertexIndices()[i]);
        }
      }
    }
    const Index rows = static_cast<Index>(places.size()), columns = static_cast<Index>(out.vertices.size());
    for (LimitStencils::Weights* weights : {&out.p, &out.pu, &out.pv}) weights->setZero(rows, columns);
    for (const Part& part : parts) {
      const far::StencilReal<double> s = stencils->GetStencil(part.point);
      for (int i = 0; i < s.GetSize(); ++i) {
        const int place = column[s.GetVertexIndices()[i]];
        const double weight = s.GetWeights()[i];
        out.p(part.place, place) += part.p * weight;
        out.pu(part.place, place) += part.pu * weight;
        out.pv(part.place, place) += part.pv * weight;
      }
    }
    for (Index& v : out.vertices) {
      column[v] = -1;
      v = cage.vertex_of()[v];
    }
    return out;
  }

  /// The same turned and scaled: e along the edge, f into the face, in the ptex face's coordinates.
  static LimitJet turned(const LimitJet& j, const Eigen::Vector2d& e, const Eigen::Vector2d& f) {
    const auto second = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
      return Vec3(a[0] * b[0] * j.puu + (a[0] * b[1] + a[1] * b[0]) * j.puv + a[1] * b[1] * j.pvv);
    };
    return {j.p, e[0] * j.pu + e[1] * j.pv, f[0] * j.pu + f[1] * j.pv, second(e, e), second(e, f), second(f, f)};
  }

  LimitJet on_edge(int local, int edge, double t) const {
    const int size = cage.sizes[local];
    const int first = ptex->GetFaceId(local);
    if (loop) {
      const std::array<Eigen::Vector2d, 3> start = {Eigen::Vector2d(0, 0), {1, 0}, {0, 1}};
      const Eigen::Vector2d e = start[(edge + 1) % 3] - start[edge], f = start[(edge + 2) % 3] - start[edge];
      const Eigen::Vector2d p = start[edge] + t * e;
      return turned(at(first, p[0], p[1]), e, f);
    }
    if (size == 4) {
      const std::array<Eigen::Vector2d, 4> start = {Eigen::Vector2d(0, 0), {1, 0}, {1, 1}, {0, 1}};
      const Eigen::Vector2d e = start[(edge + 1) % 4] - start[edge], f(-e[1], e[0]);
      const Eigen::Vector2d p = start[edge] + t * e;
      return turned(at(first, p[0], p[1]), e, f);
    }
    // an n-gon is a fan of quarters, each with its origin at a corner and u along the edge that leaves it; the derivatives that
    // OpenSubdiv gives there are already those of the whole face, twice those of the quarter
    if (t <= 0.5) return turned(at(first + edge, 2 * t, 0), {1, 0}, {0, 1});
    return turned(at(first + (edge + 1) % size, 0, 2 - 2 * t), {0, -1}, {1, 0});
  }

  void on_edge_true(int local, int edge, std::span<const double> t, std::span<LimitJet> out) const {
    const std::unique_ptr<bfr::Surface<double>> surface(factory->CreateVertexSurface<double>(local));
    if (!surface || !surface->IsValid()) throw CodedRefusal(Code::face_without_limit);
    std::vector<double> patch(3 * surface->GetNumPatchPoints());
    surface->PreparePatchPoints(cage.vertices[0].position.data(), {3, sizeof(Vertex) / sizeof(double)}, patch.data(), 3);
    const bfr::Parameterization parameterization = surface->GetParameterization();
    for (std::size_t k = 0; k < t.size(); ++k) {
      Eigen::Vector2d uv, from, to;
      parameterization.GetEdgeCoord(edge, t[k], uv.data());
      // the direction of the edge in the (sub)face that the point lies in
      const double low = t[k] < 0.5 ? 0.0 : 0.5;
      parameterization.GetEdgeCoord(edge, low + 1.0 / 8, from.data());
      parameterization.GetEdgeCoord(edge, low + 3.0 / 8, to.data());
      const Eigen::Vector2d e = 4 * (to - from), f(-e[1], e[0]);
      LimitJet j;
      surface->Evaluate(uv.data(), patch.data(), 3, j.p.data(), j.pu.data(), j.pv.data(), j.puu.data(), j.puv.data(),
                        j.pvv.data());
      out[k] = turned(j, e, f);
    }
  }
};

LimitSurface::LimitSurface(const Mesh& cage, const Subdivision& settings, std::span<const Index> around)
    : LimitSurface(cage, Connectivity::around(cage, around, limit_rings - 1), settings, around) {}
LimitSurface::LimitSurface(const Mesh& cage, const Connectivity& connectivity, const Subdivision& settings,
                           std::span<const Index> around)
    : impl_(std::make_unique<Impl>(cage, settings, faces_around(connectivity, around))) {}
LimitSurface::~LimitSurface() = default;
LimitSurface::LimitSurface(LimitSurface&&) noexcept = default;

void LimitSurface::move(const PointsRef& vertices) {
  for (std::size_t k = 0; k < impl_->cage.vertices.size(); ++k)
    impl_->cage.vertices[k].position = vertices.row(impl_->cage.vertex_of()[k]);
  if (!impl_->factory) impl_->refine();
}

void LimitSurface::evaluate_edge(Index face, int edge, std::span<const double> t, std::span<LimitJet> out) const {
  const int local = impl_->cage.local(face, edge);
  if (impl_->factory) return impl_->on_edge_true(local, edge, t, out);
  for (std::size_t k = 0; k < t.size(); ++k) out[k] = impl_->on_edge(local, edge, t[k]);
}

LimitStencils LimitSurface::stencils(Index face, std::span<const FacePlace> places) const {
  if (impl_->factory) throw InvalidArgument("stencils need a quality");
  const int local = impl_->cage.local(face);
  return impl_->stencils_at(impl_->ptex->GetFaceId(local), !impl_->loop && impl_->cage.sizes[local] != 4, places);
}

Points LimitSurface::grid(int steps) const {
  std::vector<Vec3> all;
  if (impl_->factory || impl_->loop) throw InvalidArgument("grid needs a quality, and Catmull-Clark's scheme");
  const int faces = impl_->ptex->GetNumFaces();
  for (int f = 0; f < faces; ++f)
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= steps; ++j)
        all.push_back(impl_->at(f, static_cast<double>(i) / steps, static_cast<double>(j) / steps).p);
  Points points(static_cast<Index>(all.size()), 3);
  for (std::size_t k = 0; k < all.size(); ++k) points.row(static_cast<Index>(k)) = all[k];
  return points;
}

RefinedCage refine_cage(const Mesh& cage, const Connectivity& connectivity, const Subdivision& settings,
                        std::span<const Index> rim) {
  const LocalCage local(cage, settings, faces_around(connectivity, rim));
  far::TopologyRefiner& refiner = *local.refiner;
  far::TopologyRefiner::UniformOptions options(settings.level);
  options.fullTopologyInLastLevel = true;
  refiner.RefineUniform(options);
  std::vector<Vertex> points = local.vertices;
  const far::PrimvarRefinerReal<double> primvars(refiner);
  for (int level = 1; level <= settings.level; ++level) {
    std::vector<Vertex> next(refiner.GetLevel(level).GetNumVertices());
    primvars.Interpolate(level, points, next);
    points = std::move(next);
  }
  if (settings.use_limit_surface) {
    std::vector<Vertex> limit(points.size());
    primvars.Limit(points, limit);
    points = std::move(limit);
  }
  RefinedCage refined;
  const far::TopologyLevel last = refiner.GetLevel(settings.level);
  refined.vertices.resize(static_cast<Index>(points.size()), 3);
  for (std::size_t k = 0; k < points.size(); ++k) refined.vertices.row(static_cast<Index>(k)) = points[k].position;
  for (int f = 0; f < last.GetNumFaces(); ++f) {
    const far::ConstIndexArray corners = last.GetFaceVertices(f);
    refined.faces.add(std::vector<Index>(corners.begin(), corners.end()));
  }
  for (std::size_t k = 0; k < rim.size(); ++k) {
    std::vector<int> path = {local.part.vertex.find(rim[k]), local.part.vertex.find(rim[(k + 1) % rim.size()])};
    for (int level = 0; level < settings.level; ++level) {
      const far::TopologyLevel topology = refiner.GetLevel(level);
      std::vector<int> finer;
      for (std::size_t i = 0; i + 1 < path.size(); ++i) {
        finer.push_back(topology.GetVertexChildVertex(path[i]));
        finer.push_back(topology.GetEdgeChildVertex(topology.FindEdge(path[i], path[i + 1])));
      }
      finer.push_back(topology.GetVertexChildVertex(path.back()));
      path = std::move(finer);
    }
    refined.along_rim.emplace_back(path.begin(), path.end() - 1);
  }
  return refined;
}

}  // namespace tripatch
