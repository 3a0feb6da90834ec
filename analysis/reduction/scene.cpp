#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <titop/analysis/reduction/ray.hpp>
#include <titop/analysis/reduction/remove_signals.hpp>
#include <titop/analysis/reduction/scene.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

constexpr double kLeastAccuracy = 2 * kOfTransfer;  ///< half of it is left to rounding

using linalg::at;

/// A choice of the scene: an input or output, and one of its scalars or all (-1).
struct PortChoice {
  int index = -1, component = -1;
};

/// "W" or "W(3)" among inputs or outputs.
template <class List>
PortChoice find(const List& list, const std::string& name) {
  for (int i = 0; i < static_cast<int>(list.size()); ++i) {
    if (list[at(i)].name == name) return {i, -1};
    for (int k = 0; k < list[at(i)].size; ++k)
      if (list[at(i)].size > 1 && fmt::format("{}({})", list[at(i)].name, k + 1) == name)
        return {i, k};
  }
  return {};
}

/// The chosen ones in the order of the list, each once; all for no names.
template <class List>
std::vector<PortChoice> choose(const List& list, const std::vector<std::string>& names,
                               std::string_view subject, std::vector<Mistake>& mistakes) {
  std::vector<std::vector<char>> taken;
  for (const auto& item : list) taken.emplace_back(at(item.size), names.empty() ? 1 : 0);
  for (const std::string& name : names) {
    const PortChoice c = find(list, name);
    if (c.index >= 0) {
      auto& mask = taken[at(c.index)];
      if (c.component < 0)
        std::fill(mask.begin(), mask.end(), 1);
      else
        mask[at(c.component)] = 1;
      continue;
    }
    std::string valid;
    for (const auto& item : list) valid += (valid.empty() ? "" : ", ") + item.name;
    mistakes.push_back(
        {Code::unknown_name,
         fmt::format("the scene has the {} {}, which the diagram does not have", subject, name),
         {fmt::format("there are: {}", valid.empty() ? "none" : valid)},
         fmt::format("take one of them, or one scalar of it as \"{}(1)\"",
                     list.empty() ? "name" : list.front().name)});
  }
  std::vector<PortChoice> result;
  for (int i = 0; i < static_cast<int>(list.size()); ++i) {
    const auto& mask = taken[at(i)];
    if (std::count(mask.begin(), mask.end(), 1) == list[at(i)].size) {
      result.push_back({i, -1});
      continue;
    }
    for (int k = 0; k < list[at(i)].size; ++k)
      if (mask[at(k)]) result.push_back({i, k});
  }
  return result;
}

Matrix unit(int size, int component, bool row) {
  Eigen::MatrixXd e = Eigen::MatrixXd::Zero(size, 1);
  e(component, 0) = 1;
  if (row) e.transposeInPlace();
  return {std::make_shared<const Eigen::MatrixXd>(std::move(e))};
}

/// Replaces terms of the inputs by nothing, by the input itself, or by its scalars.
class Rewriter {
 public:
  Rewriter(const Graph& before, Graph& g, const std::vector<PortChoice>& inputs)
      : before_(before), new_(before.inputs.size()) {
    for (const PortChoice& c : inputs) {
      const Input& old = before.inputs[at(c.index)];
      const bool whole = c.component < 0;
      const int signal =
          add_input(g, whole ? old.name : fmt::format("{}({})", old.name, c.component + 1),
                    whole ? old.size : 1, old.where);
      new_[at(c.index)].push_back({signal, c.component});
    }
  }
  /// The terms that replace `old` (a term of the graph before) in the new graph.
  std::vector<Term> terms(const Term& old, const Term& renumbered) const {
    if (old.signal < 0) return {renumbered};
    const Signal& s = before_.signals[at(old.signal)];
    if (s.role != Signal::Role::external) return {renumbered};
    std::vector<Term> result;
    for (const auto& [signal, component] : new_[at(s.spec)]) {
      Term t = renumbered;
      t.signal = signal;
      if (component >= 0) t.factors.emplace_back(unit(s.size, component, false));
      result.push_back(std::move(t));
    }
    return result;
  }
  std::vector<Term> terms(const std::vector<Term>& old, const std::vector<Term>& renumbered) const {
    std::vector<Term> result;
    for (std::size_t i = 0; i < old.size(); ++i)
      for (Term& t : terms(old[i], renumbered[i])) result.push_back(std::move(t));
    return result;
  }

 private:
  const Graph& before_;
  std::vector<std::vector<std::pair<int, int>>> new_;  ///< per old input: signal and component
};

}  // namespace

void check(const Scene& scene) {
  std::vector<Mistake> mistakes;
  const auto refuse = [&](std::string message, std::string hint) {
    mistakes.push_back({Code::bad_value, std::move(message), {}, std::move(hint)});
  };
  const auto [lo, hi] = scene.band_hz;
  if (!std::isfinite(lo) || !std::isfinite(hi) || lo < 0 || hi < lo)
    refuse(fmt::format("the scene's band is {} to {} Hz", lo, hi),
           "give Scene{.band_hz = {lower, upper}} with 0 <= lower <= upper");
  if (!(scene.accuracy >= kLeastAccuracy && scene.accuracy <= 1))
    refuse(fmt::format("the scene's accuracy is {}", scene.accuracy),
           fmt::format("give a relative error between {:.0e} and 1", kLeastAccuracy));
  if (!(scene.damping_floor >= kUndamped && scene.damping_floor <= 0.5))
    refuse(fmt::format("the scene's damping floor is {}", scene.damping_floor),
           "give a damping ratio between 1e-6 and 0.5");
  if (scene.whole_up_to < 1)
    refuse(fmt::format("the scene reduces the whole up to {} coordinates", scene.whole_up_to),
           "give Scene::whole_up_to at least 1");
  if (scene.balance_up_to < 1)
    refuse(fmt::format("the scene balances up to {} states", scene.balance_up_to),
           "give Scene::balance_up_to at least 1");
  if (!mistakes.empty()) throw Error(std::move(mistakes));
}

Graph restricted(const Graph& graph, const Scene& scene) {
  std::vector<Mistake> mistakes;
  const auto inputs = choose(graph.inputs, scene.inputs, "input", mistakes);
  const auto outputs = choose(graph.outputs, scene.outputs, "output", mistakes);
  if (!mistakes.empty()) throw Error(std::move(mistakes));
  Graph g = graph;
  std::vector<char> external;
  for (const Signal& s : g.signals) external.push_back(s.role == Signal::Role::external);
  remove_signals(g, external);
  g.inputs.clear();
  const Rewriter rewrite(graph, g, inputs);
  for (std::size_t e = 0; e < g.equations.size(); ++e)
    g.equations[e].terms = rewrite.terms(graph.equations[e].terms, g.equations[e].terms);
  std::vector<Output> kept;
  for (const PortChoice& c : outputs) {
    Output o = g.outputs[at(c.index)];
    o.terms = rewrite.terms(graph.outputs[at(c.index)].terms, o.terms);
    if (c.component >= 0) {
      for (Term& t : o.terms) {
        t.factors.emplace_back(unit(o.size, c.component, true));
        std::rotate(t.factors.begin(), t.factors.end() - 1, t.factors.end());  // it acts last
      }
      o.name = fmt::format("{}({})", o.name, c.component + 1);
      o.size = 1;
    }
    o.declared = static_cast<int>(kept.size());
    kept.push_back(std::move(o));
  }
  g.outputs = std::move(kept);
  return g;
}

}  // namespace titop::detail
