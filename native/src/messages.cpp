#include "tripatch/messages.h"

#include <algorithm>
#include <sstream>

namespace tripatch {
namespace {

constexpr AboutMessage all[] = {
#define MESSAGE(code, kind, sentence, panel, meaning) {#code, #kind, sentence, panel, meaning},
#include "tripatch/messages.def"
#define MESSAGE_OF_PYTHON(code, kind, sentence, panel, meaning) {#code, #kind, sentence, panel, meaning},
#include "tripatch/interface_messages.def"
#define LABEL(code, label, text) {#code, "label", text, label, ""},
#include "tripatch/labels.def"
};

// one row for each code, in the same order; the rows of interfaces follow
constexpr int first_row = __COUNTER__ + 1;
#define MESSAGE(code, ...) static_assert(static_cast<int>(Code::code) == __COUNTER__ - first_row);
#include "tripatch/messages.def"

constexpr std::size_t max_named = 8;  ///< vertices in a sentence: more are not read
/// From here on a measure has three digits instead of two, for 99.6 of two are 1e+02.
constexpr double three_digits = 99.5;

std::string number(double value) {
  std::ostringstream text;
  text.precision(value < three_digits ? 2 : 3);
  text << value;
  return text.str();
}

/// "1, 2 and 3", or the first of many "and more".
std::string listed(const std::vector<Index>& vertices) {
  std::string text;
  const std::size_t n = vertices.size();
  for (std::size_t k = 0; k < std::min(n, max_named); ++k)
    text += (k == 0 ? "" : k + 1 == n ? " and " : ", ") + std::to_string(vertices[k]);
  return n > max_named ? text + " and more" : text;
}

/// Makes one sentence.
class Formatter {
public:
  Formatter(const Message& message, const Wording& wording) : message_(message), wording_(wording) {}

  std::string operator()(std::string_view pattern) {
    std::string out;
    for (std::size_t k = 0; k < pattern.size(); ++k) {
      if (pattern[k] != '{' && pattern[k] != '[') {
        out += pattern[k];
        continue;
      }
      const std::size_t end = pattern.find(pattern[k] == '{' ? '}' : ']', k);
      const std::string_view inside = pattern.substr(k + 1, end - k - 1);
      out += pattern[k] == '{' ? filled(inside) : clause(inside);
      k = end;
    }
    return out;
  }

private:
  std::string clause(std::string_view pattern) {
    missing_ = false;
    std::string out = (*this)(pattern);
    return std::exchange(missing_, false) ? "" : out;
  }

  std::string filled(std::string_view field) {
    const std::size_t colon = field.find(':');
    const std::string_view name = field.substr(0, colon);
    const std::string_view kind = colon == std::string_view::npos ? "" : field.substr(colon + 1);
    const auto is_there = [&] { return std::ranges::count(message_.parameters, name, &Parameter::name) > 0; };
    if (kind == "if" && is_there()) return "";
    if (kind == "option") return written(std::string(name), "names");
    if (name == "where") return written(message_.where, kind);
    const auto found = std::ranges::find(message_.parameters, name, &Parameter::name);
    if (found != message_.parameters.end())
      return std::visit([&](const auto& value) { return written(value, kind); }, found->value);
    missing_ = true;
    return "{" + std::string(field) + "}";
  }

  /// "# edge" or "# edges", the one or the other of what stands on both sides of a bar.
  static std::string plural(Index count, std::string_view kind) {
    const std::size_t bar = kind.find('|');
    std::string out;
    for (char c : count == 1 ? kind.substr(0, bar) : kind.substr(bar + 1))
      out += c == '#' ? std::to_string(count) : std::string(1, c);
    return out;
  }
  static bool is_plural(std::string_view kind) { return kind.find('|') != std::string_view::npos; }

  std::string written(Index value, std::string_view kind) {
    if (kind == "vertices" || kind == "Vertices") return written(std::vector<Index>{value}, kind);
    if (is_plural(kind)) return plural(value, kind);
    return std::to_string(value + (kind == "side" && wording_.panel ? 1 : 0)) + (kind == "degrees" ? degrees() : "");
  }
  std::string written(double value, std::string_view kind) { return number(value) + (kind == "degrees" ? degrees() : ""); }
  std::string written(const std::string& value, std::string_view kind) {
    const auto found = wording_.names.find(value);
    if (kind == "problem") return value.substr(0, value.find(". "));
    return kind == "names" && found != wording_.names.end() ? found->second : value;
  }
  std::string written(const std::vector<std::string>& values, std::string_view kind) {
    if (is_plural(kind)) return plural(static_cast<Index>(values.size()), kind);
    std::string out;
    for (const std::string& value : values) out += (out.empty() ? "" : ", ") + written(value, kind);
    return out;
  }
  std::string written(const std::vector<Index>& vertices, std::string_view kind) {
    if (is_plural(kind)) return plural(static_cast<Index>(vertices.size()), kind);
    const bool begins = kind == "Vertices", are_vertices = begins || kind == "vertices";
    missing_ |= vertices.empty() || (are_vertices && wording_.vertices == Wording::Vertices::unnamed);
    if (!are_vertices) return listed(vertices);
    const std::string many = vertices.size() == 1 ? "ex" : "ices";
    if (wording_.vertices == Wording::Vertices::selected) return (begins ? "The selected vert" : "the selected vert") + many;
    return (begins ? "Vert" : "vert") + many + " " + listed(vertices);
  }
  std::string written(const std::shared_ptr<const Message>& message, std::string_view kind) {
    return written(text(*message, wording_), kind);
  }

  const char* degrees() const { return wording_.panel ? "°" : " degrees"; }

  const Message& message_;
  const Wording& wording_;
  bool missing_ = false;
};

std::string text_of(const Message& message, const Messages& also) {
  std::string all_said = message.text();
  for (const Message& each : also) all_said += ". " + each.text();
  return all_said;
}

}  // namespace

std::span<const AboutMessage> messages() { return all; }

const AboutMessage& about(Code code) { return all[static_cast<std::size_t>(code)]; }

std::string format(std::string_view pattern, const Message& message, const Wording& wording) {
  return Formatter(message, wording)(pattern);
}

std::string text(const Message& message, const Wording& wording) {
  const AboutMessage& row = about(message.code);
  return format(wording.panel && *row.panel ? row.panel : row.sentence, message, wording);
}

Message with_vertices(Message message, const std::function<Index(Index)>& named) {
  const auto rename = [&](std::vector<Index>& vertices) {
    for (Index& v : vertices) v = named(v);
    std::erase_if(vertices, [](Index v) { return v < 0; });
  };
  rename(message.where);
  for (Parameter& each : message.parameters)
    if (auto* const vertices = std::get_if<std::vector<Index>>(&each.value)) rename(*vertices);
  return message;
}

std::string Message::text() const { return tripatch::text(*this); }

CodedRefusal::CodedRefusal(Message message, Messages also)
    : Refusal(text_of(message, also), message.where), message_(std::move(message)), also_(std::move(also)) {}

CodedArgument::CodedArgument(Code code, std::vector<Parameter> parameters)
    : InvalidArgument(text({code, parameters})), message_{code, std::move(parameters)} {}

}  // namespace tripatch
