#include <algorithm>
#include <titop/compiler/passes/lower/lowering.hpp>
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
  const auto look = [&](const std::vector<Term>& terms, const SourceLine& where) {
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

  /// z' = `of` times the motion of the reference and `of_states` times that of the states.
  std::vector<Term> motion_terms(const Node& node, const Kinematics& k,
                                 const std::vector<const OpenedMotion*>& motions,
                                 bool position) const {
    const Channel& reference = g.channels[at(node.first_channel + k.reference)];
    const Eigen::Index n = k.Phi[0].cols(), rows = std::ssize(motions);
    Eigen::MatrixXd of = Eigen::MatrixXd::Zero(rows, reference.size),
                    of_states = Eigen::MatrixXd::Zero(rows, n);
    for (Eigen::Index j = 0; j < rows; ++j) {
      const OpenedMotion& m = *motions[at(j)];
      if (m.of.size() > 0) of.row(j) = m.of;
      if (m.of_states.size() > 0) of_states.row(j) = m.of_states;
    }
    std::vector<Term> terms;
    const auto add = [&](Term term, Eigen::MatrixXd factor) {
      if (factor.isZero(0)) return;
      term.factors = {Matrix{std::make_shared<const Eigen::MatrixXd>(std::move(factor))}};
      terms.push_back(std::move(term));
    };
    add({.signal = reference.accel, .of = position ? Term::Of::position : Term::Of::rate},
        std::move(of));
    if (node.state >= 0)
      add({.signal = node.state},
          position ? of_states
                   : Eigen::MatrixXd(of_states * node.block->dynamics(stage.values)->A));
    return terms;
  }

  /// motion_terms of a w of a block that moves points; else none.
  std::vector<Term> of_block(const std::vector<Term>& z, bool position) const {
    if (z.size() != 1 || g.signals[at(z[0].signal)].node < 0) return {};
    const Signal& out = g.signals[at(z[0].signal)];
    const Node& node = g.nodes[at(out.node)];
    if (out.channel >= 0 || out.role != Signal::Role::output) return {};
    const auto k = node.block->kinematics(stage.values);
    if (!k) return {};
    for (const auto& [port, motions] : opened_ports_of(*k)) {
      // The z of a port stands among the outputs as its w among the inputs, from the end.
      const Interface& face = node.block->interface();
      if (face.inputs.size() - at(port) != face.outputs.size() - at(out.spec)) continue;
      return motion_terms(node, *k, motions, position);
    }
    return {};
  }

  /// The input of the motion of this w; made, with its output, if it is not there.
  int opened(int w, bool position) {
    if (const int there = opened_motion(g, w, position); there >= 0) return there;
    const Input of = g.inputs[at(g.signals[at(w)].spec)];
    const std::string name = name_of_motion(of.name, position);
    const auto same = [&](const auto& item) { return item.name == of.name; };
    std::vector<Term> z = std::find_if(g.outputs.begin(), g.outputs.end(), same)->terms;
    std::vector<Term> moved = of_block(z, position);
    const int size = moved.empty() ? of.size : rows_of(g, moved[0]);
    const int made = add_input(g, name, size);
    g.inputs.back().parameter = of.parameter;
    if (!moved.empty()) z.clear();
    for (Term& t : z)
      if (g.signals[at(t.signal)].role == Signal::Role::external)
        t.signal = opened(t.signal, position);
      else
        t.of = position ? Term::Of::position : Term::Of::rate;
    z.insert(z.end(), moved.begin(), moved.end());
    g.outputs.push_back({.name = name, .size = size, .set = true, .terms = std::move(z)});
    g.outputs.back().declared = static_cast<int>(g.outputs.size()) - 1;
    const auto pairs = std::find_if(stage.opened.begin(), stage.opened.end(), same);
    const OpenedPairs more{name, of.parameter, size, pairs->where};
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

std::map<int, std::vector<const OpenedMotion*>> opened_ports_of(const Kinematics& k) {
  std::map<int, std::vector<const OpenedMotion*>> ports;
  for (const OpenedMotion& m : k.opened) ports[m.port].push_back(&m);
  return ports;
}

int opened_input(const Graph& g, const Node& node, int port) {
  for (int s = node.first_signal; s < node.end_signal; ++s) {
    const Signal& u = g.signals[at(s)];
    if (u.role != Signal::Role::input || u.channel >= 0 || u.spec != port) continue;
    for (const Equation& e : g.equations)
      if (e.target == s) return e.terms.at(0).signal;
  }
  throw std::logic_error("an opened block without the equation of its w");
}

void open_motions(Stage& stage, Graph& g) {
  if (stage.opened.empty()) return;
  MotionOpening opening{stage, g};
  for (auto list = unopened(stage, g); !list.empty(); list = unopened(stage, g))
    for (const auto& [w, level] : list) opening.opened(w, level == Level::position);
}

}  // namespace titop::passes
