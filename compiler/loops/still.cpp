#include <algorithm>
#include <iterator>
#include <titop/compiler/loops/still.hpp>
#include <titop/graph/linalg/index.hpp>
#include <titop/graph/support/some_names.hpp>
#include <utility>

namespace titop::loops {
namespace {

using linalg::at;

/// Scalar points mounted on others without any other tie close no chain, though their equations are
/// no edges of the tree either.
std::vector<Closing> without_hanging(const std::vector<Closing>& closings) {
  std::map<FormColumn, int> uses;
  for (const Closing& c : closings)
    for (const auto& [column, matrix] : c.form) ++uses[column];
  std::vector<Closing> result;
  std::copy_if(closings.begin(), closings.end(), std::back_inserter(result), [&](const Closing& c) {
    return c.tie->S.rows() != 1 || std::none_of(c.form.begin(), c.form.end(), [&](const auto& f) {
             return f.first.kind == FormColumn::Kind::root && uses[f.first] == 1 &&
                    !f.second.isZero(0);
           });
  });
  return result;
}

/// The chains' own equations, and those that determine the position of the point that they read (a
/// tree fixed at a far end), with the gains and sums that they read.
std::vector<char> placing(const Graph& g, const Motion& motion,
                          const std::vector<Closing>& closings) {
  std::vector<int> equation_of(g.signals.size(), -1);  // of signals outside channels
  for (int e = 0; e < static_cast<int>(g.equations.size()); ++e)
    if (const int target = g.equations[at(e)].target; g.signals[at(target)].channel < 0)
      equation_of[at(target)] = e;
  std::vector<int> open;
  for (const Closing& c : closings) open.insert(open.end(), c.equations.begin(), c.equations.end());
  for (int p = 0; p < static_cast<int>(g.channels.size()); ++p)
    if (const int e = motion.tie_above(p);
        e >= 0 && g.signals[at(g.equations[at(e)].target)].channel != p)
      open.push_back(e);
  std::vector<char> result(g.equations.size(), 0);
  while (!open.empty()) {
    const int e = open.back();
    open.pop_back();
    if (std::exchange(result[at(e)], 1)) continue;
    for (const Term& t : g.equations[at(e)].terms)
      if (equation_of[at(t.signal)] >= 0) open.push_back(equation_of[at(t.signal)]);
  }
  return result;
}

}  // namespace

void hold_still(Stage& stage, const Motion& motion, const std::vector<Closing>& closings,
                const AtRest& held) {
  if (held.empty()) return;
  Graph& g = stage.graph;
  const auto holds = [&](const FormColumn& c, int index) { return held.contains({c, index}); };
  const std::vector<char> still = motion.at_rest(holds),
                          grounded = motion.at_rest([](const FormColumn&, int) { return false; });
  const std::vector<char> places = placing(g, motion, without_hanging(closings));
  std::set<int> points;
  const auto clear = [&](std::vector<Term>& terms) {
    std::erase_if(terms, [&](const Term& t) {
      const Signal& s = g.signals[at(t.signal)];
      if (s.channel < 0 || s.quantity != Quantity::acceleration) return false;
      if (!still[at(s.channel)] || grounded[at(s.channel)]) return false;
      points.insert(s.channel);
      return true;
    });
  };
  const auto of_body = [&](const Equation& e) {
    return e.of_block && g.signals[at(e.target)].channel >= 0;
  };
  for (std::size_t e = 0; e < g.equations.size(); ++e)
    if (!places[e] && !of_body(g.equations[e])) clear(g.equations[e].terms);
  for (Output& o : g.outputs) clear(o.terms);
  if (points.empty()) return;
  std::vector<std::string> names;
  for (const int p : points) names.push_back(motion.name(p));
  stage.notes.push_back({Note::Kind::info, "chains",
                         "closed chains immobilise these points: " + detail::some_names(names)});
}

}  // namespace titop::loops
