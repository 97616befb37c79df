#include "tripatch/boundary/osd_error_scope.h"

#include <opensubdiv/far/error.h>
#include <opensubdiv/vtr/types.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <vector>

#include "tripatch/mesh/submesh.h"

namespace tripatch {
namespace {

namespace far = OpenSubdiv::Far;

thread_local OsdErrorScope* innermost = nullptr;

/// Once, whichever thread is the first: the others wait for it.
void set_callbacks() {
  static const bool set = [] {
    far::SetErrorCallback([](far::ErrorType, const char* message) {
      if (!OsdErrorScope::takes_error(message)) std::fprintf(stderr, "OpenSubdiv: %s\n", message);
    });
    far::SetWarningCallback([](const char* message) {
      if (!OsdErrorScope::takes_warning()) std::fprintf(stderr, "OpenSubdiv: %s\n", message);
    });
    return true;
  }();
  static_cast<void>(set);
}

/// Corners of a face, and faces at a vertex, at most.
constexpr Index most = OpenSubdiv::Vtr::VALENCE_LIMIT;

}  // namespace

OsdErrorScope::OsdErrorScope() : outer_(innermost) {
  set_callbacks();
  innermost = this;
}

OsdErrorScope::~OsdErrorScope() { innermost = outer_; }

bool OsdErrorScope::takes_error(const char* message) {
  if (innermost) innermost->text_ = message;
  return innermost != nullptr;
}

bool OsdErrorScope::takes_warning() { return innermost != nullptr; }

CodedRefusal not_subdivided(Subdivided what, const FacesRef& faces, std::span<const Index> some, const OsdErrorScope& complaint) {
  const char* const name = what == Subdivided::cage ? "cage" : "mesh";
  const Submesh part = submesh(faces, std::numeric_limits<Index>::max(), {some.begin(), some.end()});
  const std::vector<Index>& vertices = part.vertex.items();
  for (Index f : part.face) {
    const Index size = static_cast<Index>(faces[f].size());
    if (size > most) return {Code::face_has_many_corners, {{"what", name}, {"corners", size}, {"most", most}}, {faces[f][0]}};
  }
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Index count = static_cast<Index>(part.faces_at(static_cast<int>(v)).size());
    if (count > most) return {Code::many_faces_at_vertex, {{"what", name}, {"faces", count}, {"most", most}}, {vertices[v]}};
  }
  for (Index f : part.face) {
    std::vector<Index> face(faces[f].begin(), faces[f].end());
    std::sort(face.begin(), face.end());
    const auto twice = std::adjacent_find(face.begin(), face.end());
    if (twice != face.end()) return {Code::face_passes_twice, {{"what", name}}, {*twice}};
  }
  return {Code::not_subdivided, {{"what", name}, {"reason", complaint.text()}}, vertices};
}

}  // namespace tripatch
