#include <algorithm>
#include <titop/compiler/passes/lower/amounts.hpp>
#include <titop/compiler/passes/lower/open_motions.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::passes {
namespace {

using linalg::at;
using Level = Lowering::Level;

std::string name_of_motion(const std::string& w, bool position) {
  return w + (position ? " position" : " rate");
}

/// The pairs that terms of rates and positions need and that are not there.
std::set<std::pair<int, Level>> unopened(const Stage& stage, const Graph& g) {
  Lowering l(g, stage.values, std::make_shared<const Drives>(g), stage.motions);
  const auto look = [&](const std::vector<Term>& terms, const std::source_location& where) {
    for (const Term& t : terms)
      if (t.of == Term::Of::position || t.of == Term::Of::rate)
        l.collect(where, [&] { return l.terms({t}); });  // mistakes: found again by `lower`
  };
  for (const Equation& e : g.equations) look(e.terms, e.where);
  for (const Output& o : g.outputs) look(o.terms, o.where);
  return l.unopened;
}

struct MotionOpening {
  Stage& stage;
  Graph& g;

  /// The input of the motion of this w; made, with its output, if it is not there.
  int opened(int w, bool position) {
    if (const int there = opened_motion(g, w, position); there >= 0) return there;
    const Input of = g.inputs[at(g.signals[at(w)].spec)];
    const std::string name = name_of_motion(of.name, position);
    const int made = add_input(g, name, of.size);
    g.inputs.back().parameter = of.parameter;
    const auto same = [&](const auto& item) { return item.name == of.name; };
    std::vector<Term> z = std::find_if(g.outputs.begin(), g.outputs.end(), same)->terms;
    for (Term& t : z)
      if (g.signals[at(t.signal)].role == Signal::Role::external)
        t.signal = opened(t.signal, position);
      else
        t.of = position ? Term::Of::position : Term::Of::rate;
    g.outputs.push_back({.name = name, .size = of.size, .set = true, .terms = std::move(z)});
    g.outputs.back().declared = static_cast<int>(g.outputs.size()) - 1;
    const auto pairs = std::find_if(stage.opened.begin(), stage.opened.end(), same);
    const OpenedPairs more{name, of.parameter, of.size, pairs->where};
    stage.opened.push_back(more);
    return made;
  }
};

}  // namespace

int opened_motion(const Graph& g, int w, bool position) {
  const std::string name = name_of_motion(g.inputs[at(g.signals[at(w)].spec)].name, position);
  for (const Input& u : g.inputs)
    if (u.parameter >= 0 && u.name == name) return u.signal;
  return -1;
}

void open_motions(Stage& stage, Graph& g) {
  if (stage.opened.empty()) return;
  MotionOpening opening{stage, g};
  for (auto list = unopened(stage, g); !list.empty(); list = unopened(stage, g))
    for (const auto& [w, level] : list) opening.opened(w, level == Level::position);
}

}  // namespace titop::passes
