#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/compiler/passes/moves_points.hpp>
#include <titop/compiler/passes/passes.hpp>
#include <titop/compiler/solve/data_digits.hpp>
#include <titop/compiler/solve/evaluate.hpp>
#include <titop/compiler/solve/margins.hpp>
#include <titop/compiler/solve/weak_pivot.hpp>
#include <titop/compiler/system/system_data.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/linalg/rounding.hpp>
#include <titop/graph/support/each_once.hpp>
#include <unordered_set>

/// New values of the parameters on the same plan: recomputes only the parts that depend on them.
namespace titop::detail {
namespace {

using linalg::at;

/// The parameters on which each coefficient depends, by its index.
std::vector<const std::vector<int>*> parameters_of_coefficients(const Stage& stage,
                                                                const solve::JointSystem& joint) {
  std::vector<const std::vector<int>*> result;
  const auto take = [&](int first, std::size_t terms, const Origin& origin) {
    result.resize(std::max(result.size(), at(first) + terms), nullptr);
    for (std::size_t k = 0; k < terms; ++k) result[at(first) + k] = &origin.parameters;
  };
  const Graph& g = stage.graph;
  for (std::size_t e = 0; e < g.equations.size(); ++e)
    take(joint.equation_coefficient[e], g.equations[e].terms.size(), stage.origins[e]);
  for (std::size_t o = 0; o < g.outputs.size(); ++o)
    take(joint.output_coefficient[o], g.outputs[o].terms.size(),
         stage.origins[g.equations.size() + o]);
  return result;
}

}  // namespace

std::vector<Dependents> find_dependents(const Stage& stage, const solve::JointSystem& joint) {
  const Graph& g = stage.graph;
  std::vector<Dependents> result(g.parameters.size());
  if (result.empty()) return result;
  std::vector<std::vector<int>> of_node(g.nodes.size());
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i)
    for (const Value& v : g.nodes[at(i)].block->values())
      if (v.is_parameter()) of_node[at(i)].push_back(v.index());
  for (int i = 0; i < static_cast<int>(g.nodes.size()); ++i)
    for (const int p : of_node[at(i)]) result[at(p)].nodes.push_back(i);
  for (int o = 0; o < static_cast<int>(stage.origins.size()); ++o)
    for (const int p : stage.origins[at(o)].parameters) result[at(p)].origins.push_back(o);
  const auto of_coefficient = parameters_of_coefficients(stage, joint);
  std::vector<int> loop_of_row(stage.rows.size(), -1), row_of_equation(g.equations.size(), -1);
  for (int l = 0; l < static_cast<int>(stage.loops.size()); ++l)
    for (const int r : stage.loops[at(l)].rows) loop_of_row[at(r)] = l;
  for (int r = 0; r < static_cast<int>(stage.rows.size()); ++r)
    if (const int e = stage.rows[at(r)].equation; e >= 0) row_of_equation[at(e)] = r;
  for (int r = 0; r < static_cast<int>(joint.rows.size()); ++r) {
    const auto depends = [&](const std::vector<int>& parameters) {
      for (const int p : parameters) result[at(p)].rows.push_back(r);
    };
    for (const solve::Piece& p : joint.row(r)) {
      using Left = solve::Piece::Left;
      if (p.of == Left::direct || p.of == Left::state) depends(of_node[at(p.left)]);
      for (const int c : {p.of == Left::coefficient ? p.left : -1, p.right})
        if (c >= 0 && at(c) < of_coefficient.size() && of_coefficient[at(c)])
          depends(*of_coefficient[at(c)]);
    }
  }
  for (Dependents& d : result) {
    keep_each_once(d.nodes);
    keep_each_once(d.rows);
    const auto add_loop = [&](int stage_row) {
      if (stage_row >= 0 && loop_of_row[at(stage_row)] >= 0)
        d.loops.push_back(loop_of_row[at(stage_row)]);
    };
    for (const int r : d.rows) add_loop(joint.rows[at(r)]);
    // Equations that are written out have no row of their own there.
    for (const int o : d.origins)
      if (at(o) < g.equations.size()) add_loop(row_of_equation[at(o)]);
    keep_each_once(d.loops);
  }
  return result;
}

