#include <fmt/format.h>

#include <algorithm>
#include <titop/compiler/passes/lower/by_name.hpp>
#include <titop/compiler/passes/lower/lowering.hpp>
#include <titop/compiler/passes/lower/open_motions.hpp>
#include <titop/compiler/passes/lower/rigid_motions.hpp>
#include <titop/compiler/passes/lower/shared_motions.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using linalg::at;

/// The lowered equations, one after the other, each with its origin.
struct Lowered {
  Lowering& l;
  std::vector<Equation> equations = {};
  std::vector<Origin> origins = {};

  std::vector<Term> terms(Origin origin, const SourceLine& where) {
    std::vector<Term> result = l.collect(where, [&] { return l.written_out(origin); });
    origins.push_back(std::move(origin));
    return result;
  }

  void equation(Origin origin, int target, Part part, const SourceLine& where) {
    std::vector<Term> list = terms(std::move(origin), where);
    equations.push_back(
        {.target = target, .part = std::move(part), .terms = std::move(list), .where = where});
  }

  void channel(int index) {
    const Channel& c = l.g.channels[at(index)];
    const Drive& d = l.drive[at(index)];
    for (const int e : d.accel)
      equation({Origin::Of::accel, e}, c.accel, l.g.equations[at(e)].part,
               l.g.equations[at(e)].where);
    if (d.free == 0) return;
    const std::span<const int> first = d.force.empty() ? d.added : d.force;
    equation({Origin::Of::force, index}, c.force, d.all_free() ? Part{} : Part{d.some, ".free"},
             first.empty() ? l.g.nodes[at(c.node)].where : l.g.equations[at(first.front())].where);
  }

  void one_way() {
    std::vector<int> list;
    for (int e = 0; e < static_cast<int>(l.g.equations.size()); ++e)
      if (l.g.signals[at(l.g.equations[at(e)].target)].channel < 0) list.push_back(e);
    std::sort(list.begin(), list.end(), [&](int a, int b) {
      return l.g.equations[at(a)].target < l.g.equations[at(b)].target;
    });
    for (const int e : list)
      equation({Origin::Of::one_way, e}, l.g.equations[at(e)].target, {},
               l.g.equations[at(e)].where);
  }

  void algebraic(int node) {
    const Node& n = l.g.nodes[at(node)];
    for (int o = n.first_signal; o < end_signal(l.g, node); ++o)
      if (l.g.signals[at(o)].role == Signal::Role::output) {
        equation({Origin::Of::algebraic, o}, o, {}, n.where);
        equations.back().of_block = true;
      }
  }

  void shared_motions(Graph& to) {
    for (const Lowering::SharedMotion& motion : l.shared) {
      const int node = add_shared_motion(to, motion), out = to.nodes[at(node)].first_signal;
      equation({Origin::Of::algebraic, out}, out, {}, to.nodes[at(node)].where);
      equations.back().of_block = true;
    }
  }
};

Graph without_equations(const Graph& g) {
  return {.name = g.name,
          .nodes = g.nodes,
          .channels = g.channels,
          .signals = g.signals,
          .equations = {},
          .inputs = g.inputs,
          .outputs = g.outputs,
          .parameters = g.parameters,
          .mistakes = {}};
}

}  // namespace

Stage lower(Stage stage) {
  Graph source = by_name(stage.written(), stage);
  open_motions(stage, source);
  add_rigid_motions(stage, source);
  stage.source = std::make_shared<const Graph>(std::move(source));
  Graph g = without_equations(*stage.source);
  auto all_drives = std::make_shared<const Drives>(*stage.source);
  Lowering l(*stage.source, stage.values, all_drives, stage.motions);
  l.share(find_shared_motions(stage, *stage.source));
  if (!g.parameters.empty()) stage.drives = std::move(all_drives);
  Lowered out{l};
  out.equations.reserve(stage.source->equations.size() + g.channels.size());
  out.origins.reserve(stage.source->equations.size() + g.channels.size() + g.outputs.size());
  for (int c = 0; c < static_cast<int>(g.channels.size()); ++c) out.channel(c);
  out.one_way();
  int algebraic = 0;
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i)
    if (g.nodes[at(i)].block->is_algebraic()) {
      out.algebraic(i);
      g.nodes[at(i)].lowered = true;
      ++algebraic;
    }
  out.shared_motions(g);
  for (int o = 0; o < static_cast<int>(g.outputs.size()); ++o)
    g.outputs[at(o)].terms = out.terms({Origin::Of::output, o}, g.outputs[at(o)].where);
  if (!l.mistakes.empty()) throw Error(std::move(l.mistakes));
  if (!l.missing.empty()) throw std::logic_error("a motion without an Integrator");
  if (l.astray) throw std::logic_error("a shared motion that does not lead to its anchor");
  g.equations = std::move(out.equations);
  stage.origins = std::move(out.origins);
  stage.graph = std::move(g);
  stage.notes.push_back(
      {Note::Kind::info, "lower",
       fmt::format("{} blocks, of which {} became coefficients (sums, gains); {} equations",
                   stage.source->nodes.size(), algebraic, stage.graph.equations.size())});
  if (!l.shared.empty())
    stage.notes.push_back(
        {Note::Kind::info, "lower",
         fmt::format("{} positions and rates along long chains are unknowns of their own: several "
                     "equations read them",
                     l.shared.size())});
  return stage;
}

bool lower_again(const Stage& stage, const std::vector<int>& origins, ParameterValues values,
                 const std::function<bool(int, std::span<const NumericTerm>)>& take) {
  Lowering l(*stage.source, values, stage.drives, stage.motions);
  l.numbers_only = true;
  l.share(shared_motions_of(stage));
  std::vector<NumericTerm> terms;
  return std::all_of(origins.begin(), origins.end(), [&](int origin) {
    terms.clear();
    for (Summand& s : summed(l.amount(stage.origins[at(origin)])))
      terms.push_back({s.signal, std::move(s.c)});
    return l.missing.empty() && !l.astray && take(origin, terms);
  });
}

}  // namespace titop::passes
