#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <titop/analysis/control/loop.hpp>
#include <titop/analysis/reduction/remove_signals.hpp>
#include <titop/compiler/passes/stage.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/graph/declared.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/nodes/gain.hpp>

namespace titop {
namespace {

using linalg::at;

enum class Wanted { L, S, T };

/// The node's one-way signal of this role.
int port_of(const Graph& g, int node, Signal::Role role) {
  const Node& n = g.nodes[at(node)];
  for (int s = n.first_signal; s < n.end_signal; ++s)
    if (g.signals[at(s)].role == role) return s;
  return -1;
}

/// The diagram without its inputs and outputs; the motions' signals follow.
Graph without_ports(const Graph& from, std::vector<RigidMotion>& motions) {
  Graph g = from;
  std::vector<char> external;
  std::vector<int> before{0};
  for (const Signal& s : g.signals) {
    external.push_back(s.role == Signal::Role::external);
    before.push_back(before.back() + external.back());
  }
  for (RigidMotion& m : motions) m.signal -= before[at(m.signal)];
  detail::remove_signals(g, external);
  for (Equation& e : g.equations)
    std::erase_if(e.terms, [](const Term& t) { return t.signal < 0; });
  g.inputs.clear();
  g.outputs.clear();
  return g;
}

/// The signals of a cut: u is fed into the diagram after the cut, r returns to it.
struct CutSignals {
  int r = -1, u = -1;  ///< the loop point's input and output
  int d = -1;          ///< the new external input
};

/// Adds an input and an output of the loop point's name: the sum that returns, or u. Returns the
/// cut; in the closed loop u is r, or r + d.
CutSignals add_ports(Graph& g, int node, Wanted wanted) {
  CutSignals c{port_of(g, node, Signal::Role::input), port_of(g, node, Signal::Role::output), -1};
  const Node n = g.nodes[at(node)];
  const int size = g.signals[at(c.r)].size;
  c.d = add_input(g, n.name, size, n.where);
  Output output{.name = n.name, .size = size, .set = true, .terms = {}, .where = n.where};
  output.declared = static_cast<int>(g.outputs.size());
  if (wanted == Wanted::S) output.terms = {{.signal = c.u}};
  for (const Equation& e : g.equations)
    if (e.target == c.r && wanted != Wanted::S)
      for (Term t : e.terms) {
        t.sign = -t.sign;
        output.terms.push_back(std::move(t));
      }
  g.outputs.push_back(std::move(output));
  return c;
}

void replace(std::vector<Term>& terms, int signal, int by) {
  for (Term& t : terms)
    if (t.signal == signal) t.signal = by;
}

/// L: everything that reads u reads the input instead. S, T: the input is added to r.
void apply(Graph& g, const CutSignals& c, Wanted wanted) {
  for (Equation& e : g.equations) {
    if (wanted == Wanted::L) replace(e.terms, c.u, c.d);
    if (wanted != Wanted::L && e.target == c.r) e.terms.push_back({.signal = c.d});
  }
  if (wanted == Wanted::L)
    for (Output& o : g.outputs) replace(o.terms, c.u, c.d);
}

System compiled(const System& system, const std::vector<int>& nodes, Wanted wanted) {
  const auto rewritten = [&](const Stage& stage) {
    Stage begin;
    begin.values = stage.values;
    begin.motions = stage.motions;
    begin.before = stage.dependents;
    Graph g = without_ports(stage.written(), begin.motions);
    std::vector<CutSignals> cuts;
    for (const int node : nodes) cuts.push_back(add_ports(g, node, wanted));
    for (const CutSignals& c : cuts) apply(g, c, wanted);
    begin.source = std::make_shared<const Graph>(std::move(g));
    return begin;
  };
  // Modes that the loop does not reach or see would count as poles of the closed loop.
  constexpr int kOfAnySize = std::numeric_limits<int>::max();
  return System(detail::compile_rewritten(detail::data_of(system), rewritten,
                                          wanted == Wanted::L ? kOfAnySize : 0));
}

/// The node of this name; -1 with a mistake if it is no loop point.
int find(const System& system, const std::string& name, std::vector<Mistake>& mistakes) {
  const Graph& g = system.stage().written();
  for (std::size_t n = 0; n < g.nodes.size(); ++n)
    if (g.nodes[n].name == name && is_loop_point(*g.nodes[n].block)) return static_cast<int>(n);
  const std::vector<std::string> known = loop_points(system);
  mistakes.push_back(
      {Code::unknown_name,
       fmt::format("{} has no loop point {}", g.name, name),
       {},
       known.empty() ? fmt::format("mark one in the diagram: d.loop_point(\"{}\", signal)", name)
                     : fmt::format("its loop points are {}", fmt::join(known, ", "))});
  return -1;
}

}  // namespace

std::vector<std::string> loop_points(const System& system) {
  const Graph& g = system.stage().written();
  std::vector<std::string> names;
  for (const int n : detail::as_declared(g.nodes))
    if (is_loop_point(*g.nodes[at(n)].block)) names.push_back(g.nodes[at(n)].name);
  return names;
}

ControlLoop mimo_loop(const System& system, const std::vector<std::string>& names) {
  std::vector<Mistake> mistakes;
  std::vector<int> nodes;
  for (const std::string& name : names) {
    if (std::count(names.begin(), names.end(), name) > 1) {
      mistakes.push_back({Code::duplicate_name,
                          fmt::format("loop point {} is given twice", name),
                          {},
                          "a loop is cut once at each point"});
      break;
    }
    nodes.push_back(find(system, name, mistakes));
  }
  if (names.empty())
    mistakes.push_back(
        {Code::bad_value, "a loop without a loop point", {}, "give the names of one or more"});
  if (!mistakes.empty()) throw Error(std::move(mistakes));
  return {names, compiled(system, nodes, Wanted::L), compiled(system, nodes, Wanted::S),
          compiled(system, nodes, Wanted::T)};
}

ControlLoop loop(const System& system, const std::string& name) {
  return mimo_loop(system, {name});
}

}  // namespace titop
