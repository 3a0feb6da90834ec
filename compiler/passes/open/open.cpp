#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/passes/open/differences.hpp>
#include <titop/compiler/passes/open/open.hpp>
#include <titop/compiler/passes/open/open_terms.hpp>
#include <titop/compiler/passes/open/opened_block.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// The graph with blocks opened, before its equations are.
struct Opening {
  const Graph& from;
  ParameterValues values;
  std::span<const ToOpen> parameters;
  Graph to = {};
  std::vector<int> signal = {};                         ///< of each signal in `from`
  std::vector<std::vector<ParameterPorts>> ports = {};  ///< per node
  std::vector<Mistake> mistakes = {};
  std::vector<Note> notes = {};
  std::vector<ByDifferences> by_differences = {};

  std::vector<int> opened_of(const Node& node) const {
    std::vector<int> result;
    const std::vector<Value> all = node.block->values();
    for (const ToOpen& p : parameters)
      if (std::any_of(all.begin(), all.end(),
                      [&](const Value& v) { return v.is_parameter() && v.index() == p.parameter; }))
        result.push_back(p.parameter);
    return result;
  }

  void refuse(const Node& node, int parameter) {
    mistakes.push_back(
        {Code::not_rational,
         fmt::format("{}: a {} does not say how it depends on the parameter {}", node.name,
                     node.block->type(), from.parameters[at(parameter)].name),
         {},
         "write Block::opened for it, or leave the parameter out and use sweep"});
  }

  /// Refuses the parameter if its derivative is not known; one of 0 has no pairs.
  void check_difference(const Node& node, int parameter) {
    const auto why = why_no_differences(*node.block, values, parameter);
    if (!why) {
      by_differences.push_back({parameter, node.name});
      return;
    }
    mistakes.push_back(
        {Code::not_rational,
         fmt::format("{}: a {} has no derivative by the parameter {}: {}", node.name,
                     node.block->type(), from.parameters[at(parameter)].name, why->message),
         {},
         why->hint});
  }

  void note_difference(const Node& node, int parameter) {
    by_differences.push_back({parameter, node.name});
    notes.push_back(
        {Note::Kind::unchecked, "open",
         fmt::format("{}: the derivative by {} is that of the {}'s matrices by "
                     "differences, to 1e-12 of entries that change by their own size",
                     node.name, from.parameters[at(parameter)].name, node.block->type())});
  }

  void refuse_motion(const Node& node, int parameter) {
    mistakes.push_back(
        {Code::not_rational,
         fmt::format(
             "{}: a {} moves its points with the parameter {}, and its opened() does not say "
             "how",
             node.name, node.block->type(), from.parameters[at(parameter)].name),
         {},
         "give Opened::motions (OpenedPair::moves), or leave the parameter out and use sweep"});
  }

  BlockPtr block_of(const Node& node) {
    const std::vector<int> wanted = opened_of(node);
    ports.emplace_back();
    if (wanted.empty()) return node.block;
    const bool differences = std::any_of(parameters.begin(), parameters.end(),
                                         [](const ToOpen& p) { return p.differences; });
    ports.back() = opened_ports(*node.block, values, wanted, differences);
    for (const int p : wanted)
      if (std::none_of(ports.back().begin(), ports.back().end(),
                       [&](const ParameterPorts& o) { return o.parameter == p; }))
        differences ? check_difference(node, p) : refuse(node, p);
      else if (moves_points_unsaid(*node.block, values, p))
        refuse_motion(node, p);
      else if (differences && !is_opened_by(*node.block, values, p))
        note_difference(node, p);
    return ports.back().empty() ? node.block : opened_block(node.block, ports.back(), differences);
  }

  void nodes() {
    to.name = from.name;
    to.parameters = from.parameters;
    signal.assign(from.signals.size(), -1);
    for (const Node& node : from.nodes) {
      const int n = add_node(to, node.name, block_of(node), node.where);
      to.nodes[at(n)].declared = node.declared;
      const int more = static_cast<int>(ports.back().size());
      for (int s = node.first_signal; s < node.end_signal; ++s) {
        const Signal& old = from.signals[at(s)];
        int place = to.nodes[at(n)].first_signal + s - node.first_signal;
        if (old.channel < 0 && old.role == Signal::Role::output) place += more;
        if (old.role == Signal::Role::state) place += 2 * more;
        signal[at(s)] = place;
      }
    }
    for (const Input& u : from.inputs) {
      signal[at(u.signal)] = add_input(to, u.name, u.size, u.where);
      to.inputs.back().declared = u.declared;
    }
    to.outputs = from.outputs;
  }

