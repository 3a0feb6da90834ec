#include <fmt/format.h>

#include <cmath>
#include <titop/graph/port.hpp>

namespace titop::detail {
namespace {

/// A port that was never one: "the only child" of a body that has none, or several.
bool missing(Graph* graph, int signal, const std::source_location& where) {
  if (!graph || signal >= 0) return !graph;
  if (signal <= -2) note_unknown_channel(*graph, -2 - signal, "child", where);
  return true;
}

int size_of(const Graph* graph, int signal, const Part& part) {
  if (!graph || signal < 0) return 6;
  if (!part.whole()) return static_cast<int>(part.rows.rows());
  return graph->signals[static_cast<std::size_t>(signal)].size;
}

std::string named(const Graph& graph, int node, std::string_view what) {
  return fmt::format("{}.{}", graph.nodes[static_cast<std::size_t>(node)].name, what);
}

const Interface& face_of(const Graph& graph, int node) {
  return graph.nodes[static_cast<std::size_t>(node)].block->interface();
}

}  // namespace

Expr SignalRef::expr() const {
  if (missing(graph_, signal_, {})) return Expr(graph_, Term{.signal = -1});
  Term term{.signal = signal_, .of = of_};
  if (!part_.whole()) term.factors.emplace_back(part_);
  return Expr(graph_, std::move(term));
}

void SignalRef::set(const Rhs& rhs, bool accumulate, double sign) const {
  if (missing(graph_, signal_, rhs.where())) return;
  if (rhs.expr().graph() && rhs.expr().graph() != graph_)
    throw Error(Code::unknown_name,
                fmt::format("the equation of {} takes a signal from another diagram",
                            name_of(*graph_, signal_)),
                "take both sides from the same Diagram");
  Equation equation{signal_, part_, accumulate, rhs.expr().terms(), rhs.where()};
  for (Term& term : equation.terms) term.sign *= sign;
  note_foreign_parameters(*graph_, equation.terms, rhs.where());
  graph_->equations.push_back(std::move(equation));
}

SignalRef SignalRef::linear() const {
  SignalRef half = *this;
  half.part_ = {Eigen::MatrixXd::Identity(3, 6), ".linear"};
  return half;
}

SignalRef SignalRef::angular() const {
  SignalRef half = *this;
  half.part_ = {Eigen::MatrixXd::Zero(3, 6), ".angular"};
  half.part_.rows.rightCols(3).setIdentity();
  return half;
}

SignalRef SignalRef::along(const Vector3d& r) const {
  if (!(r.norm() > 0) || !std::isfinite(r.norm()))
    throw Error(Code::bad_value,
                fmt::format("{}.along({}, {}, {}): no direction", name_of(*graph_, signal_), r.x(),
                            r.y(), r.z()),
                "give a finite vector other than 0");
  SignalRef component = *this;
  component.part_.rows = (r.normalized().transpose() * part_.rows).eval();
  component.part_.name += fmt::format(".along({}, {}, {})", r.x(), r.y(), r.z());
  if (size_of(graph_, signal_, part_) != 3)
    throw Error(Code::size, fmt::format("{} has no direction", name_of(*graph_, signal_)),
                "along(r) belongs to vectors of size 3");
  return component;
}

int port_signal(const Graph& graph, int node, std::string_view name) {
  const Node& n = graph.nodes[static_cast<std::size_t>(node)];
  const Interface& face = n.block->interface();
  int signal = n.first_signal + 2 * static_cast<int>(face.channels.size());
  for (const auto* ports : {&face.inputs, &face.outputs})
    for (const PortSpec& p : *ports) {
      if (p.name == name) return signal;
      ++signal;
    }
  throw Error(Code::unknown_name, fmt::format("{} does not exist", named(graph, node, name)),
              fmt::format("a {} has no such port", n.block->type()));
}

int find_channel(const Graph& graph, int node, std::string_view name) {
  const auto& channels = face_of(graph, node).channels;
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (channels[i].name == name) return static_cast<int>(i);
  return -1;
}

int find_child(const Graph& graph, int node, std::string_view name) {
  const int spec = find_channel(graph, node, name);
  return spec >= 0 &&
                 face_of(graph, node).channels[static_cast<std::size_t>(spec)].takes == Takes::force
             ? spec
             : -1;
}

void note_foreign_parameters(Graph& graph, const std::vector<Term>& terms,
                             const std::source_location& at) {
  const auto look_at = [&](const Value& v) {
    if (!v.is_parameter() || v.owner() == &graph) return;
    graph.mistakes.push_back(
        {Code::unknown_name,
         fmt::format("a parameter of another diagram, nominally {}, is used", v.parameter()),
         {"written at " + to_string(at)},
         "make the parameter with param(...) of this diagram"});
  };
  for (const Term& term : terms)
    for (const Factor& factor : term.factors) {
      if (const auto* k = std::get_if<Value>(&factor)) look_at(*k);
      if (const auto* T = std::get_if<Rotation>(&factor))
        for (const Value& angle : T->values()) look_at(angle);
    }
}

int only_child(const Graph& graph, int node) {
  int found = -1;
  const auto& channels = face_of(graph, node).channels;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].name == "parent" || channels[i].takes != Takes::force) continue;
    if (found >= 0) return -1;
    found = static_cast<int>(i);
  }
  return found;
}

void note_unknown_channel(Graph& graph, int node, std::string_view name, std::source_location at) {
  std::string names;
  for (const ChannelSpec& c : face_of(graph, node).channels)
    if (c.takes == Takes::force) names += (names.empty() ? "" : ", ") + c.name;
  const std::string& who = graph.nodes[static_cast<std::size_t>(node)].name;
  Mistake mistake{Code::unknown_name, {}, {}, {}};
  mistake.message = name == "child"
                        ? fmt::format("{}.child: {} has not exactly one child point", who, who)
                        : fmt::format("{} has no child point \"{}\"", who, name);
  if (at.line() != 0) mistake.details.push_back("written at " + to_string(at));
  mistake.hint = names.empty() ? fmt::format("{} has no child points; add one to its data", who)
                               : fmt::format("its child points are: {}", names);
  graph.mistakes.push_back(std::move(mistake));
}

}  // namespace titop::detail