namespace {

/// The parameters that get another value, and the values of all.
std::vector<int> set_values(const Graph& g, std::span<const std::pair<std::string, double>> list,
                            std::vector<double>& values) {
  std::vector<Mistake> mistakes;
  std::vector<int> changed;
  std::unordered_set<std::string_view> seen;
  for (const auto& [name, value] : list) {
    if (!seen.insert(name).second) {
      mistakes.push_back(
          {Code::duplicate_name,
           fmt::format("parameter {} is set twice, the second time to {}", name, value),
           {},
           "keep one of the two values"});
      continue;
    }
    const auto found = std::find_if(g.parameters.begin(), g.parameters.end(),
                                    [&](const Parameter& p) { return p.name == name; });
    if (found == g.parameters.end()) {
      std::string names;
      for (const Parameter& p : g.parameters) names += (names.empty() ? "" : ", ") + p.name;
      mistakes.push_back({Code::unknown_name,
                          fmt::format("{} has no parameter {}", g.name, name),
                          {},
                          names.empty() ? "make one with Diagram::param and use it for a number"
                                        : "its parameters are " + names});
      continue;
    }
    if (!std::isfinite(value)) {
      mistakes.push_back({Code::not_finite,
                          fmt::format("parameter {} is set to {}", name, value),
                          {},
                          "give it a finite value"});
      continue;
    }
    const int index = static_cast<int>(found - g.parameters.begin());
    if (values[at(index)] == value) continue;
    values[at(index)] = value;
    changed.push_back(index);
  }
  if (!mistakes.empty()) throw Error(std::move(mistakes));
  keep_each_once(changed);
  return changed;
}

template <class Member>
std::vector<int> united(const Skeleton& k, const std::vector<int>& changed, Member member) {
  std::vector<int> result;
  for (const int p : changed) {
    const std::vector<int>& list = k.dependents[at(p)].*member;
    result.insert(result.end(), list.begin(), list.end());
  }
  if (changed.size() > 1) keep_each_once(result);
  return result;
}

void remake_blocks(const Skeleton& k, const std::vector<int>& nodes, solve::Numbers& n) {
  for (const int i : nodes) {
    const Node& node = k.stage.graph.nodes[at(i)];
    try {
      n.blocks[at(i)] = node.block->dynamics(n.parameters);
      if (auto mistakes = mistakes_of(*node.block, *n.blocks[at(i)]); !mistakes.empty())
        throw Error(std::move(mistakes));
    } catch (const Error& error) {
      std::vector<Mistake> mistakes = error.mistakes();
      for (Mistake& m : mistakes)
        m.message = fmt::format("{} with the new values: {}", node.name, m.message);
      throw Error(std::move(mistakes));
    }
  }
}

/// False if the new values add or remove a term, which the plan does not provide for.
bool remake_coefficients(const Skeleton& k, const std::vector<int>& origins, solve::Numbers& n) {
  if (origins.empty()) return true;
  const Graph& g = k.stage.graph;
  const auto take = [&](int origin, std::span<const passes::NumericTerm> terms) {
    const std::size_t o = at(origin), equations = g.equations.size();
    const bool output = o >= equations;
    const auto& made = output ? g.outputs[o - equations].terms : g.equations[o].terms;
    const int first =
        output ? k.joint.output_coefficient[o - equations] : k.joint.equation_coefficient[o];
    if (made.size() != terms.size()) return false;
    for (std::size_t t = 0; t < made.size(); ++t) {
      if (made[t].signal != terms[t].signal) return false;
      n.coefficients[at(first) + t] = solve::coefficient_of(terms[t].coefficient);
    }
    return true;
  };
  return passes::lower_again(k.stage, origins, n.parameters, take);
}

}  // namespace

bool moves_chains(const Skeleton& k, const std::vector<int>& changed, ParameterValues before,
                  ParameterValues now) {
  const Stage& stage = k.stage;
  if (!stage.chained && stage.dependents.empty()) return false;
  for (const int i : united(k, changed, &Dependents::nodes))
    if (passes::moves_points(*stage.graph.nodes[at(i)].block, before, now)) return true;
  const auto origins = united(k, changed, &Dependents::origins);
  if (!stage.released.empty() && !origins.empty()) return true;  // may read internal forces
  return std::any_of(origins.begin(), origins.end(), [&](int o) {
    const Origin::Of of = stage.origins[at(o)].of;
    if (of == Origin::Of::accel) return true;
    if (of != Origin::Of::one_way && of != Origin::Of::algebraic) return false;
    // Gains, sums and Integrators pass motions on; controllers, and hubs with their masses, do not.
    const Graph& g = stage.graph;
    const Node& node = g.nodes[at(g.signals[at(g.equations[at(o)].target)].node)];
    return node.block->interface().channels.empty() &&
           (node.lowered || node.block->type() == "Integrator");
  });
}

