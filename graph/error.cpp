#include <fmt/format.h>

#include <algorithm>
#include <titop/graph/error.hpp>

namespace titop {

std::string_view to_string(Code code) {
  switch (code) {
    case Code::no_equation: return "no-equation";
    case Code::two_equations: return "two-equations";
    case Code::size: return "size";
    case Code::quantity: return "quantity";
    case Code::frame: return "frame";
    case Code::unknown_name: return "unknown-name";
    case Code::duplicate_name: return "duplicate-name";
    case Code::not_finite: return "not-finite";
    case Code::not_a_rotation: return "not-a-rotation";
    case Code::structure: return "structure";
    case Code::ill_posed: return "ill-posed";
    case Code::improper: return "improper";
    case Code::kinematic_loop: return "kinematic-loop";
    case Code::bad_inertia: return "bad-inertia";
    case Code::bad_modes: return "bad-modes";
    case Code::bad_file: return "bad-file";
    case Code::bad_value: return "bad-value";
    case Code::singular: return "singular";
    case Code::not_rational: return "not-rational";
  }
  return "unknown";
}

std::string to_string(const SourceLine& where) {
  if (where.line() == 0) return "a diagram file";  // no source line: read from a file
  std::string_view path = where.file_name();
  const auto last = path.rfind('/');
  if (last != std::string_view::npos && last > 0) {
    const auto before = path.rfind('/', last - 1);
    if (before != std::string_view::npos) path.remove_prefix(before + 1);
  }
  return fmt::format("{}:{}", path, where.line());
}

namespace {

std::string print(const std::vector<Mistake>& mistakes) {
  std::string text;
  for (const Mistake& m : mistakes) {
    if (!text.empty()) text += "\n\n";
    text += fmt::format("error[{}]: {}", to_string(m.code), m.message);
    for (const std::string& line : m.details) text += "\n  " + line;
    if (!m.hint.empty()) text += "\n  " + m.hint;
  }
  return text;
}

}  // namespace

Error::Error(std::vector<Mistake> mistakes)
    : mistakes_(std::move(mistakes)), text_(print(mistakes_)) {}

Error::Error(Mistake mistake) : Error(std::vector<Mistake>{std::move(mistake)}) {}

Error::Error(Code code, std::string message, std::string hint, std::vector<std::string> details)
    : Error(Mistake{code, std::move(message), std::move(details), std::move(hint)}) {}

bool Error::has(Code code) const {
  return std::any_of(mistakes_.begin(), mistakes_.end(),
                     [&](const Mistake& m) { return m.code == code; });
}

}  // namespace titop
