#include "tripatch/mesh/changed_faces.h"

#include <vector>

#include "tripatch/messages.h"

namespace tripatch {

std::vector<char> marked_faces(const FacesRef& faces, std::span<const Index> replaced) {
  std::vector<char> gone(replaced.empty() ? 0 : faces.size(), 0);
  for (Index f : replaced) {
    if (f < 0 || f >= faces.size())
      throw CodedArgument(Code::no_such_face, {{"option", "replaced"}, {"face", f}, {"count", faces.size()}});
    gone[f] = 1;
  }
  return gone;
}

Faces changed_faces(const FacesRef& faces, std::span<const Index> replaced, const std::map<EdgeKey, Index>& middles) {
  const std::vector<char> gone = marked_faces(faces, replaced);
  Faces changed;
  std::vector<Index> face;
  for (Index f = 0; f < faces.size(); ++f) {
    if (!gone.empty() && gone[static_cast<std::size_t>(f)] != 0) continue;
    if (middles.empty()) {
      changed.add(faces[f]);
      continue;
    }
    face.clear();
    for (std::size_t k = 0; k < faces[f].size(); ++k) {
      face.push_back(faces[f][k]);
      const auto middle = middles.find(edge_key(face.back(), faces[f][(k + 1) % faces[f].size()]));
      if (middle != middles.end()) face.push_back(middle->second);
    }
    changed.add(face);
  }
  return changed;
}

}  // namespace tripatch
