#include <titop/compiler/passes/stage.hpp>

namespace titop {

std::string_view to_string(Note::Kind kind) {
  switch (kind) {
    case Note::Kind::info: return "info";
    case Note::Kind::inverted: return "inverted";
    case Note::Kind::removed: return "removed";
    case Note::Kind::unchecked: return "unchecked";
    case Note::Kind::warning: return "warning";
  }
  return "note";
}

Stage as_written(const Graph& graph) {
  Stage stage;
  stage.source = std::shared_ptr<const Graph>(std::shared_ptr<void>(), &graph);  // owns nothing
  stage.values = nominal_values(graph);
  return stage;
}

}  // namespace titop