namespace {

/// "k = 3, angle = 0.2"
std::string text_of(const Skeleton& k, const std::vector<int>& changed, ParameterValues values) {
  std::string text;
  for (const int p : changed)
    text += fmt::format("{}{} = {:.6g}", text.empty() ? "" : ", ",
                        k.stage.graph.parameters[at(p)].name, values[at(p)]);
  return text.empty() ? "no new value" : text;
}

/// All passes again; notes it, and whether the states have changed.
std::shared_ptr<const SystemData> compiled_again(const SystemData& old,
                                                 const std::vector<int>& changed,
                                                 const std::vector<double>& values,
                                                 const char* why) {
  const std::shared_ptr<SystemData> d = compile_again(old, values);
  d->notes.push_back(
      {Note::Kind::info, "update",
       fmt::format("{}: {}, all passes run again", text_of(*old.skeleton, changed, values), why)});
  if (d->state_names() != old.state_names())
    d->notes.push_back(
        {Note::Kind::warning, "update",
         "the dependent states have changed: the model has other states than before"});
  return d;
}

/// True if a value has moved so far that the scaling found for another one may not serve.
bool has_moved(double value, double scaled_at) {
  constexpr double kFar = 8;
  const double a = std::abs(value), b = std::abs(scaled_at);
  return a > kFar * b || b > kFar * a;
}

/// True if pivots have lost half the digits that they had when the scaling was found, in any number
/// of updates, or have none.
bool outgrown(const solve::Health& now, const solve::Health& scaled) {
  return now.singular || now.weakest < linalg::kHalfDigits * scaled.weakest ||
         linalg::kHalfDigits * now.growth > scaled.growth;
}

/// The factors for the new values, scaled anew if need be.
void refactor(const SystemData& old, const std::vector<int>& changed, SystemData& d) {
  const Skeleton& k = *d.skeleton;
  const auto rows = real_rows(k, d.numbers);
  const auto& values = d.numbers.parameters;
  d.scaled_at = old.scaled_at;
  const bool rescale = std::any_of(changed.begin(), changed.end(), [&](int p) {
    return has_moved(values[at(p)], d.scaled_at[at(p)]);
  });
  for (const int p : changed)
    if (rescale) d.scaled_at[at(p)] = values[at(p)];
  d.factors = std::make_unique<const solve::Factors<double>>(
      old.factors->changed(rows, united(k, changed, &Dependents::rows), rescale));
  const solve::Health now = d.factors->health();
  const bool all = outgrown(now, old.scaled_health);
  d.scaled_health = old.scaled_health;
  if (rescale) {  // some fronts only: the losses of all still count
    d.scaled_health.weakest = std::max(d.scaled_health.weakest, now.weakest);
    d.scaled_health.growth = std::min(d.scaled_health.growth, now.growth);
  }
  if (all) {
    d.scaled_at = values;
    d.factors = std::make_unique<const solve::Factors<double>>(k.joint.plan, rows);
    d.scaled_health = d.factors->health();
  }
  d.plans_renewed = old.plans_renewed + (rescale || all);
}

}  // namespace

std::shared_ptr<const SystemData> updated(const SystemData& old,
                                          std::span<const std::pair<std::string, double>> list) {
  const Skeleton& k = *old.skeleton;
  auto d = std::make_shared<SystemData>();
  d->skeleton = old.skeleton;
  d->numbers = old.numbers;
  d->states = old.states;
  const std::vector<int> changed = set_values(k.stage.graph, list, d->numbers.parameters);
  const auto again = [&](const char* why) {
    return compiled_again(old, changed, d->numbers.parameters, why);
  };
  constexpr const char* kSingular =
      "the equations as written are singular, as where a point has no mass";
  constexpr const char* kOtherTerms = "closed chains or terms of the equations change";
  constexpr const char* kOpened = "parameters are opened";
  constexpr const char* kNoDigit = "a pivot has no digit left";
  remake_blocks(k, united(k, changed, &Dependents::nodes), d->numbers);
  if (!k.stage.opened.empty()) return again(kOpened);
  // The reduction depends on all rows and all numbers.
  if (k.before_reduce) return again(kSingular);
  if (moves_chains(k, changed, old.numbers.parameters, d->numbers.parameters))
    return again(kOtherTerms);
  if (!remake_coefficients(k, united(k, changed, &Dependents::origins), d->numbers))
    return again(kOtherTerms);
  refactor(old, changed, *d);
  const solve::Health health = d->factors->health();
  if (health.singular) return again(kNoDigit);  // it may reduce: a mass of 0
  std::ranges::copy_if(old.notes, std::back_inserter(d->notes),
                       [](const Note& n) { return n.pass != "digits" && n.pass != "update"; });
  std::ranges::copy(judge_data_digits(*d), std::back_inserter(d->notes));
  d->notes.push_back(
      {Note::Kind::info, "update",
       fmt::format("{}: {} of {} fronts recomputed", text_of(k, changed, d->numbers.parameters),
                   d->factors->fronts_made(), k.joint.plan->fronts.size())});
  d->margins = old.margins;
  d->changed_loops = united(k, changed, &Dependents::loops);
  d->changed_loops.insert(d->changed_loops.end(), old.changed_loops.begin(),
                          old.changed_loops.end());
  keep_each_once(d->changed_loops);
  // A pivot about as weak as before (within a digit) has been judged then.
  if (health.weakest < std::min(kFewDigits, linalg::kOneDigit * old.scaled_health.weakest)) {
    update_margins(*d);
    d->weak_pivots = judge_weak_pivots(*d, *d->margins);
    if (d->weak_pivots->least > 0) return again(kNoDigit);
  }
  return d;
}

}  // namespace titop::detail
