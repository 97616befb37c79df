// What tests ask of refusals and warnings: their codes, for sentences are free to change.
#pragma once

#include <algorithm>
#include <string>

#include "tripatch/messages.h"

namespace tripatch {

/// The code of the refusal that something ends with; empty: none.
template <class Act>
std::string refusal_code(const Act& act) {
  try {
    act();
  } catch (const CodedRefusal& refusal) {
    return about(refusal.message().code).code;
  }
  return "";
}

inline std::string code_of(const Message& message) { return about(message.code).code; }
inline bool has(const Messages& messages, Code code) { return std::ranges::count(messages, code, &Message::code) > 0; }

}  // namespace tripatch