  std::vector<Term> moved(std::vector<Term> terms) const {
    for (Term& t : terms) t.signal = signal[at(t.signal)];
    return terms;
  }

  /// The one-way signal of this role and port of the node.
  int port_signal(int node, Signal::Role role, int port) const {
    const Node& n = to.nodes[at(node)];
    for (int s = n.first_signal; s < n.end_signal; ++s)
      if (const Signal& x = to.signals[at(s)]; x.channel < 0 && x.role == role && x.spec == port)
        return s;
    return -1;
  }

  void pairs_of_blocks(OpenTerms& terms) {
    for (int n = 0; n < static_cast<int>(to.nodes.size()); ++n) {
      const Interface& face = to.nodes[at(n)].block->interface();
      const int more = static_cast<int>(ports[at(n)].size()),
                inputs = static_cast<int>(face.inputs.size()) - more,
                outputs = static_cast<int>(face.outputs.size()) - more;
      for (int p = 0; p < more; ++p) {
        const ParameterPorts& port = ports[at(n)][at(p)];
        const int w = terms.pair(port.parameter, port.size, to.nodes[at(n)].name);
        to.outputs.back().terms = {{.signal = port_signal(n, Signal::Role::output, outputs + p)}};
        to.equations.push_back(
            {.target = port_signal(n, Signal::Role::input, inputs + p), .terms = {{.signal = w}}});
      }
    }
  }

  void equations(OpenTerms& terms) {
    for (const Equation& e : from.equations) {
      Equation q = e;
      q.target = signal[at(e.target)];
      q.terms = terms.opened(moved(e.terms), name_of(to, q.target));
      to.equations.push_back(std::move(q));
    }
    for (std::size_t i = 0; i < from.outputs.size(); ++i) {
      std::vector<Term> sum = terms.opened(moved(from.outputs[i].terms), from.outputs[i].name);
      to.outputs[i].terms = std::move(sum);
    }
  }

  /// Parameters that are an angle somewhere and a number elsewhere.
  void refuse_mixed() {
    std::vector<char> angle(from.parameters.size(), 0), number(from.parameters.size(), 0);
    const auto mark = [](std::vector<char>& list, const std::vector<Value>& all) {
      for (const Value& v : all)
        if (v.is_parameter()) list[at(v.index())] = 1;
    };
    const auto look = [&](const std::vector<Term>& terms) {
      for (const Term& t : terms)
        for (const Factor& f : t.factors)
          if (const auto* T = std::get_if<Rotation>(&f))
            mark(angle, T->values());
          else if (const auto* k = std::get_if<Value>(&f))
            mark(number, {*k});
    };
    for (const Node& n : from.nodes) mark(number, n.block->values());
    for (const Equation& e : from.equations) look(e.terms);
    for (const Output& y : from.outputs) look(y.terms);
    for (const ToOpen& p : parameters)
      if (angle[at(p.parameter)] && number[at(p.parameter)])
        mistakes.push_back({Code::not_rational,
                            fmt::format("the parameter {} is an angle and also a number elsewhere",
                                        from.parameters[at(p.parameter)].name),
                            {},
                            "declare two parameters, or use sweep"});
  }
};

}  // namespace

Stage open_parameters(const Stage& stage, std::span<const ToOpen> parameters) {
  Stage result;
  result.values = stage.values;
  result.motions = stage.motions;
  result.before = stage.dependents;
  Opening o{stage.written(), stage.values, parameters};
  o.refuse_mixed();
  o.nodes();
  if (!o.mistakes.empty()) throw Error(std::move(o.mistakes));
  OpenTerms terms(o.to, stage.values, parameters, result.opened);
  o.equations(terms);
  o.pairs_of_blocks(terms);
  if (!terms.mistakes.empty()) throw Error(std::move(terms.mistakes));
  for (RigidMotion& m : result.motions) m.signal = o.signal[at(m.signal)];
  result.notes = std::move(o.notes);
  result.by_differences = std::move(o.by_differences);
  result.source = std::make_shared<const Graph>(std::move(o.to));
  return result;
}

}  // namespace titop::passes
