#include "commands/diagram.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <titop/blocks/diagram_file/diagram_file.hpp>
#include <titop/blocks/fe/text_file.hpp>

namespace titop::command_line {
namespace {

using Json = nlohmann::ordered_json;

/// Sets the nominal value of a parameter of the diagram file.
void set(Json& diagram, const std::string& name, double value) {
  std::vector<std::string> names;
  for (Json& parameter : diagram["parameters"]) {
    if (parameter["name"] == name) {
      parameter["value"] = value;
      return;
    }
    names.push_back(parameter["name"]);
  }
  throw Error(
      Code::unknown_name, fmt::format("--set {}: the diagram has no such parameter", name),
      names.empty() ? "it has none" : fmt::format("its parameters are {}", fmt::join(names, ", ")));
}

constexpr const char* kKeepDigits =
    "  frequency responses keep the digits (titop export DIAGRAM.json FILE.csv), in C++ also\n"
    "  System::transfer, apply and simulate; a reduced model of the required band may keep them:\n"
    "  titop reduce DIAGRAM.json FILE --band LOW HIGH\n";

}  // namespace

Diagram diagram_of(const Arguments& a) {
  Diagram diagram = read_diagram(a.words[1]);  // refuses other files
  if (a.set.empty()) return diagram;
  const fe::TextFile file = fe::read_text(a.words[1]);
  Json json = Json::parse(file.content);
  for (const auto& [name, value] : a.set) set(json, name, value);
  return parse_diagram(json.dump(), file.name);
}

System compiled(const Arguments& a) {
  return compile(diagram_of(a), {.minimize_up_to = a.minimize_up_to});
}

void warn_of_lost_digits(const System& system) {
  const std::vector<std::string> warnings = dense_warnings(system);
  std::string text;
  for (const std::string& w : warnings) text += fmt::format("warning: {}\n", w);
  if (!warnings.empty()) std::fputs((text + kKeepDigits).c_str(), stderr);
}

}  // namespace titop::command_line
