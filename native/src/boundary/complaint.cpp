#include "tripatch/boundary/complaint.h"

#include <opensubdiv/far/error.h>

#include <cstdio>

namespace tripatch {
namespace {

namespace far = OpenSubdiv::Far;

thread_local Complaint* innermost = nullptr;

/// Once, whichever thread is the first: the others wait for it.
void set_callbacks() {
  static const bool set = [] {
    far::SetErrorCallback([](far::ErrorType, const char* message) {
      if (!Complaint::takes_error(message)) std::fprintf(stderr, "OpenSubdiv: %s\n", message);
    });
    far::SetWarningCallback([](const char* message) {
      if (!Complaint::takes_warning()) std::fprintf(stderr, "OpenSubdiv: %s\n", message);
    });
    return true;
  }();
  static_cast<void>(set);
}

}  // namespace

Complaint::Complaint() : outer_(innermost) {
  set_callbacks();
  innermost = this;
}

Complaint::~Complaint() { innermost = outer_; }

bool Complaint::takes_error(const char* message) {
  if (innermost) innermost->text_ = message;
  return innermost != nullptr;
}

bool Complaint::takes_warning() { return innermost != nullptr; }

}  // namespace tripatch
