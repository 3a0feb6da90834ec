#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/graph/diagram.hpp>
#include <titop/graph/nodes/gain.hpp>

namespace titop {
namespace {

void note(Graph& graph, Code code, std::string message, std::string hint, const SourceLine& at) {
  graph.mistakes.push_back(
      {code, std::move(message), {"written at " + to_string(at)}, std::move(hint)});
}

}  // namespace

Diagram::Diagram(std::string name) : graph_(std::make_unique<Graph>()) {
  graph_->name = std::move(name);
}

Diagram Diagram::clone() const {
  Diagram copy(graph_->name);
  const std::uint64_t id = copy.graph_->id;
  *copy.graph_ = *graph_;
  copy.graph_->id = id;
  return copy;
}

int Diagram::add_block(std::string name, const std::function<BlockPtr()>& make, SourceLine at) {
  BlockPtr block;
  try {
    block = make();
  } catch (const Error& error) {  // a block's own mistakes do not contain the node's name
    std::vector<Mistake> mistakes = error.mistakes();
    for (Mistake& m : mistakes) {
      m.message = fmt::format("{}: {}", name, m.message);
      m.details.push_back(fmt::format("{} was added at {}", name, to_string(at)));
    }
    throw Error(std::move(mistakes));
  }
  for (const Value& v : block->values())
    if (v.is_parameter() && !detail::belongs_to(v, *graph_))
      note(*graph_, Code::unknown_name,
           fmt::format("{} takes a parameter of another diagram", name),
           "make the parameter with param(...) of this diagram", at);
  return add_node(*graph_, std::move(name), std::move(block), at);
}

InputRef Diagram::input(std::string name, int size, SourceLine at) {
  if (size < 1) {
    note(*graph_, Code::size, fmt::format("input {} has size {}", name, size),
         "give it at least one scalar", at);
    size = 1;
  }
  return {graph_.get(), add_input(*graph_, std::move(name), size, at)};
}

OutputRef Diagram::output(std::string name, int size, SourceLine at) {
  if (size < 1) {
    note(*graph_, Code::size, fmt::format("output {} has size {}", name, size),
         "give it at least one scalar", at);
    size = 1;
  }
  const int index = static_cast<int>(graph_->outputs.size());
  graph_->outputs.push_back({std::move(name), size, false, {}, at, index});
  return {graph_.get(), index};
}

Param Diagram::param(std::string name, double value, SourceLine at) {
  if (!std::isfinite(value))
    note(*graph_, Code::not_finite, fmt::format("parameter {} is {}", name, value),
         "give it a finite value", at);
  graph_->parameters.push_back({std::move(name), value, at});
  return {static_cast<int>(graph_->parameters.size()) - 1, value, graph_->id};
}

Reading Diagram::loop_point(std::string name, const Rhs& signal) {
  const std::vector<Term>& terms = signal.expr().terms();
  const bool known =
      !terms.empty() && terms.front().signal >= 0 && signal.expr().graph() == graph_.get();
  const int rows = known ? rows_of(*graph_, terms.front()) : 1;
  const int node = add_block(
      std::move(name), [&] { return as_block(LoopPoint{.size = std::max(rows, 1)}); },
      signal.where());
  const Gain::Handle handle{graph_.get(), node};
  handle.in = signal;
  return handle.out;
}

void OutputRef::operator=(const Rhs& rhs) const {
  Output& output = graph_->outputs[static_cast<std::size_t>(index_)];
  if (output.set)
    note(*graph_, Code::two_equations, fmt::format("output {} is set twice", output.name),
         fmt::format("keep one of them; the first is at {}", to_string(output.where)), rhs.where());
  output.set = true;
  if (rhs.expr().graph() && rhs.expr().graph() != graph_)
    throw Error(Code::unknown_name,
                fmt::format("output {} takes a signal from another diagram", output.name),
                "take both sides from the same Diagram", {"written at " + to_string(rhs.where())});
  output.terms = rhs.expr().terms();
  detail::note_missing(*graph_, output.terms, rhs.where());
  detail::note_foreign_parameters(*graph_, output.terms, rhs.where());
  output.where = rhs.where();
}

}  // namespace titop
