#include <fmt/format.h>

#include <algorithm>
#include <titop/graph/closed_form.hpp>
#include <titop/graph/error.hpp>

namespace titop {

const ClosedForm* closed_form_of(const Block& block) {
  if (!block.interface().states.empty()) return nullptr;
  return dynamic_cast<const ClosedForm*>(&block);
}

bool has_closed_form(const Graph& graph) {
  return std::ranges::any_of(graph.nodes,
                             [](const Node& n) { return closed_form_of(*n.block) != nullptr; });
}

namespace {

Mistake mistake_of(const std::string& name, const ClosedForm& block) {
  const Block::Cause cause = block.no_state_space();
  return {Code::not_rational, fmt::format("{} {}", name, cause.why), {}, cause.way_out};
}

}  // namespace

void require_state_space(const Graph& graph) {
  std::vector<Mistake> mistakes;
  for (const Node& node : graph.nodes)
    if (const ClosedForm* block = closed_form_of(*node.block))
      mistakes.push_back(mistake_of(node.name, *block));
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

void require_state_space(const Block& block) {
  if (const ClosedForm* closed = closed_form_of(block))
    throw Error(mistake_of(fmt::format("a {}", block.type()), *closed));
}

}  // namespace titop
