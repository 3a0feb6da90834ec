#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <titop/compiler/loops/chain_parts.hpp>
#include <titop/compiler/passes/moves_points.hpp>
#include <titop/compiler/system/compile_graph.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/graph/linalg/index.hpp>

/// A system whose diagram is rewritten. Parameters are taken out: which of them it refuses, and the
/// passes on the rest.
namespace titop::detail {
namespace {

using linalg::at;

/// The parameter is in an equation or a body on the way round a closed chain, or integrals are
/// repeated. Internal forces that are read are found in the opened diagram itself.
bool on_chains(const Skeleton& k, const loops::ChainParts& parts, int parameter,
               ParameterValues before, ParameterValues now) {
  const Stage& stage = k.stage;
  const Dependents& d = k.dependents[at(parameter)];
  const auto integrates = [&](const Dependent& x) {
    return stage.graph.nodes[at(x.node)].block->interface().channels.empty();
  };
  if (!stage.chained || std::any_of(stage.dependents.begin(), stage.dependents.end(), integrates))
    return true;
  const auto in = [](const std::vector<int>& list, int x) {
    return std::binary_search(list.begin(), list.end(), x);
  };
  return std::any_of(d.origins.begin(), d.origins.end(),
                     [&](int o) { return in(parts.equations, o); }) ||
         std::any_of(d.nodes.begin(), d.nodes.end(), [&](int i) {
           return in(parts.nodes, i) &&
                  passes::moves_points(*stage.graph.nodes[at(i)].block, before, now);
         });
}

/// Changed values of angles and lengths would close a chain elsewhere.
void refuse_moving_chains(const Skeleton& k, const std::vector<double>& values,
                          const std::vector<passes::ToOpen>& parameters) {
  std::vector<Mistake> mistakes;
  std::optional<loops::ChainParts> parts;
  for (const passes::ToOpen& p : parameters) {
    std::vector<double> other = values;
    other[at(p.parameter)] += 0.1;  // any other value
    if (!moves_chains(k, {p.parameter}, values, other)) continue;
    if (!parts) parts = loops::parts_of_chains(k.stage);
    if (!on_chains(k, *parts, p.parameter, values, other)) continue;
    const auto& name = k.stage.graph.parameters[at(p.parameter)].name;
    mistakes.push_back(
        {Code::not_rational,
         fmt::format("{}: the parameter {} changes how the points of a closed chain move, or of "
                     "repeated integrals",
                     k.stage.graph.name, name),
         {},
         "use sweep, which closes the chains anew at each value"});
  }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

}  // namespace

std::shared_ptr<const SystemData> compile_rewritten(
    const SystemData& d, const std::function<Stage(const Stage&)>& rewrite, int minimize_up_to) {
  const Skeleton& k = *d.skeleton;
  Stage begin;
  begin.source = k.stage.source;
  begin.values = d.numbers.parameters;
  begin.motions = k.stage.motions;
  begin.dependents = k.stage.dependents;
  Options options = k.options;
  options.dump_to.clear();
  options.minimize_up_to = std::max(options.minimize_up_to, minimize_up_to);
  return compile_stage(rewrite(begin), options);
}

std::shared_ptr<const SystemData> compile_opened(const SystemData& d,
                                                 const std::vector<passes::ToOpen>& parameters) {
  refuse_moving_chains(*d.skeleton, d.numbers.parameters, parameters);
  return compile_rewritten(
      d, [&](const Stage& stage) { return passes::open_parameters(stage, parameters); });
}

}  // namespace titop::detail
