#include <algorithm>
#include <titop/compiler/passes/lower/by_name.hpp>
#include <titop/compiler/passes/lower/lowering.hpp>
#include <titop/compiler/passes/lower/rigid_motions.hpp>
#include <titop/compiler/passes/lower/shared_motions.hpp>
#include <titop/graph/drives.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/nodes/lti.hpp>
#include <unordered_set>

namespace titop::passes {
namespace {

using Eigen::MatrixXd;
using linalg::at;

/// "hub.parent.angular_rate"
std::string name_of(const Graph& g, const RigidMotion& m) {
  const std::string half = m.half == RigidMotion::Half::linear    ? "linear_"
                           : m.half == RigidMotion::Half::angular ? "angular_"
                                                                  : "";
  return channel_name(g, g.signals[at(m.signal)].channel) + "." + half +
         (m.twice ? "position" : "rate");
}

/// This name, longer if a node has it.
std::string free_name(std::unordered_set<std::string>& taken, std::string name) {
  while (!taken.insert(name).second) name += '_';
  return name;
}

/// Integrators of the acceleration, once or twice, as a user would write them.
void add_integrators(Graph& g, const std::set<RigidMotion>& missing,
                     std::vector<RigidMotion>& motions) {
  std::set<RigidMotion> all = missing;
  for (RigidMotion m : missing)
    if (m.twice) {
      m.twice = false;
      const bool there = std::any_of(motions.begin(), motions.end(), [&](const RigidMotion& o) {
        return o.signal == m.signal && o.half == m.half && !o.twice;
      });
      if (!there) all.insert(m);
    }
  std::unordered_set<std::string> taken;
  for (const Node& n : g.nodes) taken.insert(n.name);
  const auto find = [&](const RigidMotion& m, bool twice) {
    return std::find_if(motions.begin(), motions.end(),
                        [&](const RigidMotion& o) {
                          return o.signal == m.signal && o.half == m.half && o.twice == twice;
                        })
        ->node;
  };
  for (const bool twice : {false, true})
    for (RigidMotion m : all) {
      if (m.twice != twice) continue;
      const int size = g.signals[at(m.signal)].size;
      const bool half = m.half != RigidMotion::Half::whole;
      const Node& owner = g.nodes[at(g.signals[at(m.signal)].node)];
      m.node = add_node(g, free_name(taken, name_of(g, m)), as_block(Integrator{half ? 3 : size}),
                        owner.where);
      Term from{.signal = m.signal};
      if (twice) {
        from.signal = g.nodes[at(find(m, false))].first_signal + 1;
      } else if (half) {
        const int first = m.half == RigidMotion::Half::angular ? 3 : 0;
        from.factors.emplace_back(
            Part{MatrixXd::Identity(6, 6).middleRows(first, 3), first ? ".angular" : ".linear"});
      }
      g.equations.push_back({.target = g.nodes[at(m.node)].first_signal, .terms = {from}});
      motions.push_back(m);
    }
}

bool asks_for_motion(const std::vector<Term>& terms) {
  return std::any_of(terms.begin(), terms.end(), [](const Term& t) {
    return t.of == Term::Of::position || t.of == Term::Of::rate;
  });
}

bool asks_for_motion(const Graph& g) {
  const auto asks = [](const auto& item) { return asks_for_motion(item.terms); };
  return std::any_of(g.equations.begin(), g.equations.end(), asks) ||
         std::any_of(g.outputs.begin(), g.outputs.end(), asks);
}

}  // namespace

void add_rigid_motions(Stage& stage, Graph& g) {
  if (!asks_for_motion(g)) return;
  std::set<RigidMotion> missing;
  {
    Lowering l(g, stage.values, std::make_shared<const Drives>(g), stage.motions);
    l.share(find_shared_motions(stage, g));
    const auto look = [&](const std::vector<Term>& terms, const SourceLine& where) {
      for (const Term& t : terms)
        if (t.of == Term::Of::position || t.of == Term::Of::rate)
          l.collect(where, [&] { return l.terms({t}); });
    };
    for (const Equation& e : g.equations) look(e.terms, e.where);
    for (const Output& o : g.outputs) look(o.terms, o.where);
    missing = l.missing;  // mistakes in these terms are found again by `lower`
  }
  if (missing.empty()) return;
  add_integrators(g, missing, stage.motions);
  g = by_name(g, stage);
  std::string list;
  for (const RigidMotion& m : stage.motions)
    list += (list.empty() ? "" : ", ") + g.nodes[at(m.node)].name;
  stage.notes.push_back({Note::Kind::info, "lower",
                         "Integrators added for motions that no state determines: " + list});
}

}  // namespace titop::passes
