#include <titop/analysis/reduction/remove_signals.hpp>
#include <titop/graph/linalg/index.hpp>

namespace titop::detail {
namespace {

using linalg::at;

}  // namespace

void remove_signals(Graph& g, const std::vector<char>& gone) {
  std::vector<int> place(g.signals.size() + 1);
  std::vector<Signal> kept;
  for (std::size_t s = 0; s < g.signals.size(); ++s) {
    place[s] = static_cast<int>(kept.size());
    if (!gone[s]) kept.push_back(g.signals[s]);
  }
  place.back() = static_cast<int>(kept.size());
  const auto follow = [&](int& signal) {
    if (signal >= 0) signal = gone[at(signal)] ? -1 : place[at(signal)];
  };
  g.signals = std::move(kept);
  for (Node& n : g.nodes) {
    n.first_signal = place[at(n.first_signal)];
    n.end_signal = place[at(n.end_signal)];
    follow(n.state);
  }
  for (Channel& c : g.channels) follow(c.accel), follow(c.force);
  for (Input& u : g.inputs) follow(u.signal);
  for (Equation& e : g.equations) {
    follow(e.target);
    for (Term& t : e.terms) follow(t.signal);
  }
  for (Output& o : g.outputs)
    for (Term& t : o.terms) follow(t.signal);
}

}  // namespace titop::detail
