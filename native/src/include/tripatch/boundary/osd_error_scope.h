// What OpenSubdiv says about a cage that it cannot take.
#pragma once

#include <span>
#include <string>

#include "tripatch/messages.h"
#include "tripatch/types.h"

namespace tripatch {

/// Collects OpenSubdiv's error messages on the thread that it lives on, the innermost first; warnings meanwhile are dropped.
///
/// OpenSubdiv has one callback for the whole process and does not tell which one is set, so there is nothing to restore. It is set
/// once, before the first cage, and takes only what a OsdErrorScope waits for: all other messages, of other users of the same copy of the
/// library, are printed. Who sets a callback later than that replaces this one. (What is shipped has a copy of OpenSubdiv of its own, with
/// hidden symbols.)
class OsdErrorScope {
public:
  OsdErrorScope();
  ~OsdErrorScope();
  OsdErrorScope(const OsdErrorScope&) = delete;
  OsdErrorScope& operator=(const OsdErrorScope&) = delete;

  /// The last message; empty: none.
  const std::string& text() const { return text_; }

  /// What the callbacks ask: whether a OsdErrorScope on this thread takes the message.
  static bool takes_error(const char* message);
  static bool takes_warning();

private:
  OsdErrorScope* outer_;
  std::string text_;
};

enum class Subdivided { cage, mesh };
/// Why it, of these faces of a mesh, cannot be subdivided: in numbers of the mesh, and where; in OpenSubdiv's own words, quoted, where the
/// reason is none of those that it is known for.
CodedRefusal not_subdivided(Subdivided what, const FacesRef& faces, std::span<const Index> some, const OsdErrorScope& complaint);

}  // namespace tripatch
