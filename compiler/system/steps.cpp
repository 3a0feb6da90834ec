#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <titop/compiler/index_reduction/reduce.hpp>
#include <titop/compiler/loops/internal_forces.hpp>
#include <titop/compiler/solve/data_digits.hpp>
#include <titop/compiler/solve/layout.hpp>
#include <titop/compiler/solve/margins.hpp>
#include <titop/compiler/solve/weak_pivot.hpp>
#include <titop/compiler/system/steps.hpp>
#include <titop/graph/ahead.hpp>
#include <titop/graph/data_digits.hpp>

namespace titop::steps {
namespace {

void add_notes(const std::vector<Note>& more, detail::SystemData& d) {
  d.notes.insert(d.notes.end(), more.begin(), more.end());
}

}  // namespace

Compiled layout(Compiled c) {
  detail::Skeleton& k = *c.skeleton;
  k.layout = detail::make_layout(k.stage.graph);
  c.data->states = detail::StateMap(k.stage.dependents, k.layout);
  return c;
}

Compiled blocks(Compiled c) {
  const Stage& stage = c.skeleton->stage;
  titop::solve::Numbers& numbers = c.data->numbers;
  numbers.parameters = stage.values;
  for (const Node& node : stage.graph.nodes) {
    fetch_ahead(stage.graph, numbers.blocks.size());
    numbers.blocks.push_back(node.block->dynamics(stage.values));
  }
  return c;
}

Compiled join(Compiled c) {
  c.skeleton->joint = titop::solve::joint(c.skeleton->stage, c.data->numbers.coefficients);
  return c;
}

bool has_parameters(const Compiled& c) { return !c.skeleton->stage.graph.parameters.empty(); }

Compiled depend(Compiled c) {
  detail::Skeleton& k = *c.skeleton;
  k.dependents = detail::find_dependents(k.stage, k.joint);
  for (std::size_t i = 0; i < k.dependents.size(); ++i)
    if (k.dependents[i].nodes.empty() && k.dependents[i].origins.empty())
      c.data->notes.push_back(
          {Note::Kind::info, "depend",
           fmt::format("parameter {}: nothing depends on it", k.stage.graph.parameters[i].name)});
  return c;
}

Compiled solve(Compiled c) {
  detail::Skeleton& k = *c.skeleton;
  detail::SystemData& d = *c.data;
  d.factors = std::make_unique<const titop::solve::Factors<double>>(
      k.joint.plan, detail::real_rows(k, d.numbers));
  d.scaled_at = d.numbers.parameters;
  d.scaled_health = d.factors->health();
  d.notes.push_back({Note::Kind::info, "solve",
                     fmt::format("{} unknowns in {} fronts", k.joint.plan->unknowns,
                                 k.joint.plan->fronts.size())});
  return c;
}

Compiled pivots(Compiled c) {
  detail::SystemData& d = *c.data;
  d.changed_loops.resize(c.skeleton->stage.loops.size());
  std::iota(d.changed_loops.begin(), d.changed_loops.end(), 0);
  detail::update_margins(d);
  if (!d.factors->health().singular) d.weak_pivots = detail::judge_weak_pivots(d, *d.margins);
  return c;
}

bool has_no_pivot(const Compiled& c) {
  return !c.data->weak_pivots || c.data->weak_pivots->least > 0;
}

Compiled reduce(Compiled c) {
  // Pivots may be rounding because the data have no digit there, or because of released joints: the
  // factors tell that first.
  if (c.data->weak_pivots) {
    detail::judge_internal_forces(*c.data);
    detail::judge_data_digits(*c.data);
  }
  detail::reduce(*c.skeleton, *c.data);
  return c;
}

bool is_overconstrained(const Compiled& c) { return !c.skeleton->stage.released.empty(); }

Compiled forces(Compiled c) {
  add_notes(detail::judge_internal_forces(*c.data), *c.data);
  return c;
}

bool has_data(const Compiled& c) {
  const std::vector<Node>& nodes = c.skeleton->stage.graph.nodes;
  return std::any_of(nodes.begin(), nodes.end(), [](const Node& n) {
    return dynamic_cast<const FromData*>(n.block.get()) != nullptr;
  });
}

Compiled digits(Compiled c) {
  add_notes(detail::judge_data_digits(*c.data), *c.data);
  return c;
}

Compiled certify(Compiled c) {
  c.data->checked();
  return c;
}

}  // namespace titop::steps
